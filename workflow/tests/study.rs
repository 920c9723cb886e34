//! A study that an observer ends goes on where it was, and its results are those of one that was never ended.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use armid::observer::{Progress, Unobserved, Work};
use armid::study::OwnMethods;
use armid_io::study::load_plans;
use armid_workflow::study::{StudyAnswer, StudySettings, perform};

const PLAN: &str = r#"
name = "tiny"
question = "Does it go on where it was ended?"
robot = "planar-2r"
seed = 3
runs = 12

[experiment]
period_s = 2.0
harmonics = 3
rate_hz = 1000.0
periods = 3
discarded_periods = 1

[identification]
columns = "rigid"
derivatives = "fourier"
samples_per_period = 200
estimators = ["ols"]

[validation]
trajectories = 2
samples = 50

[reference]
mass_kg = 0.1
first_moment_kg_m = 0.02
inertia_kg_m2 = 0.01
viscous_nm_s_rad = 0.1
torque_nm = 0.1

[[design]]
name = "random"
making = "random"
criterion = "condition"
starts = 2
evaluations = 5

[[design]]
name = "condition"
making = "optimised"
criterion = "condition"
starts = 2
evaluations = 20
"#;

/// Every file of a study but those that hold wall times and dates.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_file() && !["timing.parquet", "provenance.json"].contains(&name.as_str()) {
            found.insert(name, std::fs::read(&path).unwrap());
        }
    }
    found
}

#[test]
fn identity_a_study_that_was_ended_goes_on_to_the_same_results() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("study.toml");
    std::fs::write(&file, PLAN).unwrap();
    let (plans, _) = load_plans(file.to_str().unwrap(), &["analytic"], &OwnMethods::default()).unwrap();
    let into = |name: &str| StudySettings { output: folder.path().join(name), threads: 2, ..StudySettings::default() };

    let StudyAnswer::Whole(whole) = perform(&plans, &into("whole"), &Unobserved).unwrap() else { panic!("whole") };
    assert!(whole.is_positive() && (whole.runs, whole.failed) == (48, 0), "{} {}", whole.runs, whole.failed);

    let ended = |work: Work, at: usize| {
        move |progress: Progress| {
            let is_there = progress.work == work && progress.done >= at;
            if is_there { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    };
    let settings = StudySettings { resume: true, ..into("ended") };
    for (work, at) in [(Work::Designs, 1), (Work::Runs, 9)] {
        let answer = perform(&plans, &settings, &ended(work, at)).unwrap();
        assert!(matches!(answer, StudyAnswer::Interrupted { .. }), "{work:?}");
        assert!(!settings.output.join("summary.json").exists());
    }
    let StudyAnswer::Whole(resumed) = perform(&plans, &settings, &Unobserved).unwrap() else { panic!("resumed") };
    assert_eq!(resumed.result, whole.result);
    assert_eq!(results(&settings.output), results(&folder.path().join("whole")));
}
