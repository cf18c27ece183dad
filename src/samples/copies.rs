//! Places of the exemplar that the maker copies to places of the output: the clone mode of Tu 2020 §3.
//!
//! The paper copies samples, which then move like all others. Here what is copied stays as it is: curves are cut at the box and at the border of the
//! area, and the pattern goes on from there as from a maker's own strokes; elements whose middle is in the box come whole.

use glam::DVec2;
use kurbo::{BezPath, PathEl, PathSeg, Shape as _};

use super::area::Area;
use super::border::stretches;
use super::cubic::{Cubic, part};
use super::drawing::{Curve, Drawing};
use super::elements::{Elements, Placed, Similarity};
use super::level::SampleError;
use super::reconstruct::point;
use crate::planar::{FillRule, Grid, Region};

/// Lengths are measured within this part of the pen.
const MEASURED_PENS: f64 = 0.1;

/// A box of the exemplar and where it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloneBox {
    /// The middle of the box in the exemplar, in millimetres.
    pub from_mm: DVec2,
    /// Half of its width and height.
    pub half_mm: DVec2,
    /// The place of its middle in the output.
    pub to_mm: DVec2,
}

impl CloneBox {
    /// Whether a place of the output is inside of the copy.
    pub(super) fn covers(&self, p: DVec2, area: &Area) -> bool {
        area.way(self.to_mm, p).abs().cmplt(self.half_mm).all()
    }

    /// The box as an area of the exemplar.
    fn area(&self) -> Result<Area, SampleError> {
        let [low, high] = [self.from_mm - self.half_mm, self.from_mm + self.half_mm];
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let region = Grid::for_extent(low.abs().max(high.abs()).max_element()).and_then(|grid| {
            let path = corners.iter().map(|&p| grid.snap(p)).collect::<Result<Vec<_>, _>>()?;
            Ok(Region::fill(grid, &[path], FillRule::NonZero))
        });
        let region = region.map_err(|error| refused(error.to_string(), "a box of the exemplar"))?;
        Ok(Area::new(region))
    }
}

pub(super) fn refused(found: String, wanted: &'static str) -> SampleError {
    SampleError::Option { name: "--clone", found, wanted }
}

/// What is copied, where it goes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Copies {
    /// Stretches of curves.
    pub curves: Vec<Curve>,
    /// Whole elements.
    pub placed: Vec<Placed>,
    /// How many elements are left out, as they would reach beyond the area.
    pub lost: usize,
}

impl Copies {
    /// All that is in the boxes. Stretches that are shorter than their pen are left out.
    ///
    /// # Errors
    /// [`SampleError::Option`] for a box in which nothing is drawn.
    pub(super) fn new(
        clones: &[CloneBox],
        exemplar: &Drawing,
        elements: &Elements,
        area: &Area,
    ) -> Result<Self, SampleError> {
        let mut copies = Self::default();
        for clone in clones {
            let source = clone.area()?;
            let shift = clone.to_mm - clone.from_mm;
            let before = copies.count();
            for curve in &exemplar.curves {
                for piece in cut(&curve.path, &source, DVec2::ZERO) {
                    copies.curves.extend(cut(&piece, area, shift).into_iter().filter_map(|path| {
                        let is_line = path.perimeter(MEASURED_PENS * curve.width_mm) >= curve.width_mm;
                        is_line.then_some(Curve { path, width_mm: curve.width_mm })
                    }));
                }
            }
            let inside = elements.placed.iter().filter(|placed| source.contains(placed.similarity.shift));
            for placed in inside {
                let similarity = Similarity { shift: placed.similarity.shift + shift, ..placed.similarity };
                match area.covers_all(&elements.classes[placed.class as usize].drawn(&similarity)) {
                    true => copies.placed.push(Placed { similarity, is_given: true, ..*placed }),
                    false => copies.lost += 1,
                }
            }
            if copies.count() == before {
                let [low, high] = [clone.from_mm - clone.half_mm, clone.from_mm + clone.half_mm];
                let found = format!(
                    "from {:.2}, {:.2} to {:.2}, {:.2} mm, where nothing is drawn",
                    low.x, low.y, high.x, high.y
                );
                return Err(refused(
                    found,
                    "a box of the exemplar with strokes, or with the middles of shapes",
                ));
            }
        }
        Ok(copies)
    }

    fn count(&self) -> usize {
        self.curves.len() + self.placed.len() + self.lost
    }
}

