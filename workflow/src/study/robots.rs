//! A study on several robots: one study after the other, and all side by side.

use armid::observer::Observer;
use armid::study::{RobotsSummary, StudyPlan, StudyResult};
use armid_io::Error;
use armid_io::study::{check_robots_output, read_study, write_robots};

use super::answer::{RobotsAnswer, StudyAnswer};
use super::part::Part;
use super::prepared::PreparedStudy;
use super::settings::StudySettings;
use crate::report::{Sheet, write_robots_report};

/// Performs the study on each robot in a folder of its own, and sums up what they say. A robot whose study is stored there is
/// not performed again where the study is resumed.
pub(super) fn perform(
    plans: &[StudyPlan],
    settings: &StudySettings,
    observer: &dyn Observer,
) -> Result<StudyAnswer, Error> {
    let output = &settings.output;
    check_robots_output(output, plans)?;
    // What cannot be prepared for the last robot is found before the first is performed.
    let studies = plans
        .iter()
        .map(|plan| {
            let prepared = PreparedStudy::new(plan.clone(), settings.beside.as_deref(), &settings.own)?;
            Ok((prepared, output.join(plan.robot_folder())))
        })
        .collect::<Result<Vec<_>, Error>>()?;
    for (prepared, folder) in &studies {
        prepared.check_output(folder)?;
    }
    let mut without_result = Vec::new();
    for (prepared, folder) in &studies {
        let study = prepared.performance(folder, Part::default(), observer);
        let robot = &study.setup.plan.robot;
        if settings.resume && study.is_stored() {
            observer.note(&format!("{robot} is complete in {}", folder.display()));
            continue;
        }
        observer.note(&format!("{robot}, into {}", folder.display()));
        let mut work = study.no_work()?;
        study.begin(&mut work, settings.resume)?;
        match study.perform(work)? {
            Some(performed) => {
                if !study.sum_up(performed)?.is_positive() {
                    without_result.push(robot.clone());
                }
            }
            None => return Ok(StudyAnswer::Interrupted { folder: output.clone() }),
        }
    }
    let stored = studies.iter().map(|(_, folder)| Ok(read_study(folder)?.result));
    let summary = RobotsSummary::from_results(&stored.collect::<Result<Vec<StudyResult>, Error>>()?);
    write_robots(output, &summary)?;
    let report = write_robots_report(&output.join("report"), &summary, Sheet::Screen)?;
    Ok(StudyAnswer::OnRobots(Box::new(RobotsAnswer { summary, report, without_result })))
}
