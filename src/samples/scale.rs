//! Levels that suit a drawing, for those who do not say which.

use glam::DVec2;
use kurbo::Shape;

use super::drawing::Drawing;
use super::elements::Elements;
use super::options::Level;
use super::sampling::{Resolution, sampled};

/// Spacings in parts of the mean distance between lines. Tu 2020 §5.1 has 40, 30 and 25 units for all exemplars, whose lines are some 30 units apart.
const SPACINGS: [f64; 3] = [1.3, 1.1, 0.9];
/// Samples in a neighbourhood (Tu 2020 Appendix C).
const NEIGHBOURS: [f64; 3] = [30.0, 30.0, 20.0];
/// The least and the greatest spacing, in parts of the exemplar's shorter side.
const SPACING_RANGE: [f64; 2] = [0.02, 0.12];
/// The greatest radius, in the same.
const MOST_RADIUS: f64 = 0.3;
/// The least radius, in parts of the spacing.
const LEAST_RADIUS: f64 = 1.5;
/// Where an exemplar has few samples, the least radius in parts of their mean distance, so that the nearest are in it.
const LEAST_APART: f64 = 1.4;
/// A part of a chord error that measuring lengths is done with, in parts of the side.
const MEASURED: f64 = 1e-4;

/// So many levels (1 to 3), coarse first, for an area whose shorter side is `room_mm` long. Spacings follow from how far apart lines are, and radii
/// from how many samples are then around one: 30, 30 and 20 (Tu 2020 Appendix C). In a narrow area neighbourhoods are as large as it is wide, and
/// samples nearer to each other if they have to be; but never finer than the exemplar is worth, so that a tiny area may be smaller than a radius.
pub fn default_levels(drawing: &Drawing, levels: usize, room_mm: f64) -> Vec<Level> {
    let levels = levels.clamp(1, 3);
    let Some((low, high)) = drawing.bounds_mm() else { return Vec::new() };
    let size = (high - low).max(DVec2::splat(1e-6));
    let side_mm = size.min_element().max(0.2 * size.max_element());
    let elements = Elements::of(&drawing.elements);
    let lines: f64 = drawing.curves.iter().map(|curve| curve.path.perimeter(MEASURED * side_mm)).sum();
    let rims: f64 = drawing.elements.iter().flat_map(|element| &element.contours).map(|c| rim(c)).sum();
    let apart_mm = size.element_product() / (lines + 0.5 * rims).max(1e-6);
    let level = |number: usize| {
        let most_mm = (SPACING_RANGE[1] * side_mm).min(room_mm / LEAST_RADIUS);
        let spacing_mm = (SPACINGS[number] * apart_mm).min(most_mm).max(SPACING_RANGE[0] * side_mm);
        let resolution = Resolution { level: number, levels, spacing_mm };
        let samples = sampled(drawing, &elements, resolution).samples.len().max(1) as f64;
        let radius_mm =
            (NEIGHBOURS[number] * size.element_product() / (std::f64::consts::PI * samples)).sqrt();
        let least_mm = LEAST_RADIUS * spacing_mm;
        let apart_mm = LEAST_APART * (size.element_product() / samples).sqrt();
        let most_mm = (MOST_RADIUS * side_mm).max(apart_mm).min(room_mm);
        let radius_mm = rounded(radius_mm.min(most_mm).max(least_mm));
        // Rounding must not make it larger than the area again.
        Level {
            radius_mm: radius_mm.min(room_mm.max(least_mm)),
            spacing_mm: rounded(spacing_mm).min(radius_mm),
        }
    };
    (0..levels).map(level).collect()
}

fn rim(contour: &[DVec2]) -> f64 {
    let n = contour.len();
    (0..n).map(|i| contour[i].distance(contour[(i + 1) % n])).sum()
}

/// Three digits, which can be read and typed again.
fn rounded(mm: f64) -> f64 {
    let unit = 10.0_f64.powf(mm.log10().floor() - 2.0);
    // Divided by a whole number, so that the shortest text of it has three digits too.
    if unit < 1.0 { (mm / unit).round() / (1.0 / unit).round() } else { (mm / unit).round() * unit }
}

#[cfg(test)]
mod tests {
    use kurbo::BezPath;

    use super::*;
    use crate::samples::Curve;

    #[test]
    fn neighbourhoods_are_no_larger_than_a_narrow_area() {
        let line = |i: i32| BezPath::from_svg(&format!("M0 {}H100", 10 * i)).unwrap();
        let curves = (0..=10).map(|i| Curve { path: line(i), width_mm: 1.0 }).collect();
        let drawing = Drawing { curves, elements: Vec::new() };
        let wide = default_levels(&drawing, 3, 500.0);
        assert!(
            wide.iter().all(|level| level.radius_mm > 11.3 && level.radius_mm >= 1.5 * level.spacing_mm),
            "{wide:?}"
        );
        for room_mm in [11.27, 9.999, 3.333] {
            let narrow = default_levels(&drawing, 3, room_mm);
            let fits = |level: &Level| level.radius_mm <= room_mm && level.spacing_mm <= level.radius_mm;
            assert!(narrow.iter().all(fits), "{room_mm}: {narrow:?}");
        }
        // Nine shapes in three rows.
        let shape = |i: i32| {
            let (x, y) = (f64::from(11 * (i % 3)), f64::from(11 * (i / 3)));
            let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)];
            crate::samples::Element {
                contours: vec![corners.map(|(a, b)| DVec2::new(x + a, y + b)).to_vec()],
            }
        };
        let few = Drawing { curves: Vec::new(), elements: (0..9).map(shape).collect() };
        assert!(default_levels(&few, 3, 500.0)[0].radius_mm > 11.0);
        // Where a sample is worth nothing it is refused later.
        assert!(default_levels(&drawing, 1, 0.1)[0].radius_mm > 0.1);
    }
}