/// The parts of a path, moved by `shift`, that are inside of an area. A closed path that is not cut stays closed.
fn cut(path: &BezPath, area: &Area, shift: DVec2) -> Vec<BezPath> {
    let cubics: Vec<Cubic> = path.segments().map(|segment| cubic(segment, shift)).collect();
    let mut pieces: Vec<Vec<Cubic>> = Vec::new();
    let (mut begins_inside, mut goes_on, mut is_cut) = (false, false, false);
    for (i, cubic) in cubics.iter().enumerate() {
        let inside = stretches(cubic, area);
        is_cut |= inside != [[0.0, 1.0]];
        let starts = inside.first().is_some_and(|stretch| stretch[0] == 0.0);
        begins_inside |= i == 0 && starts;
        for (k, &[from, until]) in inside.iter().enumerate() {
            let stretch = part(cubic, from, until);
            match pieces.last_mut() {
                Some(piece) if k == 0 && starts && goes_on => piece.push(stretch),
                _ => pieces.push(vec![stretch]),
            }
        }
        goes_on = inside.last().is_some_and(|stretch| stretch[1] == 1.0);
    }
    let is_closed = matches!(path.elements().last(), Some(PathEl::ClosePath));
    if is_closed && is_cut && begins_inside && goes_on {
        // The last piece goes on where the path began.
        let mut last = pieces.pop().expect("what goes on is there");
        match pieces.first_mut() {
            Some(first) => {
                last.append(first);
                *first = last;
            }
            None => pieces.push(last),
        }
    }
    let drawn = |piece: &Vec<Cubic>| {
        let mut path = BezPath::new();
        path.move_to(point(piece[0][0]));
        piece.iter().for_each(|[_, p, q, to]| path.curve_to(point(*p), point(*q), point(*to)));
        if is_closed && !is_cut {
            path.close_path();
        }
        path
    };
    pieces.iter().map(drawn).collect()
}

fn cubic(segment: PathSeg, shift: DVec2) -> Cubic {
    let cubic = segment.to_cubic();
    [cubic.p0, cubic.p1, cubic.p2, cubic.p3].map(|p| DVec2::new(p.x, p.y) + shift)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Element;
    use crate::samples::area::tests::square;

    fn copied(paths: &[&str], clone: CloneBox) -> Result<Copies, SampleError> {
        let curve = |d: &&str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
        let corners = [(21.0, 9.0), (25.0, 9.0), (25.0, 13.0), (21.0, 13.0)];
        let leaf = Element { contours: vec![corners.map(|(x, y)| DVec2::new(x, y)).to_vec()] };
        let exemplar = Drawing { curves: paths.iter().map(curve).collect(), elements: vec![leaf] };
        Copies::new(&[clone], &exemplar, &Elements::of(&exemplar.elements), &square(100.0))
    }

    fn bounds(curve: &Curve) -> [f64; 4] {
        let b = curve.path.bounding_box();
        [b.x0, b.y0, b.x1, b.y1].map(|mm| (mm * 1e4).round() / 1e4)
    }

    const CLONE: CloneBox = CloneBox {
        from_mm: DVec2::new(10.0, 10.0),
        half_mm: DVec2::new(10.0, 5.0),
        to_mm: DVec2::new(60.0, 50.0),
    };

    #[test]
    fn curves_are_cut_at_the_box_and_stay_in_one_where_they_are_not() {
        let copies = copied(&["M-9 8H30V12H-9", "M4 10L9 12L14 10Z", "M40 10H60"], CLONE).unwrap();
        let boxes: Vec<[f64; 4]> = copies.curves.iter().map(bounds).collect();
        assert_eq!(boxes, [[50.0, 48.0, 70.0, 48.0], [50.0, 52.0, 70.0, 52.0], [54.0, 50.0, 64.0, 52.0]]);
        let is_closed = |c: &Curve| matches!(c.path.elements().last(), Some(PathEl::ClosePath));
        assert_eq!(copies.curves.iter().map(is_closed).collect::<Vec<_>>(), [false, false, true]);
        assert!(copies.placed.is_empty(), "the middle of the leaf is not in it");
    }

    #[test]
    fn a_ring_that_is_cut_is_open_and_one_piece() {
        // It begins inside of the box and leaves it to the right.
        let copies = copied(&["M15 10H30V14H15Z"], CLONE).unwrap();
        let [curve] = &copies.curves[..] else { panic!("one piece: {copies:?}") };
        assert_eq!(bounds(curve), [65.0, 50.0, 70.0, 54.0]);
        assert!(!matches!(curve.path.elements().last(), Some(PathEl::ClosePath)));
    }

    #[test]
    fn elements_come_whole_and_boxes_hold_something() {
        let wide = CloneBox { half_mm: DVec2::new(14.0, 5.0), ..CLONE };
        let copies = copied(&[], wide).unwrap();
        let [leaf] = &copies.placed[..] else { panic!("{copies:?}") };
        assert!(leaf.is_given && leaf.similarity.shift.distance(DVec2::new(73.0, 51.0)) < 1e-9);
        let beside = copied(&[], CloneBox { to_mm: DVec2::new(86.0, 50.0), ..wide }).unwrap();
        assert_eq!((beside.placed.len(), beside.lost), (0, 1), "it would reach from 97 to 101 mm");
        let message = copied(&["M40 10H60"], CLONE).unwrap_err().to_string();
        assert!(message.contains("from 0.00, 5.00 to 20.00, 15.00 mm, where nothing is drawn"), "{message}");
    }

    #[test]
    fn what_would_lie_outside_of_the_area_is_cut_off() {
        let beside = CloneBox { to_mm: DVec2::new(95.0, 50.0), ..CLONE };
        let copies = copied(&["M-9 8H30"], beside).unwrap();
        assert_eq!(copies.curves.iter().map(bounds).collect::<Vec<_>>(), [[85.0, 48.0, 100.0, 48.0]]);
    }
}
