//! What somebody who makes a band should know of it, one sentence each.
//!
//! A note tells what was done that was not asked for. What makes a band that counts right and looks wrong is a warning,
//! and begins with [`WARNING`]. Excluded: what is found in the files, and bridges, which are told where they are laid.

use std::collections::BTreeSet;

use glam::DVec2;

use super::builder::{BandJob, SlicingChoice};
use super::choice::Choice;
use super::cut::Cut;
use super::plan::Plan;
use crate::domain::BandMap;
use crate::fit::{Outline, Sides};
use crate::reeb::Slicing;

/// How a warning begins.
pub(super) const WARNING: &str = "warning: ";

/// Cuts named in a note; a report lists all.
const DROPPED_SHOWN: usize = 5;
/// Stretching by less than this part shows to nobody.
const SEEN: f64 = 0.03;
/// Stretched or pressed by more than this part, circles are eggs and an ornament is another one.
const SPOILT: f64 = 0.15;
/// Where the inner side of a bend keeps less than this part of the length of the middle, the pattern there is crushed.
const LEAST_INNER: f64 = 0.5;
/// A band of more jumps than this part of its joins is made of scraps.
const SCRAPS: f64 = 0.5;
/// A band that uses less than this part of the exemplar's pieces shows little of it, if it is long enough for all.
const LEAST_USED: f64 = 1.0 / 3.0;
/// Exemplars of fewer pieces than this, and bands, cannot be judged so.
const FEW_PIECES: usize = 8;
/// What is more than this many times the cost of the best there can be is not worth a number.
const MOST_TIMES: f64 = 10.0;

/// All notes on a band; `shift_mm` takes positions of the curve to the page.
pub(super) fn notes(
    job: &BandJob,
    cut: &Cut,
    plan: &Plan,
    map: &BandMap,
    outline: &Outline,
    shift_mm: DVec2,
) -> Vec<String> {
    let mut notes = cut.exemplar.notes().to_vec();
    notes.extend(specks(job, cut));
    notes.extend(warped(job, cut, plan, outline));
    notes.extend(dropped(&cut.slicing));
    notes.extend(missed(job, cut));
    notes.extend(given_up(job, plan));
    let length_mm = map.curve().length_mm();
    notes.extend(stretched(outline.stretch, length_mm, cut.sides));
    notes.extend(pressed(outline.squash, cut.sides));
    notes.extend(collapsed(cut, plan, outline));
    notes.extend(crushed(map, shift_mm));
    notes.extend(squeezed(map, shift_mm));
    notes
}

/// Notes on bends that are too hard for the inner side of a band, with their places moved onto the page.
pub(super) fn squeezed(map: &BandMap, shift_mm: DVec2) -> impl Iterator<Item = String> + '_ {
    map.squeezes().iter().map(move |squeeze| {
        let at = DVec2::from(squeeze.position_mm) + shift_mm;
        format!(
            "the curve bends so hard at ({:.1}, {:.1}) mm that the inner side is squeezed from {:.1} to {:.1} mm",
            at.x, at.y, squeeze.reach_mm, squeeze.squeezed_to_mm
        )
    })
}

/// A note on the first of two passes.
pub(super) fn of_first_pass(note: &str) -> String {
    match note.strip_prefix(WARNING) {
        Some(rest) => format!("{WARNING}first pass: {rest}"),
        None => format!("first pass: {note}"),
    }
}

fn specks(job: &BandJob, cut: &Cut) -> Option<String> {
    let first = cut.specks.first()?;
    Some(format!(
        "{} speck(s) of less than {:.1e} mm2 were left out, the first at ({:.3}, {:.3}) mm; a smaller --chord keeps them",
        cut.specks.len(),
        job.tolerances.chord_mm().powi(2),
        first.x,
        first.y
    ))
}

fn warped(job: &BandJob, cut: &Cut, plan: &Plan, outline: &Outline) -> Vec<String> {
    let mut notes = Vec::new();
    if outline.method != job.options.stitch && !cut.sides.are_held() {
        notes.push(
            "the whole band was stitched by --stitch warp, as rotation-invariant deformation made contours meet between its pieces"
                .to_owned(),
        );
    }
    if !outline.fallbacks.is_empty() {
        notes.push(format!(
            "{} of {} pieces were warped, as rotation-invariant deformation would have broken them",
            outline.fallbacks.len(),
            plan.sequence.len()
        ));
    }
    notes
}

