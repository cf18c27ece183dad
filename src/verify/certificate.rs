//! Replays the certificate of a report: whether each of its steps follows, and whether it is about this file.
//!
//! Each join is proved by itself, from the line before it to the line after it, so that a wrong number is found
//! where it stands and not in all that follows. Then come the closing join, the bridges, what was wanted, the
//! recount on the file, its SHA-256, and last the digest of the certificate: a change that no step feels, as one
//! piece for another with the same descriptor, is found by that.
//!
//! Excluded: whether the descriptors are those of the exemplar. The counts of the file do not rest on it.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use thiserror::Error;

use super::replay::Run;
use super::shells::StlReport;
use super::svg::SvgReport;

/// The version of certificates that are understood.
const VERSION: i64 = 1;
/// Faults that a message names; the report lists all.
const FAULTS_SHOWN: usize = 10;

/// Why a report could not be replayed at all.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CertificateError {
    /// No JSON.
    #[error("it is not JSON: {message}")]
    Json {
        /// What the parser says.
        message: String,
    },
    /// JSON without a certificate.
    #[error("it has no certificate; a report that band --report has written is wanted")]
    Missing,
    /// A certificate of another form.
    #[error("its certificate cannot be read: {message}")]
    Form {
        /// What is wrong.
        message: String,
    },
}

/// Where a certificate does not hold.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Error)]
#[error("{place}: {fault}")]
pub struct CertificateFault {
    /// The place.
    pub place: CertificatePlace,
    /// What is wrong there.
    pub fault: String,
}

/// A part of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(tag = "part", rename_all = "snake_case")]
pub enum CertificatePlace {
    /// The descriptor of a piece.
    Piece {
        /// Its number.
        piece: i64,
    },
    /// The first piece, or the join at which a piece is added.
    Join {
        /// The position of the piece in the sequence, from 0.
        position: usize,
        /// The piece before it; `None` for the first.
        from: Option<i64>,
        /// The piece.
        to: i64,
    },
    /// The join of the last piece to the first.
    Closing,
    /// A bridge, counted from 0.
    Bridge {
        /// Its number.
        number: usize,
    },
    /// The counts in the end.
    Result,
    /// What was asked for.
    Wanted,
    /// The counts of the file.
    Recount,
    /// The bytes of the file.
    File,
    /// What the rest of the report says.
    Report,
    /// The certificate as a whole.
    Digest,
}

impl fmt::Display for CertificatePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Piece { piece } => write!(f, "piece {piece}"),
            Self::Join { position, from: Some(from), to } => {
                write!(f, "join {position}, of piece {from} to piece {to}")
            }
            Self::Join { position, from: None, to } => write!(f, "step {position}, piece {to}"),
            Self::Closing => f.write_str("the closing join"),
            Self::Bridge { number } => write!(f, "bridge {number}"),
            Self::Result => f.write_str("the result"),
            Self::Wanted => f.write_str("what was wanted"),
            Self::Recount => f.write_str("the recount"),
            Self::File => f.write_str("the file"),
            Self::Report => f.write_str("the report"),
            Self::Digest => f.write_str("the whole"),
        }
    }
}

/// What replaying a certificate came to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CertificateReport {
    /// Whether every step follows and the file is the one that it speaks of.
    pub holds: bool,
    /// Pieces of the sequence.
    pub pieces: usize,
    /// Different pieces among them.
    pub different_pieces: usize,
    /// Joins that were replayed, the closing one included.
    pub joins: usize,
    /// Bridges.
    pub bridges: usize,
    /// Components that the steps add up to.
    pub components: i64,
    /// Holes that they add up to.
    pub holes: i64,
    /// Whether some component goes all the way round.
    pub closed_pattern: bool,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Every place where it does not hold.
    pub faults: Vec<CertificateFault>,
}

impl fmt::Display for CertificateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.holds {
            let closed = if self.closed_pattern { ", closed all the way round" } else { "" };
            return write!(
                f,
                "certificate holds: {} joins of {} different pieces and {} bridge(s) give {} component(s) and {} hole(s){closed}, as counted on this file (SHA-256 {})",
                self.joins, self.different_pieces, self.bridges, self.components, self.holes, self.sha256
            );
        }
        write!(f, "certificate does not hold, {} fault(s)", self.faults.len())?;
        for fault in self.faults.iter().take(FAULTS_SHOWN) {
            write!(f, "\n  {fault}")?;
        }
        if self.faults.len() > FAULTS_SHOWN { write!(f, "\n  ...") } else { Ok(()) }
    }
}

