//! Elements that are alike, and where each of them is (Tu 2020 §4.1.1, §4.4.1).
//!
//! Two elements are of one class when one is the other moved, turned and scaled, but not mirrored. An element is drawn from its class
//! again by the similarity that fits its samples best, so the samples of one class are all that the synthesis needs.

use glam::DVec2;

use super::Element;

/// Points of an outline that are compared.
const COMPARED: usize = 64;
/// Phases of the one outline that are tried against the other, between two points. With fewer, what the phase is off by is taken for a
/// difference of the shapes.
const PHASES: usize = 8;
/// Outlines are alike when they differ by less than this part of their size: the mean square of the distance against that of the radius.
const ALIKE: f64 = 0.02;
/// Turns that fit almost as well as the best one, in parts of [`ALIKE`], are as good: those of a circle, a star.
const AS_GOOD: f64 = 0.25;
/// The samples of an outline: a triangle is the least that shows how it is turned; more than a dozen are not told apart by a neighbourhood.
const OUTLINE_POINTS: std::ops::RangeInclusive<f64> = 3.0..=12.0;

/// A motion with scaling: p goes to `shift` + `turn` · p, the product being that of complex numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// Where the origin goes, in millimetres.
    pub shift: DVec2,
    /// The scale times the cosine, and the scale times the sine of the angle.
    pub turn: DVec2,
}

impl Similarity {
    /// Nothing but a shift.
    pub fn shifted(shift: DVec2) -> Self {
        Self { shift, turn: DVec2::X }
    }

    /// Where `p` goes.
    pub fn apply(&self, p: DVec2) -> DVec2 {
        self.shift + self.turn.rotate(p)
    }

    /// The similarity that takes the points `from` to `to` with the least sum of squared distances. Points that are all one place can
    /// only tell a shift.
    ///
    /// # Panics
    /// When there are not as many points of either.
    pub fn fitted(from: &[DVec2], to: &[DVec2]) -> Self {
        assert_eq!(from.len(), to.len(), "points come in pairs");
        let (a, b) = (mean(from), mean(to));
        let (mut product, mut square) = (DVec2::ZERO, 0.0);
        for (&p, &q) in from.iter().zip(to) {
            product += conjugate(p - a).rotate(q - b);
            square += (p - a).length_squared();
        }
        let turn = if square > 0.0 && product != DVec2::ZERO { product / square } else { DVec2::X };
        Self { shift: b - turn.rotate(a), turn }
    }
}

/// Where an element is, and what it is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// The number of its class.
    pub class: u32,
    /// From the class to the element.
    pub similarity: Similarity,
    /// Whether it was given by the maker, and stays.
    pub is_given: bool,
}

/// Elements that are alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Class {
    /// The contours in millimetres as in an [`Element`], about the centroid of their area.
    pub contours: Vec<Vec<DVec2>>,
    shape: Shape,
}

/// The elements of a pattern by their classes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Elements {
    /// The classes, in the order of their first elements.
    pub classes: Vec<Class>,
    /// For each element its class, and where it is.
    pub placed: Vec<Placed>,
}

impl Elements {
    /// Finds out which elements are alike. The first of a class is its model.
    pub fn of(elements: &[Element]) -> Self {
        let mut found = Self::default();
        for element in elements {
            let class = Class::of(element);
            let known =
                found.classes.iter().zip(0..).find_map(|(known, number)| Some((number, known.onto(&class)?)));
            let (number, onto) =
                known.unwrap_or((found.classes.len() as u32, Similarity::shifted(DVec2::ZERO)));
            found.placed.push(Placed {
                class: number,
                similarity: Similarity { shift: onto.shift + centroid(&element.contours), ..onto },
                is_given: false,
            });
            if number as usize == found.classes.len() {
                found.classes.push(class);
            }
        }
        found
    }
}

impl Class {
    fn of(element: &Element) -> Self {
        let centre = centroid(&element.contours);
        let contours: Vec<Vec<DVec2>> =
            element.contours.iter().map(|contour| contour.iter().map(|&p| p - centre).collect()).collect();
        Self { shape: Shape::of(&contours), contours }
    }

