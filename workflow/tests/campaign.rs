//! A campaign on a simulated arm: it ends where its targets are met, or says what keeps them out of reach, and goes on after any end.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::collections::BTreeMap;
use std::path::Path;

use armid::experiment::{Arm, Replay};
use armid::model::format::ChainEnds;
use armid::observer::Unobserved;
use armid::signal::{Processing, TorqueFilter};
use armid_io::estimate::read;
use armid_io::recording::{FileSink, McapSink};
use armid_io::{LogSettings, experiment};
use armid_workflow::campaign::{Campaign, CampaignAnswer, CampaignSettings, Outcome, Step, experiment_table};
use armid_workflow::{LogSource, SimulationSettings, simulate};
use toml::Value;

/// A campaign whose rounds take little work.
fn settings(until: &[&str]) -> CampaignSettings {
    let mut experiment = experiment_table("planar-2r", &ChainEnds::default()).unwrap();
    experiment.insert("rate_hz".to_owned(), Value::Float(250.0));
    experiment.insert("periods".to_owned(), Value::Integer(3));
    let until = until.iter().map(|target| target.parse().unwrap()).collect();
    let usual = CampaignSettings::new(experiment, until);
    CampaignSettings { most_rounds: 6, period_s: 4.0, starts: 1, evaluations: 40, ..usual }
}

/// A campaign on an arm whose friction grows with its load.
fn with_load_friction(size: f64, target: &str) -> CampaignSettings {
    let mut wanted = settings(&[target]);
    let effects = [("load-friction".to_owned(), Value::Float(size))].into_iter().collect();
    wanted.experiment.insert("effects".to_owned(), Value::Table(effects));
    wanted
}

/// Performs the next round; `false` where there is none.
fn perform(campaign: &mut Campaign) -> bool {
    let Step::Perform(round) = campaign.next(&Unobserved).unwrap() else { return false };
    let planned = experiment::load(round.experiment().to_str().unwrap()).unwrap();
    let (effects, sensing) = (planned.effects, planned.sensing);
    let arm =
        SimulationSettings { effects, sensing, seed: planned.seed, run: planned.run, ..SimulationSettings::default() };
    let simulated = simulate(&planned.robot, &planned.plan, &arm, &Unobserved).unwrap();
    let mut sink = Box::new(McapSink::new(&round.recording(), BTreeMap::new(), |_| {}));
    let ending = Replay(simulated.recording).perform(&planned.plan, &mut *sink).unwrap();
    let log = sink.finish(&ending, BTreeMap::new()).unwrap();
    let processing = Processing { torque_filter: campaign.settings().torque_filter, ..Processing::default() };
    let read = LogSettings { processing, ..LogSettings::default() };
    let (log, inputs) = LogSource::default().find(&[log], None).unwrap().process(read).unwrap();
    campaign.take(log, &inputs, &Unobserved).unwrap();
    true
}

fn whole(settings: CampaignSettings, folder: &Path) -> CampaignAnswer {
    let mut campaign = Campaign::begin(settings, folder).unwrap();
    while perform(&mut campaign) {}
    campaign.answer().unwrap()
}

/// Every file below a folder with its bytes.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push((path.display().to_string(), std::fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

/// The first takes a few rounds. Encoder counts, which repeat with the motion, hold torque at some 0.7 % of some motions.
const REACHED: [&str; 2] = ["Fc2 <= 4 %", "torque <= 1 %"];

#[test]
fn identity_a_campaign_that_is_ended_after_every_step_has_the_bytes_of_one_in_a_piece() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("campaign");
    let wanted = || CampaignSettings { seed: 3, ..settings(&REACHED) };
    let answer = whole(wanted(), &place);
    assert_eq!(answer.outcome, Outcome::Reached, "{answer:#?}");
    assert!(answer.rounds.len() >= 2 && answer.met == [true, true]);
    let last = answer.rounds.last().unwrap();
    assert_eq!(last.total_s, answer.rounds.iter().map(|round| round.seconds).sum::<f64>());
    // Information adds up: intervals become narrower.
    for pair in answer.rounds.windows(2).filter(|pair| pair[1].widened_by == 1.0) {
        assert!(pair[1].widths[0].half_width < pair[0].widths[0].half_width, "{pair:?}");
    }
    let bytes = files(&place);
    std::fs::remove_dir_all(&place).unwrap();

    Campaign::begin(wanted(), &place).unwrap();
    let open = || Campaign::of_folder(&place).unwrap().unwrap();
    // A motion without its experiment, and an experiment without its log.
    open().next(&Unobserved).unwrap();
    std::fs::remove_file(place.join("rounds/01/experiment.toml")).unwrap();
    while perform(&mut open()) {}
    assert_eq!(open().answer().unwrap(), answer);
    assert!(files(&place) == bytes);
}

