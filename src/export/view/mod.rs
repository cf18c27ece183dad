//! A picture of solids, shaded, without graphics hardware or a display.
//!
//! Triangles are drawn into a depth picture of the eye ([`depth`]) at twice the size of the result; what each cell
//! sees is lit by a lamp and a sky whose directions have depth pictures of their own ([`light`]), and four cells
//! make a pixel. Light of the lamp is the same in all of a plane that a pixel sees, and that of the sky in four pixels.
//! The part stands on a sheet of paper on which its shadow falls, except in the view from in front.
//! Excluded: perspective, gloss that mirrors, textures.

mod camera;
mod depth;
mod light;

use glam::{DVec2, DVec3};
use resvg::tiny_skia::{ColorU8, Pixmap};

pub use camera::View;

use self::camera::{Camera, Raster};
use self::depth::{Depths, NONE};
use self::light::{Place, lamp_light, open_sky, towards_lamp};
use super::ExportError;
use super::canvas::{PAPER, check_pixels};
use crate::fabricate::Solid;

/// Cells along the side of a pixel.
const CELLS: usize = 2;
/// Cells along the side of a square in which the sky is the same.
const SKY_CELLS: usize = 4;
/// The margin on each side, as a part of the longer side of what is seen.
const MARGIN: f64 = 0.05;
/// What parts are painted with when nothing else is asked for: brass.
pub const DEFAULT_COLOUR: [u8; 3] = [0xd9, 0x9c, 0x4b];

/// How much the lamp, the sky, and what the paper throws back give.
const LAMP: f32 = 0.8;
const SKY: f32 = 0.4;
const BOUNCE: f32 = 0.12;
/// How bright the reflection of the lamp is, and how small.
const GLOSS: f32 = 0.22;
const POLISH: i32 = 28;

/// A solid and its colour (sRGB).
#[derive(Debug, Clone, Copy)]
pub struct Painted<'s> {
    /// The solid.
    pub solid: &'s Solid,
    /// Red, green and blue.
    pub colour: [u8; 3],
}