/// What was counted on a file.
#[derive(Debug, Clone, Copy)]
pub enum Counted<'a> {
    /// A drawing.
    Svg(&'a SvgReport),
    /// A solid: a shell for each component, a tunnel for each hole.
    Stl(&'a StlReport),
}

#[derive(Deserialize)]
struct Certificate {
    version: i64,
    shape: Shape,
    wanted: Wanted,
    pieces: Vec<Piece>,
    sequence: Vec<i64>,
    states: Vec<State>,
    steps: Steps,
    closing: Option<Closing>,
    bridges: Vec<Bridge>,
    result: Counts,
    recount: Option<[i64; 2]>,
    files: Vec<File>,
    sha256: String,
}

#[derive(Deserialize, PartialEq, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum Shape {
    Open,
    Ring,
}

#[derive(Deserialize)]
struct Wanted {
    components: Option<[i64; 2]>,
    holes: Option<[i64; 2]>,
    closed_pattern: bool,
}

#[derive(Deserialize)]
struct Piece {
    piece: i64,
    left: Vec<i64>,
    right: Vec<i64>,
    closed: i64,
    euler: i64,
}

#[derive(Deserialize)]
struct State {
    left: Vec<i64>,
    right: Vec<i64>,
}

#[derive(Deserialize)]
struct Steps {
    state: Vec<i64>,
    closed: Vec<i64>,
    euler: Vec<i64>,
}

#[derive(Deserialize)]
struct Closing {
    portals: i64,
    components: i64,
    euler: i64,
    closed_pattern: bool,
}

#[derive(Deserialize)]
struct Bridge {
    kind: String,
    components: i64,
    holes: i64,
}

#[derive(Deserialize)]
struct Counts {
    components: i64,
    holes: i64,
    euler: i64,
    closed_pattern: bool,
}

#[derive(Deserialize)]
struct File {
    format: String,
    sha256: String,
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
        faults,
    })
}

/// A shape without open portals.
#[derive(Clone, Copy)]
struct Made {
    components: i64,
    euler: i64,
    winds: bool,
}

struct Replay<'c> {
    certificate: &'c Certificate,
    faults: Vec<CertificateFault>,
}

