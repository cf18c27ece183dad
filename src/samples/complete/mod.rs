//! The promise: the ink has the components and the holes that were asked for.
//!
//! A synthesized pattern has as many as chance would have it. It is completed the way a maker would: ends that almost meet are joined
//! and stray twigs taken away; then, until the exact region has the counts, components are joined along the edges that were most nearly
//! there, else along the shortest stroke that goes on from an end; holes are opened where the edge between them is least sure, and
//! closed and parted likewise.
//!
//! What a change will do to the counts is only a plan. Each batch of changes is drawn and counted on its region, and kept if it brought
//! the counts nearer; a batch that did not is tried in halves, down to the single change that is no use and is not tried again. So the
//! distance to the goal falls with each round, and the work ends.

mod beside;
#[cfg(test)]
mod cases;
mod cuts;
mod frame;
mod lines;
mod links;
mod places;
mod roads;
mod scene;
mod slits;
mod step;
#[cfg(test)]
mod tests;
mod tidy;
mod work;

use glam::DVec2;
use thiserror::Error;

use super::{Area, Drawing, Element, Graph, Options, inked};
use crate::planar::{GridError, Region};
use crate::topology::Goal;
use links::Planner;
use scene::Scene;
use step::Step;
use work::Work;

/// Regions that are inked while changes are tried, at the most: a refusal takes seconds too.
const MOST_TRIALS: usize = 120;
/// How often what is too small to be a hole is looked for and filled.
const FILLINGS: usize = 3;
/// A batch is kept when it does at least this part of what it should; the rest is planned anew.
const GOOD_BATCH: f64 = 0.6;

/// How a pattern is completed. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct CompleteOptions {
    /// The greatest distance between the region and the true outline of the strokes.
    pub chord_mm: f64,
    /// What new strokes keep from other ink, and the least gap of a cut; smaller holes are filled. 0 asks for nothing.
    pub min_gap_mm: f64,
    /// The width of all strokes, if it is not that of the exemplar.
    pub stroke_mm: Option<f64>,
    /// The width of a stroke along the border of the area.
    pub frame_mm: Option<f64>,
    /// Whether ends that almost meet are joined in any case.
    pub joins_ends: bool,
    /// Whether twigs that are hardly longer than the pen is wide are taken away in any case.
    pub removes_twigs: bool,
    /// Whether a small component may be taken away where that is less than joining it.
    pub leaves_out_small: bool,
    /// Ends are joined along edges of at least this confidence: 0.3.
    pub least_confidence: f64,
    /// Components are joined, and holes closed, along edges of at least this confidence first: 0.1. With less, a short link is as likely.
    pub least_vote: f64,
    /// Ends nearer than this that point at each other are joined; `None` for twice the spacing.
    pub reach_mm: Option<f64>,
    /// How many ends there should be in the open and farther than a pen from the border, as in the exemplar: no more are joined or trimmed when
    /// there are no more than that.
    pub ends_wanted: Option<usize>,
}

impl Default for CompleteOptions {
    fn default() -> Self {
        Self {
            chord_mm: 0.01,
            min_gap_mm: 0.0,
            stroke_mm: None,
            frame_mm: None,
            joins_ends: true,
            removes_twigs: true,
            leaves_out_small: true,
            least_confidence: 0.3,
            least_vote: 0.1,
            reach_mm: None,
            ends_wanted: None,
        }
    }
}

/// What a change is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ChangeKind {
    /// A stroke along an edge that was voted for, or between ends that almost met.
    Join,
    /// A stroke between two components, where the way is shortest.
    Link,
    /// A stroke that closes a hole.
    Enclose,
    /// A dab on a hole that is too small to be one, or on a slit along the frame.
    Fill,
    /// Edges taken away to open a hole.
    Open,
    /// Edges taken away to make two components of one.
    Part,
    /// A twig taken away, or what of a stroke runs along the frame.
    Trim,
    /// A small component taken away.
    LeaveOut,
}

/// One change of the pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// What it is for.
    pub kind: ChangeKind,
    /// Where the stroke begins that was added or taken away, in millimetres.
    pub from_mm: DVec2,
    /// Where it ends.
    pub to_mm: DVec2,
    /// The vote for the edge that was added, the least of those that were taken away; `None` where none was voted for.
    pub confidence: Option<f64>,
}

