//! `armid report`

use std::path::{Path, PathBuf};

use armid::model::format::ChainEnds;
use armid::study::{CriterionRatios, EffectLevels, StudyResult};
use armid_io::study::{read_figure_numbers, read_robots, read_study};
use armid_io::{Error, Text, estimate};
use armid_workflow::LogSource;
use armid_workflow::report::{
    ComparisonAnswer, EstimatePage, Sheet, write_comparison, write_criteria, write_levels, write_report,
    write_robots_report,
};
use miette::Result;
use serde::de::DeserializeOwned;
use serde_json::json;

use crate::arguments::ChainArguments;
use crate::terminal::{Answer, Console, Ending, Watch};

const AFTER_HELP: &str = "\
The page of a study is drawn again from stored results; nothing is computed. The page of an estimate shows \
measured and predicted torque, residuals, parameters with intervals, and a verdict with its reason. The \
estimate holds all of it. Its logs are read again for a campaign's estimate, or with --robot.

Examples:
  armid report reports/01-criteria
  armid report reports/01-criteria -o /tmp/page
  armid report E.json -o page
  armid report E.json --paper column -o page
  armid report E.json --robot lab/robot.toml -o page
  armid report --compare simulated measured -o page
  armid report reports/06-ten-times reports/06-two-robots/puma-560 --figure criteria -o figure
  armid report reports/gallery/readme/criteria.json --figure criteria -o figure
  armid report reports/06-levels --figure levels --paper column -o figure";

/// Draw the page of an estimate, or regenerate the report of a stored study
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// Folders of `armid study`, files of `armid identify`, or figure numbers
    #[arg(required_unless_present = "compare", value_name = "DIR|FILE")]
    folders: Vec<PathBuf>,
    /// Compare two estimates: JSON files of `identify`, or folders
    #[arg(long, num_args = 2, value_names = ["A", "B"], conflicts_with = "folders")]
    compare: Option<Vec<PathBuf>>,
    /// Read the logs of the estimates again, with this robot
    #[arg(long, conflicts_with = "compare")]
    robot: Option<String>,
    /// Draw one figure of one or several studies
    #[arg(long, conflicts_with_all = ["compare", "robot"])]
    figure: Option<Figure>,
    /// Draw figures for a journal, as SVG and PDF
    #[arg(long, value_name = "WIDTH")]
    paper: Option<Paper>,
    #[command(flatten)]
    chain: ChainArguments,
}

/// A figure of one or several studies.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Figure {
    /// Condition number and I-optimality relative to D-optimality, by unmodelled effect
    Criteria,
    /// Error relative to D-optimality over the size of each unmodelled effect
    Levels,
}

/// What a journal has room for; labels are 8 pt high.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Paper {
    /// 88 mm
    Column,
    /// 181 mm
    Page,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let sheet = match arguments.paper {
        None => Sheet::Screen,
        Some(Paper::Column) => Sheet::Column,
        Some(Paper::Page) => Sheet::Page,
    };
    if let Some([first, second]) = arguments.compare.as_deref() {
        let folder = console.output().map_or_else(|| PathBuf::from("reports/comparison"), Path::to_path_buf);
        let answer = write_comparison(&folder, first, second, sheet)?;
        let json = serde_json::to_value(&answer).map_err(Error::new)?;
        console.show(&Answer { text: comparison_text(&answer), json })?;
        return Ok(Ending::Done);
    }
    if let Some(figure) = arguments.figure {
        let folder = console.output().unwrap_or(Path::new("reports/figure"));
        let all = &arguments.folders;
        let figures = match figure {
            Figure::Criteria => {
                let numbers = numbers(all, "criteria", |study| vec![CriterionRatios::from_result(study)])?;
                vec![write_criteria(folder, &numbers, sheet)?]
            }
            Figure::Levels => write_levels(folder, &numbers(all, "levels", EffectLevels::from_result)?, sheet)?,
        };
        let figures: Vec<String> = figures.iter().map(|figure| figure.display().to_string()).collect();
        console.show(&Answer { text: figures.join("\n") + "\n", json: json!({ "figures": figures }) })?;
        return Ok(Ending::Done);
    }
    let mut pages = Vec::new();
    for folder in &arguments.folders {
        if folder.is_file() {
            let output = match console.output() {
                Some(output) if arguments.folders.len() > 1 => {
                    Some(output.join(folder.file_stem().unwrap_or_default()))
                }
                output => output.map(Path::to_path_buf),
            };
            let stem = folder.file_stem().unwrap_or_else(|| "estimate".as_ref());
            let output = output.unwrap_or_else(|| Path::new("reports").join(stem));
            let text = Text::read(folder)?;
            let estimate = estimate::parse(&text)?;
            let (robot, chain) = (arguments.robot.clone(), arguments.chain.ends());
            let is_stated = robot.is_some() || chain != ChainEnds::default();
            let page = match EstimatePage::of_file(&text)?.filter(|_| !is_stated) {
                Some(page) => page,
                None => {
                    let (log, inputs) = LogSource { robot, chain, ..LogSource::default() }.again(&text, &[])?;
                    EstimatePage::of_log(&estimate, &text.name, &log, inputs, &Watch::new(console))?
                }
            };
            pages.push(page.write(&output, &estimate, sheet)?);
            continue;
        }
        if !folder.is_dir() {
            let message = format!("not a study directory, nor a file of `armid identify`: {}", folder.display());
            let help = "`armid identify LOG -o E.json` writes an estimate, `armid study STUDY -o DIR` a study";
            return Err(Error::new(message).help(help).into());
        }
        if arguments.robot.is_some() {
            let message =
                format!("{} is of a study, which holds its robot: --robot is for estimates", folder.display());
            return Err(Error::new(message).into());
        }
        let output = |name: &str| match console.output() {
            Some(output) if arguments.folders.len() > 1 => output.join(name),
            Some(output) => output.to_path_buf(),
            None => folder.join("report"),
        };
        if let Some(summary) = read_robots(folder)? {
            pages.push(write_robots_report(&output(&summary.name), &summary, sheet)?);
            continue;
        }
        let input = read_study(folder)?;
        pages.push(write_report(&output(&input.result.plan.name), &input, sheet)?);
    }
    let lines: Vec<String> = pages.iter().map(|page: &PathBuf| page.display().to_string()).collect();
    console.show(&Answer { text: lines.join("\n") + "\n", json: json!({ "pages": lines }) })?;
    Ok(Ending::Done)
}

/// The numbers of a figure: of each study, or as a figure has left them in a file.
fn numbers<T: DeserializeOwned>(
    paths: &[PathBuf],
    figure: &str,
    of: impl Fn(&StudyResult) -> Vec<T>,
) -> std::result::Result<Vec<T>, Error> {
    let mut all = Vec::new();
    for path in paths {
        all.extend(if path.is_dir() { of(&read_study(path)?.result) } else { read_figure_numbers(path, figure)? });
    }
    Ok(all)
}

fn comparison_text(ComparisonAnswer { page, labels: [first, second], comparison }: &ComparisonAnswer) -> String {
    format!(
        "{}: {first} and {second}: {} parameters, {:.0} % differ by more than 1.96 standard deviations (noise alone: 5 %), RMS {:.2}\n  {}\n",
        comparison.robot,
        comparison.parameters.len(),
        100.0 * comparison.beyond,
        comparison.rms_difference_std,
        page.display()
    )
}