#[test]
fn errors_of_the_model_keep_a_target_out_of_reach_and_have_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let wanted = CampaignSettings { adds_terms: false, ..with_load_friction(0.1, "torque <= 0.2 %") };
    let answer = whole(wanted, folder.path());
    assert_eq!(answer.outcome, Outcome::ModelError, "{answer:#?}");
    assert_eq!(answer.obstacles.len(), 1);
    assert!(answer.obstacles[0].effect.contains("load friction"), "{:?}", answer.obstacles);
    assert!(answer.added_terms.is_empty());
}

#[test]
fn a_term_that_the_logs_show_joins_the_model_of_all_rounds_after_a_kill_too() {
    let folder = tempfile::tempdir().unwrap();
    let mut wanted = with_load_friction(0.05, "torque <= 0.9 %");
    wanted.experiment.insert("ramp_s".to_owned(), Value::Float(0.75));
    let mut campaign = Campaign::begin(wanted, folder.path()).unwrap();
    assert!(perform(&mut campaign) && perform(&mut campaign));
    let motion = std::fs::read_to_string(folder.path().join("rounds/02/trajectory.toml")).unwrap();
    assert!(motion.contains("ramp_s = 0.75"), "limits hold on the ramps of the experiment: {motion}");
    let names = ["01/together.json", "01/E.json", "02/together.json", "02/E.json"];
    let places = names.map(|name| folder.path().join("rounds").join(name));
    let without = places.each_ref().map(|place| std::fs::read(place).unwrap());
    while perform(&mut campaign) {}
    let answer = campaign.answer().unwrap();
    assert_eq!(answer.outcome, Outcome::Reached, "{answer:#?}");
    assert!(answer.added_terms.contains(&"load".to_owned()), "{:?}", answer.added_terms);
    for round in 1..=answer.rounds.len() {
        let estimate = read(&folder.path().join(format!("rounds/{round:02}/E.json"))).unwrap();
        assert!(estimate.columns.contains("load") && estimate.names().contains(&"Fl1".to_owned()));
    }

    // As if it had been killed when the columns were written and no estimate was, and when only the first round was.
    let bytes = files(folder.path());
    for stale in [0, 2] {
        for (place, without) in places.iter().zip(&without).skip(stale) {
            std::fs::write(place, without).unwrap();
        }
        assert!(files(folder.path()) != bytes);
        assert_eq!(Campaign::of_folder(folder.path()).unwrap().unwrap().answer().unwrap(), answer);
        assert!(files(folder.path()) == bytes);
    }
}

#[test]
fn a_narrow_band_of_positions_is_no_error_of_the_model_where_torque_has_it_too() {
    let folder = tempfile::tempdir().unwrap();
    // Counts of this arm's encoders hide the accelerations where friction reverses, and its currents show them.
    let mut wanted = settings(&["mcx2 <= 0.05"]);
    wanted.experiment = experiment_table("puma-560", &ChainEnds::default()).unwrap();
    wanted.experiment.insert("rate_hz".to_owned(), Value::Float(500.0));
    wanted.experiment.insert("periods".to_owned(), Value::Integer(4));
    let exact = ["encoders", "converters"].map(|name| (name.to_owned(), Value::Boolean(false)));
    wanted.experiment.insert("sensing".to_owned(), Value::Table(exact.into_iter().collect()));
    let columns = "rigid+rotor+friction".to_owned();
    let torque_filter = TorqueFilter::SameAsPositions;
    let wanted = CampaignSettings {
        columns,
        torque_filter,
        adds_terms: false,
        period_s: 10.0,
        evaluations: 60,
        // Of eight seeds one ends with a finding, by p = 0.001.
        seed: 3,
        ..wanted
    };
    let answer = whole(wanted, folder.path());
    assert_eq!(answer.outcome, Outcome::Reached, "{answer:#?}");
}

#[test]
fn what_a_campaign_cannot_be_asked_for_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |settings: CampaignSettings| Campaign::begin(settings, folder.path()).unwrap_err().to_string();
    assert!(refused(settings(&[])).contains("no target"));
    assert!(refused(settings(&["Fc9 <= 1 %"])).contains("\"Fc9\" is no base parameter"));
    assert!(refused(settings(&["payload.mass <= 1 %"])).contains("without it"));
    let none = CampaignSettings { most_rounds: 0, ..settings(&REACHED) };
    assert!(refused(none).contains("number of rounds is 0"));
    assert!(refused(CampaignSettings { first_speed: 1.5, ..settings(&REACHED) }).contains("speed of the first round"));
    // Nothing was written so far.
    assert!(Campaign::of_folder(folder.path()).unwrap().is_none());
    Campaign::begin(settings(&REACHED), folder.path()).unwrap();
    assert!(refused(settings(&REACHED[..1])).contains("of another campaign"));
}
