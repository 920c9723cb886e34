//! The claims of `radkhah2007`, and its Table II beside what is found here.

use armid::study::radkhah2007::Reproduction;

use crate::{Cell, Column, Section, Table};

/// One table row per number behind each claim.
pub(super) fn claims(found: &Reproduction) -> Section {
    let mut table = Table::new(
        "Each claim of Radkhah et al. (2007) and what the simulation shows.",
        Column::list("claim | verdict | measured | #value | #low | #high | #n"),
    );
    let mut section = Section::new("Claims of Radkhah et al. (2007)");
    for claim in &found.claims {
        for (i, q) in claim.quantities.iter().enumerate() {
            let first = |text: &str| if i == 0 { Cell::text(text) } else { Cell::text("") };
            table = table.row(vec![
                first(&claim.claim),
                first(claim.verdict.words()),
                Cell::text(&q.name),
                Cell::number(q.value, 3),
                q.interval.map_or(Cell::Missing, |i| Cell::number(i.low, 3)),
                q.interval.map_or(Cell::Missing, |i| Cell::number(i.high, 3)),
                Cell::count(q.samples),
            ]);
        }
        section = section.text(format!("**{}** {}: {}", claim.verdict.words(), claim.claim, claim.rule));
    }
    section.table(table)
}

/// Table II.
pub(super) fn table(found: &Reproduction) -> Section {
    let mut table = Table::new(
        "The 36 base parameters: what Radkhah et al. (2007) printed for their arm, the truth of this simulation (another arm of the same shape), the mean estimate of the rigid columns alone as in the paper, and the range that links of at most 10 kg inside their shapes can have.",
        Column::list(
            "parameter | combination | unit | #Table II | possible | #truth | #rigid WLS | #invalid runs | \
             #least | #most",
        ),
    );
    for line in &found.table {
        table = table.row(vec![
            Cell::text(&line.name),
            Cell::text(&line.expression),
            Cell::text(&line.unit),
            line.printed.map_or(Cell::Missing, |v| Cell::number(v, 4)),
            line.printed_valid.map_or(Cell::Missing, |ok| Cell::text(if ok { "yes" } else { "no" })),
            Cell::number(line.truth, 4),
            Cell::number(line.rigid, 4),
            Cell::text(format!("{} of {}", line.rigid_invalid, line.runs)),
            Cell::number(line.feasible.low, 3),
            Cell::number(line.feasible.high, 3),
        ]);
    }
    Section::new("Table II")
        .text("The printed `m4*rcy4` reads as a misprint for `m4*rcz4`: with standard DH y4 lies along joint axis 4, so `mcy4` goes into `mcz3`, while `mcz4` is a base parameter that the table lacks. The four that remain without a printed value are `Ixx2`, `Iyy4`, `Ixx5` and `Iyy5`.")
        .table(table)
}
