//! Numbers and texts as they stand in files.

use std::fmt::Write;

/// A number with the decimals it has: no trailing zeros, no exponent, no minus before zero.
pub(super) struct Number(pub(super) f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Twelve decimals are more than a rounded coordinate has, and fewer than show its binary tail.
        let digits = format!("{:.12}", self.0);
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if digits == "-0" { "0" } else { digits })
    }
}

/// Text as XML content; characters that XML cannot hold become U+FFFD.
pub(super) struct Escaped<'a>(pub(super) &'a str);

impl std::fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '\t' | '\n' => f.write_char(c)?,
                '\0'..='\x1f' | '\x7f' | '\u{fffe}' | '\u{ffff}' => f.write_char('\u{fffd}')?,
                _ => f.write_char(c)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, -0.0, -1e-14, 1.5, -2.25, 100.0, 0.1 + 0.2].map(|x| Number(x).to_string());
        assert_eq!(texts, ["0", "0", "0", "1.5", "-2.25", "100", "0.3"]);
    }
}
