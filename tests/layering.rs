//! The walls of the house: which room may import which, which library stays in which file, and whether
//! `docs/architecture.md` speaks of files and items that exist.
//!
//! The sources are read as text. Comments and literals are blanked out first, so that prose may mention any
//! room; then every path that starts at `crate`, or climbs there through `super`, is followed to the room that
//! it names. Unit tests inside a room keep to the room's rules too: what needs more of the house is tested in
//! this folder. Excluded: macros that build paths, of which there are none.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Every room with the rooms that it may import, in the order of the house. A room knows only earlier ones.
const ROOMS: [(&str, &[&str]); 15] = [
    ("planar", &[]),
    ("exemplar", &["planar"]),
    ("reeb", &["planar"]),
    // No coordinates here, and none in the solver.
    ("topology", &[]),
    ("pieces", &["planar", "reeb", "topology"]),
    ("solver", &["topology"]),
    // Not the curve: outlines are band coordinates. The grid only judges them.
    ("fit", &["planar", "pieces"]),
    ("domain", &["planar"]),
    ("fabricate", &["planar"]),
    // A solid is all that a writer knows of how shapes came to be.
    ("export", &["planar", "fabricate"]),
    // Nothing of what made the file that is judged.
    ("verify", &["planar"]),
    // What is asked for, and not how the other engine meets it.
    ("samples", &["planar", "topology"]),
    ("analysis", &["planar", "exemplar", "reeb", "topology", "pieces", "export"]),
    (
        "job",
        &[
            "planar",
            "exemplar",
            "reeb",
            "topology",
            "pieces",
            "solver",
            "fit",
            "domain",
            "fabricate",
            "export",
            "verify",
            "samples",
            "analysis",
        ],
    ),
    // Values and whole jobs, no algorithm.
    ("cli", &["planar", "domain", "fabricate", "export", "verify", "analysis", "job"]),
];

/// Imports that the table does not allow and that are still there. One that is gone may not stay in this list.
const OWED: [(&str, &str); 3] = [
    // `analyze` puts its job together by itself; it belongs beside `extrude` in `job`.
    ("src/cli/run.rs", "exemplar"),
    ("src/cli/run.rs", "pieces"),
    ("src/cli/run.rs", "reeb"),
];

/// Libraries that only these files or folders may name.
const LIBRARIES: [(&str, &[&str]); 18] = [
    ("i_overlay", &["src/planar/overlay.rs", "src/fabricate/caps.rs"]),
    ("i_triangle", &["src/fabricate/caps.rs"]),
    ("manifold_rust", &["src/fabricate/boolean.rs"]),
    ("spade", &["src/verify", "src/fit/links.rs", "src/fabricate/caps.rs", "src/fabricate/enforce/core.rs"]),
    ("faer", &["src/fit/least_squares.rs", "src/domain/surface/mean_value.rs", "src/samples/positions.rs"]),
    ("petgraph", &["src/reeb"]),
    ("usvg", &["src/exemplar", "src/verify", "src/analysis/overlay.rs"]),
    (
        "resvg",
        &[
            "src/exemplar/heights.rs",
            "src/export/canvas.rs",
            "src/export/view/mod.rs",
            "src/analysis/overlay.rs",
        ],
    ),
    ("svgtypes", &["src/exemplar"]),
    ("simplecss", &["src/exemplar"]),
    ("tempfile", &["src/export/staged.rs"]),
    ("toml", &["src/fabricate/workshop.rs", "src/cli/preset.rs", "src/cli/scene"]),
    ("zip", &["src/export/threemf.rs", "src/verify/threemf.rs"]),
    ("robust", &["src/verify/crossings.rs", "src/domain/surface/exact.rs"]),
    ("clap", &["src/cli"]),
    ("indicatif", &["src/cli/progress.rs"]),
    ("ctrlc", &["src/cli/interrupt.rs"]),
    ("signal_hook", &["src/cli/interrupt.rs"]),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// All Rust files below `folder`, in the order of their names.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.sort();
    let (folders, files): (Vec<_>, Vec<_>) = paths.into_iter().partition(|p| p.is_dir());
    let files = files.into_iter().filter(|p| p.extension().is_some_and(|e| e == "rs"));
    files.chain(folders.iter().flat_map(|f| rust_files(f))).collect()
}