/// The solids as a PNG of `longer_side` pixels (with margins), seen from `view`.
///
/// # Errors
/// [`ExportError::Option`] for a size that no picture can have, [`ExportError::Empty`] without facets.
pub fn view_png(parts: &[Painted<'_>], view: View, longer_side: u32) -> Result<Vec<u8>, ExportError> {
    check_pixels(longer_side)?;
    let triangles: Vec<[DVec3; 3]> = parts.iter().flat_map(|part| corners(part.solid)).collect();
    let colours: Vec<[f32; 3]> = parts
        .iter()
        .flat_map(|part| std::iter::repeat_n(linear(part.colour), part.solid.triangles().len()))
        .collect();
    let floor = triangles.iter().flatten().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let camera = view.camera();
    let raster = window(&triangles, &camera, longer_side)?;
    let seen = Depths::new(&triangles, &camera, raster);

    let place = |cell: usize| {
        let middle = raster.middle(cell);
        if seen.triangles[cell] != NONE {
            let at = camera.back(middle.extend(f64::from(seen.nearest[cell])));
            return Some(Place { at, normal: normal(&triangles[seen.triangles[cell] as usize]) });
        }
        // Where the eye meets the paper that the part stands on.
        let at = camera.back(middle.extend(0.0));
        (camera.towards.z > 0.0).then(|| Place {
            at: at + camera.towards * ((floor - at.z) / camera.towards.z),
            normal: DVec3::Z,
        })
    };
    let (places, place_of) = shared(&raster, CELLS, place);
    let (sky_places, sky_of) = shared(&raster, SKY_CELLS, place);
    let lamp = lamp_light(&triangles, &places);
    let sky = open_sky(&triangles, &sky_places);
    let paper = linear(PAPER);
    let shade = |cell: usize| {
        let Some(place) = places.get(place_of[cell] as usize) else { return paper };
        let light = Light { lamp: lamp[place_of[cell] as usize], sky: sky[sky_of[cell] as usize] };
        match seen.triangles[cell] {
            NONE => on_paper(paper, &light),
            triangle => on_part(colours[triangle as usize], &light, place.normal, &camera),
        }
    };
    encode(&raster, shade)
}

/// What reaches a point, each from 0 to 1.
struct Light {
    /// Of the lamp, with the angle at which it falls.
    lamp: f32,
    /// The part of the sky that is seen.
    sky: f32,
}

/// The places that cells see, and which each of them sees ([`NONE`] for nothing). Cells of one square with so many to a side
/// that look at the same plane share one.
fn shared(raster: &Raster, side: usize, place: impl Fn(usize) -> Option<Place>) -> (Vec<Place>, Vec<u32>) {
    let mut places: Vec<Place> = Vec::new();
    let mut place_of = vec![NONE; raster.cells()];
    let within = side as f64 / raster.scale;
    for square in 0..raster.width.div_ceil(side) * raster.height.div_ceil(side) {
        let first = places.len();
        for cell in cells_of(raster, side, square) {
            let Some(place) = place(cell) else { continue };
            let is_same = |known: &Place| {
                known.normal.dot(place.normal) > 0.9999
                    && (known.at - place.at).dot(place.normal).abs() < within
            };
            let known = places[first..].iter().position(is_same);
            place_of[cell] = (first + known.unwrap_or(places.len() - first)) as u32;
            if known.is_none() {
                places.push(place);
            }
        }
    }
    (places, place_of)
}

/// The cells of a square with so many to a side; squares are counted line by line from the one with the least x and y.
fn cells_of(raster: &Raster, side: usize, square: usize) -> impl Iterator<Item = usize> {
    let across = raster.width.div_ceil(side);
    let (left, below) = (square % across * side, square / across * side);
    let (width, right, above) =
        (raster.width, raster.width.min(left + side), raster.height.min(below + side));
    (below..above).flat_map(move |y| (left..right).map(move |x| y * width + x))
}

fn corners(solid: &Solid) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    solid.facets().map(|facet| facet.map(|p| DVec3::from_array(p.map(f64::from))))
}

fn normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// What the eye sees with its margins, in whole pixels.
fn window(triangles: &[[DVec3; 3]], camera: &Camera, longer_side: u32) -> Result<Raster, ExportError> {
    let flat = triangles.iter().flatten().map(|&p| camera.of(p).truncate());
    let (low, high) =
        flat.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    if !low.is_finite() || !high.is_finite() {
        return Err(ExportError::Empty);
    }
    let margin = DVec2::splat(MARGIN * (high - low).max_element());
    let pixels = Raster::new(low - margin, high + margin, longer_side as usize);
    let (width, height) = (pixels.width * CELLS, pixels.height * CELLS);
    Ok(Raster { scale: pixels.scale * CELLS as f64, width, height, ..pixels })
}

/// The colour of the paper where light falls on it like this.
fn on_paper(paper: [f32; 3], light: &Light) -> [f32; 3] {
    let open = towards_lamp().z as f32;
    let brightness = (LAMP * light.lamp / open + SKY * light.sky) / (LAMP + SKY);
    // Shadows on paper are cold, as only the sky shines into them.
    let [r, g, b] = paper;
    let shade = 1.0 - brightness;
    [r * brightness, g * (brightness + 0.02 * shade), b * (brightness + 0.07 * shade)]
}

/// The colour of a part where light falls on it like this.
fn on_part(colour: [f32; 3], light: &Light, normal: DVec3, camera: &Camera) -> [f32; 3] {
    let bounce = BOUNCE * (1.0 - normal.z as f32) / 2.0;
    let diffuse = LAMP * light.lamp + SKY * light.sky * (0.6 + 0.4 * normal.z as f32) + bounce;
    let half = (towards_lamp() + camera.towards).normalize();
    let is_lit = if light.lamp > 0.0 { 1.0 } else { 0.0 };
    let gloss = GLOSS * is_lit * (normal.dot(half).max(0.0) as f32).powi(POLISH);
    colour.map(|c| c * diffuse + gloss)
}

