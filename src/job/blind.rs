//! What is narrower than was asked for and changes no count: told, as a machine loses it all the same.
//!
//! The widths that are asked for are kept wherever something is held together or apart, or nothing is written. What is left
//! are ends: a bay whose mouth closes before its pocket does, a lump of ink that breaks off by its neck. Excluded: long
//! slots and hairs without a neck, which have no narrowest place, and tips, which end in nothing.

use crate::planar::Tolerances;
use crate::verify::{NarrowPlaces, Narrowest};

/// Notes on those of `places` that are narrower than the widths of `tolerances`, by more than a chord. `larger` would make
/// all of it larger.
pub(super) fn notes(
    places: &NarrowPlaces,
    tolerances: &Tolerances,
    can_enforce: bool,
    larger: &str,
) -> Vec<String> {
    let chord_mm = tolerances.chord_mm();
    let note = |places: &[Narrowest], wanted_mm: f64, [what, fate, option]: [&str; 3]| {
        let narrow = places.iter().filter(|place| place.width_mm < wanted_mm - chord_mm).count();
        let worst = places.first().filter(|_| narrow > 0)?;
        let more = if narrow == NarrowPlaces::WORST { " or more" } else { "" };
        let remedy = if can_enforce { format!("--enforce, or {larger},") } else { larger.to_owned() };
        Some(format!(
            "{narrow}{more} {what} narrower than {option} {wanted_mm} mm, the worst with {:.3} mm at ({:.2}, {:.2}) mm; no count depends on them, but {fate}: {remedy} mends that",
            worst.width_mm, worst.position_mm.x, worst.position_mm.y
        ))
    };
    let lumps = ["lump(s) of ink hang on a neck", "they may break off", "--min-feature"];
    let bays = ["bay(s) have a mouth", "they may close", "--min-gap"];
    let notes = [
        note(&places.ink, tolerances.min_feature_mm(), lumps),
        note(&places.gaps, tolerances.min_gap_mm(), bays),
    ];
    notes.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn narrow_ends_are_told_with_number_place_and_remedy() {
        let place = |width_mm: f64, x: f64| Narrowest { width_mm, position_mm: DVec2::new(x, 2.0) };
        let gaps = vec![place(0.28, 7.0), place(0.43, 1.0), place(0.495, 3.0), place(0.9, 5.0)];
        let places = NarrowPlaces { ink: vec![place(1.1, 0.0)], gaps };
        let wanted = Tolerances::new(0.02, 1.0, 0.5).unwrap();
        let told = notes(&places, &wanted, true, "a larger --width");
        assert_eq!(told.len(), 1, "{told:?}");
        let parts = ["2 bay(s)", "--min-gap 0.5 mm", "0.280 mm at (7.00, 2.00) mm", "--enforce"];
        assert!(parts.into_iter().all(|part| told[0].contains(part)), "{told:?}");
        assert!(!notes(&places, &wanted, false, "a larger --width")[0].contains("--enforce"));
        assert!(notes(&places, &Tolerances::default(), false, "a larger --width").is_empty());
    }
}
