//! The algebra of runs, once more: what gluing at portals makes, written apart from the code that planned it.
//!
//! A run is known by the labels of its open portals, the components that are closed and χ. Gluing m portals unites
//! labels; what is left without a portal is closed; χ(A∪B) = χ(A) + χ(B) − m (Zhou 2014 §3.4). Whether a ring goes
//! all the way round is decided by walking: each label is given a number of turns, crossing the seam adds one, and
//! a walk that comes back to a label with another number has gone round (Zhou 2014 §3.6.3, Figure 6).

/// A run, or a single piece.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Run {
    /// Labels of the open portals on the left end, top to bottom.
    pub(super) left: Vec<i64>,
    /// On the right end.
    pub(super) right: Vec<i64>,
    /// Components without an open portal.
    pub(super) closed: i64,
    /// The Euler characteristic.
    pub(super) euler: i64,
}

/// What a closed ring is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Ring {
    pub(super) components: i64,
    pub(super) euler: i64,
    pub(super) winds: bool,
}

impl Run {
    /// Components with an open portal; labels are in order.
    fn open(&self) -> i64 {
        self.left.iter().chain(&self.right).max().map_or(0, |most| most + 1)
    }

    /// All components.
    pub(super) fn components(&self) -> i64 {
        self.closed + self.open()
    }

    /// Why there can be no such run: labels must be numbered as they come, counts must not be negative.
    pub(super) fn fault(&self) -> Option<String> {
        let mut next = 0;
        for &label in self.left.iter().chain(&self.right) {
            if !(0..=next).contains(&label) {
                return Some(format!(
                    "label {label} comes where at most {next} can, as labels are numbered as they come"
                ));
            }
            next = next.max(label + 1);
        }
        if self.closed < 0 {
            return Some(format!("it has {} closed components", self.closed));
        }
        let holes = self.components() - self.euler;
        (holes < 0).then(|| {
            format!(
                "{} component(s) with an Euler characteristic of {} have {holes} holes",
                self.components(),
                self.euler
            )
        })
    }

    /// The run `self` followed by `next`; both are without fault. The error says why they do not fit.
    pub(super) fn glue(&self, next: &Self) -> Result<Self, String> {
        let m = self.right.len();
        if next.left.len() != m {
            return Err(format!("{m} open portal(s) meet {}", next.left.len()));
        }
        // Groups of labels; those of `next` come after those of `self`.
        let shift = self.open();
        let mut group: Vec<i64> = (0..shift + next.open()).collect();
        for (&a, &b) in self.right.iter().zip(&next.left) {
            let (keep, give) = (group[a as usize], group[(shift + b) as usize]);
            for g in group.iter_mut().filter(|g| **g == give) {
                *g = keep;
            }
        }
        // Renumbered as they come; a group that does not come is closed.
        let mut names: Vec<Option<i64>> = vec![None; group.len()];
        let mut given = 0;
        let mut name = |label: i64| {
            *names[group[label as usize] as usize].get_or_insert_with(|| {
                given += 1;
                given - 1
            })
        };
        let left = self.left.iter().map(|&l| name(l)).collect();
        let right = next.right.iter().map(|&l| name(shift + l)).collect();
        let mut groups = group.clone();
        groups.sort_unstable();
        groups.dedup();
        let closed = self.closed + next.closed + groups.len() as i64 - given;
        Ok(Self { left, right, closed, euler: self.euler + next.euler - m as i64 })
    }