/// What to say of cuts through ink that is too thin.
fn dropped(slicing: &Slicing) -> Option<String> {
    let dropped = &slicing.dropped;
    let shown = dropped.iter().take(DROPPED_SHOWN).map(|d| format!("{:.2} ({:.3})", d.x_mm, d.portal_mm));
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = if dropped.len() > DROPPED_SHOWN { ", ..." } else { "" };
    (!dropped.is_empty()).then(|| {
        format!(
            "{} cut(s) were left out, as they pass through ink thinner than --min-feature: at x (portal) {shown}{more} mm",
            dropped.len()
        )
    })
}

fn missed(job: &BandJob, cut: &Cut) -> Option<String> {
    match (job.options.slicing, cut.slicing.missed) {
        (SlicingChoice::Uniform(lines), missed @ 1..) => Some(format!(
            "{missed} of the {lines} cuts were left out, as contours run along them or nearly touch there"
        )),
        _ => None,
    }
}

/// What to say of a sequence that may not be the best.
fn given_up(job: &BandJob, plan: &Plan) -> Option<String> {
    let gap = plan.gap.filter(|&gap| gap > 0.0 && !matches!(job.options.choice, Choice::Best(_)))?;
    let least = plan.cost - gap;
    let how_far = if least > 0.0 && gap <= MOST_TIMES * least {
        format!(
            "costs at most {:.0} % more in jumps and rough joins than the best there is",
            (100.0 * gap / least).ceil()
        )
    } else {
        "works, but nothing is known of how much better the best there is would look".to_owned()
    };
    let limit = shown_bytes(job.memory_limit);
    Some(match job.memory_limit < job.options.memory_limit {
        true => format!(
            "the search was given up at {limit}, as there are many ways to try: the best found {how_far}"
        ),
        false => format!(
            "the search was given up at its --effort or --memory-limit ({limit}): the best found {how_far}; more of them or fewer constraints may give a better one"
        ),
    })
}

fn shown_bytes(bytes: usize) -> String {
    match bytes >> 20 {
        mb if mb >= 1024 && mb % 1024 == 0 => format!("{} GB", mb >> 10),
        0 => format!("{bytes} bytes"),
        mb => format!("{mb} MB"),
    }
}

/// What to say of a run that was made longer or shorter to fill `length_mm`.
fn stretched(stretch: f64, length_mm: f64, sides: Sides) -> Option<String> {
    let direction = if sides == Sides::Free { "along its length" } else { "upwards" };
    let (warning, done) = changed(stretch, direction)?;
    let natural_mm = length_mm / stretch;
    let (warning, remedy) = match warning {
        true => (
            WARNING,
            "; it hardly looks like the ornament any more: take a length near that, another --width, or other counts",
        ),
        false => ("", ""),
    };
    Some(format!(
        "{warning}the pattern was {done} to fill {length_mm:.1} mm, as by itself it is {natural_mm:.1} mm long{remedy}"
    ))
}

/// What to say of heights that were changed to fit the band.
fn pressed(squash: f64, sides: Sides) -> Option<String> {
    let (direction, why) = match sides {
        Sides::Free => ("in height", "as it climbs"),
        _ => ("sideways", "to fill the width"),
    };
    let (warning, done) = changed(squash, direction)?;
    let (warning, remedy) = match warning {
        true => (
            WARNING,
            "; it hardly looks like the ornament any more: other counts or another length may spare it",
        ),
        false => ("", ""),
    };
    Some(format!("{warning}the pattern was {done}, {why}{remedy}"))
}

/// By how much something was stretched or pressed, and whether that spoils it; `None` if nobody sees it.
fn changed(factor: f64, direction: &str) -> Option<(bool, String)> {
    let part = (factor - 1.0).abs();
    let done = if factor > 1.0 { "stretched" } else { "pressed" };
    (part > SEEN).then(|| (part > SPOILT, format!("{done} by {:.1} % {direction}", part * 100.0)))
}