/// A path below the root with `/` between its parts.
fn name(path: &Path) -> String {
    let below = path.strip_prefix(root()).expect("a path of this repository");
    below.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// An identifier, `::`, or one character of punctuation; with its line.
#[derive(Debug, Clone, PartialEq)]
struct Token {
    text: String,
    line: usize,
}

/// The tokens of Rust source, without comments and literals.
fn tokens(source: &str) -> Vec<Token> {
    let chars: Vec<char> = source.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut tokens = Vec::new();
    let (mut i, mut line) = (0, 1);
    while i < chars.len() {
        let from = i;
        if at(i) == '/' && at(i + 1) == '/' {
            while i < chars.len() && at(i) != '\n' {
                i += 1;
            }
        } else if at(i) == '/' && at(i + 1) == '*' {
            let mut depth = 0;
            loop {
                match (at(i), at(i + 1)) {
                    ('/', '*') => (depth, i) = (depth + 1, i + 2),
                    ('*', '/') => (depth, i) = (depth - 1, i + 2),
                    _ => i += 1,
                }
                if depth == 0 || i >= chars.len() {
                    break;
                }
            }
        } else if at(i) == '"' {
            i = end_of_string(&chars, i);
        } else if at(i) == '\'' {
            // A character literal closes after one character or an escape; a lifetime does not.
            if at(i + 1) == '\\' {
                i += 3;
                while at(i) != '\'' {
                    i += 1;
                }
                i += 1;
            } else {
                i += if at(i + 2) == '\'' { 3 } else { 1 };
            }
        } else if is_word(at(i)) {
            while is_word(at(i)) {
                i += 1;
            }
            let word: String = chars[from..i].iter().collect();
            let is_prefix = matches!(word.as_str(), "r" | "b" | "br" | "c" | "cr");
            if is_prefix && word.ends_with('r') && raw_hashes(&chars, i).is_some() {
                i = end_of_raw_string(&chars, i);
            } else if is_prefix && at(i) == '"' {
                i = end_of_string(&chars, i);
            } else {
                tokens.push(Token { text: word, line });
            }
        } else if at(i) == ':' && at(i + 1) == ':' {
            tokens.push(Token { text: "::".to_owned(), line });
            i += 2;
        } else {
            if !at(i).is_whitespace() {
                tokens.push(Token { text: at(i).to_string(), line });
            }
            i += 1;
        }
        i = i.min(chars.len());
        line += chars[from..i].iter().filter(|&&c| c == '\n').count();
    }
    tokens
}

/// Past the string that begins at `i` with a quotation mark.
fn end_of_string(chars: &[char], mut i: usize) -> usize {
    i += 1;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// The number of `#` at `i` if a raw string begins there.
fn raw_hashes(chars: &[char], i: usize) -> Option<usize> {
    let hashes = chars[i..].iter().take_while(|&&c| c == '#').count();
    (chars.get(i + hashes) == Some(&'"')).then_some(hashes)
}

fn end_of_raw_string(chars: &[char], i: usize) -> usize {
    let hashes = raw_hashes(chars, i).expect("called at a raw string");
    let mut at = i + hashes + 1;
    while at < chars.len() {
        let closes = chars[at] == '"' && chars[at + 1..].iter().take_while(|&&c| c == '#').count() >= hashes;
        at += 1;
        if closes {
            return at + hashes;
        }
    }
    at
}

/// The rooms that a file imports, with the line of each import. `depth` is how many modules deep the file is:
/// 1 for `src/room/mod.rs`, 2 for `src/room/file.rs`.
fn imports(source: &str, depth: usize) -> Vec<(String, usize)> {
    let tokens = tokens(source);
    let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    let mut found = Vec::new();
    // One entry for each open brace: whether it is that of a module.
    let mut braces: Vec<bool> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        match text(i) {
            "{" => braces.push(i >= 2 && text(i - 2) == "mod"),
            "}" => {
                braces.pop();
            }
            "crate" | "super" if text(i + 1) == "::" => {
                let mut height = depth + braces.iter().filter(|&&is_module| is_module).count();
                let mut path = i;
                if text(i) == "crate" {
                    height = 0;
                    path += 2;
                }
                while text(path) == "super" && text(path + 1) == "::" {
                    height -= 1;
                    path += 2;
                }
                if height == 0 {
                    found.extend(heads(&tokens[path..]));
                }
                i = path;
                continue;
            }
            // What names the whole crate, or renames it, could hide a room.
            "crate" if text(i + 1) != ")" => found.push(("crate".to_owned(), tokens[i].line)),
            _ => {}
        }
        i += 1;
    }
    found
}

/// The first names of what follows `crate::`: one, or each one of a group.
fn heads(tokens: &[Token]) -> Vec<(String, usize)> {
    let named = |t: &Token| (t.text.clone(), t.line);
    if tokens.first().is_none_or(|t| t.text != "{") {
        return tokens.first().map(named).into_iter().collect();
    }
    let mut depth = 0;
    let mut found = Vec::new();
    for pair in tokens.windows(2) {
        match pair[0].text.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            break;
        }
        let begins = matches!(pair[0].text.as_str(), "{" | ",") && pair[1].text != "}";
        if depth == 1 && begins {
            found.push(named(&pair[1]));
        }
    }
    found
}