/// Four cells to a pixel, y down.
fn encode(raster: &Raster, shade: impl Fn(usize) -> [f32; 3]) -> Result<Vec<u8>, ExportError> {
    let (width, height) = (raster.width / CELLS, raster.height / CELLS);
    let size = |n: usize| u32::try_from(n).map_err(|_| ExportError::Picture);
    let mut picture = Pixmap::new(size(width)?, size(height)?).ok_or(ExportError::Picture)?;
    for (at, pixel) in picture.pixels_mut().iter_mut().enumerate() {
        let mut sum = [0.0; 3];
        for cell in cells_of(raster, CELLS, (height - 1 - at / width) * width + at % width) {
            sum.iter_mut().zip(shade(cell)).for_each(|(sum, c)| *sum += c.min(1.0) / (CELLS * CELLS) as f32);
        }
        let [r, g, b] = sum.map(encoded);
        *pixel = ColorU8::from_rgba(r, g, b, 255).premultiply();
    }
    picture.encode_png().map_err(|_| ExportError::Picture)
}

/// Light from sRGB (IEC 61966-2-1).
fn linear(colour: [u8; 3]) -> [f32; 3] {
    colour.map(|c| {
        let c = f32::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

/// sRGB from light.
fn encoded(light: f32) -> u8 {
    let c = if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (c.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::super::canvas::frame;
    use super::*;
    use crate::fabricate::extrude;

    fn solid_frame() -> Solid {
        extrude(&frame(), 5.0).unwrap()
    }

    fn picture(view: View) -> Pixmap {
        let solid = solid_frame();
        let bytes = view_png(&[Painted { solid: &solid, colour: DEFAULT_COLOUR }], view, 220).unwrap();
        assert_eq!(bytes, view_png(&[Painted { solid: &solid, colour: DEFAULT_COLOUR }], view, 220).unwrap());
        Pixmap::decode_png(&bytes).unwrap()
    }

    #[test]
    fn from_above_there_is_the_part_its_hole_and_a_shadow() {
        let picture = picture(View::Top);
        assert_eq!((picture.width(), picture.height()), (220, 120));
        let blue = |x, y| picture.pixel(x, y).unwrap().blue();
        // The bar on the left, and the paper in the middle of the hole and in a corner.
        assert!(blue(22, 60) < 0xa0);
        assert!(blue(110, 60) > 0xc8 && blue(4, 116) > 0xd0, "{} {}", blue(110, 60), blue(4, 116));
        // The lamp is on the left, so the shadow of the bar falls to its right.
        assert!(blue(37, 60) < blue(150, 60) - 20, "{} {}", blue(37, 60), blue(150, 60));
    }

    #[test]
    fn from_in_front_there_is_no_paper_to_shade() {
        let picture = picture(View::Front);
        assert_eq!((picture.width(), picture.height()), (220, 33));
        let corner = picture.pixel(2, 2).unwrap();
        assert_eq!([corner.red(), corner.green(), corner.blue()], PAPER);
        assert!(picture.pixel(110, 16).unwrap().blue() < 0xa0);
    }

    #[test]
    fn colours_survive_going_to_light_and_back() {
        for c in 0..=255 {
            assert_eq!(linear([c; 3]).map(encoded), [c; 3]);
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        let solid = solid_frame();
        let part = Painted { solid: &solid, colour: DEFAULT_COLOUR };
        assert!(matches!(view_png(&[part], View::Iso, 3), Err(ExportError::Option { .. })));
        assert!(matches!(view_png(&[], View::Iso, 100), Err(ExportError::Empty)));
    }
}
