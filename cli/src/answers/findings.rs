//! Findings of an estimate as a text.

use armid::estimation::Finding;
use armid_workflow::identification::grouped;

use crate::terminal::Table;

/// The findings behind the first so many kinds as a text.
pub(crate) fn findings(all: &[Finding], kinds: usize) -> String {
    let mut text = String::new();
    for (sentences, advice) in grouped(all).into_iter().skip(kinds) {
        text.push('\n');
        for sentence in sentences {
            text.push_str(&paragraph(&sentence, 2));
        }
        text.push_str(&paragraph(&format!("→ {advice}"), 4));
    }
    text
}

/// A sentence, broken between words.
pub(crate) fn paragraph(sentence: &str, indent: usize) -> String {
    let mut table = Table::of("");
    table.row([sentence]);
    table.render(indent).trim_start_matches('\n').to_owned()
}

#[cfg(test)]
mod tests {
    use super::findings;
    use armid::estimation::Finding;

    #[test]
    fn many_of_a_kind_become_one_sentence_behind_what_matters_more() {
        let mut all: Vec<Finding> = (0..33)
            .map(|k| Finding::PoorlyDetermined {
                parameter: format!("mcx{k}"),
                value: 1.0,
                std: 0.5,
                unit: "kg·m".into(),
            })
            .collect();
        all.push(Finding::NegativeDrive { parameter: "Fv2".into(), value: -1.0 });
        let text = findings(&all, 0);
        assert!(text.lines().count() < 12, "{text}");
        let place = |word: &str| text.find(word).unwrap();
        assert!(place("Fv2 = ") < place("33 parameters have") && text.contains("mcx32"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }
}
