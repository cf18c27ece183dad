//! What replaying a certificate came to, and where it does not hold.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

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
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema, Error)]
#[error("{place}: {fault}")]
pub struct CertificateFault {
    /// The place.
    pub place: CertificatePlace,
    /// What is wrong there.
    pub fault: String,
}

/// A part of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "part", rename_all = "snake_case")]
pub enum CertificatePlace {
    /// The exemplar, if it was given.
    Exemplar,
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
            Self::Exemplar => f.write_str("the exemplar"),
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
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
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
    /// Whether its pieces were compared with the exemplar's.
    pub exemplar_compared: bool,
    /// Every place where it does not hold.
    pub faults: Vec<CertificateFault>,
}

impl CertificateReport {
    /// Adds where the exemplar is not as the certificate says.
    pub fn add_exemplar(&mut self, faults: Vec<CertificateFault>) {
        self.exemplar_compared = true;
        self.holds &= faults.is_empty();
        self.faults.extend(faults);
    }
}

impl fmt::Display for CertificateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.holds {
            let closed = if self.closed_pattern { ", closed all the way round" } else { "" };
            let exemplar = if self.exemplar_compared { "; its pieces are those of the exemplar" } else { "" };
            return write!(
                f,
                "certificate holds: {} joins of {} different pieces and {} bridge(s) give {} component(s) and {} hole(s){closed}, as counted on this file (SHA-256 {}){exemplar}",
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
