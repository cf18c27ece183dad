//! What is too small for any machine is told before one is asked.
//!
//! Widths that were asked for are kept by every file; where none were, ornament may well have parts that slicers leave out
//! without a word, and specks that no beam leaves. Excluded: thin places that hold something together, which are measured on
//! the files.

use glam::DVec2;

use super::notes::WARNING;
use super::output::Output;
use crate::fabricate::{smaller_than, thin_everywhere};
use crate::planar::{Region, Tolerances};
use crate::verify::Narrowest;

/// The nozzle that nearly every printer has.
const NOZZLE_MM: f64 = 0.4;
/// A tenth of a millimetre square: nothing that a nozzle or a beam makes is smaller.
const SPECK_MM2: f64 = 0.01;
/// Hardly any machine makes ink or a gap narrower than this.
const HAIRLINE_MM: f64 = 0.1;

/// Warnings of parts of `region` that are lost when `outputs` are made, if no minimum feature was asked for. `narrowest_mm`
/// is its narrowest ink, so that what is wide needs no search, and `larger` what would make all of it larger.
pub(super) fn warnings(
    region: &Region,
    tolerances: &Tolerances,
    outputs: &[Output],
    narrowest_mm: Option<f64>,
    larger: &str,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let is_printed = outputs.iter().any(|output| output.format().is_solid());
    let is_wide = tolerances.min_feature_mm() > 0.0 || narrowest_mm.is_some_and(|mm| mm >= NOZZLE_MM);
    if is_printed && !is_wide {
        let lost = thin_everywhere(region, NOZZLE_MM);
        warnings.extend(lost.first().map(|&first| of_thin(lost.len(), region.components(), first, larger)));
    }
    let tiny = smaller_than(region, SPECK_MM2);
    if let Some(first) = tiny.first() {
        warnings.push(format!(
            "{WARNING}{} component(s) or hole(s) are smaller than {SPECK_MM2} mm2, the first at ({:.2}, {:.2}) mm, and will not come out; {larger} makes them larger",
            tiny.len(), first.x, first.y
        ));
    }
    warnings
}

/// A warning where the narrowest `what` of the `whole` is a hair, so that counts hang by it.
pub(super) fn hairline(
    narrowest: Option<Narrowest>,
    what: &str,
    whole: &str,
    larger: &str,
) -> Option<String> {
    let Narrowest { width_mm, position_mm } = narrowest.filter(|n| n.width_mm < HAIRLINE_MM)?;
    Some(format!(
        "{WARNING}{what} of the {whole} is only {width_mm:.3} mm wide at ({:.2}, {:.2}) mm, and hardly any machine makes that; {larger} makes it wider in proportion, --min-feature and --min-gap with --enforce as wide as the machine needs",
        position_mm.x, position_mm.y
    ))
}

fn of_thin(lost: usize, of: usize, first: DVec2, larger: &str) -> String {
    let rest = format!("; --process fdm-0.4 --enforce makes them as wide, {larger} all of the ink");
    let place = format!("({:.1}, {:.1}) mm", first.x, first.y);
    match lost == of {
        true => format!(
            "{WARNING}all ink is thinner than a nozzle of {NOZZLE_MM} mm, and little or nothing of it is printed{rest}"
        ),
        false => format!(
            "{WARNING}{lost} of {of} components are nowhere as wide as a nozzle of {NOZZLE_MM} mm, the first at {place}, and slicers leave them out{rest}"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{FillRule, Grid, boxes};

    #[test]
    fn hairs_are_told_with_their_place() {
        let tell = |width_mm: f64| {
            let narrowest = Narrowest { width_mm, position_mm: DVec2::new(7.0, 2.0) };
            hairline(Some(narrowest), "ink", "part", "a larger exemplar")
        };
        let told = tell(0.004).unwrap();
        assert!(
            told.starts_with("warning: ink of the part is only 0.004 mm wide at (7.00, 2.00) mm"),
            "{told}"
        );
        assert!(tell(0.1).is_none() && hairline(None, "ink", "part", "").is_none());
    }

    #[test]
    fn what_will_be_lost_is_told_for_what_is_made() {
        let step = Grid::for_extent(100.0).unwrap().steps(0.1);
        let region = boxes(step, FillRule::EvenOdd, &[(0, 0, 50, 50), (100, 0, 3, 50), (200, 0, 1, 9)]);
        let none = Tolerances::default();
        let tell = |file: &str, tolerances: &Tolerances| {
            warnings(&region, tolerances, &[Output::file(file).unwrap()], None, "a larger --width")
        };
        let printed = tell("a.stl", &none);
        assert_eq!(printed.len(), 1, "{printed:?}");
        assert!(printed[0].starts_with("warning: 2 of 3 components"), "{printed:?}");
        assert!(printed[0].contains("(10.1, 2.5) mm"), "{printed:?}");
        assert!(tell("a.dxf", &none).is_empty());
        let speck = boxes(step, FillRule::EvenOdd, &[(0, 0, 1, 9), (50, 0, 1, 1)]).offset(-0.01, 0.001);
        let told = warnings(&speck, &none, &[Output::file("a.3mf").unwrap()], Some(0.01), "a larger --width");
        assert!(
            told[0].contains("all ink is thinner") && told[1].contains("1 component(s) or hole(s)"),
            "{told:?}"
        );
        assert!(
            warnings(&region, &none, &[Output::file("a.stl").unwrap()], Some(0.4), "a larger --width")
                .is_empty()
        );
    }
}