    /// The samples of an element of this class, about its centroid, in millimetres: at the coarsest level, number 0, the centre only; at
    /// the finest, points of its largest outline by the spacing, from 3 to 12 of them; at those between, half as many, halfway to the
    /// centre (Tu 2020 §4.1.1). A single level is a coarsest one.
    pub fn points(&self, level: usize, levels: usize, spacing_mm: f64) -> Vec<DVec2> {
        if level == 0 {
            return vec![DVec2::ZERO];
        }
        let outline = &self.contours[self.shape.largest];
        let wanted = (perimeter(outline) / spacing_mm).round();
        let count = wanted.clamp(*OUTLINE_POINTS.start(), *OUTLINE_POINTS.end()) as usize;
        let points = resampled(outline, count);
        match level + 1 == levels {
            true => points,
            false => points.into_iter().step_by(2).map(|p| p / 2.0).collect(),
        }
    }

    /// The contours of an element of this class.
    pub fn drawn(&self, similarity: &Similarity) -> Vec<Vec<DVec2>> {
        self.contours.iter().map(|contour| contour.iter().map(|&p| similarity.apply(p)).collect()).collect()
    }

    /// The similarity that makes this class the other one, if there is one.
    fn onto(&self, other: &Self) -> Option<Similarity> {
        let (mine, others) = (&self.shape, &other.shape);
        if mine.contours.len() != others.contours.len() {
            return None;
        }
        // Of several equal contours any may be the one that answers to the largest.
        let nearly_largest =
            others.contours.iter().filter(|c| c.area > (1.0 - ALIKE) * others.contours[others.largest].area);
        let answers = |similarity: &Similarity| {
            let slack = ALIKE * similarity.turn.length() * mine.contours[mine.largest].radius;
            mine.contours.iter().all(|c| {
                others.contours.iter().any(|o| {
                    let area = c.area * similarity.turn.length_squared();
                    similarity.apply(c.centre).distance(o.centre) < 2.0 * slack
                        && (area - o.area).abs() < 2.0 * ALIKE * area.abs()
                })
            })
        };
        nearly_largest.flat_map(|contour| mine.turns(contour)).find(answers)
    }
}

/// What is compared of contours.
#[derive(Debug, Clone, PartialEq)]
struct Shape {
    contours: Vec<Outline>,
    /// The contour with the largest area.
    largest: usize,
}

/// What is compared of a contour.
#[derive(Debug, Clone, PartialEq)]
struct Outline {
    /// [`COMPARED`] times [`PHASES`] points at equal distances along it, about their mean.
    points: Vec<DVec2>,
    /// The mean.
    centre: DVec2,
    /// The root of the mean square of their distances to the centre.
    radius: f64,
    /// Signed.
    area: f64,
}

impl Shape {
    fn of(contours: &[Vec<DVec2>]) -> Self {
        let contours: Vec<Outline> = contours.iter().map(|contour| Outline::of(contour)).collect();
        let largest = (1..contours.len())
            .fold(0, |best, i| if contours[i].area > contours[best].area { i } else { best });
        Self { contours, largest }
    }

    /// The similarities that take the largest contour to `other`, those that turn least first.
    fn turns(&self, other: &Outline) -> Vec<Similarity> {
        let mine = &self.contours[self.largest];
        if mine.radius == 0.0 || other.radius == 0.0 {
            return Vec::new();
        }
        let count = mine.points.len();
        let fit = |phase: usize| {
            let (mut product, mut squares) = (DVec2::ZERO, [0.0; 2]);
            for i in (0..count).step_by(PHASES) {
                let (p, q) = (mine.points[i], other.points[(i + phase) % count]);
                product += conjugate(p).rotate(q);
                squares[0] += p.length_squared();
                squares[1] += q.length_squared();
            }
            // What is left of the mean square distance, in parts of the other's size.
            (1.0 - product.length_squared() / (squares[0] * squares[1]), product / squares[0])
        };
        let fits: Vec<(f64, DVec2)> = (0..count).map(fit).collect();
        let least = fits.iter().map(|fit| fit.0).fold(f64::INFINITY, f64::min);
        let bound = (ALIKE * ALIKE).min(least.max(0.0) + (AS_GOOD * ALIKE).powi(2));
        // Of the phases next to each other only the best is worth anything.
        let is_best = |i: usize| fits[i].0 <= fits[(i + 1) % count].0.min(fits[(i + count - 1) % count].0);
        let mut found: Vec<(f64, DVec2)> =
            (0..count).filter(|&i| fits[i].0 < bound && is_best(i)).map(|i| fits[i]).collect();
        found.sort_by(|a, b| a.1.to_angle().abs().total_cmp(&b.1.to_angle().abs()));
        found
            .iter()
            .map(|&(_, turn)| Similarity { shift: other.centre - turn.rotate(mine.centre), turn })
            .collect()
    }
}

