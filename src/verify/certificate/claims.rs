//! What a certificate claims beside its steps: the counts, the file, the rest of the report, and itself unchanged.

use serde_json::Value;
use sha2::{Digest, Sha256};

use super::Counted;
use super::fault::CertificatePlace;
use super::form::{Counts, File, Wanted};
use super::steps::{Made, Replay, all_round};

impl Replay<'_> {
    /// The counts that were made against those that are told, wanted and counted.
    pub(super) fn counts(&mut self, made: Made) {
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
    pub(super) fn file(&mut self, bytes: &[u8], counted: Counted<'_>) -> String {
        let sha256 = hexadecimal(bytes);
        let (format, found) = match counted {
            Counted::Svg(report) => ("svg", (report.components as i64, report.holes as i64)),
            Counted::Cut(report, format) => {
                if let Some(first) = report.faults.first() {
                    self.fault(CertificatePlace::File, format!("the cut lines are not sound: {first}"));
                }
                (format, (report.components as i64, report.holes as i64))
            }
            Counted::Mesh { format, report } => {
                if let Some(first) = report.faults.first() {
                    self.fault(CertificatePlace::File, format!("the solid is not sound: {first}"));
                }
                (format, (report.shells.len() as i64, report.genus))
            }
        };
        let of_format = |f: &&File| f.format == format;
        if !self.certificate.files.iter().filter(of_format).any(|f| f.sha256 == sha256) {
            let known: Vec<&str> =
                self.certificate.files.iter().filter(of_format).map(|f| f.sha256.as_str()).collect();
            let known = if known.is_empty() {
                "no such file, or one whose counts are others: a pattern on a model, or one cut open"
                    .to_owned()
            } else {
                known.join(", ")
            };
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
    pub(super) fn report(&mut self, report: &Value) {
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

    pub(super) fn digest(&mut self, certificate: &Value) {
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

fn hexadecimal(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
