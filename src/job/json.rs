//! JSON for people and programs: an object has a line for each field, an array stays on one line.
//!
//! A sequence of a hundred thousand pieces would else be as many lines.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::{Formatter, Serializer};

/// `value` as indented JSON, ending in a line break.
pub(super) fn indented(value: &impl Serialize) -> String {
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, Indented { depth: 0, is_empty: true });
    value.serialize(&mut serializer).expect("reports have no maps with keys that are not text");
    bytes.push(b'\n');
    String::from_utf8(bytes).expect("JSON is text")
}

struct Indented {
    depth: usize,
    /// Whether the innermost object has no field so far.
    is_empty: bool,
}

impl Indented {
    fn new_line<W: ?Sized + Write>(&self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b"\n")?;
        (0..self.depth).try_for_each(|_| writer.write_all(b"  "))
    }
}

impl Formatter for Indented {
    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if first { Ok(()) } else { writer.write_all(b", ") }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        self.is_empty = true;
        writer.write_all(b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        if !self.is_empty {
            self.new_line(writer)?;
        }
        writer.write_all(b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.is_empty = false;
        if !first {
            writer.write_all(b",")?;
        }
        self.new_line(writer)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        self.is_empty = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn fields_have_lines_and_arrays_do_not() {
        let value = json!({ "a": [1, 2, [3]], "b": { "c": null, "d": {} }, "e": [{ "f": "x" }, {}] });
        let text = indented(&value);
        let wanted = [
            "{",
            "  \"a\": [1, 2, [3]],",
            "  \"b\": {",
            "    \"c\": null,",
            "    \"d\": {}",
            "  },",
            "  \"e\": [{",
            "    \"f\": \"x\"",
            "  }, {}]",
            "}",
            "",
        ];
        assert_eq!(text, wanted.join("\n"));
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }
}
