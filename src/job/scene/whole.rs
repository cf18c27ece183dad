//! Whether the union of a scene is what was declared, and where it is not, which copies hang together.

use std::collections::BTreeMap;
use std::path::PathBuf;

use glam::DVec3;

use super::Placed;
use crate::fabricate::{Shell, Solid};
use crate::job::error::JobError;
use crate::job::output::Output;
use crate::planar::Sets;
use crate::verify::{Between, Mismatch};

/// That the whole has the shells and the genus that were declared.
///
/// # Errors
/// [`JobError::Mismatch`], with what hangs together.
pub(super) fn check(
    [wanted_shells, wanted_genus]: [Option<Between>; 2],
    whole: &Solid,
    copies: &[Placed],
    outputs: &[Output],
) -> Result<(), JobError> {
    let (shells, genus) = (whole.shells().len(), whole.genus());
    let is_missed = |wanted: Option<Between>, found: usize| {
        wanted.filter(|wanted| !(wanted.least..=wanted.most).contains(&found))
    };
    let file = PathBuf::from(outputs.first().map_or("the scene".to_owned(), |o| o.target().to_string()));
    if let Some(wanted) = is_missed(wanted_shells, shells) {
        let remedy = format!("; {}", groups(whole, copies)?);
        return Err(JobError::Mismatch {
            file,
            mismatch: Mismatch::Shells { found: shells, wanted },
            remedy,
        });
    }
    if let Some(wanted) = is_missed(wanted_genus, genus) {
        let mismatch = Mismatch::Genus { found: genus as i64, wanted };
        return Err(JobError::Mismatch { file, mismatch, remedy: String::new() });
    }
    Ok(())
}

/// Which copies hang together, for people.
fn groups(whole: &Solid, copies: &[Placed]) -> Result<String, JobError> {
    let mut sets = Sets::new(copies.len());
    for i in 0..copies.len() {
        for j in 0..i {
            if copies[i].bounds.meets(&copies[j].bounds) && copies[i].body.overlap(&copies[j].body)?.is_some()
            {
                sets.join(i, j);
            }
        }
    }
    let mut groups: BTreeMap<usize, Vec<&str>> = BTreeMap::new();
    for (i, copy) in copies.iter().enumerate() {
        groups.entry(sets.find(i)).or_default().push(&copy.name);
    }
    if let [cavity, ..] = &cavities(whole)[..] {
        return Ok(format!(
            "where parts overlap they enclose {} cavities, the first near ({:.2}, {:.2}, {:.2}) mm: move a part so that it opens or fills them",
            cavities(whole).len(),
            cavity.x,
            cavity.y,
            cavity.z
        ));
    }
    if groups.len() < 2 {
        return Ok("all parts hang together, so that some part is itself in several pieces".to_owned());
    }
    let texts: Vec<String> = groups.values().map(|names| names.join(", ")).collect();
    Ok(format!("these hang together: {}", texts.join(" | ")))
}

/// A corner of each shell that faces inwards.
fn cavities(whole: &Solid) -> Vec<DVec3> {
    let at = |v: u32| DVec3::from_array(whole.vertices()[v as usize].map(f64::from));
    let corner = |shell: Shell<'_>| {
        let origin = at(shell.first_vertex);
        let six_volumes = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| at(v) - origin);
            a.dot(b.cross(c))
        };
        (shell.triangles.iter().map(six_volumes).sum::<f64>() < 0.0).then_some(origin)
    };
    whole.shells().filter_map(corner).collect()
}
