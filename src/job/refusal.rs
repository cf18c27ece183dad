//! Refusals in words: which constraint cannot be met, why, and what can be had.

use crate::pieces::Catalogue;
use crate::solver::{Nearest, Refusal};
use crate::topology::{Goal, Shape, Wanted};

use super::plan::{EPSILONS, PlanOptions};

/// The message for a refusal: which constraint, and what can be had.
pub(super) fn message(
    catalogue: &Catalogue,
    options: &PlanOptions,
    refusal: &Refusal,
    bin_mm: f64,
) -> String {
    let hint = match *refusal {
        Refusal::Length { below, above } => lengths(options, below, above, bin_mm),
        Refusal::Drift => {
            "draw the ornament more level, or use --slicing uniform:T with other cuts".to_owned()
        }
        Refusal::ClosedPattern => {
            "leave out --closed-pattern, or take an exemplar whose strands run from end to end".to_owned()
        }
        Refusal::Components { nearest } => nearest_hint("--components", nearest),
        Refusal::Holes { nearest } => nearest_hint("--holes", nearest),
        Refusal::Both { nearest_holes, .. } => nearest_hint("--holes", nearest_holes),
    };
    let separator = if matches!(refusal, Refusal::Length { .. }) { ": " } else { "; " };
    reason(catalogue, options, refusal) + separator + &hint
}

/// Which constraint cannot be met, and why.
pub(super) fn reason(catalogue: &Catalogue, options: &PlanOptions, refusal: &Refusal) -> String {
    let along = format!("along {:.1} mm", options.length_mm);
    let Goal { components, holes, .. } = options.goal;
    let shown = |wanted: Option<Wanted>| wanted.map_or_else(String::new, |w| w.to_string());
    match *refusal {
        Refusal::Length { below: None, above: None } => {
            format!("no sequence of the {} piece(s) exists at all", catalogue.pieces().len())
        }
        Refusal::Length { .. } => format!(
            "no sequence of pieces is within {:.0} % of the curve's {:.1} mm",
            EPSILONS[EPSILONS.len() - 1] * 100.0,
            options.length_mm
        ),
        Refusal::Drift => format!("every sequence {along} climbs or falls out of the band"),
        Refusal::ClosedPattern => {
            format!("no sequence {along} goes all the way round: {}", break_witness(catalogue))
        }
        Refusal::Components { .. } => format!(
            "no sequence {along} has {} component(s): {}",
            shown(components),
            component_witness(catalogue, options)
        ),
        Refusal::Holes { .. } => {
            format!("no sequence {along} has {} hole(s): {}", shown(holes), hole_witness(catalogue, options))
        }
        Refusal::Both { each_exists: true, .. } => format!(
            "{} component(s) can be had {along}, and {} hole(s) can, but not both in one sequence",
            shown(components),
            shown(holes)
        ),
        Refusal::Both { each_exists: false, .. } => format!(
            "no sequence {along} has {} component(s) and {} hole(s) together",
            shown(components),
            shown(holes)
        ),
    }
}

fn nearest_hint(option: &str, nearest: Option<Nearest>) -> String {
    let alone = match (nearest, option) {
        (Some(Nearest { is_alone: true, .. }), "--holes") => ", without --components",
        (Some(Nearest { is_alone: true, .. }), _) => ", without --holes",
        _ => "",
    };
    match nearest {
        Some(Nearest { count, is_proven: true, .. }) => {
            format!("the nearest that can be had is {option} {count}{alone}")
        }
        Some(Nearest { count, is_proven: false, .. }) => format!("{option} {count} can be had{alone}"),
        None => format!("leave out {option} to see what can be had"),
    }
}

fn lengths(options: &PlanOptions, below: Option<u32>, above: Option<u32>, bin_mm: f64) -> String {
    let mm = |bins: u32| format!("{:.1} mm", f64::from(bins) * bin_mm);
    let can = match (below, above) {
        (None, None) => {
            let why = match options.shape {
                Shape::Open => "no piece that the exemplar can begin with leads to one that it can end with",
                Shape::Ring => "no piece leads back to itself through compatible cuts",
            };
            return format!("{why}; try --slicing uniform:T, or an exemplar with more cuts");
        }
        (Some(a), Some(b)) => format!("the nearest lengths that can be made are {} and {}", mm(a), mm(b)),
        (Some(a), None) => format!("the nearest length that can be made is {}", mm(a)),
        (None, Some(b)) => format!("the shortest that can be made is {}", mm(b)),
    };
    format!("{can} at this width; change the curve's length, or scale the ornament with --width")
}

/// Whether runs exist, of any length, without an empty join inside and without a piece that holds an island.
fn unbroken_run_exists(catalogue: &Catalogue, shape: Shape) -> bool {
    let pieces = catalogue.pieces();
    let usable = |p: usize| pieces[p].descriptor.closed() == 0;
    let reach = |start: usize| {
        let mut seen = vec![false; pieces.len()];
        let mut queue = vec![start];
        while let Some(p) = queue.pop() {
            let inside = catalogue.joins()[p].iter().filter(|_| !pieces[p].right.is_empty());
            for join in inside.filter(|j| usable(j.to)) {
                if !std::mem::replace(&mut seen[join.to], true) {
                    queue.push(join.to);
                }
            }
        }
        seen
    };
    (0..pieces.len()).filter(|&p| usable(p)).any(|first| match shape {
        Shape::Open => {
            pieces[first].left.is_empty()
                && (pieces[first].right.is_empty()
                    || (0..pieces.len()).any(|p| pieces[p].right.is_empty() && reach(first)[p]))
        }
        Shape::Ring => reach(first)[first],
    })
}

fn component_witness(catalogue: &Catalogue, options: &PlanOptions) -> String {
    match options.goal.components.map(Wanted::most) {
        Some(1) if !unbroken_run_exists(catalogue, options.shape) => {
            "every run of pieces passes an empty cut, where all strands have ended, or a piece that holds an island".to_owned()
        }
        Some(1) => {
            "no run of this length keeps all its strands together to the end".to_owned()
        }
        _ => "every run of this length comes to another number".to_owned(),
    }
}

fn hole_witness(catalogue: &Catalogue, options: &PlanOptions) -> String {
    let with_holes = catalogue.descriptors().iter().filter(|d| d.holes() > 0).count();
    let pieces = catalogue.pieces().len();
    match options.goal.holes.map(Wanted::most) {
        Some(0) if with_holes > 0 => {
            format!(
                "{with_holes} of the {pieces} pieces have holes of their own, and joins of the others close more"
            )
        }
        Some(0) => "every run of this length has strands that split and merge again".to_owned(),
        _ => "every run of this length comes to another number".to_owned(),
    }
}

fn break_witness(catalogue: &Catalogue) -> String {
    if unbroken_run_exists(catalogue, Shape::Ring) {
        "in every ring of this length the strands end somewhere".to_owned()
    } else {
        "every ring of pieces passes an empty cut, where all strands have ended".to_owned()
    }
}
