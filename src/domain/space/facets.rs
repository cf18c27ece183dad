//! Where a curved sheet needs lines so that flat facets between them stay within the chord error.

use glam::DVec2;

use super::map::SpaceMap;

/// A chord error below this gives no better part, only more facets.
const MIN_CHORD_MM: f64 = 1e-4;
/// The part of the chord error that is used, as the greatest error may lie between two samples.
const CHORD_SHARE: f64 = 0.9;
/// No facet goes round more of a bend or a twist than this, in radians: where samples are farther apart, a whole turn could look
/// straight.
const MOST_TURN: f64 = 0.5;
/// The cells of a relief are from this wide, in millimetres, to as wide as the greatest; each next one is half of it.
const CELLS_MM: [f64; 7] = [8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125];

/// The most cells of a sheet. Finer ones make files that no program opens; where they are not flat enough, the chord error is not kept, which is told.
const MOST_CELLS: f64 = 2e6;

impl SpaceMap {
    /// Places along the curve, from `start` to a whole length further, between which flat facets stay within `chord_mm` of the band.
    /// The start is 0 on an open curve.
    pub fn lines(&self, start: f64, chord_mm: f64) -> Vec<f64> {
        if self.has_relief() {
            return self.even_lines(start, chord_mm);
        }
        let tolerance = CHORD_SHARE * chord_mm.max(MIN_CHORD_MM);
        let mut lines = vec![start];
        // Stretches that turn no more than a facet may, and end where a twist changes.
        let length = self.curve().length_mm();
        let creases = self.curve().creases().map(|u| if u < start { u + length } else { u });
        let creases: Vec<f64> = creases.collect();
        let mut places: Vec<f64> = self.looks().map(|u| u + start).chain(creases.iter().copied()).collect();
        places.sort_by(f64::total_cmp);
        let (mut from, mut turned) = (start, 0.0);
        for pair in places.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|u| self.curve().frame(u));
            let is_crease = creases.contains(&pair[0]);
            turned += a.along.angle_between(b.along).max(a.across.angle_between(b.across));
            if (turned > MOST_TURN || is_crease) && pair[0] > from {
                self.refine(from, pair[0], tolerance, &mut lines);
                (from, turned) = (pair[0], 0.0);
            }
        }
        self.refine(from, start + length, tolerance, &mut lines);
        lines
    }

    /// Adds the places after `from` up to `to`.
    fn refine(&self, from: f64, to: f64, tolerance: f64, lines: &mut Vec<f64>) {
        if self.is_flat(from, to, tolerance) {
            lines.push(to);
            return;
        }
        let middle = 0.5 * (from + to);
        self.refine(from, middle, tolerance, lines);
        self.refine(middle, to, tolerance, lines);
    }

    /// Whether facets between two places stay within `tolerance` of the band, on its front and its back.
    fn is_flat(&self, from: f64, to: f64, tolerance: f64) -> bool {
        let corner = |u: f64, v: usize, w: usize| {
            self.place(DVec2::new(u, self.v_range_mm()[v]), self.w_range_mm()[w])
        };
        (0..2).all(|w| {
            // Of facets in a strip that is twisted any may be on either side of it by this.
            let twist = corner(from, 0, w) - corner(from, 1, w) - corner(to, 0, w) + corner(to, 1, w);
            let bend = (0..2).flat_map(|v| [0.25, 0.5, 0.75].map(|part| (v, part))).map(|(v, part)| {
                let chord = corner(from, v, w).lerp(corner(to, v, w), part);
                corner(from + part * (to - from), v, w).distance(chord)
            });
            0.25 * twist.length() + bend.fold(0.0, f64::max) <= tolerance
        })
    }

    /// Lines across the band, at which a relief is bent: ascending, from below its lower side to above its upper one. None without a relief.
    pub fn levels(&self, chord_mm: f64) -> Vec<f64> {
        if !self.has_relief() {
            return Vec::new();
        }
        let [low, high] = self.v_range_mm();
        let cell = self.cell_mm(chord_mm);
        let cells = ((high - low) / cell).ceil().max(1.0);
        (-1..=cells as i64 + 1).map(|i| low + (high - low) * i as f64 / cells).collect()
    }

    /// The lines of a relief along the curve, which is bent both ways.
    fn even_lines(&self, start: f64, chord_mm: f64) -> Vec<f64> {
        let length = self.curve().length_mm();
        let cells = (length / self.cell_mm(chord_mm)).ceil().max(3.0);
        (0..=cells as i64).map(|i| start + length * i as f64 / cells).collect()
    }

    /// How wide the cells of a relief may be so that they are flat enough: the widest that are, or the narrowest that there are.
    fn cell_mm(&self, chord_mm: f64) -> f64 {
        let tolerance = CHORD_SHARE * chord_mm.max(MIN_CHORD_MM);
        let [low, high] = self.v_range_mm();
        let cells = |cell: f64| self.curve().length_mm() * (high - low) / (cell * cell);
        let few = CELLS_MM.into_iter().take_while(|&cell| cell == CELLS_MM[0] || cells(cell) <= MOST_CELLS);
        let all: Vec<f64> = few.collect();
        all.iter().copied().find(|&cell| self.are_flat(cell, tolerance)).unwrap_or(all[all.len() - 1])
    }

    /// Whether facets stay within `chord_mm` of a relief, as they do but for reliefs that are too fine or too large.
    pub fn keeps(&self, chord_mm: f64) -> bool {
        let tolerance = CHORD_SHARE * chord_mm.max(MIN_CHORD_MM);
        !self.has_relief() || self.are_flat(self.cell_mm(chord_mm), tolerance)
    }

    /// Whether cells so wide are flat: two facets of each within `tolerance` of the sheet, whichever way they part the cell.
    fn are_flat(&self, cell: f64, tolerance: f64) -> bool {
        let [low, high] = self.v_range_mm();
        let count = |length: f64| (length / cell).ceil().max(1.0) as usize;
        let (columns, rows) = (count(self.curve().length_mm()), count(high - low));
        (0..columns).all(|i| {
            (0..rows).all(|j| {
                let at = |u: f64, v: f64| {
                    self.place(DVec2::new((i as f64 + u) * cell, low + (j as f64 + v) * cell), 0.0)
                };
                let corners = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)];
                let [a, b, c, d] = corners;
                let warp = 0.25 * (a - b - c + d).length();
                let middles = [
                    (at(0.5, 0.0), a.midpoint(b)),
                    (at(0.0, 0.5), a.midpoint(c)),
                    (at(0.5, 0.5), a.midpoint(d).midpoint(b.midpoint(c))),
                ];
                let bend = middles.iter().map(|(sheet, flat)| sheet.distance(*flat)).fold(0.0, f64::max);
                warp + bend <= tolerance
            })
        })
    }
}
