//! Random numbers that belong to a place: the same whoever asks first.

/// Numbers that follow from a seed and from what they are for (SplitMix64, Steele, Lea and Flood 2014).
#[derive(Debug, Clone)]
pub struct Draws {
    state: u64,
}

impl Draws {
    /// The numbers for `purpose`, which names level, step, sample and the like.
    pub fn new(seed: u64, purpose: &[u64]) -> Self {
        let mut draws = Self { state: seed };
        for &word in purpose {
            draws.state = draws.bits() ^ word.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
        draws
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number from 0 up to, and without, 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// One of `count` numbers from 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }
}
