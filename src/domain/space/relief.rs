//! How far a sheet stands out from where it would be flat.

use glam::DVec2;

/// A smooth height over a sheet: the uniform cubic B-spline of a table of heights.
///
/// The table is stretched over the sheet, its corners on the sheet's corners. A B-spline lies between its values and has a
/// continuous curvature; where a table has a single peak it is rounded. On a closed sheet the first column follows the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    /// Row by row, from the lower side up; each row along the sheet.
    heights_mm: Vec<f64>,
    columns: usize,
    rows: usize,
    length_mm: f64,
    v_range_mm: [f64; 2],
    is_closed: bool,
}

impl Relief {
    /// The height of a sheet from u = 0 to `length_mm` and across `v_range_mm`. The table has rows of so many `columns`, the lowest
    /// first. On a closed sheet the last column is followed by the first, a step further.
    ///
    /// # Panics
    /// If the table is not of that shape, with four rows and columns at least.
    pub fn new(
        heights_mm: Vec<f64>,
        columns: usize,
        length_mm: f64,
        v_range_mm: [f64; 2],
        is_closed: bool,
    ) -> Self {
        let rows = heights_mm.len() / columns;
        assert!(rows * columns == heights_mm.len() && rows >= 4 && columns >= 4, "a table of heights");
        Self { heights_mm, columns, rows, length_mm, v_range_mm, is_closed }
    }

    /// The height in mm at (u, v). Beyond the sheet it goes on as at its border.
    pub fn at(&self, uv: DVec2) -> f64 {
        let [low, high] = self.v_range_mm;
        let (columns, rows) = (self.columns as f64, self.rows as f64);
        let x = match self.is_closed {
            true => (uv.x / self.length_mm).rem_euclid(1.0) * columns,
            false => (uv.x / self.length_mm).clamp(0.0, 1.0) * (columns - 1.0),
        };
        let y = ((uv.y - low) / (high - low)).clamp(0.0, 1.0) * (rows - 1.0);
        let ((i, wx), (j, wy)) = match self.is_closed {
            true => (weights(x), bordered(weights(y), self.rows)),
            false => (bordered(weights(x), self.columns), bordered(weights(y), self.rows)),
        };
        let column = |k: i64| match self.is_closed {
            true => k.rem_euclid(self.columns as i64) as usize,
            false => k.clamp(0, self.columns as i64 - 1) as usize,
        };
        let row = |k: i64| k.clamp(0, self.rows as i64 - 1) as usize;
        let along = |j: i64| -> f64 {
            let start = row(j) * self.columns;
            (-1..3).zip(wx).map(|(k, weight)| weight * self.heights_mm[start + column(i + k)]).sum()
        };
        (-1..3).zip(wy).map(|(k, weight)| weight * along(j + k)).sum()
    }

    /// The least and the greatest height of the table, between which the sheet stays.
    pub fn range_mm(&self) -> [f64; 2] {
        let range = |[low, high]: [f64; 2], &height: &f64| [low.min(height), high.max(height)];
        self.heights_mm.iter().fold([f64::INFINITY, f64::NEG_INFINITY], range)
    }
}

/// The cell of a place, and what the four values around it weigh.
fn weights(x: f64) -> (i64, [f64; 4]) {
    let cell = x.floor();
    let t = x - cell;
    let s = 1.0 - t;
    let inner = |t: f64| (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0;
    (cell as i64, [s * s * s / 6.0, inner(t), inner(s), t * t * t / 6.0])
}

/// The same at the borders of a table of `n` values, beyond which it goes on straight: what the value beyond would weigh is put on the last
/// two. No weight becomes negative by that, and the border is met exactly.
fn bordered((cell, mut weights): (i64, [f64; 4]), n: usize) -> (i64, [f64; 4]) {
    let last = n as i64 - 1;
    if cell == 0 {
        weights[1] += 2.0 * weights[0];
        weights[2] -= weights[0];
        weights[0] = 0.0;
    }
    if cell == last {
        weights[1] += 2.0 * weights[2];
        weights[0] -= weights[2];
        (weights[2], weights[3]) = (0.0, 0.0);
    } else if cell + 1 == last {
        weights[2] += 2.0 * weights[3];
        weights[1] -= weights[3];
        weights[3] = 0.0;
    }
    (cell, weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn planes_stay_planes() {
        let heights = (0..5).flat_map(|j| (0..7).map(move |i| 2.0 * f64::from(i) - f64::from(j))).collect();
        let relief = Relief::new(heights, 7, 60.0, [-20.0, 20.0], false);
        for (u, v) in
            [(20.0, 0.0), (31.0, -3.0), (40.0, 5.5), (0.0, -20.0), (60.0, 20.0), (59.0, -19.0), (1.0, 19.5)]
        {
            let plane = 2.0 * u / 10.0 - (v + 20.0) / 10.0;
            assert!((relief.at(DVec2::new(u, v)) - plane).abs() < 1e-12);
        }
    }

    #[test]
    fn a_closed_sheet_goes_on_over_its_end() {
        let heights = (0..4).flat_map(|_| (0..12).map(|i| f64::from(i % 5))).collect();
        let relief = Relief::new(heights, 12, 60.0, [0.0, 10.0], true);
        for v in [0.0, 3.3, 10.0] {
            let at = |u: f64| relief.at(DVec2::new(u, v));
            assert!((at(0.0) - at(60.0)).abs() < 1e-12 && (at(-1.0) - at(59.0)).abs() < 1e-12);
            assert!((at(1e-7) - at(60.0 - 1e-7)).abs() < 1e-6);
        }
    }

    proptest! {
        #[test]
        fn heights_stay_between_those_of_the_table(
            heights in prop::collection::vec(-9.0..9.0f64, 30), u in -5.0..65.0f64, v in -5.0..15.0f64,
        ) {
            let relief = Relief::new(heights, 6, 60.0, [0.0, 10.0], false);
            let [low, high] = relief.range_mm();
            let height = relief.at(DVec2::new(u, v));
            prop_assert!(height >= low - 1e-12 && height <= high + 1e-12);
        }
    }
}
