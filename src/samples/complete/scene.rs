//! The pattern with its ink, and what of it is one component.

use glam::DVec2;

use super::lines::{Lines, Owner};
use super::places::Places;
use super::work::{Foot, Work};
use crate::planar::{GridError, Region};
use crate::samples::cubic::point_at;
use crate::samples::{Drawing, Kind, Reconstruction};

/// Edges as far as so many samples from the foot of a link are of the ink that it hangs on to: they are near it because the link is.
const OWN_HOPS: usize = 2;

/// A pattern that is drawn, inked and looked up by place.
pub(super) struct Scene<'a> {
    pub work: Work<'a>,
    pub drawn: Reconstruction,
    /// In the plane where the counts hold.
    pub region: Region,
    pub lines: Lines,
    pub places: Places,
    pub by_sample: Vec<Vec<usize>>,
    /// A length that is usual between two samples: the middle one of all edges.
    pub spacing_mm: f64,
    /// The part of the region that an edge, a contour, a stroke of the frame is in.
    edge_parts: Vec<Option<usize>>,
    contour_parts: Vec<Option<usize>>,
    frame_parts: Vec<Option<usize>>,
}

impl<'a> Scene<'a> {
    pub fn new(work: Work<'a>) -> Result<Self, GridError> {
        let drawn = work.drawn();
        let region = work.inked(&drawn.drawing)?;
        Ok(Self::with_ink(work, drawn, region))
    }

    /// The same where it is inked already.
    pub fn with_ink(work: Work<'a>, drawn: Reconstruction, region: Region) -> Self {
        let places = Places::new(&region);
        let part = |p| places.part(work.plane.place(p));
        let edge_part =
            |edge| if work.is_there[edge] { part(point_at(&work.cubic(edge), 0.5)) } else { None };
        let edge_parts = (0..work.edges.len()).map(edge_part).collect();
        let contours = work.elements.iter().flat_map(|element| &element.contours);
        let contour_parts =
            contours.map(|contour| part(contour[0].midpoint(contour[1 % contour.len()]))).collect();
        let frame_parts = work.frame.iter().map(|curve| {
            let first = curve.path.segments().next()?;
            let p = kurbo::ParamCurve::eval(&first, 0.5);
            part(DVec2::new(p.x, p.y))
        });
        let frame_parts = frame_parts.collect();
        let (lines, by_sample) = (Lines::new(&work), work.edges_by_sample());
        let mut lengths: Vec<f64> = work.present().map(|edge| work.length_mm(edge)).collect();
        lengths.sort_by(f64::total_cmp);
        let spacing_mm = lengths.get(lengths.len() / 2).copied().unwrap_or(4.0 * work.pen_mm);
        Self {
            work,
            drawn,
            region,
            lines,
            places,
            by_sample,
            spacing_mm,
            edge_parts,
            contour_parts,
            frame_parts,
        }
    }

    /// The part of the region that ink is in; `None` for what was only just added.
    pub fn part(&self, owner: Owner) -> Option<usize> {
        match owner {
            Owner::Edge(edge) => self.edge_parts.get(edge).copied().flatten(),
            Owner::Contour(contour) => self.contour_parts[contour],
            Owner::Frame(stroke) => self.frame_parts[stroke],
        }
    }

    /// The part that a sample of a curve is in, if it has an edge.
    pub fn part_of_sample(&self, sample: usize) -> Option<usize> {
        self.by_sample[sample].first().and_then(|&edge| self.edge_parts[edge])
    }

    /// The ink that a stroke with this foot may touch there.
    pub fn own(&self, foot: Foot, owner: Option<Owner>) -> Vec<Owner> {
        self.own_within(foot, owner, OWN_HOPS)
    }