/// A pattern that was completed.
#[derive(Debug, Clone, PartialEq)]
pub struct Completed {
    /// Its graph, with the changes; handles are as drawn.
    pub graph: Graph,
    /// Its strokes and elements, and the frame.
    pub drawing: Drawing,
    /// What they cover; of a rolled area as it is drawn, open.
    pub region: Region,
    /// Components, counted on the region; of a rolled area as it stands.
    pub components: usize,
    /// Holes, counted likewise.
    pub holes: usize,
    /// Components and holes of the pattern by itself: tidied, and before anything was done for the goal.
    pub own: [usize; 2],
    /// What was changed, in this order.
    pub changes: Vec<Change>,
}

/// Why a pattern cannot be completed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CompleteError {
    /// A coordinate is no number or too large.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// There is nothing that could be joined or opened.
    #[error(
        "nothing is drawn: the graph has no edges and there are no elements; use a larger area or more samples"
    )]
    Empty,
    /// The counts cannot be had.
    #[error("{} component(s) and {} hole(s) were reached by {} change(s), wanted were {wanted}; {remedy}", nearest.components, nearest.holes, nearest.changes.len())]
    NotMet {
        /// What was wanted, in words.
        wanted: String,
        /// The reason, where one is known, and what would work.
        remedy: String,
        /// The pattern that came nearest.
        nearest: Box<Completed>,
    },
}

/// Completes the pattern of `graph` and `elements` so that its ink has the components and holes of `goal`. What `goal` leaves free is as
/// it comes; ends and twigs are tidied in any case, as `completing` says.
///
/// The same arguments give the same result.
///
/// # Errors
/// [`CompleteError`] when nothing is drawn, and when no change that is left brings the counts nearer; it has the pattern reached.
pub fn complete(
    graph: &Graph,
    elements: &[Element],
    area: &Area,
    options: &Options,
    goal: &Goal,
    completing: &CompleteOptions,
) -> Result<Completed, CompleteError> {
    let scene = Scene::new(Work::new(graph, elements, area, options, completing))?;
    if scene.region.is_empty() {
        return Err(CompleteError::Empty);
    }
    let mut run =
        Completion { goal, own: [0; 2], changes: Vec::new(), banned: Vec::new(), trials: 0, nearest: None };
    let scene = run.tidied(scene)?;
    run.own = [scene.region.components(), scene.region.holes()];
    run.met(scene)
}

/// The work on one pattern.
struct Completion<'a> {
    goal: &'a Goal,
    own: [usize; 2],
    changes: Vec<Change>,
    /// Changes that brought nothing.
    banned: Vec<Change>,
    trials: usize,
    /// The pattern and its changes before a hole was opened that had to be made up for.
    nearest: Option<(Work<'a>, Vec<Change>)>,
}

