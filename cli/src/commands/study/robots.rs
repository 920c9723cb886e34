//! `armid study` of a plan with several robots: one study after the other, and all side by side.

use std::path::Path;

use armid::study::{RobotsSummary, StudyPlan, StudyResult};
use armid_io::Error;
use armid_io::study::{check_robots_output, read_study, write_robots};
use miette::Result;

use crate::answers::robots as robots_answer;
use crate::study::{Part, Performance, Prepared, write_robots_report};
use crate::terminal::{Console, Ending};

/// Performs the study on each robot in a folder of its own, and sums up what they say. A robot whose study is stored there is
/// not performed again by `--resume`.
pub(super) fn perform(
    plans: &[StudyPlan],
    beside: Option<&Path>,
    (output, resume): (&Path, bool),
    console: &Console,
) -> Result<Ending> {
    check_robots_output(output, plans)?;
    // What cannot be prepared for the last robot is found before the first is performed.
    let studies = plans
        .iter()
        .map(|plan| Ok((Prepared::new(plan.clone(), beside)?, output.join(plan.robot_folder()))))
        .collect::<Result<Vec<_>>>()?;
    for (prepared, folder) in &studies {
        prepared.performance(folder, Part::default(), console).check_output()?;
    }
    let mut ending = Ending::Done;
    for (prepared, folder) in &studies {
        let study = prepared.performance(folder, Part::default(), console);
        let robot = &study.plan().robot;
        if resume && study.is_stored() {
            console.note(format!("{robot} is complete in {}", folder.display()));
            continue;
        }
        console.note(format!("{robot}, into {}", folder.display()));
        match perform_one(&study, resume, console)? {
            Ending::Done => {}
            Ending::Negative => ending = Ending::Negative,
            stopped @ (Ending::Interrupted | Ending::NotConfirmed) => {
                console.note(format!("interrupted; go on with --resume -o {}", output.display()));
                return Ok(stopped);
            }
        }
    }
    let stored = studies.iter().map(|(_, folder)| Ok(read_study(folder)?.result));
    let summary = RobotsSummary::of(&stored.collect::<Result<Vec<StudyResult>, Error>>()?);
    write_robots(output, &summary)?;
    let page = write_robots_report(&output.join("report"), &summary)?;
    console.show(&robots_answer::answer(&summary, &page)?)?;
    Ok(ending)
}

/// The whole study on one robot.
fn perform_one(study: &Performance<'_>, resume: bool, console: &Console) -> Result<Ending> {
    let mut work = study.no_work()?;
    study.begin(&mut work, resume)?;
    if let Some(note) = work.note() {
        console.note(note);
    }
    match study.perform(work)? {
        Some(performed) => Ok(study.sum_up(performed)?.0),
        None => Ok(Ending::Interrupted),
    }
}
