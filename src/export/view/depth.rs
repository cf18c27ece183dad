//! What is nearest, cell by cell: triangles drawn by lines of cells.
//!
//! Caps have long thin triangles that cover few cells of their bounding box, so each line is cut with the sides of the
//! triangle. A side of two triangles is cut at the same places for both, which leaves no cracks and no cell twice.

use glam::DVec3;

use super::camera::{Camera, Raster};

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// The nearest triangle of each cell and how near it is.
pub(super) struct Depths {
    pub(super) nearest: Vec<f32>,
    pub(super) triangles: Vec<u32>,
}

impl Depths {
    /// The triangles as they are seen in the window of a frame.
    pub(super) fn new(triangles: &[[DVec3; 3]], camera: &Camera, raster: Raster) -> Self {
        let mut depths =
            Self { nearest: vec![f32::NEG_INFINITY; raster.cells()], triangles: vec![NONE; raster.cells()] };
        draw(triangles, camera, &raster, |cell, z, number| {
            if z > depths.nearest[cell] {
                depths.nearest[cell] = z;
                depths.triangles[cell] = number;
            }
        });
        depths
    }
}

/// Tells `paint` every cell of every triangle that is seen from in front, how near it is there, and the triangle's number.
pub(super) fn draw(
    triangles: &[[DVec3; 3]],
    camera: &Camera,
    raster: &Raster,
    mut paint: impl FnMut(usize, f32, u32),
) {
    for (number, [a, b, c]) in triangles.iter().enumerate() {
        // Half of a solid is behind, and walls that are seen from the side have no cells.
        if (b - a).cross(c - a).dot(camera.towards) > 0.0 {
            let corners = [a, b, c].map(|&p| raster.in_cells(camera.of(p)));
            draw_one(corners, raster, |cell, z| paint(cell, z, number as u32));
        }
    }
}

fn draw_one([a, b, c]: [DVec3; 3], raster: &Raster, mut paint: impl FnMut(usize, f32)) {
    let normal = (b - a).cross(c - a);
    let (slope_x, slope_y) = (-normal.x / normal.z, -normal.y / normal.z);
    let (least, most) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
    let (low, high) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
    for line in cells(low, high, raster.height) {
        let y = line as f64 + 0.5;
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if let Some(x) = crossing(p, q, y) {
                (from, to) = (from.min(x), to.max(x));
            }
        }
        for column in cells(from, to, raster.width) {
            let x = column as f64 + 0.5;
            // Where the triangle is nearly edge-on its plane says little.
            let z = (a.z + slope_x * (x - a.x) + slope_y * (y - a.y)).clamp(least, most) as f32;
            paint(line * raster.width + column, z);
        }
    }
}

/// The cells whose middle lies in [from, to).
fn cells(from: f64, to: f64, most: usize) -> std::ops::Range<usize> {
    // Rounded up; the library's function is a call for each line.
    let cell = |x: f64| {
        let x = (x - 0.5).clamp(0.0, most as f64);
        let whole = x as i64;
        (whole + i64::from((whole as f64) < x)) as usize
    };
    if from < to { cell(from)..cell(to) } else { 0..0 }
}

/// Where the side from p to q crosses a line, taken from its lower end whichever way it runs.
fn crossing(p: DVec3, q: DVec3, y: f64) -> Option<f64> {
    let (p, q) = if (p.y, p.x) <= (q.y, q.x) { (p, q) } else { (q, p) };
    (p.y <= y && y < q.y).then(|| p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;

    fn from_above() -> Camera {
        Camera::towards(DVec3::Z, DVec3::Y)
    }

    #[test]
    fn the_nearer_hides_the_farther() {
        let triangle = |z: f64| [DVec3::new(0.0, 0.0, z), DVec3::new(4.0, 0.0, z), DVec3::new(0.0, 4.0, z)];
        let raster = Raster::new(DVec2::ZERO, DVec2::splat(4.0), 4);
        for order in [[1.0, 2.0], [2.0, 1.0]] {
            let depths = Depths::new(&order.map(triangle), &from_above(), raster);
            assert_eq!(depths.nearest[0], 2.0);
            assert_eq!(order[depths.triangles[0] as usize], 2.0);
            assert_eq!(depths.triangles[15], NONE);
        }
        let away = triangle(1.0);
        let behind = Depths::new(&[[away[0], away[2], away[1]]], &from_above(), raster);
        assert!(behind.triangles.iter().all(|&t| t == NONE));
    }

    proptest! {
        /// Every cell of a fan belongs to one triangle, and to the fan if it does to the whole.
        #[test]
        fn a_fan_covers_each_cell_once(
            x in 0.1..19.9f64, y in 0.1..19.9f64, size in 1usize..40,
        ) {
            let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)];
            let corners = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
            let raster = Raster::new(DVec2::ZERO, DVec2::splat(20.0), size);
            let middle = DVec3::new(x, y, 0.0);
            let mut times = vec![0; raster.cells()];
            for i in 0..4 {
                let fan = [[middle, corners[i], corners[(i + 1) % 4]]];
                let depths = Depths::new(&fan, &from_above(), raster);
                depths.triangles.iter().zip(&mut times).for_each(|(&t, n)| *n += usize::from(t != NONE));
            }
            prop_assert!(times.iter().all(|&n| n == 1), "{times:?}");
        }
    }
}
