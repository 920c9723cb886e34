//! `armid doctor`

use std::time::Duration;

use armid::model::bundled;
use armid_hardware::link::{LinkSettings, peers};
use armid_io::bundled_experiments;
use armid_sim::{Engine, MujocoStatus};
use miette::Result;
use serde_json::json;

use crate::arms::ArmKind;
use crate::terminal::{Answer, Console, Ending, Table};

const AFTER_HELP: &str = "\
Example:
  armid doctor --json";

/// Check the environment: engines, MuJoCo, ROS 2
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// ROS domain in which to listen for peers
    #[arg(long, value_name = "ID", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=232))]
    domain: u16,
}

/// How long to listen for ROS 2 peers: they announce themselves anew within a second of our announcement.
const LISTEN: Duration = Duration::from_millis(1200);

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let link = LinkSettings { domain: arguments.domain, ..LinkSettings::default() };
    let (topics, found) = match peers(&link, LISTEN) {
        Ok(topics) if topics.is_empty() => (topics, format!("none in domain {} on this machine", link.domain)),
        Ok(topics) => {
            let list = topics.join(", ");
            (topics, format!("in domain {}: {list}", link.domain))
        }
        Err(error) => (Vec::new(), error.to_string()),
    };
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let simd = vector_units();
    let mujoco = MujocoStatus::now();
    let engines = engines(&mujoco);
    let arms = ArmKind::ALL.map(ArmKind::name);
    let robots: Vec<&str> = bundled().iter().map(|entry| entry.name).collect();
    let experiments = bundled_experiments::names("experiment.toml");
    let studies = bundled_experiments::names("study.toml");
    let platform = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    let none = |list: String| if list.is_empty() { "none".to_owned() } else { list };
    let mut table = Table::of(concat!("armid | ", env!("CARGO_PKG_VERSION")));
    for (name, value) in [
        ("platform", platform.clone()),
        ("cores", cores.to_string()),
        ("vector units", none(simd.join(", "))),
        ("arms", arms.join(", ")),
        ("engines", engines.join(", ")),
        ("MuJoCo", in_words(&mujoco)),
        ("robots", robots.join(", ")),
        ("experiments", none(experiments.join(", "))),
        ("studies", none(studies.join(", "))),
        ("ROS 2 peers", found.clone()),
    ] {
        table.row([name.to_owned(), value]);
    }
    let json = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "platform": platform,
        "cores": cores,
        "simd": simd,
        "arms": arms,
        "engines": engines,
        "mujoco": as_json(&mujoco),
        "robots": robots,
        "experiments": experiments,
        "studies": studies,
        "ros2": json!({ "domain": link.domain, "topics": topics, "in_words": found }),
    });
    console.answer(&Answer { text: table.render(0), json })?;
    Ok(Ending::Done)
}

/// The engines that can simulate here.
fn engines(mujoco: &MujocoStatus) -> Vec<&'static str> {
    let here = |engine: &Engine| *engine != Engine::Mujoco || matches!(mujoco, MujocoStatus::Found { .. });
    Engine::ALL.into_iter().filter(here).map(Engine::name).collect()
}

fn in_words(status: &MujocoStatus) -> String {
    match status {
        MujocoStatus::Found { path, version } => format!("{version}, {}", path.display()),
        MujocoStatus::Missing { reason } => reason.to_string(),
    }
}

fn as_json(status: &MujocoStatus) -> serde_json::Value {
    match status {
        MujocoStatus::Found { path, version } => json!({ "version": version, "library": path.display().to_string() }),
        MujocoStatus::Missing { reason } => json!({ "missing": reason.to_string() }),
    }
}

/// Vector instructions of this processor.
fn vector_units() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    let found = [
        ("sse4.2", is_x86_feature_detected!("sse4.2")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ];
    #[cfg(target_arch = "aarch64")]
    let found = [("neon", true)];
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let found: [(&'static str, bool); 0] = [];
    found.into_iter().filter(|(_, there)| *there).map(|(name, _)| name).collect()
}
