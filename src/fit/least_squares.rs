//! Complex least squares with some unknowns held fixed: factorized once, solved for any fixed values.
//!
//! The sum of w |Σ aₖ xₖ|² over all terms is a quadratic form with a sparse Hermitian matrix H. With the
//! unknowns split into free and fixed ones its minimum solves H_ff x_f = −H_fx x_x. What is fixed is decided when
//! H_ff is factorized, to what value only when it is solved, so that one factorization serves all values. This is
//! the adapter to faer; nothing else in the room knows of it.

use faer::linalg::solvers::Solve;
use faer::prelude::*;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Side, c64};
use glam::DVec2;

/// A sum of weighted squares of linear forms in complex unknowns; a complex number is a vector.
#[derive(Debug, Clone)]
pub(super) struct LeastSquares {
    unknowns: usize,
    entries: Vec<(usize, usize, c64)>,
}

/// The normal equations with the free part factorized.
#[derive(Debug, Clone)]
pub(super) struct Factorized {
    llt: Llt<usize, c64>,
    /// The place of each unknown among the free or the fixed ones.
    slots: Vec<Slot>,
    /// H_fx: place among the free, place among the fixed, value.
    coupling: Vec<(usize, usize, c64)>,
    free: usize,
}

#[derive(Debug, Clone, Copy)]
enum Slot {
    Free(usize),
    Fixed(usize),
}

impl LeastSquares {
    pub(super) fn new(unknowns: usize) -> Self {
        Self { unknowns, entries: Vec::new() }
    }

    /// Adds weight · |Σ coefficient · unknown|².
    pub(super) fn add(&mut self, weight: f64, form: &[(usize, DVec2)]) {
        for &(i, a) in form {
            for &(j, b) in form {
                let product = c64::new(a.x, -a.y) * c64::new(b.x, b.y) * weight;
                self.entries.push((i, j, product));
            }
        }
    }

    /// The factorization for the `fixed` unknowns, in the order in which their values will be given. `None` when
    /// they do not determine the others, or the numbers are too far apart for floats.
    pub(super) fn factorized(&self, fixed: &[usize]) -> Option<Factorized> {
        let mut slots: Vec<Option<Slot>> = vec![None; self.unknowns];
        for (place, &unknown) in fixed.iter().enumerate() {
            slots[unknown] = Some(Slot::Fixed(place));
        }
        let mut free = 0;
        let slots: Vec<Slot> = slots
            .into_iter()
            .map(|slot| {
                slot.unwrap_or_else(|| {
                    free += 1;
                    Slot::Free(free - 1)
                })
            })
            .collect();
        let (mut inner, mut coupling) = (Vec::new(), Vec::new());
        for &(i, j, value) in &self.entries {
            match (slots[i], slots[j]) {
                // One triangle of a Hermitian matrix is enough.
                (Slot::Free(i), Slot::Free(j)) if i >= j => inner.push(Triplet::new(i, j, value)),
                (Slot::Free(i), Slot::Fixed(j)) => coupling.push((i, j, value)),
                _ => {}
            }
        }
        let matrix = SparseColMat::<usize, c64>::try_new_from_triplets(free, free, &inner).ok()?;
        let symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok()?;
        let llt = Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).ok()?;
        Some(Factorized { llt, slots, coupling, free })
    }
}

impl Factorized {
    /// All unknowns, with the fixed ones at `values`.
    pub(super) fn minimum(&self, values: &[DVec2]) -> Vec<DVec2> {
        let mut right = Mat::<c64>::zeros(self.free, 1);
        for &(i, j, h) in &self.coupling {
            right[(i, 0)] -= h * c64::new(values[j].x, values[j].y);
        }
        self.llt.solve_in_place(&mut right);
        let value = |slot: &Slot| match *slot {
            Slot::Free(i) => DVec2::new(right[(i, 0)].re, right[(i, 0)].im),
            Slot::Fixed(i) => values[i],
        };
        self.slots.iter().map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = DVec2> {
        (-2.0f64..2.0, -2.0f64..2.0).prop_map(|(x, y)| DVec2::new(x, y))
    }

    proptest! {
        // The gradient at the minimum vanishes: no small step in any free unknown makes the sum smaller.
        #[test]
        fn no_neighbour_is_better(
            coefficients in prop::collection::vec((vector(), vector(), 0.1f64..3.0), 6),
            ends in (vector(), vector()),
            steps in prop::collection::vec(vector(), 7),
        ) {
            let mut sum = LeastSquares::new(7);
            for (k, &(a, b, weight)) in coefficients.iter().enumerate() {
                sum.add(weight, &[(k, a), (k + 1, b)]);
                sum.add(1e-2, &[(k, DVec2::X)]);
            }
            let energy = |x: &[DVec2]| -> f64 {
                coefficients.iter().enumerate().map(|(k, &(a, b, weight))| {
                    weight * (a.rotate(x[k]) + b.rotate(x[k + 1])).length_squared() + 1e-2 * x[k].length_squared()
                }).sum()
            };
            let factorized = sum.factorized(&[6, 0]).expect("every unknown has a weight");
            let best = factorized.minimum(&[ends.1, ends.0]);
            prop_assert_eq!((best[0], best[6]), (ends.0, ends.1));
            let mut other = best.clone();
            for (x, step) in other[1..6].iter_mut().zip(&steps) {
                *x += *step * 1e-2;
            }
            prop_assert!(energy(&best) <= energy(&other) * (1.0 + 1e-9) + 1e-9);
        }
    }

    #[test]
    fn what_nothing_determines_has_no_factorization() {
        let mut sum = LeastSquares::new(3);
        sum.add(1.0, &[(0, DVec2::X), (1, -DVec2::X)]);
        assert!(sum.factorized(&[0]).is_none(), "unknown 2 stands alone");
    }
}