#[test]
fn rooms_import_only_what_they_may_know() {
    let mut faults = Vec::new();
    let mut owed: Vec<_> = OWED.to_vec();
    for file in rust_files(&root().join("src")) {
        let name = name(&file);
        let parts: Vec<&str> = name.split('/').collect();
        let [_, room, inner @ ..] = parts.as_slice() else { panic!("{name} is not below src") };
        if inner.is_empty() {
            continue;
        }
        let Some((_, allowed)) = ROOMS.iter().find(|(known, _)| known == room) else {
            faults.push(format!("{name}: the room {room} is not in the table of this test"));
            continue;
        };
        let depth = inner.len() + usize::from(inner[inner.len() - 1] != "mod.rs");
        for (import, line) in imports(&read(&file), depth) {
            let is_owed = OWED.contains(&(name.as_str(), import.as_str()));
            owed.retain(|debt| *debt != (name.as_str(), import.as_str()));
            if import != *room && !allowed.contains(&import.as_str()) && !is_owed {
                faults.push(format!("{name}:{line}: {room} may not know {import}"));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    assert!(owed.is_empty(), "no longer owed, take them out of the list: {owed:?}");
}

#[test]
fn the_table_goes_one_way() {
    for (i, (room, allowed)) in ROOMS.iter().enumerate() {
        for import in *allowed {
            let earlier = ROOMS[..i].iter().any(|(known, _)| known == import);
            assert!(earlier, "{room} comes before {import}, or {import} is no room");
        }
    }
}

#[test]
fn libraries_stay_behind_their_adapters() {
    let mut faults = Vec::new();
    for file in rust_files(&root().join("src")) {
        let name = name(&file);
        for pair in tokens(&read(&file)).windows(2) {
            // A library is named at the beginning of a path; `zip` alone is what iterators do.
            let [token, next] = pair else { unreachable!("windows of two") };
            let home = LIBRARIES.iter().find(|(library, _)| *library == token.text && next.text == "::");
            let is_home = |place: &&str| name == **place || name.starts_with(&format!("{place}/"));
            if home.is_some_and(|(_, places)| !places.iter().any(is_home)) {
                faults.push(format!("{name}:{}: {} belongs behind its adapter", token.line, token.text));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn imports_are_found_in_every_form() {
    let source = r##"
        //! Prose may speak of crate::cli.
        use crate::planar::{Grid, Region};
        use crate::{reeb::Cut, topology::{Goal, Shape}, solver,};
        use super::super::fit;
        pub(crate) fn f<'a>(x: &'a crate::domain::BandMap) -> char {
            let _ = ("crate::cli", r#"crate::"cli""#, b"crate::cli", '"');
            /* crate::cli /* crate::cli */ */
            super::neighbour::g();
            '\''
        }
        mod tests {
            use super::super::super::{export, verify::read_svg};
            use super::super::sibling;
        }
        use super::super::job;
    "##;
    let found: Vec<String> = imports(source, 2).into_iter().map(|(room, _)| room).collect();
    let wanted = ["planar", "reeb", "topology", "solver", "fit", "domain", "export", "verify", "job"];
    assert_eq!(found, wanted);
    assert_eq!(imports("use crate as all;\nuse crate::cli;", 1), [("crate".into(), 1), ("cli".into(), 2)]);
}

/// What stands between backticks, outside of code blocks.
fn code_spans(markdown: &str) -> BTreeSet<String> {
    let mut fenced = false;
    let mut spans = BTreeSet::new();
    for line in markdown.lines() {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if !fenced && !line.starts_with("    ") {
            spans.extend(line.split('`').skip(1).step_by(2).map(str::to_owned));
        }
    }
    spans
}

/// Whether a span of code is meant to name a file or folder of the repository.
fn is_path(span: &str) -> bool {
    let folders = ["src/", "tests/", "benches/", "examples/", "docs/", "fixtures/", ".ci/"];
    folders.iter().any(|folder| span.starts_with(folder))
}

#[test]
fn the_map_names_files_that_exist() {
    let spans = code_spans(&read(&root().join("docs/architecture.md")));
    let paths: Vec<&String> = spans.iter().filter(|span| is_path(span)).collect();
    assert!(paths.len() > 30, "the map names {} paths", paths.len());
    let missing: Vec<_> = paths.iter().filter(|path| !root().join(path).exists()).collect();
    assert!(missing.is_empty(), "docs/architecture.md names what is not there: {missing:?}");
}

#[test]
fn the_map_names_items_that_exist() {
    let map = read(&root().join("docs/architecture.md"));
    let mut faults = Vec::new();
    let mut items = 0;
    // In a row of a table, names stand after the file that defines them.
    for line in map.lines().filter(|line| line.starts_with('|')) {
        let mut source: Option<(&str, BTreeSet<String>)> = None;
        for span in line.split('`').skip(1).step_by(2) {
            if is_path(span) {
                let is_file = span.ends_with(".rs") && root().join(span).exists();
                source = is_file.then(|| {
                    let words = tokens(&read(&root().join(span))).into_iter().map(|t| t.text);
                    (span, words.collect())
                });
            } else if let Some((file, words)) = &source {
                let item = span.rsplit("::").next().unwrap_or(span);
                items += 1;
                if !words.contains(item) {
                    faults.push(format!("{item} is not in {file}"));
                }
            }
        }
    }
    assert!(items > 30, "the map names {items} items");
    assert!(faults.is_empty(), "docs/architecture.md: {faults:?}");
}

#[test]
fn the_map_names_every_room() {
    let map = read(&root().join("docs/architecture.md"));
    let entries = fs::read_dir(root().join("src")).expect("src is a folder");
    for folder in entries.map(|e| e.expect("a readable folder").path()).filter(|p| p.is_dir()) {
        let room = name(&folder).replace("src/", "");
        assert!(map.contains(&format!("| `{room}` |")), "docs/architecture.md has no row for {room}");
    }
}
