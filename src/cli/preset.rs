//! Options from files.
//!
//! A preset is a TOML file whose keys are options without their dashes. Its values are put into the arguments as if
//! they had been typed, so that one parser judges both, and only where the command line does not speak of the
//! option, or of one that excludes it: the command line wins. Of several presets the last wins. Keys at the top are for
//! every command and must be options of the one that runs; those of a table named after a command are for that
//! command only.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, CommandFactory};
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::args::Arguments;

/// The option by which presets are given, here and in the parser.
const OPTION: &str = "preset";

#[derive(Debug, Clone, Args)]
pub(super) struct PresetArgs {
    /// Take options from a TOML file, as components = 1; what is typed wins over it, and of several files the last wins
    #[arg(long, value_name = "FILE.toml")]
    pub(super) preset: Vec<PathBuf>,
}

/// Why a preset cannot be used.
#[derive(Debug, Error)]
pub(super) enum PresetError {
    #[error("{}: {error}", file.display())]
    Unreadable { file: PathBuf, error: std::io::Error },
    #[error("{}: {error}", file.display())]
    Syntax { file: PathBuf, error: Box<toml::de::Error> },
    #[error("{}, line {line}: {command} has no option {key}{}", file.display(), did_you_mean(suggestion.as_deref()))]
    Unknown { file: PathBuf, line: usize, command: String, key: String, suggestion: Option<String> },
    #[error("{}, line {line}: {key} is {found}; use {wanted}", file.display())]
    Value { file: PathBuf, line: usize, key: String, found: &'static str, wanted: &'static str },
}

pub(super) fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |known| format!("; did you mean {known}?"))
}

/// The arguments with those of their presets put in.
pub(super) fn expanded(arguments: Vec<OsString>) -> Result<Vec<OsString>, PresetError> {
    expanded_with(arguments, |file| std::fs::read_to_string(file))
}

fn expanded_with(
    arguments: Vec<OsString>,
    read: impl Fn(&Path) -> std::io::Result<String>,
) -> Result<Vec<OsString>, PresetError> {
    let program = Arguments::command();
    // What is wrong or missing is found when all options are together.
    let Ok(typed) = program.clone().ignore_errors(true).try_get_matches_from(&arguments) else {
        return Ok(arguments);
    };
    let Some((name, typed)) = typed.subcommand() else { return Ok(arguments) };
    let command = program.find_subcommand(name).expect("what was parsed is a command");
    let has_presets = command.get_arguments().any(|arg| arg.get_id() == OPTION);
    let files: Vec<&PathBuf> = match has_presets {
        true => typed.get_many(OPTION).unwrap_or_default().collect(),
        false => Vec::new(),
    };
    let mut options = BTreeMap::new();
    for file in files {
        let text = read(file).map_err(|error| PresetError::Unreadable { file: file.clone(), error })?;
        Preset { file, text: &text, program: &program, command }.read(&mut options)?;
    }
    let words =
        options.into_values().filter(|option| !option.is_overruled(command, typed)).flat_map(|o| o.words);
    let mut arguments = arguments;
    let at = arguments.iter().position(|word| word == name).map_or(arguments.len(), |at| at + 1);
    arguments.splice(at..at, words);
    Ok(arguments)
}

/// A preset for one command of the program.
struct Preset<'c, 't> {
    file: &'t Path,
    text: &'t str,
    program: &'c Command,
    command: &'c Command,
}

/// An option of a preset, as words of a command line.
struct PresetOption<'c> {
    arg: &'c Arg,
    words: Vec<OsString>,
}

impl PresetOption<'_> {
    /// Whether this option, or one that excludes it, was typed.
    fn is_overruled(&self, command: &Command, typed: &ArgMatches) -> bool {
        let was_typed =
            |arg: &Arg| typed.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine);
        // Of two options that exclude each other, either may be the one that says so.
        let excludes = |one: &Arg, other: &Arg| command.get_arg_conflicts_with(one).contains(&other);
        let is_excluded = |arg: &Arg| was_typed(arg) && (excludes(arg, self.arg) || excludes(self.arg, arg));
        was_typed(self.arg) || command.get_arguments().any(is_excluded)
    }
}

impl<'c> Preset<'c, '_> {
    /// Adds the options of this preset to those of the ones before, by the names that they have in the parser.
    fn read(&self, options: &mut BTreeMap<&'c str, PresetOption<'c>>) -> Result<(), PresetError> {
        let table = DeTable::parse(self.text)
            .map_err(|error| PresetError::Syntax { file: self.file.to_owned(), error: Box::new(error) })?;
        let is_command = |key: &str| self.program.get_subcommands().any(|command| command.get_name() == key);
        let (sections, shared): (Vec<_>, Vec<_>) = table
            .get_ref()
            .iter()
            .partition(|(key, value)| is_command(key.get_ref()) && value.get_ref().is_table());
        for (key, value) in shared {
            self.add(key, value, options)?;
        }
        let own = sections.into_iter().filter(|(key, _)| key.get_ref() == self.command.get_name());
        for (key, value) in own.filter_map(|(_, section)| section.get_ref().as_table()).flatten() {
            self.add(key, value, options)?;
        }
        Ok(())
    }

    fn add(
        &self,
        key: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
        options: &mut BTreeMap<&'c str, PresetOption<'c>>,
    ) -> Result<(), PresetError> {
        let name = key.get_ref().as_ref();
        let known = || self.command.get_arguments().filter(|arg| arg.get_id() != OPTION);
        let Some(arg) = known().find(|arg| name_of(arg) == name) else {
            return Err(PresetError::Unknown {
                file: self.file.to_owned(),
                line: line_of(self.text, key.span().start),
                command: self.command.get_name().to_owned(),
                key: name.to_owned(),
                suggestion: nearest(name, known().map(name_of)),
            });
        };
        let words = words(arg, value.get_ref()).map_err(|wanted| PresetError::Value {
            file: self.file.to_owned(),
            line: line_of(self.text, value.span().start),
            key: name.to_owned(),
            found: value.get_ref().type_str(),
            wanted,
        })?;
        options.insert(arg.get_id().as_str(), PresetOption { arg, words });
        Ok(())
    }
}

