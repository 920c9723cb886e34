//! Every decoder that bytes from outside reach, one function per kind of file: what the fuzz targets call.
//!
//! A decoder may refuse anything and must never panic, hang or ask for more memory than its input explains. Where it
//! accepts, writing what it read and reading that again must give the same.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use armid::estimation::compare;
use armid::model::format::{
    ChainEnds, FormatError, ImportedModel, embed_urdf, parse_mjcf, parse_nominal, parse_parameter_map,
    parse_parameters, parse_robot, parse_robot_model, parse_urdf, write_robot, write_urdf,
};
use armid::model::{Hull, Robot, bundled};
use armid::spatial::Inertia;
use armid::study::{StudyPlan, StudySetup};
use armid::trajectory::PeriodicTrajectory;
use armid_cdr::{FloatArray, JointState, decode, encode};
use armid_hardware::message::{
    Float64MultiArray, FollowFeedback, FollowGoal, FollowResult, JointState as WireState, JointTrajectory, Text as Word,
};
use armid_io::log::{parse_csv, parse_mcap};
use armid_io::study::{LineChain, Piece, parse_journal, parse_study};
use armid_io::table::{Third, parse_states};
use armid_io::{Log, Text, estimate, experiment};
use armid_reports::study_document;

/// CDR: the ROS 2 messages of recordings and of the wire.
///
/// # Panics
/// Where a message that was read is not the same after writing and reading: a fault that fuzzing looks for.
pub fn cdr(bytes: &[u8]) {
    let _ = FloatArray::decode(bytes);
    if let Ok(state) = JointState::decode(bytes) {
        let written = state.encode().expect("what was read has lists that can be written");
        let again = JointState::decode(&written).and_then(|state| state.encode());
        assert_eq!(again.as_deref(), Ok(written.as_slice()), "a message changes when it is written and read");
    }
    // Bytes, not messages, are compared: a number that is none equals nothing.
    macro_rules! there_and_back {
        ($($message:ty),*) => {$(
            if let Ok(message) = decode::<$message>(bytes) {
                let written = encode(&message).expect("what was read has lists that can be written");
                let again = decode::<$message>(&written).and_then(|message| encode(&message));
                assert_eq!(again, Ok(written), "a message changes when it is written and read");
            }
        )*};
    }
    there_and_back!(WireState, JointTrajectory, FollowGoal, FollowFeedback, FollowResult, Float64MultiArray, Word);
}

/// MCAP: a recording, cut off or not, and the robot that it holds.
pub fn mcap(bytes: &[u8]) {
    if let Ok(log) = parse_mcap(Path::new("fuzz.mcap.part"), bytes)
        && log.robot.is_some()
    {
        let _ = log.robot();
    }
}

/// SQLite: a bag of ROS 2, as a file, since SQLite reads nothing else.
///
/// # Panics
/// Where the file cannot be written.
pub fn sqlite(bytes: &[u8]) {
    static PATH: LazyLock<PathBuf> =
        LazyLock::new(|| std::env::temp_dir().join(format!("armid-fuzz-{}.db3", std::process::id())));
    std::fs::write(PATH.as_path(), bytes).expect("a temporary file");
    let _ = Log::read(&PATH);
}

/// Tables of other tools that are no text: arrays of NumPy, Parquet, gzip.
///
/// Parquet is left out: panics of the library that decodes it are caught, and libFuzzer ends at every panic.
pub fn table(bytes: &[u8]) {
    if bytes.starts_with(b"PAR1") {
        return;
    }
    let _ = Log::of_table(Path::new("fuzz"), bytes.to_vec());
}

/// TOML: robots, parameters, trajectories, studies, experiments.
///
/// # Panics
/// Where a trajectory that was read is not the same after writing and reading: a fault that fuzzing looks for.
pub fn toml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let robot = robot();
    let _ = parse_robot(text);
    let _ = parse_parameters(text, &robot, true);
    let _ = parse_nominal(text, &robot);
    let _ = parse_parameter_map(text, &robot);
    let _ = StudyPlan::from_toml(text);
    let _ = experiment::parse(Text::new("fuzz.toml", text), None);
    if let Ok(trajectory) = PeriodicTrajectory::from_toml(text) {
        let again = PeriodicTrajectory::from_toml(&trajectory.to_toml());
        assert_eq!(again.ok(), Some(trajectory), "a trajectory changes when it is written and read");
    }
}

/// CSV: recordings and states.
pub fn csv(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = parse_csv(Text::new("fuzz.csv", text));
    for third in [Third::Acceleration, Third::Effort] {
        let _ = parse_states(Text::new("fuzz.csv", text), 2, third);
    }
}

/// URDF: the chain of a robot.
///
/// # Panics
/// A panic where what was read is not what was written.
pub fn urdf(bytes: &[u8]) {
    tree(bytes, parse_urdf);
    let ends = ChainEnds::default();
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(model) = parse_urdf(text, &ends) else { return };
    // The robot file that begins from it is one, and says the same.
    let file = embed_urdf(&write_robot(&model, "arm.urdf", &ends), text);
    let read = parse_robot_model(&file).expect("a robot file over a URDF that can be read");
    assert_eq!(read.parameters, Some(model.parameters), "parameters change on the way through a robot file");
}

