//! Vertical offsets of the pieces (Zhou 2014 §4.1).

/// The offsets δ that minimise Σ M_i (δ_i + τ_i − δ_{i+1})² with δ = 0 at both ends of an open run, or at the
/// first piece of a ring. `rises` are the τ of successive joins in millimetres and `portals` their M; a ring
/// has one more join than an open run of as many pieces, the closing one last.
///
/// The paper solves the tridiagonal normal equations. As the terms form a chain, what the τ do not add up to
/// is spread over the joins in proportion to 1 / M_i, which is the same in closed form. Joins without portals
/// cost nothing and take all of it if there are any.
pub fn offsets(rises: &[f64], portals: &[usize], is_ring: bool) -> Vec<f64> {
    let excess: f64 = rises.iter().sum();
    let empty = portals.iter().filter(|&&m| m == 0).count();
    let yielding = |m: usize| match (empty, m) {
        (0, m) => 1.0 / m as f64,
        (_, 0) => 1.0,
        _ => 0.0,
    };
    let total: f64 = portals.iter().map(|&m| yielding(m)).sum();
    let mut offset = 0.0;
    let mut offsets = vec![offset];
    for (&rise, &m) in rises.iter().zip(portals) {
        offset += rise - excess * yielding(m) / total;
        offsets.push(offset);
    }
    if is_ring {
        offsets.pop();
    }
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn energy(offsets: &[f64], rises: &[f64], portals: &[usize]) -> f64 {
        let ring = offsets.len() == rises.len();
        (0..rises.len())
            .map(|i| {
                let next = if ring && i + 1 == rises.len() { offsets[0] } else { offsets[i + 1] };
                portals[i] as f64 * (offsets[i] + rises[i] - next).powi(2)
            })
            .sum()
    }

    #[test]
    fn ends_lie_on_the_axis() {
        let found = offsets(&[1.0, 2.0, 3.0], &[1, 2, 3], false);
        assert!(found[0] == 0.0 && found[3].abs() < 1e-12);
        let ring = offsets(&[1.0, -3.0, 0.5], &[2, 1, 1], true);
        assert_eq!(ring.len(), 3);
    }

    #[test]
    fn an_empty_join_takes_all() {
        let found = offsets(&[1.0, 0.0, 2.0], &[2, 0, 1], false);
        assert_eq!(found, [0.0, 1.0, -2.0, 0.0]);
    }

    proptest! {
        #[test]
        fn no_other_offsets_are_better(
            joins in prop::collection::vec((-2.0f64..2.0, 1usize..6), 2..12),
            nudges in prop::collection::vec(-0.1f64..0.1, 12),
            is_ring in any::<bool>(),
        ) {
            let (rises, portals): (Vec<f64>, Vec<usize>) = joins.into_iter().unzip();
            let best = offsets(&rises, &portals, is_ring);
            let mut other = best.clone();
            let last = other.len() - usize::from(!is_ring);
            for (o, nudge) in other[1..last].iter_mut().zip(&nudges) {
                *o += nudge;
            }
            prop_assert!(energy(&best, &rises, &portals) <= energy(&other, &rises, &portals) + 1e-9);
        }
    }
}
