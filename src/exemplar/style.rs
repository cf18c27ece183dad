//! The properties that an element declares, from its attributes, the style sheets and its `style`.
//!
//! The cascade is the one of the SVG library (attributes, then rules by specificity, then `style`, with
//! `!important` on top), so that the scan sees what the library will see. Inheritance is left to the scan.
//! Style sheets that depend on other files or on the viewer are refused.

use roxmltree::Node;
use simplecss::{AttributeOperator, Declaration, DeclarationTokenizer, Element, PseudoClass, StyleSheet};

use super::error::{ExemplarFault, shortened};
use super::source::{Source, svg_tag};

/// The style sheets of a document.
pub(super) struct Cascade<'a> {
    sheet: StyleSheet<'a>,
}

/// One declared property or attribute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Declared<'a> {
    pub(super) name: &'a str,
    pub(super) value: &'a str,
    /// Whether it comes from a style sheet or `style`, where only properties count.
    pub(super) styled: bool,
    important: bool,
}

impl<'a> Cascade<'a> {
    /// The style sheets of `source`.
    pub(super) fn new(source: &'a Source) -> Result<Self, ExemplarFault> {
        let mut sheet = StyleSheet::new();
        for node in source.xml().descendants().filter(|&n| svg_tag(n) == Some("style")) {
            if node.attribute("type").is_some_and(|t| t != "text/css") {
                continue;
            }
            let text = node.text().unwrap_or_default();
            if let Some(rule) = viewer_rule(text) {
                let what = format!("the style rule {rule}");
                return Err(ExemplarFault::StyleSheet { what, line: source.line(node.range().start) });
            }
            sheet.parse_more(text);
        }
        Ok(Self { sheet })
    }

    /// What `node` declares, each name once, in the order of first appearance.
    pub(super) fn declared(
        &self,
        source: &Source,
        node: Node<'a, '_>,
    ) -> Result<Vec<Declared<'a>>, ExemplarFault> {
        let mut all = Vec::new();
        for attribute in node.attributes().filter(|a| a.namespace().is_none() && a.name() != "style") {
            all.push(Declared {
                name: attribute.name(),
                value: attribute.value().trim(),
                styled: false,
                important: false,
            });
        }
        for rule in self.sheet.rules.iter().filter(|rule| rule.selector.matches(&Styled(node))) {
            for declaration in &rule.declarations {
                apply(&mut all, declaration);
            }
        }
        if let Some(style) = node.attribute("style") {
            let mut count = 0;
            for declaration in DeclarationTokenizer::from(style) {
                apply(&mut all, &declaration);
                count += 1;
            }
            if count != declarations_in(style) {
                return Err(ExemplarFault::Attribute {
                    place: source.place(node),
                    name: "style".into(),
                    value: shortened(style),
                    wanted: format!(
                        "\"name: value\" pairs separated by semicolons are wanted, {count} could be read"
                    ),
                });
            }
        }
        Ok(all)
    }
}

fn apply<'a>(all: &mut Vec<Declared<'a>>, declaration: &Declaration<'a>) {
    let names: &[&'a str] = match declaration.name {
        "marker" => &["marker-start", "marker-mid", "marker-end"],
        _ => &[declaration.name],
    };
    for &name in names {
        let new = Declared { name, value: declaration.value, styled: true, important: declaration.important };
        match all.iter_mut().find(|d| d.name == name) {
            Some(old) if old.important => {}
            Some(old) => *old = new,
            None => all.push(new),
        }
    }
}

/// The name of the first at-rule that makes styles depend on other files or on the viewer.
fn viewer_rule(css: &str) -> Option<&'static str> {
    ["@import", "@media", "@supports", "@layer", "@container"].into_iter().find(|rule| css.contains(rule))
}

/// The number of declarations in a `style` attribute, by its semicolons outside of quotes, parentheses and
/// comments.
fn declarations_in(style: &str) -> usize {
    let mut bare = String::with_capacity(style.len());
    let mut rest = style;
    while let Some(start) = rest.find("/*") {
        bare.push_str(&rest[..start]);
        rest = rest[start..].find("*/").map_or("", |end| &rest[start + end + 2..]);
    }
    bare.push_str(rest);
    let (mut quote, mut depth) = (None, 0);
    bare.split(|c: char| {
        match (quote, c) {
            (Some(q), c) if c == q => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '(') => depth += 1,
            (None, ')') => depth -= 1,
            (None, _) => {}
        }
        quote.is_none() && depth <= 0 && c == ';'
    })
    .filter(|piece| !piece.trim().is_empty())
    .count()
}

/// An XML element as the selector engine sees it.
struct Styled<'a, 'input>(Node<'a, 'input>);

impl Element for Styled<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Styled)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Styled)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0.attribute(local_name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.prev_sibling_element().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exemplar::Limits;

    fn declared(svg: &str, id: &str) -> Result<Vec<(String, String)>, String> {
        let limits = Limits::default();
        let source = Source::parse(svg.as_bytes(), &limits).map_err(|e| e.to_string())?;
        let cascade = Cascade::new(&source).map_err(|e| e.to_string())?;
        let node = source.xml().descendants().find(|n| n.attribute("id") == Some(id)).unwrap();
        let declared = cascade.declared(&source, node).map_err(|e| e.to_string())?;
        Ok(declared.iter().map(|d| (d.name.to_owned(), d.value.to_owned())).collect())
    }

    fn value(svg: &str, name: &str) -> Option<String> {
        declared(svg, "p").unwrap().into_iter().find(|(n, _)| n == name).map(|(_, v)| v)
    }

    #[test]
    fn style_beats_rules_and_rules_beat_attributes() {
        let sheet = "<style>.a{fill:red;stroke:blue} path{fill:green;stroke-width:2!important}</style>";
        let svg = format!(
            "<svg>{sheet}<path id='p' class='a' fill='black' style='stroke:none;stroke-width:9'/></svg>"
        );
        assert_eq!(value(&svg, "fill").as_deref(), Some("red"));
        assert_eq!(value(&svg, "stroke").as_deref(), Some("none"));
        assert_eq!(value(&svg, "stroke-width").as_deref(), Some("2"));
    }

    #[test]
    fn a_broken_style_is_named() {
        let error =
            declared("<svg>\n<path id='p' style='fill:red; stroke blue; x:1'/></svg>", "p").unwrap_err();
        assert!(error.contains("<path id=\"p\"> on line 2") && error.contains("style"), "{error}");
        assert!(
            declared("<svg><path id='p' style='fill:url(#a);; /* ; */ stroke:red; '/></svg>", "p").is_ok()
        );
    }

    #[test]
    fn rules_that_depend_on_the_viewer_are_refused() {
        let error = declared("<svg>\n<style>@media print{path{fill:red}}</style><path id='p'/></svg>", "p")
            .unwrap_err();
        assert!(error.contains("@media on line 2"), "{error}");
    }
}