/// Meshes: STL, OBJ and COLLADA, and the hull of their points.
///
/// # Panics
/// Where the hull leaves a point out: a fault that fuzzing looks for.
pub fn mesh(bytes: &[u8]) {
    for ending in ["stl", "obj", "dae"] {
        let Ok(points) = armid_io::mesh::parse(ending, bytes) else { continue };
        // Beyond any arm, distances have no digits left.
        if points.len() > 1000 || points.iter().flatten().any(|x| x.abs() > 1e3) {
            continue;
        }
        let hull = Hull::enclosing(&points).expect("there are points");
        for axis in 0..3 {
            let along = |p: &[f64]| p[axis];
            let furthest = points.iter().map(|p| along(p.as_slice())).fold(f64::NEG_INFINITY, f64::max);
            let reach = hull.points.iter().map(|p| along(p.as_slice())).fold(f64::NEG_INFINITY, f64::max);
            assert!(furthest <= reach + hull.margin + 1e-9, "a point of a {ending} lies outside its hull");
        }
    }
}

/// MJCF: the chain of a robot.
///
/// # Panics
/// A panic where what was read is not what was written.
pub fn mjcf(bytes: &[u8]) {
    tree(bytes, parse_mjcf);
}

/// A chain of a tree, of the longest and of every tip that the text names where it is asked for one.
///
/// # Panics
/// Where what was read cannot be written as URDF and read again with as many joints: a fault that fuzzing looks for.
fn tree(bytes: &[u8], parse: fn(&str, &ChainEnds) -> Result<ImportedModel, FormatError>) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(model) = parse(text, &ChainEnds::default()) else { return };
    // URDF states centres of mass, which a mass of next to nothing puts beyond all numbers.
    let beyond = |link: &Inertia| link.about_com().iter().chain(link.com().iter().flatten()).any(|x| !x.is_finite());
    if model.parameters.links.iter().any(beyond) {
        return;
    }
    let written = write_urdf(&model.robot, &model.parameters, "fuzz");
    let again = parse_urdf(&written, &ChainEnds::default()).map(|again| again.robot.dof());
    assert_eq!(again, Ok(model.robot.dof()), "a chain changes when it is written and read: {written}");
}

/// JSON of estimates: one, or a list.
///
/// # Panics
/// Where an estimate that was read is not the same after writing and reading: a fault that fuzzing looks for.
pub fn estimate(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(estimates) = estimate::parse_all(&Text::new("fuzz.json", text)) else { return };
    for found in estimates {
        let written = serde_json::to_string(&found).expect("an estimate can be written");
        let again = estimate::parse(&Text::new("fuzz.json", written.as_str())).expect("what was written can be read");
        assert_eq!(again, found, "an estimate changes when it is written and read");
        // What designs and comparisons ask of it.
        let _ = (found.beta(), found.std(), found.half_width(), found.information());
        let _ = compare(&found, &found);
    }
}

/// Journals: as bytes, and with checksums that fit, so that what is behind them is reached too.
///
/// # Panics
/// Where a piece that was read is not the same after writing and reading: a fault that fuzzing looks for.
pub fn journal(bytes: &[u8]) {
    let _ = parse_journal("fuzz.jsonl", bytes);
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let mut chain = LineChain::default();
    let header = r#"{"armid":"0","plan_sha256":"0"}"#;
    let lines: String = std::iter::once(header).chain(text.lines()).map(|entry| chain.line(entry)).collect();
    let Ok(pieces) = parse_journal("fuzz.jsonl", lines.as_bytes()) else { return };
    static SETUP: LazyLock<StudySetup> = LazyLock::new(setup);
    for piece in pieces {
        let written = serde_json::to_string(&piece).expect("a piece can be written");
        let again: Piece = serde_json::from_str(&written).expect("what was written can be read");
        assert_eq!(serde_json::to_string(&again).ok(), Some(written), "a piece changes when it is written and read");
        let _ = piece.check(&SETUP);
    }
}

/// The study whose journal is among the seeds.
fn setup() -> StudySetup {
    let plan = StudyPlan::from_toml(STUDY).expect("a plan");
    let loaded = armid_io::robot::find(&plan.robot).expect("a bundled robot");
    let (truth, nominal) = (loaded.truth().expect("its truth"), loaded.nominal.expect("its nominal parameters"));
    StudySetup::new(plan, loaded.robot, nominal, &truth).expect("a study")
}

/// Stored studies: a summary, a byte zero, and examples; what is accepted is drawn.
pub fn summary(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let (summary, examples) = text.split_once('\0').unwrap_or((text, r#"{"limits":[],"prediction":null}"#));
    let texts = (Text::new("summary.json", summary), Text::new("examples.json", examples));
    if let Ok(input) = parse_study(&texts.0, &texts.1)
        && let Ok(document) = study_document(&input)
    {
        let _ = document.html();
    }
}

/// The plan of the small study whose files are seeds.
pub const STUDY: &str = include_str!("../study.toml");

/// The smallest bundled robot, for files that are about one.
fn robot() -> Robot {
    let smallest = bundled().iter().min_by_key(|entry| entry.robot.len()).expect("robots are compiled in");
    parse_robot(smallest.robot).expect("a bundled robot can be read")
}
