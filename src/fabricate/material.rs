//! Materials, and the numbers of a part that cost money.

use schemars::JsonSchema;
use serde::Serialize;

/// Densities from foam to platinum, in grams for each cubic centimetre; outside, it is a slip of a unit.
pub(super) const DENSITIES: std::ops::RangeInclusive<f64> = 0.01..=25.0;

/// A material.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Material {
    /// Its name on the command line.
    pub name: String,
    /// Grams for each cubic centimetre.
    pub density_g_cm3: f64,
}

const METALS: &str = "wermac.org, density of metal";

/// The name, the density and its source.
const BUILT_IN: [(&str, f64, &str); 12] = [
    ("pla", 1.24, "usual data sheets of filament"),
    ("petg", 1.27, "usual data sheets of filament"),
    ("abs", 1.04, "usual data sheets of filament"),
    ("resin", 1.18, "our choice: cured standard resins are 1.1 to 1.2"),
    (
        "birch-ply",
        0.68,
        "our choice: between the wood (0.70, apsimplepsaltery.com, material densities) and lighter veneers",
    ),
    ("mdf", 0.75, "our choice: boards are 0.70 to 0.80"),
    ("acrylic", 1.18, "1.16 to 1.19 (hadice-shop.cz, densities)"),
    (
        "silver-925",
        10.36,
        "0.925 of silver (10.49) and 0.075 of copper (8.93) by mass (simetric.co.uk, metals)",
    ),
    ("brass", 8.5, "8.43 to 8.73 rolled (wermac.org, density of metal; simetric.co.uk, metals)"),
    ("steel", 7.85, "rolled (simetric.co.uk, metals)"),
    ("stainless", 7.9, "7.48 to 8.00 (simetric.co.uk, metals)"),
    ("aluminium", 2.71, METALS),
];

pub(super) fn built_in() -> impl Iterator<Item = Material> {
    BUILT_IN.iter().map(|&(name, density_g_cm3, _)| Material { name: name.to_owned(), density_g_cm3 })
}

/// A row of a table for each material that is built in.
pub(super) fn rows() -> String {
    BUILT_IN.iter().map(|(name, density, source)| format!("| `{name}` | {density} | {source} |\n")).collect()
}

/// What a part takes of its material.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MaterialReport {
    /// The material.
    #[serde(flatten)]
    pub material: Material,
    /// The mass of the part in grams, solid throughout.
    pub mass_g: f64,
}

impl Material {
    /// What a part of so many cubic millimetres takes.
    pub fn report(&self, volume_mm3: f64) -> MaterialReport {
        MaterialReport { material: self.clone(), mass_g: volume_mm3 * self.density_g_cm3 / 1000.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_centimetre_has_its_density_as_mass() {
        for material in built_in() {
            assert!(DENSITIES.contains(&material.density_g_cm3));
            assert_eq!(material.report(1000.0).mass_g, material.density_g_cm3);
        }
    }

    #[test]
    fn silver_is_an_alloy_by_mass() {
        let mixed = 1.0 / (0.925 / 10.49 + 0.075 / 8.93);
        let silver = built_in().find(|m| m.name == "silver-925").unwrap();
        assert!((silver.density_g_cm3 - mixed).abs() < 0.01, "{mixed}");
    }
}
