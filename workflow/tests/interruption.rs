//! What an observer ends returns its last iterate, and does hardly any more work: bounded by what is reported after the end was
//! asked for and by how much work lies between two reports, never by time.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::ops::ControlFlow;
use std::sync::Mutex;

use armid::estimation::{EstimatorKind, Termination, candidate_terms};
use armid::excitation::CriterionKind;
use armid::experiment::ExperimentPlan;
use armid::model::{Columns, EffortInterface};
use armid::observer::{Observer, Progress, Unobserved, Work};
use armid_io::inputs::RobotSource;
use armid_io::log::{ArrayTime, LogArrays};
use armid_io::{ErrorKind, Inputs, LoadedRobot, Log, LogSettings, ProcessedLog, robot};
use armid_workflow::design::{DesignGoal, DesignSettings, design};
use armid_workflow::export::{Exchange, ExportSettings, export};
use armid_workflow::identification::{IdentifySettings, identify};
use armid_workflow::report::EstimatePage;
use armid_workflow::{PayloadSide, SimulationSettings, simulate, validate};

/// Ends the work at so many reports, and keeps all of them.
struct EndAt {
    reports: usize,
    seen: Mutex<Vec<Progress>>,
}

impl EndAt {
    fn new(reports: usize) -> Self {
        Self { reports, seen: Mutex::new(Vec::new()) }
    }

    /// Reports after the one that was answered by an end.
    fn late(&self) -> usize {
        self.seen.lock().unwrap().len().saturating_sub(self.reports + 1)
    }

    /// Evaluations of a design that were reported last.
    fn evaluations(&self) -> usize {
        let seen = self.seen.lock().unwrap();
        seen.iter().rfind(|of| of.work == Work::Evaluations).map_or(0, |of| of.done)
    }

    /// The most samples of a simulation between two reports.
    fn widest_gap(&self) -> usize {
        let seen = self.seen.lock().unwrap();
        let pairs = seen.windows(2).filter(|pair| pair.iter().all(|of| of.work == Work::Samples));
        pairs.map(|pair| pair[1].done.saturating_sub(pair[0].done)).max().unwrap_or(0)
    }
}

