//! A solid of at most so many triangles.
//!
//! The chord error is a promise, so only what of it is left over may be spent: the part that drawings need for
//! their curves, which meshes do not have. The least of it that brings the number down is taken; when all of it
//! does not, the error says what would.

use super::FabricateError;
use super::profile::Profile;
use super::raise::raise;
use super::simplify::simplified;
use super::solid::Solid;
use crate::planar::Region;

/// The part of the chord error that meshes may spend on simpler outlines. Flattening, bending and mapping have spent
/// half of it before, and the round corners of walls that go in have [`CORNER_SHARE`].
const SPARE_SHARE: f64 = 0.4;
/// The part of the chord error for round corners of walls that go in.
const CORNER_SHARE: f64 = 0.1;
/// Halvings in the search for the least that must be spent.
const HALVINGS: u32 = 6;
/// Doublings in the search for a chord error that would do: up to a thousand times as much.
const DOUBLINGS: i32 = 10;

/// A solid, and what it cost to keep within a number of triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Limited {
    /// The solid.
    pub solid: Solid,
    /// The number of triangles that it would have had without a limit.
    pub triangles_before: usize,
}

/// The solid over `region` as [`raise`] makes it, with at most `most` triangles. Where it has more, its outline is
/// simplified as little as need be, so that in all it stays within `chord_mm` of what it stands for.
///
/// # Errors
/// [`FabricateError::TooManyTriangles`] when both cannot hold, with a chord error that would do; otherwise as for
/// [`raise`].
pub fn raise_within(
    region: &Region,
    profile: &Profile,
    chord_mm: f64,
    most: Option<usize>,
) -> Result<Limited, FabricateError> {
    let corner_mm = chord_mm * CORNER_SHARE;
    let solid = raise(region, profile, corner_mm)?;
    let triangles_before = solid.triangles().len();
    let Some(most) = most.filter(|&most| triangles_before > most) else {
        return Ok(Limited { solid, triangles_before });
    };
    let spent = |part: f64| raise(&simplified(region, chord_mm * SPARE_SHARE * part), profile, corner_mm);
    let simplest = spent(1.0)?;
    if simplest.triangles().len() > most {
        // Larger tolerances for all of it, as a whole run would have them.
        let with = |chord_mm: f64| {
            let simpler = simplified(region, chord_mm * SPARE_SHARE);
            raise(&simpler, profile, chord_mm * CORNER_SHARE).ok().map(|solid| solid.triangles().len())
        };
        let mut chords = (1..=DOUBLINGS).map(|i| chord_mm * f64::from(1 << i));
        return Err(FabricateError::TooManyTriangles {
            found: simplest.triangles().len(),
            most,
            chord_mm,
            remedy: match chords.find(|&chord| with(chord).is_some_and(|found| found <= most)) {
                Some(chord) => format!("a chord error of {chord} mm does"),
                None => "no chord error does; allow more triangles, or make less of the pattern".to_owned(),
            },
        });
    }
    let (mut fails, mut works, mut best) = (0.0, 1.0, simplest);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (fails + works);
        let tried = spent(middle)?;
        match tried.triangles().len() <= most {
            true => (works, best) = (middle, tried),
            false => fails = middle,
        }
    }
    Ok(Limited { solid: best, triangles_before })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::planar::{FillRule, Grid};

    fn disc(sides: usize) -> Region {
        let grid = Grid::for_extent(100.0).unwrap();
        let turn = std::f64::consts::TAU / sides as f64;
        let point = |i: usize| grid.snap(DVec2::from_angle(turn * i as f64) * 40.0 + 50.0).unwrap();
        Region::fill(grid, &[(0..sides).map(point).collect()], FillRule::NonZero)
    }

    #[test]
    fn detail_is_given_up_only_as_far_as_asked() {
        let profile = Profile::upright(2.0).unwrap();
        let made = |most| raise_within(&disc(2000), &profile, 0.05, most).unwrap();
        let triangles = |most| made(most).solid.triangles().len();
        assert_eq!((triangles(None), triangles(Some(8000))), (7996, 7996));
        let (many, few) = (triangles(Some(4000)), triangles(Some(1000)));
        assert!((2000..=4000).contains(&many) && (500..=1000).contains(&few), "{many} {few}");
        assert_eq!(made(Some(1000)).triangles_before, 7996);
    }

    #[test]
    fn when_both_cannot_hold_the_error_says_what_would() {
        let profile = Profile::upright(2.0).unwrap();
        let error = raise_within(&disc(2000), &profile, 0.05, Some(100)).unwrap_err();
        let FabricateError::TooManyTriangles { found, .. } = error else { panic!("{error}") };
        assert!(found > 100 && found < 1000, "{found}");
        let text = error.to_string();
        let chord: f64 =
            text.split("a chord error of ").last().unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(raise_within(&disc(2000), &profile, chord, Some(100)).is_ok(), "{text}");
        let none = raise_within(&disc(2000), &profile, 0.05, Some(7)).unwrap_err().to_string();
        assert!(none.contains("no chord error does"), "{none}");
    }
}
