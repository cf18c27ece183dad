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
/// A part of a chord error that measuring lengths is done with, in parts of the side.
const MEASURED: f64 = 1e-4;

/// So many levels (1 to 3), coarse first. Spacings follow from how far apart lines are, and radii from how many samples are then around one: 30, 30
/// and 20 (Tu 2020 Appendix C).
pub fn default_levels(drawing: &Drawing, levels: usize) -> Vec<Level> {
    let levels = levels.clamp(1, 3);
    let Some((low, high)) = drawing.bounds_mm() else { return Vec::new() };
    let size = (high - low).max(DVec2::splat(1e-6));
    let side_mm = size.min_element().max(0.2 * size.max_element());
    let elements = Elements::of(&drawing.elements);
    let lines: f64 = drawing.curves.iter().map(|curve| curve.path.perimeter(MEASURED * side_mm)).sum();
    let rims: f64 = drawing.elements.iter().flat_map(|element| &element.contours).map(|c| rim(c)).sum();
    let apart_mm = size.element_product() / (lines + 0.5 * rims).max(1e-6);
    let level = |number: usize| {
        let spacing_mm =
            (SPACINGS[number] * apart_mm).clamp(SPACING_RANGE[0] * side_mm, SPACING_RANGE[1] * side_mm);
        let resolution = Resolution { level: number, levels, spacing_mm };
        let samples = sampled(drawing, &elements, resolution).samples.len().max(1) as f64;
        let radius_mm =
            (NEIGHBOURS[number] * size.element_product() / (std::f64::consts::PI * samples)).sqrt();
        let least_mm = LEAST_RADIUS * spacing_mm;
        Level {
            radius_mm: rounded(radius_mm.min(MOST_RADIUS * side_mm).max(least_mm)),
            spacing_mm: rounded(spacing_mm),
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