impl Replay<'_> {
    fn fault(&mut self, place: CertificatePlace, fault: impl Into<String>) {
        self.faults.push(CertificateFault { place, fault: fault.into() });
    }

    /// The run that the certificate gives after the piece at `position`.
    fn recorded(&self, position: usize) -> Result<Run, String> {
        let Steps { state, closed, euler } = &self.certificate.steps;
        let known = usize::try_from(state[position]).ok().and_then(|s| self.certificate.states.get(s));
        let State { left, right } = known.ok_or_else(|| format!("there is no state {}", state[position]))?;
        let run = Run {
            left: left.clone(),
            right: right.clone(),
            closed: closed[position],
            euler: euler[position],
        };
        run.fault().map_or(Ok(run), |fault| Err(format!("the run after it is impossible: {fault}")))
    }

    /// Proves every join; the run after the last one, as far as it is known.
    fn joins(&mut self) -> Option<Run> {
        let certificate = self.certificate;
        let mut pieces: BTreeMap<i64, Run> = BTreeMap::new();
        for Piece { piece, left, right, closed, euler } in &certificate.pieces {
            let run = Run { left: left.clone(), right: right.clone(), closed: *closed, euler: *euler };
            let place = CertificatePlace::Piece { piece: *piece };
            if let Some(fault) = run.fault() {
                self.fault(place, fault);
            } else if pieces.insert(*piece, run).is_some() {
                self.fault(place, "it is listed twice");
            }
        }
        let mut before: Option<Run> = None;
        for (position, &to) in certificate.sequence.iter().enumerate() {
            let from = position.checked_sub(1).map(|p| certificate.sequence[p]);
            let place = CertificatePlace::Join { position, from, to };
            let recorded = self.recorded(position).map_err(|fault| self.fault(place, fault)).ok();
            match (pieces.get(&to), &before) {
                (None, _) => self
                    .fault(place, format!("piece {to} has no descriptor in the list, or an impossible one")),
                // What the run before was is not known, which has been told.
                (Some(_), None) if position > 0 => {}
                (Some(piece), before) => {
                    let made = before.as_ref().map_or_else(|| Ok(piece.clone()), |run| run.glue(piece));
                    match (made, &recorded) {
                        (Err(fault), _) => self.fault(place, fault),
                        (Ok(made), Some(recorded)) => {
                            if let Some(fault) = difference(&made, recorded) {
                                self.fault(place, fault);
                            }
                        }
                        (Ok(_), None) => {}
                    }
                }
            }
            before = recorded;
        }
        before
    }

    /// The ends of an open run, or the closing join of a ring.
    fn ends(&mut self, run: Option<Run>) -> Made {
        let Counts { components, euler, closed_pattern: winds, .. } = self.certificate.result;
        let told = Made { components, euler, winds };
        let Some(run) = run else { return told };
        match (self.certificate.shape, &self.certificate.closing) {
            (Shape::Open, None) => {
                let open = run.left.len() + run.right.len();
                if open > 0 {
                    self.fault(
                        CertificatePlace::Result,
                        format!("{open} portal(s) are still open at the ends"),
                    );
                }
                Made { components: run.components(), euler: run.euler, winds: false }
            }
            (Shape::Ring, Some(closing)) => match run.ring() {
                Ok(ring) => {
                    let found = (run.right.len() as i64, ring.components, ring.euler, ring.winds);
                    let written =
                        (closing.portals, closing.components, closing.euler, closing.closed_pattern);
                    if found != written {
                        self.fault(
                            CertificatePlace::Closing,
                            format!(
                                "it glues {} portal(s) to {} component(s), an Euler characteristic of {}, {}; the certificate says {}, {}, {}, {}",
                                found.0, found.1, found.2, all_round(found.3), written.0, written.1, written.2, all_round(written.3)
                            ),
                        );
                    }
                    Made { components: ring.components, euler: ring.euler, winds: ring.winds }
                }
                Err(fault) => {
                    self.fault(CertificatePlace::Closing, fault);
                    told
                }
            },
            (Shape::Open, Some(_)) => {
                self.fault(CertificatePlace::Closing, "an open run has none");
                told
            }
            (Shape::Ring, None) => {
                self.fault(CertificatePlace::Closing, "a ring has one, and it is not there");
                told
            }
        }
    }

    /// A strut joins two components or closes a hole off; a slit opens a hole or parts a component.
    fn bridges(&mut self, mut made: Made) -> Made {
        for (number, bridge) in self.certificate.bridges.iter().enumerate() {
            let place = CertificatePlace::Bridge { number };
            let may = match bridge.kind.as_str() {
                "strut" => [(-1, 0), (0, 1)],
                "slit" => [(0, -1), (1, 0)],
                other => {
                    self.fault(place, format!("'{other}' is no bridge; strut and slit are"));
                    continue;
                }
            };
            if !may.contains(&(bridge.components, bridge.holes)) {
                self.fault(
                    place,
                    format!(
                        "a {} cannot change components by {} and holes by {}",
                        bridge.kind, bridge.components, bridge.holes
                    ),
                );
            }
            made.components += bridge.components;
            made.euler += bridge.components - bridge.holes;
            if made.components < 1 || made.components < made.euler {
                self.fault(place, "it leaves no component, or less than no hole");
            }
        }
        made.winds = self.winds_with_bridges(made.winds);
        made
    }

    /// Whether something goes all the way round with the bridges, where without them it did or did not. On which side of
    /// the inside a bridge lies is not in the certificate, so what the certificate says is taken where it can be: a strut
    /// may close a ring, and a slit may open one, but not the other way.
    fn winds_with_bridges(&self, winds: bool) -> bool {
        let Certificate { shape, bridges, result, .. } = self.certificate;
        let has = |kind: &str| *shape == Shape::Ring && bridges.iter().any(|bridge| bridge.kind == kind);
        if result.closed_pattern { winds || has("strut") } else { winds && !has("slit") }
    }

    /// The counts that were made against those that are told, wanted and counted.
    fn counts(&mut self, made: Made) {
        let Counts { components, holes, euler, closed_pattern } = self.certificate.result;
        let found = (made.components, made.components - made.euler);
        if (components, holes) != found || euler != made.euler || closed_pattern != made.winds {
            self.fault(
                CertificatePlace::Result,
                format!(
                    "the steps add up to {} component(s), {} hole(s), an Euler characteristic of {}, {}; the certificate says {components}, {holes}, {euler}, {}",
                    found.0, found.1, made.euler, all_round(made.winds), all_round(closed_pattern)
                ),
            );
        }
        let Wanted { components, holes, closed_pattern } = self.certificate.wanted;
        for (what, wanted, found) in [("component", components, found.0), ("hole", holes, found.1)] {
            if let Some([low, high]) = wanted.filter(|[low, high]| !(low..=high).contains(&&found)) {
                self.fault(
                    CertificatePlace::Wanted,
                    format!("{low} to {high} {what}(s) were asked for, and the steps add up to {found}"),
                );
            }
        }
        if closed_pattern && !made.winds {
            self.fault(
                CertificatePlace::Wanted,
                "a closed pattern was asked for, and nothing goes all the way round",
            );
        }
        if self.certificate.recount != Some([found.0, found.1]) {
            self.fault(
                CertificatePlace::Recount,
                format!(
                    "the steps add up to {} component(s) and {} hole(s), and the report counted others on the files",
                    found.0, found.1
                ),
            );
        }
    }

    /// The file against the digests and the recount; its SHA-256.
    fn file(&mut self, bytes: &[u8], counted: Counted<'_>) -> String {
        let sha256 = hexadecimal(bytes);
        let (format, found) = match counted {
            Counted::Svg(report) => ("svg", (report.components as i64, report.holes as i64)),
            Counted::Stl(report) => {
                if let Some(first) = report.faults.first() {
                    self.fault(CertificatePlace::File, format!("the solid is not sound: {first}"));
                }
                ("stl", (report.shells.len() as i64, report.genus))
            }
        };
        let of_format = |f: &&File| f.format == format;
        if !self.certificate.files.iter().filter(of_format).any(|f| f.sha256 == sha256) {
            let known: Vec<&str> =
                self.certificate.files.iter().filter(of_format).map(|f| f.sha256.as_str()).collect();
            let known = if known.is_empty() { "no such file".to_owned() } else { known.join(", ") };
            self.fault(
                CertificatePlace::File,
                format!("its SHA-256 is {sha256}; the report has written as .{format}: {known}"),
            );
        }
        if let Some([components, holes]) = self.certificate.recount.filter(|r| *r != [found.0, found.1]) {
            self.fault(
                CertificatePlace::Recount,
                format!(
                    "the file has {} component(s) and {} hole(s); the report counted {components} and {holes}",
                    found.0, found.1
                ),
            );
        }
        sha256
    }

    /// What the rest of the report repeats must be the same there.
    fn report(&mut self, report: &Value) {
        let certificate = self.certificate;
        let result = &certificate.result;
        let numbers = [("components", result.components), ("holes", result.holes)];
        for (name, wanted) in numbers {
            if report.get(name).is_some_and(|v| v.as_i64() != Some(wanted)) {
                self.fault(CertificatePlace::Report, format!("its {name} are not those of the certificate"));
            }
        }
        if report.get("closed_pattern").is_some_and(|v| v.as_bool() != Some(result.closed_pattern)) {
            self.fault(CertificatePlace::Report, "its closed_pattern is not that of the certificate");
        }
        if let Some(sequence) = report.get("sequence") {
            let same = sequence.as_array().is_some_and(|s| {
                s.iter().map(Value::as_i64).eq(certificate.sequence.iter().map(|&p| Some(p)))
            });
            if !same {
                self.fault(CertificatePlace::Report, "its sequence is not that of the certificate");
            }
        }
    }

    fn digest(&mut self, certificate: &Value) {
        let mut value = certificate.clone();
        if let Some(fields) = value.as_object_mut() {
            fields.remove("sha256");
        }
        if hexadecimal(value.to_string().as_bytes()) != self.certificate.sha256 {
            self.fault(
                CertificatePlace::Digest,
                "the certificate is not as it was written: its digest is another",
            );
        }
    }
}

/// How a recorded run differs from the one that was made.
fn difference(made: &Run, recorded: &Run) -> Option<String> {
    let compare = |what: &str, made: &dyn fmt::Debug, recorded: &dyn fmt::Debug| {
        format!("{what} {made:?} come of it; the certificate says {recorded:?}")
    };
    if made.left != recorded.left {
        Some(compare("labels on the left", &made.left, &recorded.left))
    } else if made.right != recorded.right {
        Some(compare("labels on the right", &made.right, &recorded.right))
    } else if made.closed != recorded.closed {
        Some(compare("closed components", &made.closed, &recorded.closed))
    } else {
        (made.euler != recorded.euler).then(|| {
            format!(
                "an Euler characteristic of {} comes of it; the certificate says {}",
                made.euler, recorded.euler
            )
        })
    }
}

fn all_round(winds: bool) -> &'static str {
    if winds { "closed all the way round" } else { "not closed all the way round" }
}

fn hexadecimal(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
