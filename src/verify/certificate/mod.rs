//! Replays the certificate of a report: whether each of its steps follows, and whether it is about this file.
//!
//! Each join is proved by itself, from the line before it to the line after it, so that a wrong number is found
//! where it stands and not in all that follows. Then come the closing join, the bridges, what was wanted, the
//! recount on the file, its SHA-256, and last the digest of the certificate: a change that no step feels, as one
//! piece for another with the same descriptor, is found by that.
//!
//! Excluded: whether the descriptors are those of the exemplar, on which the counts of the file do not rest. Who has the
//! exemplar can add that ([`CertificateReport::add_exemplar`]).

mod claims;
mod fault;
mod form;
mod steps;

use serde::Deserialize;
use serde_json::Value;

use self::form::{Certificate, Shape, Steps, VERSION};
use self::steps::Replay;
use super::cutlines::CutReport;
use super::shells::MeshReport;
use super::svg::SvgReport;

pub use fault::{CertificateError, CertificateFault, CertificatePlace, CertificateReport};

/// What was counted on a file.
#[derive(Debug, Clone, Copy)]
pub enum Counted<'a> {
    /// A drawing.
    Svg(&'a SvgReport),
    /// Cut lines, in a file with this extension.
    Cut(&'a CutReport, &'static str),
    /// A solid: a shell for each component, a tunnel for each hole.
    Mesh {
        /// `stl`, `3mf` or `obj`.
        format: &'a str,
        /// What was found in it.
        report: &'a MeshReport,
    },
}

/// Replays the certificate of `report`, the JSON of a job, for a file with these bytes in which so much was
/// counted.
///
/// # Errors
/// [`CertificateError`] when there is no certificate to replay. One that does not hold is told in the report.
pub fn replay_certificate(
    report: &[u8],
    file: &[u8],
    counted: Counted<'_>,
) -> Result<CertificateReport, CertificateError> {
    let report: Value =
        serde_json::from_slice(report).map_err(|e| CertificateError::Json { message: e.to_string() })?;
    let value = report.get("certificate").ok_or(CertificateError::Missing)?;
    let form = |message| CertificateError::Form { message };
    let certificate = Certificate::deserialize(value).map_err(|e| form(e.to_string()))?;
    if certificate.version != VERSION {
        return Err(form(format!("its version is {}; {VERSION} is understood", certificate.version)));
    }
    let n = certificate.sequence.len();
    let Steps { state, closed, euler } = &certificate.steps;
    if n == 0 || [state.len(), closed.len(), euler.len()] != [n; 3] {
        return Err(form(format!("it has {n} pieces, and steps for another number of them")));
    }
    let mut replay = Replay { certificate: &certificate, faults: Vec::new() };
    let made = replay.joins();
    let made = replay.ends(made);
    let made = replay.bridges(made);
    replay.counts(made);
    let sha256 = replay.file(file, counted);
    replay.report(&report);
    replay.digest(value);
    let faults = replay.faults;
    Ok(CertificateReport {
        holds: faults.is_empty(),
        pieces: n,
        different_pieces: certificate.pieces.len(),
        joins: if certificate.shape == Shape::Ring { n } else { n - 1 },
        bridges: certificate.bridges.len(),
        components: made.components,
        holes: made.components - made.euler,
        closed_pattern: made.winds,
        sha256,
        exemplar_compared: false,
        faults,
    })
}