/// The name among `known` that is most like `name`, if one is.
pub(super) fn nearest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> Option<String> {
    let near = known.into_iter().map(|known| (strsim::jaro_winkler(name, known), known));
    let nearest = near.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(likeness, _)| *likeness > 0.8);
    nearest.map(|(_, name)| name.to_owned())
}

/// The line of a byte, from 1.
pub(super) fn line_of(text: &str, at: usize) -> usize {
    1 + text.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count()
}

/// What an option is called in a preset: as on the command line without dashes, or, where it has no name there, as in its
/// help.
pub(super) fn name_of(arg: &Arg) -> &str {
    arg.get_long().unwrap_or_else(|| arg.get_id().as_str())
}

/// An option as it would be typed, or what its value should have been.
pub(super) fn words(arg: &Arg, value: &DeValue<'_>) -> Result<Vec<OsString>, &'static str> {
    let word = |text: &str| match arg.get_long() {
        Some(long) => OsString::from(format!("--{long}={text}")),
        None => OsString::from(text),
    };
    if matches!(arg.get_action(), ArgAction::SetTrue) {
        return match (value.as_bool(), arg.get_long()) {
            (Some(true), Some(long)) => Ok(vec![format!("--{long}").into()]),
            (Some(false), _) => Ok(Vec::new()),
            _ => Err("true or false"),
        };
    }
    let text = |value: &DeValue<'_>| {
        let number = || value.as_float().map(|number| number.as_str().replace('_', ""));
        let whole = || value.as_integer().filter(|n| n.radix() == 10).map(|n| n.as_str().replace('_', ""));
        value.as_str().map(str::to_owned).or_else(whole).or_else(number)
    };
    match (value.as_array(), arg.get_action()) {
        (Some(values), ArgAction::Append) => {
            let words = values.iter().map(|value| text(value.get_ref()).map(|text| word(&text)));
            words.collect::<Option<_>>().ok_or("a list of texts or numbers")
        }
        (None, _) => text(value).map(|text| vec![word(&text)]).ok_or("a text, as \"14mm\", or a number"),
        (Some(_), _) => Err("a single value, as it can be given once only"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What becomes of `line` with a preset of `text`.
    fn with(text: &str, line: &str) -> Result<Vec<String>, PresetError> {
        let line = line.replace("PRESET", "--preset=p.toml");
        let words = expanded_with(line.split(' ').map(OsString::from).collect(), |_| Ok(text.to_owned()))?;
        Ok(words
            .into_iter()
            .map(|word| word.into_string().unwrap())
            .filter(|w| !w.contains("preset"))
            .collect())
    }

    #[test]
    fn options_of_a_preset_are_as_if_typed() {
        let text = "along = \"circle:65mm\"\ncomponents = 1\nclosed-pattern = true\nmirror = false\nalpha = 0.5\n\
                    output = [\"a.svg\", \"b.stl\"]\n[rect]\nsize = \"3x4mm\"\n[band]\nseed = 1_000\n";
        let words = with(text, "openwork band PRESET vine.svg").unwrap();
        assert_eq!(words[..2], ["openwork", "band"]);
        for word in
            ["--along=circle:65mm", "--components=1", "--closed-pattern", "--alpha=0.5", "--seed=1000"]
        {
            assert!(words.iter().any(|w| w == word), "{word} in {words:?}");
        }
        assert!(words.contains(&"--output=b.stl".to_owned()) && words.last().unwrap() == "vine.svg");
        assert!(!words.iter().any(|w| w.contains("mirror") || w.contains("size")));
    }

    #[test]
    fn the_command_line_wins() {
        let text = "exemplar = \"rope.svg\"\ncomponents = 1\ncount = 12\n";
        let words = with(text, "openwork band vine.svg PRESET --components 2 --best 3").unwrap();
        assert_eq!(words.join(" "), "openwork band vine.svg --components 2 --best 3");
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let message = |text: &str| with(text, "openwork band PRESET vine.svg").unwrap_err().to_string();
        assert_eq!(
            message("seed = 1\ncompnents = 1\n"),
            "p.toml, line 2: band has no option compnents; did you mean components?"
        );
        assert_eq!(message("xyzzy = 1\n"), "p.toml, line 1: band has no option xyzzy");
        assert_eq!(message("mirror = 1\n"), "p.toml, line 1: mirror is integer; use true or false");
        assert!(message("width = [1, 2]\n").contains("width is array; use a single value"));
        assert!(message("width = { a = 1 }\n").contains("width is table; use a text"));
        assert!(message("width = \n").contains("line 1"));
    }
}