/// What to say of a band that is made of scraps, or shows only a few pieces again and again.
fn collapsed(cut: &Cut, plan: &Plan, outline: &Outline) -> Option<String> {
    let pieces = cut.catalogue.originals();
    let made_of = plan.sequence.len();
    let jumps = outline.seams.iter().filter(|seam| !seam.is_natural).count();
    let used: BTreeSet<usize> =
        plan.sequence.iter().map(|&piece| cut.catalogue.origin(piece).index).collect();
    // Rows of a rectangle go on as their own reflections, which is a jump each time.
    if cut.sides != Sides::Free || pieces < FEW_PIECES || made_of < FEW_PIECES {
        return None;
    }
    let is_scraps = jumps as f64 > SCRAPS * outline.seams.len() as f64;
    let is_little = made_of >= pieces && (used.len() as f64) < LEAST_USED * pieces as f64;
    (is_scraps || is_little).then(|| {
        format!(
            "{WARNING}the band has {jumps} jumps in {made_of} pieces and uses {} of the {pieces} pieces of the exemplar: what was asked for is far from what this ornament gives; other counts, or any with --bridge 1mm, look better",
            used.len()
        )
    })
}

/// What to say of a band that is too wide for the curve.
fn crushed(map: &BandMap, shift_mm: DVec2) -> Option<String> {
    let (inner, at, radius_mm) = map.tightest();
    let at = at + shift_mm;
    (inner < LEAST_INNER).then(|| {
        format!(
            "{WARNING}at ({:.1}, {:.1}) mm the inner side of the band has only {:.0} % of the length of its middle, and the pattern is crushed there; a --width of {radius_mm:.0} mm or less keeps half",
            at.x,
            at.y,
            inner * 100.0
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::BandBuilder;

    #[test]
    fn stretching_is_told_when_it_shows_and_warned_of_when_it_spoils() {
        assert_eq!(stretched(1.02, 100.0, Sides::Free), None);
        assert_eq!(
            stretched(0.93, 93.0, Sides::Free).unwrap(),
            "the pattern was pressed by 7.0 % along its length to fill 93.0 mm, as by itself it is 100.0 mm long"
        );
        let spoilt = stretched(1.549, 154.9, Sides::Filled).unwrap();
        assert!(
            spoilt.starts_with("warning: the pattern was stretched by 54.9 % upwards to fill 154.9 mm"),
            "{spoilt}"
        );
        assert_eq!(pressed(0.98, Sides::Free), None);
        assert_eq!(
            pressed(0.95, Sides::Free).unwrap(),
            "the pattern was pressed by 5.0 % in height, as it climbs"
        );
        assert!(pressed(1.25, Sides::Filled).unwrap().starts_with("warning: "));
    }

    #[test]
    fn a_warning_stays_one_in_the_first_pass() {
        assert_eq!(of_first_pass("x"), "first pass: x");
        assert_eq!(of_first_pass("warning: x"), "warning: first pass: x");
    }

    #[test]
    fn a_search_that_was_given_up_says_how_far_it_may_be_from_the_best() {
        let mut job =
            BandBuilder::new("vine.svg", "line:60mm".parse().unwrap()).memory_limit(8 << 20).build().unwrap();
        let plan = |cost, gap| Plan {
            sequence: vec![0],
            cost,
            gap,
            epsilon: 0.05,
            natural_length_mm: 60.0,
            labels: 1,
            states: 1,
        };
        assert_eq!((given_up(&job, &plan(3.0, None)), given_up(&job, &plan(3.0, Some(0.0)))), (None, None));
        let told = given_up(&job, &plan(3.0, Some(0.6))).unwrap();
        assert!(told.contains("--memory-limit (8 MB)") && told.contains("costs at most 25 % more"), "{told}");
        assert!(given_up(&job, &plan(3.0, Some(3.0))).unwrap().contains("nothing is known"));
        // A limit that nobody typed is not blamed on the option.
        job.memory_limit = 1 << 20;
        assert!(!given_up(&job, &plan(3.0, Some(0.6))).unwrap().contains("--memory-limit"));
        // Of the K best, all but the first cost more, and no search was given up.
        job.options.choice = Choice::Best(3);
        assert_eq!(given_up(&job, &plan(3.0, Some(0.6))), None);
    }

    #[test]
    fn memory_is_shown_as_it_is_typed() {
        assert_eq!([2 << 30, 512 << 20, 12].map(shown_bytes), ["2 GB", "512 MB", "12 bytes"]);
    }
}