impl Outline {
    fn of(contour: &[DVec2]) -> Self {
        let mut points = resampled(contour, COMPARED * PHASES);
        let centre = mean(&points);
        points.iter_mut().for_each(|p| *p -= centre);
        let square = points.iter().map(|p| p.length_squared()).sum::<f64>() / points.len() as f64;
        Self { points, centre, radius: square.sqrt(), area: area(contour) }
    }
}

fn conjugate(p: DVec2) -> DVec2 {
    DVec2::new(p.x, -p.y)
}

fn mean(points: &[DVec2]) -> DVec2 {
    points.iter().sum::<DVec2>() / points.len().max(1) as f64
}

/// The sides of a closed polygon.
fn sides(contour: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    contour.iter().zip(contour.iter().cycle().skip(1)).map(|(&a, &b)| (a, b))
}

fn perimeter(contour: &[DVec2]) -> f64 {
    sides(contour).map(|(a, b)| a.distance(b)).sum()
}

/// The signed area of a closed polygon.
fn area(contour: &[DVec2]) -> f64 {
    0.5 * sides(contour).map(|(a, b)| a.perp_dot(b)).sum::<f64>()
}

/// The centroid of the area within the contours; the mean of their points where there is none.
fn centroid(contours: &[Vec<DVec2>]) -> DVec2 {
    let points: Vec<DVec2> = contours.iter().flatten().copied().collect();
    let near = mean(&points);
    let (mut moment, mut doubled) = (DVec2::ZERO, 0.0);
    for (a, b) in contours.iter().flat_map(|contour| sides(contour)) {
        let (a, b) = (a - near, b - near);
        moment += a.perp_dot(b) * (a + b) / 3.0;
        doubled += a.perp_dot(b);
    }
    if doubled == 0.0 { near } else { near + moment / doubled }
}

