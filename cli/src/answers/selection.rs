//! What `armid identify --select` answers beside its estimates.

use armid::estimation::{HeldOutData, Selection, TermEvidence, Verdict};
use serde_json::{Value, json};

use super::findings::paragraph;
use crate::terminal::{Align, Table, number};

/// The keys of a selection.
pub(crate) fn selection_json(selection: &Selection) -> Value {
    json!(selection)
}

/// The table of all candidates, and what it means.
pub(crate) fn selection_text(selection: &Selection) -> String {
    let mut table = Table::new(&[
        ("term", Align::Left),
        ("coefficients", Align::Right),
        ("F", Align::Right),
        ("probability", Align::Right),
        ("ΔAIC", Align::Right),
        ("ΔBIC", Align::Right),
        ("change of the squared error", Align::Right),
        ("verdict", Align::Left),
    ]);
    for term in &selection.terms {
        table.row(row(term));
    }
    let predicted = match selection.terms.iter().find_map(|term| term.held_out) {
        Some(change) if change.data == HeldOutData::Recording => "what is held out",
        Some(_) => "each fifth of the log, predicted from the rest",
        None => "nothing: no part of the log determines the parameters alone",
    };
    let sentence = format!(
        "A term is supported where its F is less probable than {} without it, BIC falls, and torque that was not fitted is predicted \
         better ({predicted}); {} of {} equations count as independent. Figures of a term are those of the set it was left out of, \
         or of the selected one.",
        number(selection.level),
        number(selection.effective_equations.round()),
        selection.equations,
    );
    format!("terms that the data decide: {}\n{}{}\n", selection.columns, table.render(2), paragraph(&sentence, 2))
}

fn row(term: &TermEvidence) -> Vec<String> {
    let or_dash = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), number);
    let change = term.held_out.map_or_else(
        || "–".to_owned(),
        |change| {
            let mean = (change.with / change.without).powi(2) - 1.0;
            let [low, high] = change.change_ci95;
            format!("{:.1} % ({:.1} to {:.1})", 100.0 * mean, 100.0 * low, 100.0 * high)
        },
    );
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