impl<'a> Completion<'a> {
    fn tidied(&mut self, scene: Scene<'a>) -> Result<Scene<'a>, CompleteError> {
        let (work, steps) = beside::parted(&scene);
        let scene = if steps.is_empty() { scene } else { self.carried_out(work, &steps)? };
        let steps = tidy::tidied(&scene);
        let scene = if steps.is_empty() { scene } else { self.carried_out(scene.work, &steps)? };
        let mut scene = scene;
        // What a dab leaves of a wider hole is one more that is too small.
        for _ in 0..FILLINGS {
            let steps = slits::filled(&scene);
            if steps.is_empty() {
                break;
            }
            scene = self.carried_out(scene.work, &steps)?;
        }
        Ok(scene)
    }

    /// The pattern with these steps, whatever they do to its counts.
    fn carried_out(&mut self, mut work: Work<'a>, steps: &[Step]) -> Result<Scene<'a>, CompleteError> {
        self.changes.extend(steps.iter().filter(|step| step.carry_out(&mut work)).map(|step| step.change));
        Ok(Scene::new(work)?)
    }

    /// Rounds of changes until the goal is met, or nothing helps any more.
    fn met(mut self, mut scene: Scene<'a>) -> Result<Completed, CompleteError> {
        let mut is_bold = false;
        loop {
            let distance = self.distance(&scene.region);
            if distance == 0 {
                return self.completed(scene);
            }
            let steps = self.planned(&scene, is_bold);
            let (next, has_helped) = self.tried(scene, &steps)?;
            scene = next;
            // What was tried in vain is banned, and there may be more.
            if !has_helped && (is_bold && steps.is_empty() || self.trials >= MOST_TRIALS) {
                scene = match self.opened_to_part(scene)? {
                    (scene, true) => scene,
                    (scene, false) => return Err(self.refusal(scene)?),
                };
            }
            is_bold = !has_helped;
        }
    }

    /// How many components and holes there are too many or too few.
    fn distance(&self, region: &Region) -> u32 {
        let off = |wanted: Option<crate::topology::Wanted>, found: usize| {
            wanted.map_or(0, |wanted| wanted.distance(u32::try_from(found).unwrap_or(u32::MAX)))
        };
        off(self.goal.components, region.components()).saturating_add(off(self.goal.holes, region.holes()))
    }

    /// The face inside of the ink that goes round a rolled area, if that has to stay closed.
    fn kept_inside(&self, scene: &Scene) -> Option<usize> {
        let middle = scene.work.plane.middle().filter(|_| self.goal.closed_pattern)?;
        scene.places.face(middle)
    }

    /// The changes of one kind that should bring a count to what is wanted, components first.
    fn planned(&self, scene: &Scene, is_bold: bool) -> Vec<Step> {
        let planner = Planner {
            scene,
            is_bold,
            inside: self.kept_inside(scene),
            is_banned: &|step| self.banned.contains(&step.change),
        };
        let (components, holes) = (scene.region.components(), scene.region.holes());
        let [too_many, too_few] = off(self.goal.components, components);
        let [holes_too_many, holes_too_few] = off(self.goal.holes, holes);
        let can_be_joined = too_many.min(components - scene.islands().min(components));
        if can_be_joined > 0 {
            let steps = planner.joins(can_be_joined);
            if !steps.is_empty() {
                return steps;
            }
        }
        if holes_too_many > 0 {
            let mut steps = planner.openings(holes_too_many);
            if steps.is_empty() {
                // No ink can go, and these are too small to be missed.
                steps = slits::closable(scene, holes_too_many, planner.is_banned);
            }
            if !steps.is_empty() {
                return steps;
            }
        }
        // A hole that is missing may be one that was opened to part what is around it.
        match too_few > 0 {
            true => planner.partings(too_few),
            false => planner.closings(holes_too_few),
        }
    }

    /// The scene with those of the steps that bring the counts nearer, and whether there were any.
    fn tried(&mut self, mut scene: Scene<'a>, steps: &[Step]) -> Result<(Scene<'a>, bool), CompleteError> {
        if steps.is_empty() || self.trials >= MOST_TRIALS {
            return Ok((scene, false));
        }
        self.trials += 1;
        let mut work = scene.work.clone();
        let done: Vec<Change> =
            steps.iter().filter(|step| step.carry_out(&mut work)).map(|step| step.change).collect();
        let drawn = work.drawn();
        let region = work.inked(&drawn.drawing)?;
        let (before, after) = (self.distance(&scene.region), self.distance(&region));
        let wanted = (GOOD_BATCH * steps.len() as f64).ceil();
        if !region.is_empty() && f64::from(before) - f64::from(after) >= wanted {
            self.changes.extend(done);
            return Ok((Scene::with_ink(work, drawn, region), true));
        }
        if let [step] = steps {
            self.banned.push(step.change);
            return Ok((scene, false));
        }
        // The second half was planned for the pattern as it was, and edges keep their numbers.
        let (first, second) = steps.split_at(steps.len() / 2);
        let mut has_helped = false;
        for half in [first, second] {
            let (next, helps) = self.tried(scene, half)?;
            scene = next;
            has_helped |= helps;
        }
        Ok((scene, has_helped))
    }

    /// Where components are missing and every strand is part of a ring, a ring is opened, though that alone is no use; then a cut parts
    /// what is left of it, and the hole is made up for elsewhere.
    fn opened_to_part(&mut self, scene: Scene<'a>) -> Result<(Scene<'a>, bool), CompleteError> {
        let [_, too_few] = off(self.goal.components, scene.region.components());
        if too_few == 0 || self.trials >= MOST_TRIALS {
            return Ok((scene, false));
        }
        let planner = Planner {
            scene: &scene,
            is_bold: false,
            inside: self.kept_inside(&scene),
            is_banned: &|step| self.banned.contains(&step.change),
        };
        let Some(step) = planner.opening_to_part() else { return Ok((scene, false)) };
        self.trials += 1;
        let mut work = scene.work.clone();
        if self.nearest.is_none() {
            self.nearest = Some((work.clone(), self.changes.clone()));
        }
        step.carry_out(&mut work);
        self.changes.push(step.change);
        Ok((Scene::new(work)?, true))
    }

    fn completed(self, scene: Scene) -> Result<Completed, CompleteError> {
        let (components, holes) = (scene.region.components(), scene.region.holes());
        let (area, completing) = (scene.work.area, scene.work.completing);
        let region = match area.lap_mm() {
            Some(_) => inked(&scene.drawn.drawing, area.region().grid(), completing.chord_mm)?,
            None => scene.region,
        };
        let graph = scene.work.graph();
        Ok(Completed {
            graph,
            drawing: scene.drawn.drawing,
            region,
            components,
            holes,
            own: self.own,
            changes: self.changes,
        })
    }

    fn refusal(mut self, mut scene: Scene<'a>) -> Result<CompleteError, CompleteError> {
        if let Some((work, changes)) = self.nearest.take() {
            let before = Scene::new(work)?;
            if self.distance(&before.region) < self.distance(&scene.region) {
                (scene, self.changes) = (before, changes);
            }
        }
        let (components, holes) = (scene.region.components(), scene.region.holes());
        let wanted = self.goal_in_words();
        let [too_many, _] = off(self.goal.components, components);
        let [holes_too_many, _] = off(self.goal.holes, holes);
        let (islands, loops) = (scene.islands(), scene.frame_loops()?);
        let remedy = if too_many > 0 && components == islands {
            format!(
                "the area lies in {islands} pieces that have ink, and no stroke within it joins these; ask for {islands} components or more, or draw the pieces so that they hang together where the pen fits"
            )
        } else if holes_too_many > 0 && holes_too_many + loops > holes {
            format!(
                "the frame goes round the area and round each of its holes, and each of its {loops} loops is a hole of the pattern; ask for {loops} holes or more, or leave out the frame"
            )
        } else {
            self.usual_remedy(&scene.region).to_owned()
        };
        Ok(CompleteError::NotMet { wanted, remedy, nearest: Box::new(self.completed(scene)?) })
    }

    /// What helps where nothing is known of the reason.
    fn usual_remedy(&self, region: &Region) -> &'static str {
        let [too_many, too_few] = off(self.goal.components, region.components());
        let [holes_too_many, holes_too_few] = off(self.goal.holes, region.holes());
        if too_many > 0 {
            "what is left cannot be reached within the area past other ink; use a frame, or ask for more components"
        } else if too_few > 0 {
            "nothing is left that a cut would part; ask for fewer components, or use a larger area"
        } else if holes_too_many > 0 {
            "what holes are left are within elements or touched by other ink; ask for more holes, or use thinner strokes"
        } else {
            debug_assert!(holes_too_few > 0);
            "there is no clear way left across a gap; ask for fewer holes, or use thinner strokes"
        }
    }

    fn goal_in_words(&self) -> String {
        let counts = [(self.goal.components, "component(s)"), (self.goal.holes, "hole(s)")];
        let words: Vec<String> =
            counts.into_iter().filter_map(|(wanted, what)| Some(format!("{} {what}", wanted?))).collect();
        words.join(" and ")
    }
}

/// How many there are more than the most, and fewer than the least that is wanted.
fn off(wanted: Option<crate::topology::Wanted>, found: usize) -> [usize; 2] {
    let [least, most] = wanted.map_or([0, usize::MAX], |wanted| wanted.ends().map(|end| end as usize));
    [found.saturating_sub(most), least.saturating_sub(found)]
}
