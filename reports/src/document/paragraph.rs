//! Two marks inside running text: `` `code` `` and `**bold**`.

use maud::{Markup, html};

/// A run of text in one style.
#[derive(Debug, PartialEq, Eq)]
enum Span<'a> {
    Plain(&'a str),
    Code(&'a str),
    Bold(&'a str),
}

/// `text` as HTML; marks without a partner are printed as they are.
pub(super) fn marked(text: &str) -> Markup {
    html! {
        @for span in spans(text) {
            @match span {
                Span::Plain(text) => (printable(text)),
                Span::Code(text) => code { (printable(text)) },
                Span::Bold(text) => strong { (printable(text)) },
            }
        }
    }
}

fn spans(text: &str) -> Vec<Span<'_>> {
    let mut spans = Vec::new();
    let mut rest = text;
    let mut from = 0;
    while let Some(start) = rest[from..].find(['`', '*']).map(|offset| offset + from) {
        let mark = if rest[start..].starts_with('`') {
            "`"
        } else if rest[start..].starts_with("**") {
            "**"
        } else {
            from = start + 1;
            continue;
        };
        let inside = &rest[start + mark.len()..];
        let Some(length) = inside.find(mark).filter(|&length| length > 0) else {
            from = start + mark.len();
            continue;
        };
        if start > 0 {
            spans.push(Span::Plain(&rest[..start]));
        }
        let content = &inside[..length];
        spans.push(if mark == "`" { Span::Code(content) } else { Span::Bold(content) });
        rest = &inside[length + mark.len()..];
        from = 0;
    }
    if !rest.is_empty() {
        spans.push(Span::Plain(rest));
    }
    spans
}

/// `text` without the characters that HTML forbids.
pub(super) fn printable(text: &str) -> String {
    let forbidden = |character: char| {
        (character.is_control() && !"\n\r\t".contains(character)) || "\u{FFFE}\u{FFFF}".contains(character)
    };
    text.chars().map(|character| if forbidden(character) { '\u{FFFD}' } else { character }).collect()
}

#[cfg(test)]
mod tests {
    use super::{Span, marked, spans};

    #[test]
    fn analytic_marks_need_a_partner() {
        assert_eq!(
            spans("a `b` **c** d"),
            [Span::Plain("a "), Span::Code("b"), Span::Plain(" "), Span::Bold("c"), Span::Plain(" d")]
        );
        for literal in ["2 * 3", "a ` b", "**", "****", "``", "a ** b", "*", "x*"] {
            assert_eq!(spans(literal), [Span::Plain(literal)], "{literal}");
        }
    }

    #[test]
    fn analytic_html_is_escaped_inside_marks_too() {
        assert_eq!(
            marked("`<b>` & **\"x\"**").into_string(),
            "<code>&lt;b&gt;</code> &amp; <strong>&quot;x&quot;</strong>"
        );
    }
}
