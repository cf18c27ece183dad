//! Search problems of any size, made from a seed.
//!
//! An exemplar is a row of strands between its cuts, and each of its pieces holds one event: a strand begins,
//! ends, splits in two, or two of them merge (Zhou 2014 §5.2 promises just that of its pieces). The numbers of
//! portals walk up from 0, about for a while, and down to 0 again. Portals lie about evenly in the band; what a
//! join costs and by how much it raises the run is Zhou 2014 §3.6.1 on the endpoints of the two cuts.

use openwork::solver::{Problem, Step};
use openwork::topology::{Descriptor, Shape};

/// The height of the band in mm. Only costs depend on it.
const HEIGHT_MM: f64 = 10.0;
/// Units of drift in the height of the band, as in a job.
const DRIFT_UNITS: f64 = 64.0;
/// The weight of positions against tangents (Zhou 2014 §3.6.1).
const ALPHA: f64 = 0.8;

/// What an exemplar is to be like.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// Its pieces.
    pub pieces: usize,
    /// The most portals on a cut.
    pub portals: usize,
    /// Another seed gives another exemplar.
    pub seed: u64,
}

/// An exemplar in pieces.
pub struct Instance {
    descriptors: Vec<Descriptor>,
    widths: Vec<u32>,
    steps: Vec<Vec<Step>>,
}

/// Numbers that depend on a seed (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        for factor in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
            z = (z ^ (z >> 30)).wrapping_mul(factor);
            z ^= z >> 27;
        }
        z >> 11
    }

    /// A number in 0..1.
    fn part(&mut self) -> f64 {
        self.next() as f64 / (1u64 << 53) as f64
    }

    /// A number below `n`.
    fn below(&mut self, n: usize) -> usize {
        (self.part() * n as f64) as usize
    }
}

/// The endpoints of the portals on a cut: heights in mm, and directions as angles.
struct Cut(Vec<(f64, f64)>);

impl Instance {
    /// The exemplar of these sizes.
    pub fn new(sizes: Sizes) -> Self {
        let mut random = Random(sizes.seed);
        let portals = portal_numbers(sizes, &mut random);
        let cuts: Vec<Cut> = portals.iter().map(|&m| Cut::new(m, &mut random)).collect();
        let descriptors: Vec<Descriptor> =
            portals.windows(2).map(|pair| piece(pair[0], pair[1], &mut random)).collect();
        let widths = (0..sizes.pieces).map(|_| 2 + random.below(11) as u32).collect();
        let steps = (0..sizes.pieces)
            .map(|from| {
                let fits = |&to: &usize| portals[to] > 0 && portals[to] == portals[from + 1];
                (0..sizes.pieces).filter(fits).map(|to| cuts[from + 1].step(&cuts[to], to)).collect()
            })
            .collect();
        Self { descriptors, widths, steps }
    }

    /// The search for a run of `length` bins, within the paper's ε of 5 %.
    pub fn problem(&self, shape: Shape, length: u32) -> Problem<'_> {
        let free = |side: fn(&Descriptor) -> &[u16]| {
            self.descriptors.iter().map(|d| side(d).is_empty().then_some(0)).collect()
        };
        let (low, high) = (f64::from(length) * 0.95, f64::from(length) * 1.05);
        Problem {
            shape,
            descriptors: &self.descriptors,
            widths: self.widths.clone(),
            steps: self.steps.clone(),
            begin: free(Descriptor::left),
            end: free(Descriptor::right),
            window: low.ceil() as u32..=high.floor() as u32,
            drift_limit: (DRIFT_UNITS / 2.0) as i32,
            variety: None,
            memory_limit: 2 << 30,
            effort_limit: usize::MAX,
        }
    }

    /// The mean width of its pieces in bins.
    pub fn mean_width(&self) -> f64 {
        self.widths.iter().map(|&w| f64::from(w)).sum::<f64>() / self.widths.len() as f64
    }
}

/// The numbers of portals on the cuts: 0 at both ends and never between, one more or less from cut to cut. With
/// an odd number of pieces, one number occurs twice in a row.
fn portal_numbers(sizes: Sizes, random: &mut Random) -> Vec<usize> {
    let Sizes { pieces, portals: most, .. } = sizes;
    let even = pieces / 2 * 2;
    let mut numbers = vec![0usize, 1];
    while numbers.len() <= even {
        let (here, left) = (numbers[numbers.len() - 1], even + 1 - numbers.len());
        let must_fall = left <= here || here == most;
        let must_rise = here == 1 && left > 1;
        let rises = must_rise || (!must_fall && random.part() < 0.65);
        numbers.push(if rises && most > 1 { here + 1 } else { here - 1 });
    }
    if pieces > even {
        let at = numbers.iter().position(|&m| m > 1).unwrap_or(1);
        numbers.insert(at, numbers[at]);
    }
    numbers
}

/// A piece with one event between `left` and `right` portals; two strands that touch when they are equally many.
fn piece(left: usize, right: usize, random: &mut Random) -> Descriptor {
    let strands: Vec<u32> = (0..left as u32).collect();
    let (mut before, mut after) = (strands.clone(), strands);
    let new = left as u32;
    let components = if right > left {
        let is_birth = left == 0 || random.part() < 0.2;
        let at = random.below(left.max(1));
        after.insert(at, if is_birth { new } else { after[at] });
        left + usize::from(is_birth)
    } else {
        let is_death = right < left && (left == 1 || random.part() < 0.2);
        let at = random.below(if is_death { left } else { left - 1 });
        if !is_death {
            before[at + 1] = before[at];
            after[at + 1] = after[at];
        }
        if right < left {
            after.remove(at);
        }
        left - usize::from(!is_death)
    };
    Descriptor::new(&before, &after, 0, components as i64)
}

impl Cut {
    fn new(portals: usize, random: &mut Random) -> Self {
        let pitch = HEIGHT_MM / portals.max(1) as f64;
        let mut ends = Vec::new();
        for portal in (0..portals).rev() {
            let middle = (portal as f64 + 0.35 + 0.3 * random.part()) * pitch;
            let half = (0.1 + 0.15 * random.part()) * pitch;
            for y in [middle + half, middle - half] {
                ends.push((y, 1.4 * random.part() - 0.7));
            }
        }
        Self(ends)
    }

    /// The join at this cut of what lies left of it to the piece `to`, which lies right of `next`.
    fn step(&self, next: &Self, to: usize) -> Step {
        let n = self.0.len() as f64;
        let pairs = || self.0.iter().zip(&next.0);
        let rise_mm = pairs().map(|(a, b)| a.0 - b.0).sum::<f64>() / n;
        let matching = pairs().map(|(a, b)| (b.0 - a.0 + rise_mm).powi(2)).sum::<f64>() / n;
        let tangent: f64 = pairs().map(|(a, b)| 1.0 - (a.1 - b.1).cos()).sum();
        let cost = ALPHA * matching + (1.0 - ALPHA) * tangent;
        let rise = (rise_mm / HEIGHT_MM * DRIFT_UNITS).round() as i32;
        Step { to, cost: (cost * 1e6).round() as u64, rise }
    }
}