    /// The ink that hangs on to a foot by so many samples, in the order of its owners.
    pub fn own_within(&self, foot: Foot, owner: Option<Owner>, hops: usize) -> Vec<Owner> {
        let samples = match foot {
            Foot::Sample(sample) => vec![sample],
            Foot::Edge(edge, _) => self.work.edges[edge].ends.to_vec(),
            Foot::Ink(_) => Vec::new(),
        };
        self.around(samples, hops).into_iter().map(Owner::Edge).chain(owner).collect()
    }

    /// The edges that lead away from samples and on, so many one after the other, in ascending order.
    fn around(&self, mut samples: Vec<usize>, hops: usize) -> Vec<usize> {
        let mut edges = Vec::new();
        for _ in 0..hops {
            let around: Vec<usize> =
                samples.iter().flat_map(|&sample| &self.by_sample[sample]).copied().collect();
            samples = around.iter().flat_map(|&edge| self.work.edges[edge].ends).collect();
            samples.sort_unstable();
            samples.dedup();
            edges.extend(around);
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// For each contour of an element, the edges that hang on to it by so many samples.
    pub fn around_contours(&self, hops: usize) -> Vec<Vec<usize>> {
        let contours = self.work.elements.iter().flat_map(|element| &element.contours);
        let ends = |owner| match owner {
            Owner::Edge(edge) => self.work.edges.get(edge).map_or(Vec::new(), |edge| edge.ends.to_vec()),
            _ => Vec::new(),
        };
        contours
            .map(|contour| {
                let sides = contour.iter().zip(contour.iter().cycle().skip(1));
                // Nearer to one another than a pen is wide, so that none passes between them.
                let places = sides.flat_map(|(&a, &b)| {
                    let parts = (2.0 * a.distance(b) / self.work.pen_mm).ceil().clamp(1.0, 1e3) as u32;
                    (0..parts).map(move |i| a.lerp(b, f64::from(i) / f64::from(parts)))
                });
                let touching = places.flat_map(|p| self.lines.near(p, 0.0)).map(|(_, line)| line.owner);
                let mut samples: Vec<usize> = touching.flat_map(ends).collect();
                samples.sort_unstable();
                samples.dedup();
                self.around(samples, hops)
            })
            .collect()
    }

    /// The edge of a path that ends at a sample in the open: neither another edge nor other ink is there, nor what was given.
    pub fn free_end(&self, sample: usize) -> Option<usize> {
        let [edge] = self.by_sample[sample][..] else { return None };
        let is_held = self.work.samples[sample].is_given || !self.ink_at(sample).is_empty();
        (!is_held).then_some(edge)
    }

    /// Whose ink the pen touches at a sample, of what is not of its own path.
    pub fn ink_at(&self, sample: usize) -> Vec<Owner> {
        let Some(&edge) = self.by_sample[sample].first() else { return Vec::new() };
        let own = self.own(Foot::Sample(sample), None);
        let near = self.lines.near(self.work.samples[sample].at, self.work.width_mm(edge) / 2.0);
        near.into_iter().map(|(_, line)| line.owner).filter(|owner| !own.contains(owner)).collect()
    }

    /// The ends of paths that end in the open, with their edges.
    pub fn free_ends(&self) -> Vec<(usize, usize)> {
        let curves = (0..self.work.samples.len()).filter(|&i| self.work.samples[i].kind == Kind::Curve);
        curves.filter_map(|sample| Some((sample, self.free_end(sample)?))).collect()
    }

    /// How many holes the frame alone makes; there are no fewer in a pattern that has it.
    pub fn frame_loops(&self) -> Result<usize, GridError> {
        let frame = Drawing { curves: self.work.frame.clone(), elements: Vec::new() };
        Ok(self.work.inked(&frame)?.holes())
    }

    /// What a new stroke keeps from ink that it does not touch.
    pub fn margin_mm(&self) -> f64 {
        // Both outlines may be two chords outside of their pens.
        self.work.completing.min_gap_mm + 4.0 * self.work.completing.chord_mm
    }
}