impl Observer for EndAt {
    fn observe(&self, progress: Progress) -> ControlFlow<()> {
        let mut seen = self.seen.lock().unwrap();
        seen.push(progress);
        if seen.len() > self.reports { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn designed(loaded: &LoadedRobot, observer: &dyn Observer) -> armid_workflow::design::DesignAnswer {
    let goal = DesignGoal::Arm(CriterionKind::DOptimal.into());
    let settings = DesignSettings { starts: 1, evaluations: 60, baseline: false, ..DesignSettings::new(goal) };
    design(loaded, &settings, observer).unwrap().unwrap()
}

fn log(loaded: &LoadedRobot) -> ProcessedLog {
    // Estimators that simulate perform the whole plan at every step.
    let plan = ExperimentPlan { periods: 2, ..ExperimentPlan::new(designed(loaded, &Unobserved).best.trajectory) };
    let simulated = simulate(loaded, &plan, &SimulationSettings::default(), &Unobserved).unwrap();
    simulated.log().process(loaded.clone(), &LogSettings::default()).unwrap()
}

#[test]
fn identity_work_that_is_ended_returns_its_last_iterate_and_stops_there() {
    let loaded = robot::find("planar-2r").unwrap();
    let observer = EndAt::new(5);
    let ended = designed(&loaded, &observer);
    // At most the one evaluation that brings the best iterate inside the limits.
    let (evaluations, asked) = (ended.best.evaluations, observer.evaluations());
    assert!(ended.interrupted && evaluations <= asked + 1, "{evaluations} evaluations, {asked} when the end was asked");
    assert!(observer.late() <= 2, "{} reports after the end", observer.late());

    let log = log(&loaded);
    let by = |estimators: Vec<EstimatorKind>| IdentifySettings { estimators, ..IdentifySettings::default() };
    let all = [EstimatorKind::Cloe, EstimatorKind::Clie, EstimatorKind::Didim, EstimatorKind::Iv];
    for estimator in all.into_iter().chain([EstimatorKind::IrlsTukey, EstimatorKind::Mm, EstimatorKind::Ekf]) {
        let whole = EndAt::new(usize::MAX);
        let complete = identify(log.clone(), None, &by(vec![estimator]), &whole).unwrap();
        assert!(!complete.interrupted && whole.widest_gap() <= 10, "{}", estimator.name());
        let reports = whole.seen.lock().unwrap().len();
        assert!(reports > 2, "{} reports {reports} times", estimator.name());
        for at in [0, reports / 2] {
            let observer = EndAt::new(at);
            let answer = identify(log.clone(), None, &by(vec![estimator]), &observer).unwrap();
            let estimate = &answer.estimates[0].estimate;
            assert!(answer.interrupted, "{} at {at}: {:?}", estimator.name(), estimate.termination);
            assert!(estimate.base.iter().all(|parameter| parameter.value.is_finite()), "{}", estimator.name());
            // Each part of an estimator asks once more before it returns.
            assert!(observer.late() <= 8, "{} goes on for {} reports", estimator.name(), observer.late());
        }
    }
    // One that had not begun is the weighted fit, and those before it are whole.
    let answer =
        identify(log.clone(), None, &by(vec![EstimatorKind::Wls, EstimatorKind::Cloe]), &EndAt::new(0)).unwrap();
    let [first, second] = &answer.estimates[..] else { panic!("two estimates") };
    assert_eq!(first.estimate.termination, Termination::Direct);
    assert_eq!(second.estimate.termination, Termination::Interrupted { iterations: 0 });
    assert_eq!(first.estimate.beta(), second.estimate.beta());

    // A selection has no iterate to return.
    let among = candidate_terms().into_iter().fold(Columns::RIGID, Columns::with_term);
    let select = IdentifySettings { select: Some(among), ..IdentifySettings::default() };
    for at in [0, 3] {
        let observer = EndAt::new(at);
        let error = identify(log.clone(), None, &select, &observer).unwrap_err();
        assert!(error.kind() == ErrorKind::Interrupted && observer.late() <= 1, "{error}, {}", observer.late());
    }
}

/// The log as another tool would write it, without periods.
fn foreign(log: &ProcessedLog) -> ProcessedLog {
    let samples = &log.samples;
    let arrays = LogArrays {
        name: "foreign".to_owned(),
        joints: None,
        dof: samples.dof(),
        time: ArrayTime::Rate(samples.rate_hz),
        q: samples.states.q.clone(),
        qd: None,
        link_q: None,
        effort: samples.tau.clone(),
        servo: None,
        effort_unit: Some(EffortInterface::Torque),
    };
    Log::from_arrays(arrays).unwrap().process(log.robot.clone(), &LogSettings::default()).unwrap()
}

/// Ends the work at its first reports, and holds that it then has no result and goes on for no other.
fn has_no_result<T>(what: &str, ends: usize, work: impl Fn(&dyn Observer) -> Result<T, armid_io::Error>) {
    assert!(work(&Unobserved).is_ok(), "{what}");
    for at in 0..ends {
        let observer = EndAt::new(at);
        let Err(error) = work(&observer) else { panic!("{what} at {at}") };
        assert!(error.kind() == ErrorKind::Interrupted && observer.late() == 0, "{what} at {at}: {error}");
    }
}

#[test]
fn identity_what_has_no_iterate_to_return_ends_with_an_error() {
    let loaded = robot::find("planar-2r").unwrap();
    let log = log(&loaded);
    let inputs = Inputs {
        robot: RobotSource { name: None, sha256: String::new(), base_link: None, tip_link: None },
        logs: Vec::new(),
        held_out_log: None,
        files: Vec::new(),
        mapping: None,
        rate_hz: None,
        settings: LogSettings::default(),
    };
    let answer = identify(log.clone(), None, &IdentifySettings::default(), &Unobserved).unwrap();
    let (estimate, name) = (&answer.estimates[0].estimate, "the estimate");
    let settings = ExportSettings { format: Exchange::Mjcf, into: None, file: None };
    has_no_result("the fit of a model", 4, |observer| export(estimate, name, log.clone(), &settings, observer));
    let estimates = std::slice::from_ref(estimate);
    has_no_result("a validation", 2, |observer| validate(estimates, name, &log, [None; 2], 0.1, observer));
    has_no_result("a page", 3, |observer| EstimatePage::of_log(estimate, name, &log, inputs.clone(), observer));
    // The onset of friction is looked for in logs without periods.
    let foreign = foreign(&log);
    assert!(foreign.has_no_periods());
    has_no_result("the log of a load", 2, |observer| {
        let (columns, estimator) = (Columns::RIGID_ROTOR_FRICTION, EstimatorKind::Wls);
        PayloadSide::of_log(&mut foreign.clone(), None, columns, estimator, None, observer)
    });
}

#[test]
fn identity_a_simulation_that_is_ended_keeps_its_samples() {
    let loaded = robot::find("planar-2r").unwrap();
    let plan = ExperimentPlan::new(designed(&loaded, &Unobserved).best.trajectory);
    let observer = EndAt::new(20);
    let ended = simulate(&loaded, &plan, &SimulationSettings::default(), &observer).unwrap();
    assert!(!ended.ending.is_complete());
    // The arm comes to rest, which the observer sees too.
    let whole = EndAt::new(usize::MAX);
    simulate(&loaded, &plan, &SimulationSettings::default(), &whole).unwrap();
    let (of_ended, of_whole) = (observer.seen.lock().unwrap().len(), whole.seen.lock().unwrap().len());
    assert!(of_ended < of_whole, "{of_ended} of {of_whole} reports");
}
