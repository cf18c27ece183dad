//! The steps of a certificate: every join, the ends, and the bridges.
//!
//! Each join is proved from the line before it to the line after it, so that a wrong number is found where it stands
//! and not in all that follows.

use std::collections::BTreeMap;
use std::fmt;

use super::fault::{CertificateFault, CertificatePlace};
use super::form::{Certificate, Counts, Piece, Shape, State, Steps};
use crate::verify::replay::Run;

/// A shape without open portals.
#[derive(Clone, Copy)]
pub(super) struct Made {
    pub(super) components: i64,
    pub(super) euler: i64,
    pub(super) winds: bool,
}

pub(super) struct Replay<'c> {
    pub(super) certificate: &'c Certificate,
    pub(super) faults: Vec<CertificateFault>,
}

impl Replay<'_> {
    pub(super) fn fault(&mut self, place: CertificatePlace, fault: impl Into<String>) {
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
    pub(super) fn joins(&mut self) -> Option<Run> {
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
    pub(super) fn ends(&mut self, run: Option<Run>) -> Made {
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
    pub(super) fn bridges(&mut self, mut made: Made) -> Made {
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

pub(super) fn all_round(winds: bool) -> &'static str {
    if winds { "closed all the way round" } else { "not closed all the way round" }
}
