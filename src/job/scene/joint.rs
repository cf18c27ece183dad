//! Joints: copies of parts that must fuse, and what is said where they do not.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Placed;
use super::workers::each;
use crate::fabricate::{self, Overlap};
use crate::job::error::JobError;

/// What must fuse with what.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// The part of which every copy has to fuse.
    pub first: String,
    /// The part with some copy of which each has to; `None` for the next copy of the same part, and of a repeat that goes round, the
    /// first for the last.
    pub second: Option<String>,
    /// How wide they have to overlap somewhere, in millimetres; 0 for any volume.
    pub width_mm: f64,
}

/// A joint that holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointReport {
    /// The two copies.
    pub between: [String; 2],
    /// The volume that they share, in cubic millimetres.
    pub shared_mm3: f64,
    /// How wide the widest piece of it is: twice its volume over its surface, in millimetres.
    pub width_mm: f64,
    /// The middle of that piece, in millimetres.
    pub position_mm: [f64; 3],
}

/// Looks at every joint.
///
/// # Errors
/// [`JobError::Joint`] names the first copy that does not fuse, with the distance and the place.
pub(super) fn check(joints: &[Joint], copies: &[Placed]) -> Result<Vec<JointReport>, JobError> {
    let wanted: Vec<Meeting<'_>> = joints.iter().flat_map(|joint| meetings(joint, copies)).collect();
    let found = each(&wanted, |meeting, _: &dyn Fn(())| meeting.look(copies), &mut |()| ());
    found.into_iter().collect()
}

/// One copy, and those of which it has to fuse with one.
struct Meeting<'j> {
    joint: &'j Joint,
    first: usize,
    others: Vec<usize>,
}

fn meetings<'j>(joint: &'j Joint, copies: &[Placed]) -> Vec<Meeting<'j>> {
    let of = |part: &str| (0..copies.len()).filter(|&i| copies[i].part == part).collect::<Vec<_>>();
    let own = of(&joint.first);
    let meeting = |first, others| Meeting { joint, first, others };
    match &joint.second {
        Some(second) => {
            let others = |first: usize| of(second).into_iter().filter(|&i| i != first).collect();
            own.into_iter().map(|first| meeting(first, others(first))).collect()
        }
        None => {
            let next = |&first: &usize| Some(meeting(first, vec![copies[first].next?]));
            own.iter().filter_map(next).collect()
        }
    }
}

impl Meeting<'_> {
    fn look(&self, copies: &[Placed]) -> Result<JointReport, JobError> {
        let first = &copies[self.first];
        let mut best: Option<(usize, Overlap)> = None;
        for &i in self.others.iter().filter(|&&i| first.bounds.meets(&copies[i].bounds)) {
            let shared = first.body.overlap(&copies[i].body)?;
            let is_wider = |shared: &Overlap| best.as_ref().is_none_or(|(_, b)| shared.width_mm > b.width_mm);
            best = shared.filter(is_wider).map(|shared| (i, shared)).or(best);
        }
        let wanted_mm = self.joint.width_mm;
        match best {
            Some((i, shared)) if shared.width_mm >= wanted_mm => Ok(JointReport {
                between: [first.name.clone(), copies[i].name.clone()],
                shared_mm3: shared.volume_mm3,
                width_mm: shared.width_mm,
                position_mm: shared.position_mm.to_array(),
            }),
            Some((i, shared)) => {
                let [x, y, z] = shared.position_mm.to_array();
                Err(JobError::Joint {
                    first: first.name.clone(),
                    second: copies[i].name.clone(),
                    found: format!(
                        "what they share is {:.3} mm wide at ({x:.2}, {y:.2}, {z:.2}) mm, and {wanted_mm} mm are wanted",
                        shared.width_mm
                    ),
                    remedy: "move them further into each other, or give the joint a smaller width".to_owned(),
                })
            }
            None => Err(self.apart(copies)),
        }
    }

    /// How far the copy is from the nearest of the others.
    fn apart(&self, copies: &[Placed]) -> JobError {
        let first = &copies[self.first];
        // Where one cannot be rounded there is no distance to tell.
        let gap = |i: usize| fabricate::gap(&first.body.solid().ok()?, &copies[i].body.solid().ok()?);
        let gaps = self.others.iter().filter_map(|&i| Some((i, gap(i)?)));
        let nearest = gaps.min_by(|a, b| a.1.distance_mm.total_cmp(&b.1.distance_mm));
        let part = self.joint.second.as_ref().unwrap_or(&self.joint.first);
        let (second, found) = match nearest {
            Some((i, gap)) => {
                let [x, y, z] = ((gap.from_mm + gap.to_mm) / 2.0).to_array();
                let place = format!("({x:.2}, {y:.2}, {z:.2}) mm");
                let found = match gap.distance_mm < TOUCHING_MM {
                    true => format!("they only touch, near {place}"),
                    false => format!("they are {:.3} mm apart, nearest at {place}", gap.distance_mm),
                };
                (copies[i].name.clone(), found)
            }
            None => (part.clone(), "there is no other copy".to_owned()),
        };
        let remedy = "move one of them so that they overlap".to_owned();
        JobError::Joint { first: first.name.clone(), second, found, remedy }
    }
}

/// Solids without a common volume that are nearer than this are said to touch, in millimetres.
const TOUCHING_MM: f64 = 1e-3;
