//! Numbers too large or too small for a float: how many sequences there are, and what they weigh.

use super::problem::Cost;
use super::table::Weigh;

/// m·2^e with 1 ≤ m < 2, or 0. Whole numbers are exact up to 2^53.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Big {
    mantissa: f64,
    exponent: i64,
}

impl Big {
    pub(super) const ZERO: Self = Self { mantissa: 0.0, exponent: 0 };
    #[cfg(test)]
    const ONE: Self = Self { mantissa: 1.0, exponent: 0 };

    /// `value`·2^`exponent`; the value is not negative.
    pub(super) fn new(value: f64, exponent: i64) -> Self {
        Self { mantissa: value, exponent }.normal()
    }

    /// exp(−cost / temperature), both in the units of the problem; 1 at an infinite temperature.
    pub(super) fn of_cost(cost: Cost, temperature: f64) -> Self {
        let power = -(cost as f64) / temperature * std::f64::consts::LOG2_E;
        let whole = power.floor();
        Self { mantissa: (power - whole).exp2(), exponent: whole as i64 }.normal()
    }

    /// The natural logarithm; −∞ of 0.
    pub(super) fn ln(self) -> f64 {
        self.mantissa.ln() + self.exponent as f64 * std::f64::consts::LN_2
    }

    /// This part of `whole`, which is not 0.
    pub(super) fn part_of(self, whole: Self) -> f64 {
        let exponent = (self.exponent - whole.exponent).clamp(-2000, 2000) as i32;
        self.mantissa / whole.mantissa * 2f64.powi(exponent)
    }

    fn normal(self) -> Self {
        if self.mantissa == 0.0 {
            return Self::ZERO;
        }
        let Self { mut mantissa, mut exponent } = self;
        // Sums and products of normal numbers are off by a bit at most.
        while mantissa >= 2.0 {
            mantissa *= 0.5;
            exponent += 1;
        }
        while mantissa < 1.0 {
            mantissa *= 2.0;
            exponent -= 1;
        }
        Self { mantissa, exponent }
    }
}

/// Sums over runs.
impl Weigh for Big {
    const NONE: Self = Self::ZERO;

    fn or(self, other: Self) -> Self {
        let (large, small) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        if large.mantissa == 0.0 || small.mantissa == 0.0 {
            return if large.mantissa == 0.0 { small } else { large };
        }
        let apart = large.exponent - small.exponent;
        if apart > 64 {
            return large;
        }
        let mantissa = large.mantissa + small.mantissa * 2f64.powi(-(apart as i32));
        Self { mantissa, exponent: large.exponent }.normal()
    }

    fn after(self, step: Self) -> Self {
        let product =
            Self { mantissa: self.mantissa * step.mantissa, exponent: self.exponent + step.exponent };
        product.normal()
    }

    fn and(self, other: Self) -> Self {
        self.after(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_adds_and_multiplies(a in 1u64..1_000_000, b in 1u64..1_000_000, cost in 0u64..5_000_000) {
            let big = |n: u64| (0..64).rev().fold(Big::ZERO, |sum, bit| {
                let twice = sum.or(sum);
                if n >> bit & 1 == 1 { twice.or(Big::ONE) } else { twice }
            });
            prop_assert_eq!(big(a).or(big(b)), big(a + b));
            prop_assert_eq!(big(a).after(big(b)), big(a * b));
            prop_assert!((big(a).part_of(big(b)) / (a as f64 / b as f64) - 1.0).abs() < 1e-14);
            prop_assert!((Big::of_cost(cost, 1e6).ln() + cost as f64 / 1e6).abs() < 1e-12);
        }
    }

    #[test]
    fn beyond_floats_it_goes_on() {
        let tiny = Big::of_cost(10_000_000_000, 1e6);
        assert!((tiny.ln() + 10_000.0).abs() < 1e-6);
        assert!((tiny.or(tiny).ln() - (std::f64::consts::LN_2 - 10_000.0)).abs() < 1e-6);
        assert_eq!(Big::of_cost(123, f64::INFINITY), Big::ONE);
        assert_eq!(Big::ZERO.or(tiny), tiny);
        assert_eq!(Big::ZERO.ln(), f64::NEG_INFINITY);
    }
}
