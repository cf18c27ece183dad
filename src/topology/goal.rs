//! What topology is asked for.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::descriptor::{Descriptor, Topology};

/// Whether the run of pieces has two ends or closes on itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// Begins and ends without portals.
    Open,
    /// The last piece is glued to the first.
    Ring,
}

impl Shape {
    /// What a sequence of this shape adds up to, by joining all its descriptors; `None` when portal numbers do not
    /// match, an open run has portals left, or there is no descriptor.
    pub fn topology<'d>(self, descriptors: impl IntoIterator<Item = &'d Descriptor>) -> Option<Topology> {
        let mut descriptors = descriptors.into_iter();
        let first = descriptors.next()?.clone();
        let run = descriptors.try_fold(first, |run, next| run.join(next)).ok()?;
        match self {
            Self::Open => run.finished(),
            Self::Ring => run.close().ok(),
        }
    }
}

/// The numbers that are wanted of something: all from the least to the most, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Wanted {
    least: u32,
    most: u32,
}

impl Wanted {
    /// Exactly `n`.
    pub const fn exactly(n: u32) -> Self {
        Self { least: n, most: n }
    }

    /// From `least` to `most`, both included; `None` when there is no such number.
    pub fn between(least: u32, most: u32) -> Option<Self> {
        (least <= most).then_some(Self { least, most })
    }

    /// The least number wanted.
    pub fn least(self) -> u32 {
        self.least
    }

    /// The greatest number wanted.
    pub fn most(self) -> u32 {
        self.most
    }

    /// The least and the greatest number wanted.
    pub fn ends(self) -> [u32; 2] {
        [self.least, self.most]
    }

    /// Whether `n` is wanted.
    pub fn contains(self, n: u32) -> bool {
        (self.least..=self.most).contains(&n)
    }

    /// How far `n` is from the nearest number that is wanted.
    pub fn distance(self, n: u32) -> u32 {
        self.least.saturating_sub(n).max(n.saturating_sub(self.most))
    }
}

impl From<u32> for Wanted {
    fn from(n: u32) -> Self {
        Self::exactly(n)
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.least == self.most {
            true => write!(f, "{}", self.least),
            false => write!(f, "{}..{}", self.least, self.most),
        }
    }
}

/// A text that is no [`Wanted`].
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum WantedError {
    /// It is neither a number nor two with dots between them.
    #[error(
        "'{0}' is neither a number nor a range; use a number, as 1, or a range with both ends included, as 2..5"
    )]
    Form(String),
    /// The range has its ends the wrong way round.
    #[error("'{0}' ends before it begins; give the smaller number first, as 2..5")]
    Backwards(String),
}

impl FromStr for Wanted {
    type Err = WantedError;

    /// Reads `3`, or `2..5` with both ends included.
    fn from_str(text: &str) -> Result<Self, WantedError> {
        let number = |text: &str| text.trim().parse::<u32>().ok();
        let form = || WantedError::Form(text.to_owned());
        let Some((least, most)) = text.split_once("..") else {
            return number(text).map(Self::exactly).ok_or_else(form);
        };
        let most = most.strip_prefix('=').unwrap_or(most);
        let (least, most) = number(least).zip(number(most)).ok_or_else(form)?;
        Self::between(least, most).ok_or_else(|| WantedError::Backwards(text.to_owned()))
    }
}

/// The topology that is asked for. A `None` leaves a number free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Goal {
    /// Connected components.
    pub components: Option<Wanted>,
    /// Holes; the inside of a closed ring counts as one.
    pub holes: Option<Wanted>,
    /// Whether some component must wind all the way round, which none does in an open run.
    pub closed_pattern: bool,
}

impl Goal {
    /// Whether `topology` meets the goal.
    pub fn admits(&self, topology: Topology) -> bool {
        self.components.is_none_or(|wanted| wanted.contains(topology.components))
            && self.holes.is_none_or(|wanted| wanted.contains(topology.holes))
            && (topology.closed_pattern || !self.closed_pattern)
    }

    /// Whether anything is asked for.
    pub fn is_free(&self) -> bool {
        *self == Self::default()
    }

    /// Whether more than one component is too many, and one is not.
    pub fn is_one_component(&self) -> bool {
        self.components.is_some_and(|wanted| wanted.most() == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_ranges_are_read_and_shown() {
        assert_eq!("3".parse(), Ok(Wanted::exactly(3)));
        assert_eq!("2..5".parse::<Wanted>().ok(), Wanted::between(2, 5));
        assert_eq!("2..=5".parse::<Wanted>().unwrap().to_string(), "2..5");
        assert_eq!(Wanted::exactly(7).to_string(), "7");
        for wrong in ["", "x", "5..2", "1..", "..3", "-1", "1.5", "99999999999"] {
            assert!(wrong.parse::<Wanted>().unwrap_err().to_string().contains("as 2..5"), "{wrong}");
        }
        assert!("5..2".parse::<Wanted>().unwrap_err().to_string().contains("ends before it begins"));
        let wanted: Wanted = "2..5".parse().unwrap();
        assert_eq!([0, 2, 4, 5, 9].map(|n| wanted.distance(n)), [2, 0, 0, 0, 4]);
    }
}
