//! The options of solids, which every command that makes one has.

use clap::Args;

use super::values;
use crate::fabricate::Bed;
use crate::job::PrintOptions;

#[derive(Debug, Args)]
pub(super) struct PrintArgs {
    /// Bevel all edges of the bottom and the top of the solid at 45 degrees, so wide and high. Refused with its place where
    /// ink is too narrow for it
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    chamfer: Option<f64>,
    /// Slope all walls of the solid inwards from the bottom to the top, by so many degrees from upright: the draft that lets
    /// a cast leave its mould
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    taper: Option<f64>,
    /// The most triangles that the solid may have: its outline is simplified within --chord as little as need be, and it is
    /// an error when that is not enough
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_triangles: Option<usize>,
    /// The printer's bed, as 220x220mm or 220x220x250mm: a part that does not fit is an error, one that fits when it is turned
    /// is told by how much
    #[arg(long, value_name = "WxD[xH]", value_parser = values::bed, allow_hyphen_values = true)]
    bed: Option<Bed>,
    /// Turn the solid if it must be to fit the bed, and write it in the middle of the bed
    #[arg(long, requires = "bed")]
    place: bool,
}

impl PrintArgs {
    /// The options, with the command as it was typed.
    pub(super) fn options(&self) -> PrintOptions {
        PrintOptions {
            chamfer_mm: self.chamfer,
            taper_deg: self.taper,
            max_triangles: self.max_triangles,
            bed: self.bed,
            place: self.place,
            command: Some(command(std::env::args_os())),
        }
    }
}

/// Arguments as a line for a shell; the program by its name alone.
fn command(arguments: impl Iterator<Item = std::ffi::OsString>) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%#".contains(c);
    let quoted = |argument: std::ffi::OsString| {
        let text = argument.to_string_lossy().into_owned();
        match !text.is_empty() && text.chars().all(plain) {
            true => text,
            false => format!("'{}'", text.replace('\'', r"'\''")),
        }
    };
    let words = arguments.skip(1).map(quoted);
    std::iter::once("openwork".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_can_be_pasted() {
        let words = ["/usr/bin/openwork", "band", "my vine.svg", "--along", "circle:65mm", "it's", ""];
        let line = command(words.into_iter().map(Into::into));
        assert_eq!(line, r"openwork band 'my vine.svg' --along circle:65mm 'it'\''s' ''");
    }
}
