//! How far a band is turned about its curve, and where.

use std::str::FromStr;

use thiserror::Error;

/// An angle for each place of a curve, in radians: counter-clockwise seen against the direction of travel.
///
/// As text it is a number of degrees for the whole length, or a table of places and degrees such as `0:0,40:90,120:90` with
/// places in millimetres, which begin at 0 or later and ascend; between them it changes evenly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Twist {
    /// Radians over the whole length.
    whole: f64,
    /// Places in millimetres, each with radians.
    table: Vec<(f64, f64)>,
}

/// A text that is no twist.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "'{text}' is no twist; write degrees over the whole length, such as 180, or places in mm with degrees, ascending, such as 0:0,40:90,120:90"
)]
pub struct TwistError {
    text: String,
}

impl Twist {
    /// The same at each place of a curve of `length` millimetres: `radians` in all.
    pub(super) fn even(radians: f64, length: f64) -> Self {
        debug_assert!(length > 0.0);
        Self { whole: radians, table: Vec::new() }
    }

    /// The same angle everywhere.
    pub(super) fn constant(radians: f64) -> Self {
        Self { whole: 0.0, table: vec![(0.0, radians)] }
    }

    /// Both, one after the other.
    pub(super) fn and(&self, other: &Self) -> Self {
        debug_assert!(self.table.is_empty());
        Self { whole: self.whole + other.whole, table: other.table.clone() }
    }

    /// The places of the table, where the angle may begin to change otherwise.
    pub(super) fn places(&self) -> impl Iterator<Item = f64> + '_ {
        self.table.iter().map(|&(place, _)| place)
    }

    /// The angle at `u` of `length` millimetres.
    pub(super) fn at(&self, u: f64, length: f64) -> f64 {
        let even = self.whole * u / length;
        let next = self.table.partition_point(|&(place, _)| place <= u);
        let here = match (next.checked_sub(1).map(|i| self.table[i]), self.table.get(next)) {
            (None, None) => 0.0,
            (None, Some(&(_, angle))) | (Some((_, angle)), None) => angle,
            (Some((from, a)), Some(&(to, b))) => a + (b - a) * (u - from) / (to - from),
        };
        even + here
    }
}

impl FromStr for Twist {
    type Err = TwistError;

    fn from_str(text: &str) -> Result<Self, TwistError> {
        let error = || TwistError { text: text.to_owned() };
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite() && x.abs() < 1e6);
        if let Some(degrees) = number(text) {
            return Ok(Self { whole: degrees.to_radians(), table: Vec::new() });
        }
        let mut table: Vec<(f64, f64)> = Vec::new();
        for pair in text.split(',') {
            let (place, degrees) = pair.split_once(':').ok_or_else(error)?;
            let (place, degrees) = number(place).zip(number(degrees)).ok_or_else(error)?;
            if place < 0.0 || table.last().is_some_and(|&(before, _)| before >= place) {
                return Err(error());
            }
            table.push((place, degrees.to_radians()));
        }
        Ok(Self { whole: 0.0, table })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_spread_and_a_table_followed() {
        let whole: Twist = "180".parse().unwrap();
        assert!((whole.at(25.0, 100.0).to_degrees() - 45.0).abs() < 1e-12);
        let table: Twist = "10:0,40:90,120:90".parse().unwrap();
        let degrees = [0.0, 10.0, 25.0, 40.0, 100.0, 500.0].map(|u| table.at(u, 200.0).to_degrees());
        for (found, wanted) in degrees.iter().zip([0.0, 0.0, 45.0, 90.0, 90.0, 90.0]) {
            assert!((found - wanted).abs() < 1e-9, "{degrees:?}");
        }
    }

    #[test]
    fn what_is_no_twist_is_told() {
        for text in ["", "x", "10", "1:2,1:3", "-1:2", "1:2,", "NaN", "1:inf"] {
            assert_eq!(text.parse::<Twist>().is_err(), text != "10", "{text}");
        }
        assert!("5:".parse::<Twist>().unwrap_err().to_string().contains("0:0,40:90,120:90"));
    }
}
