//! What `armid identify --select` answers beside its estimates.

use armid::estimation::{HeldOutData, Selection, TermEvidence, Verdict};

use super::findings::paragraph;
use super::friction_speed::change_text;
use crate::terminal::{Table, number};

/// The table of all candidates, and what it means.
pub(crate) fn selection_text(selection: &Selection) -> String {
    let mut table =
        Table::of("term | #coefficients | #F | #probability | #ΔAIC | #ΔBIC | #change of the squared error | verdict");
    for term in &selection.terms {
        table.row(row(term));
    }
    let predicted = match selection.terms.iter().find_map(|term| term.held_out) {
        Some(change) if change.data == HeldOutData::Recording => "what is held out",
        Some(_) => "each fifth of the log, predicted from the rest",
        None => "nothing: no part of the log determines the parameters alone",
    };
    let sentence = format!(
        "A term is supported where its F is less probable than {} without it, BIC falls, and the interval of the squared error of torque \
         that was not fitted is below zero ({predicted}); {} of {} equations count as independent. Figures of a term are those of the set it was left out of, \
         or of the selected one.",
        number(selection.level),
        number(selection.effective_equations.round()),
        selection.equations,
    );
    let mut text =
        format!("terms that the log supports: {}\n{}{}", selection.columns, table.render(2), paragraph(&sentence, 2));
    for sentence in remarks(selection) {
        text += &paragraph(&sentence, 2);
    }
    text + "\n"
}

/// What the table does not say: terms between which nothing is decided, and terms that are no columns.
fn remarks(selection: &Selection) -> Vec<String> {
    let supported = || selection.terms.iter().filter(|term| term.verdict == Verdict::Supported);
    let mut all: Vec<String> = supported()
        .filter(|term| !term.alike.is_empty())
        .map(|term| format!("The log cannot tell {} from {}.", term.term, term.alike.join(" or ")))
        .collect();
    all.extend(selection.terms.iter().filter(|term| !term.negative.is_empty()).map(|term| {
        format!(
            "\"{}\" is not offered: {} would be below zero by more than 3 standard deviations.",
            term.term,
            term.negative.join(", ")
        )
    }));
    for term in supported().filter(|term| selection.beyond_motion.iter().any(|of| of.term == term.term)) {
        let own = selection.beyond_motion.iter().filter(|of| of.term == term.term);
        let own = own.map(|of| {
            let [low, high] = of.ci95;
            let unit = if of.unit == "1" { String::new() } else { format!(" {}", of.unit) };
            format!("{} {} ({} to {}){unit}", of.parameter, number(of.value), number(low), number(high))
        });
        all.push(format!(
            "The log shows \"{}\", which depends on more than the motion. The model has no term for it, so it biases the estimate: {}.",
            term.term,
            own.collect::<Vec<_>>().join(", ")
        ));
    }
    all
}

fn row(term: &TermEvidence) -> Vec<String> {
    let or_dash = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), number);
    let change = term.held_out.map_or_else(|| "–".to_owned(), |change| change_text(&change));
    let verdict = match term.verdict {
        Verdict::Supported => "supported",
        Verdict::Undecided => "undecided",
        Verdict::NotSupported => "not supported",
        Verdict::NotExcited => "not shown by the motion",
    };
    vec![
        term.term.clone(),
        term.coefficients.to_string(),
        or_dash(term.f.map(|f| f.value)),
        or_dash(term.f.map(|f| f.p_value)),
        or_dash(term.aic),
        or_dash(term.bic),
        change,
        verdict.to_owned(),
    ]
}