/// `count` points at equal distances along a closed polygon, from its first point on.
fn resampled(contour: &[DVec2], count: usize) -> Vec<DVec2> {
    let step = perimeter(contour) / count as f64;
    let mut points = Vec::with_capacity(count);
    let mut walked = 0.0;
    for (a, b) in sides(contour) {
        let length = a.distance(b);
        while points.len() < count && points.len() as f64 * step < walked + length {
            points.push(a.lerp(b, (points.len() as f64 * step - walked) / length));
        }
        walked += length;
    }
    // Where rounding has lost the last one, or the polygon is a point.
    points.resize(count, contour[contour.len() - 1]);
    points
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;

    /// A leaf with a bent tip, which has no symmetry.
    fn leaf() -> Element {
        let outline = (0..40).map(|i| {
            let angle = TAU * f64::from(i) / 40.0;
            DVec2::from_angle(angle) * (3.0 + 1.5 * angle.cos() + 0.6 * (2.0 * angle).sin())
        });
        let hole =
            (0..12).map(|i| DVec2::new(1.0, 0.5) + 0.4 * DVec2::from_angle(-TAU * f64::from(i) / 12.0));
        Element { contours: vec![outline.collect(), hole.collect()] }
    }

    fn moved(element: &Element, similarity: Similarity) -> Element {
        let moved = |contour: &Vec<DVec2>| contour.iter().map(|&p| similarity.apply(p)).collect();
        Element { contours: element.contours.iter().map(moved).collect() }
    }

    fn regular(corners: u32, phase: f64) -> Element {
        let corner = |i| DVec2::from_angle(phase + TAU * f64::from(i) / f64::from(corners));
        Element { contours: vec![(0..corners).map(corner).collect()] }
    }

    #[test]
    fn mirrored_and_different_elements_are_of_other_classes() {
        let mut mirrored = leaf();
        for contour in &mut mirrored.contours {
            contour.iter_mut().for_each(|p| p.y = -p.y);
            contour.reverse();
        }
        let mut without_hole = leaf();
        without_hole.contours.pop();
        let elements = [
            leaf(),
            mirrored,
            without_hole,
            regular(3, 0.0),
            regular(5, 0.0),
            regular(64, 0.0),
            regular(3, 1.0),
        ];
        let classes: Vec<u32> = Elements::of(&elements).placed.iter().map(|p| p.class).collect();
        assert_eq!(classes, [0, 1, 2, 3, 4, 5, 3]);
    }

    #[test]
    fn what_looks_the_same_however_turned_is_not_turned() {
        let found = Elements::of(&[
            regular(64, 0.0),
            regular(64, 1.234),
            regular(4, 0.0),
            regular(4, 0.2 + TAU / 4.0),
        ]);
        assert_eq!(found.placed[1].class, 0);
        assert!(found.placed[1].similarity.turn.to_angle().abs() < 0.01);
        assert_eq!(found.placed[3].class, 1);
        assert!((found.placed[3].similarity.turn.to_angle() - 0.2).abs() < 0.02);
    }

    #[test]
    fn levels_have_a_centre_half_and_all_of_the_outline() {
        let class = Class::of(&leaf());
        assert_eq!(class.points(0, 3, 2.0), [DVec2::ZERO]);
        let finest = class.points(2, 3, 2.0);
        assert!((3..=12).contains(&finest.len()));
        let middle = class.points(1, 3, 2.0);
        assert_eq!(middle.len(), finest.len().div_ceil(2));
        assert_eq!(middle[1], finest[2] / 2.0);
        assert_eq!(class.points(1, 2, 1e9).len(), 3);
        assert_eq!(class.points(1, 2, 1e-9).len(), 12);
        assert_eq!(class.points(0, 1, 2.0), [DVec2::ZERO]);
    }

    proptest! {
        #[test]
        fn elements_are_drawn_again_from_their_class(
            shift in (-90.0f64..90.0, -90.0f64..90.0),
            angle in 0.0f64..TAU,
            scale in 0.3f64..3.0,
            start in 0usize..40,
        ) {
            let similarity = Similarity { shift: DVec2::new(shift.0, shift.1), turn: DVec2::from_angle(angle) * scale };
            let mut other = moved(&leaf(), similarity);
            other.contours[0].rotate_left(start);
            let found = Elements::of(&[leaf(), other.clone()]);
            prop_assert_eq!(found.classes.len(), 1);
            let drawn = found.classes[0].drawn(&found.placed[1].similarity);
            for (i, &p) in other.contours[0].iter().enumerate() {
                let q = drawn[0][(i + start) % 40];
                prop_assert!(p.distance(q) < 0.01 * scale * 3.0, "{} is off {}", q, p);
            }
        }

        #[test]
        fn fitting_finds_the_similarity(
            points in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0), 2..9),
            shift in (-90.0f64..90.0, -90.0f64..90.0),
            angle in 0.0f64..TAU,
            scale in 0.3f64..3.0,
        ) {
            let from: Vec<DVec2> = points.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
            prop_assume!(from.iter().any(|p| p.distance(from[0]) > 0.1));
            let similarity = Similarity { shift: DVec2::new(shift.0, shift.1), turn: DVec2::from_angle(angle) * scale };
            let to: Vec<DVec2> = from.iter().map(|&p| similarity.apply(p)).collect();
            let found = Similarity::fitted(&from, &to);
            prop_assert!(found.turn.distance(similarity.turn) < 1e-9 && found.shift.distance(similarity.shift) < 1e-8);
        }
    }
}
