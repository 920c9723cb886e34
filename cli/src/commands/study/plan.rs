//! `armid study plan`

use std::path::PathBuf;

use armid::study::{ASSURANCE, StoppingRule, StudySize, VarianceComponents};
use armid_io::Error;
use armid_io::study::{design_and_run_seconds, log_ratios, read_study};
use miette::Result;

use crate::terminal::{Answer, Console, Ending, Table};

/// Runs of each design that are considered.
const RUNS: [usize; 9] = [2, 3, 5, 10, 20, 50, 100, 200, 500];

/// A pilot, and what is wanted.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The folder of a study that was performed: the pilot
    folder: PathBuf,
    /// The wanted interval, as "ratio(condition, d-optimal).prediction < 5 %"
    #[arg(long, value_name = "RULE")]
    until: String,
}

/// A size that gives the wanted interval, and its core-hours.
type Sized = (StudySize, f64);

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let rule: StoppingRule = arguments.until.parse().map_err(Error::new)?;
    let pilot = read_study(&arguments.folder)?.result;
    if pilot.plan.runs_of_noise() > 1 {
        let message = format!(
            "{}: found a pilot with antithetic noise, expected runs with noise of their own",
            arguments.folder.display()
        );
        let help = "its runs come in pairs, which do not show how much runs scatter: perform one without it";
        return Err(Error::new(message).help(help).into());
    }
    let truths = pilot.plan.truths.as_ref().is_some_and(|truths| truths.count > 1);
    let logs = log_ratios(&arguments.folder, &pilot, &rule)?;
    let of_pilot = StudySize {
        starts: logs.len(),
        truths: truths.then(|| logs.first().map_or(0, Vec::len)),
        runs: logs.first().map_or(0, Vec::len),
    };
    let components = VarianceComponents::new(&logs, truths).ok_or_else(|| {
        let message = format!(
            "{}: found {} pairs of starts with {} runs each, expected two of each at least",
            arguments.folder.display(),
            of_pilot.starts,
            of_pilot.runs
        );
        Error::new(message).help("perform the pilot with more starts, or --runs")
    })?;
    let (of_design, of_run) = design_and_run_seconds(&arguments.folder)?;
    let hours = |size: &StudySize| 2.0 * size.starts as f64 * (of_design + size.runs as f64 * of_run) / 3600.0;
    let sizes: Vec<Sized> =
        RUNS.iter().filter_map(|&runs| components.fewest(rule.share, runs)).map(|size| (size, hours(&size))).collect();
    let cheapest = sizes.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    console.answer(&answer(&arguments.until, &components, (of_pilot, components.share(of_pilot)), &sizes, cheapest))?;
    Ok(if sizes.is_empty() { Ending::Negative } else { Ending::Done })
}

fn answer(
    until: &str,
    components: &VarianceComponents,
    (pilot, share): (StudySize, f64),
    sizes: &[Sized],
    cheapest: Option<&Sized>,
) -> Answer {
    let deviation = |variance: f64| format!("{:.2} %", 100.0 * variance.sqrt());
    let of_truths = components.truths.map_or(String::new(), |variance| format!(", of arms {}", deviation(variance)));
    let mut text = format!(
        "{until}\nstandard deviation of ln ratio: of pairs of starts {}{of_truths}, of runs {}\n\
         the pilot, {} starts of {} runs, gives ±{:.2} %\n\n",
        deviation(components.starts),
        deviation(components.runs),
        pilot.starts,
        pilot.runs,
        100.0 * share,
    );
    let assured = format!("with {:.0} %", 100.0 * ASSURANCE);
    let mut table = Table::of(&format!("#starts | #arms | #runs | #expected | #{assured} | #core-hours"));
    let percent = |share: f64| format!("±{:.2} %", 100.0 * share);
    for (size, hours) in sizes {
        let truths = size.truths.map_or("1".to_owned(), |truths| truths.to_string());
        let (expected, assured) = (components.share(*size), components.share_with(*size, ASSURANCE));
        let hours = format!("{hours:.2}");
        table.row([size.starts.to_string(), truths, size.runs.to_string(), percent(expected), percent(assured), hours]);
    }
    match cheapest {
        Some((size, hours)) => {
            text.push_str(&table.render(0));
            let arms = size.truths.map_or(String::new(), |truths| format!(", --truths {truths}"));
            text.push_str(&format!(
                "\nleast: starts = {}, --runs {}{arms}, {hours:.2} core-hours\n",
                size.starts, size.runs
            ));
        }
        None => text.push_str("no size that was considered gives it: 10000 starts, 500 runs of each\n"),
    }
    let json = |(size, hours): &Sized| {
        serde_json::json!({
            "size": size,
            "core_hours": hours,
            "share": components.share(*size),
            "assured_share": components.share_with(*size, ASSURANCE),
        })
    };
    Answer {
        text,
        json: serde_json::json!({
            "until": until,
            "assurance": ASSURANCE,
            "components": components,
            "pilot": { "size": pilot, "share": share },
            "sizes": sizes.iter().map(json).collect::<Vec<_>>(),
            "least": cheapest.map(json),
        }),
    }
}