    /// The ring made by gluing the right end to the left one.
    pub(super) fn ring(&self) -> Result<Ring, String> {
        let m = self.right.len();
        if self.left.len() != m {
            return Err(format!("{m} open portal(s) at the end meet {} at the beginning", self.left.len()));
        }
        let n = self.open() as usize;
        let mut seams: Vec<Vec<(usize, i64)>> = vec![Vec::new(); n];
        for (&r, &l) in self.right.iter().zip(&self.left) {
            seams[r as usize].push((l as usize, 1));
            seams[l as usize].push((r as usize, -1));
        }
        let mut turns: Vec<Option<i64>> = vec![None; n];
        let (mut components, mut winds) = (self.closed, false);
        for start in 0..n {
            if turns[start].is_some() {
                continue;
            }
            components += 1;
            turns[start] = Some(0);
            let mut queue = vec![(start, 0)];
            while let Some((at, here)) = queue.pop() {
                for &(to, step) in &seams[at] {
                    match turns[to] {
                        None => {
                            turns[to] = Some(here + step);
                            queue.push((to, here + step));
                        }
                        Some(there) => winds |= there != here + step,
                    }
                }
            }
        }
        Ok(Ring { components, euler: self.euler - m as i64, winds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn run(left: &[i64], right: &[i64], closed: i64, euler: i64) -> Run {
        Run { left: left.to_vec(), right: right.to_vec(), closed, euler }
    }

    #[test]
    fn figure_4_and_figure_6() {
        // Zhou 2014 Figure 4: four components and two, joined at four portals.
        let joined = run(&[0, 1], &[1, 2, 3, 3], 0, 4).glue(&run(&[0, 1, 0, 0], &[0], 0, 2)).unwrap();
        assert_eq!(joined, run(&[0, 1], &[1], 1, 2));
        // Figure 6: strands that cross over wind, hooks do not.
        assert_eq!(run(&[0, 1], &[1, 0], 0, 2).ring(), Ok(Ring { components: 1, euler: 0, winds: true }));
        assert_eq!(run(&[0, 0], &[1, 1], 0, 2).ring(), Ok(Ring { components: 1, euler: 0, winds: false }));
        assert!(run(&[0], &[0, 0], 0, 1).ring().is_err());
        assert!(run(&[0], &[0, 0], 0, 1).glue(&run(&[0], &[], 0, 1)).is_err());
    }

    #[test]
    fn impossible_runs_are_told() {
        assert_eq!(run(&[0, 0, 1], &[2, 1], 0, -4).fault(), None);
        assert!(run(&[1], &[0], 0, 2).fault().unwrap().contains("label 1"));
        assert!(run(&[0], &[-1], 0, 2).fault().unwrap().contains("label -1"));
        assert!(run(&[0], &[0], 0, 2).fault().unwrap().contains("-1 holes"));
        assert!(run(&[], &[], -1, -1).fault().is_some());
    }

    /// A run with portals in some groups.
    fn runs() -> impl Strategy<Value = Run> {
        (prop::collection::vec(0i64..3, 3), prop::collection::vec(0i64..3, 3), 0i64..3, 0i64..3).prop_map(
            |(left, right, closed, holes)| {
                let mut names: Vec<i64> = Vec::new();
                let mut name = |l: &i64| {
                    let known = names.iter().position(|n| n == l);
                    known.unwrap_or_else(|| {
                        names.push(*l);
                        names.len() - 1
                    }) as i64
                };
                let left: Vec<i64> = left.iter().map(&mut name).collect();
                let right: Vec<i64> = right.iter().map(&mut name).collect();
                let euler = names.len() as i64 + closed - holes;
                Run { left, right, closed, euler }
            },
        )
    }

    proptest! {
        #[test]
        fn gluing_is_associative_and_never_loses_holes(a in runs(), b in runs(), c in runs()) {
            let one = a.glue(&b).unwrap().glue(&c).unwrap();
            prop_assert_eq!(&one, &a.glue(&b.glue(&c).unwrap()).unwrap());
            prop_assert_eq!(one.fault(), None);
            let holes = |r: &Run| r.components() - r.euler;
            prop_assert!(holes(&one) >= holes(&a) + holes(&b) + holes(&c));
            // Where a ring is opened does not matter.
            let turned = b.glue(&c).unwrap().glue(&a).unwrap();
            prop_assert_eq!(one.ring(), turned.ring());
        }
    }
}
