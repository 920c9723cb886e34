//! `armid export`

use std::fmt::Write;
use std::path::PathBuf;

use armid::base::{BaseReduction, Method, reduce};
use armid::codegen::Language;
use armid::estimation::{ConsistentSet, Estimate, consistent_set};
use armid::model::{Columns, ParameterId, StandardParameters};
use armid::seed::Seed;
use armid_io::estimate::{self, check_robot};
use armid_io::inputs::RobotSource;
use armid_io::{Error, Inputs, LoadedRobot, Text};
use miette::Result;
use serde_json::{Value, json};

use crate::answers::exchange::{Exchange, Reloaded};
use crate::answers::snapping::Snapping;
use crate::answers::source::SourceAnswer;
use crate::arguments::{ChainArguments, one_of};
use crate::terminal::{Answer, Console, Destination, Ending, number, report_folder};

const AFTER_HELP: &str = "\
Torque identifies base parameters; other tools need the mass, centre of mass and inertia of each link.
The set that is written is physically consistent (positive definite pseudo-inertia, friction above
zero). Of all such sets it agrees best with the estimated base parameters (least chi squared, their
squared Mahalanobis distance); of several that do, it is the nearest to the nominal one. Where chi
squared exceeds the 95 % limit of the joint distribution of all base parameters, no real arm has what
was estimated, and the exit status is 1. It is 1 as well where the search did not converge. The file is
read back, and its torque is compared with that of the regressor. --json gives the standard deviation
of every number that is written.

A robot that came as a URDF is written as that file with other inertias, damping and friction; names,
meshes, comments and formatting stay. URDF has no place for rotor inertia and torque offset, MJCF none
for the offset: the answer says what torque lacks without them. Right angles of a URDF that are written
with few digits stay as they are in the file; the answer says by how much its torque differs for that.

c and rust are source code of inverse dynamics, gravity torque and mass matrix in the base parameters
as estimated, with the operations that they need and no others; it needs a compiler alone, and no set
of all parameters is chosen. Its operations are compared with the regressor times the estimate.

Examples:
  armid export E.json --to urdf -o a460.urdf
  armid export E.json --to c -o a460.c
  armid export E.json --to mjcf --robot arm/robot.toml -o arm.xml
  armid export E.json --to json --json";

/// Write the estimate as a physically consistent model for other tools
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The estimate, a JSON file of `armid identify`
    estimate: PathBuf,
    /// Format of the file
    #[arg(long, value_parser = one_of(&Target::ALL, Target::name))]
    to: Target,
    /// The robot, where it is not the one that the estimate was made with
    #[arg(long)]
    robot: Option<String>,
    #[command(flatten)]
    chain: ChainArguments,
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    /// A model of all parameters.
    Model(Exchange),
    /// Source code in base parameters.
    Source(Language),
}

impl Target {
    const ALL: [Self; 6] = [
        Self::Model(Exchange::Urdf),
        Self::Model(Exchange::Mjcf),
        Self::Model(Exchange::Toml),
        Self::Model(Exchange::Json),
        Self::Source(Language::C),
        Self::Source(Language::Rust),
    ];

    const fn name(self) -> &'static str {
        match self {
            Self::Model(format) => format.name(),
            Self::Source(language) => language.name(),
        }
    }

    /// How its files end.
    const fn extension(self) -> &'static str {
        match self {
            Self::Model(format) => format.extension(),
            Self::Source(language) => language.extension(),
        }
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let text = Text::read(&arguments.estimate)?;
    let estimate = estimate::parse(&text)?;
    let loaded = match Inputs::of_estimate(&text)?.map(|inputs| inputs.robot) {
        // The estimate records which file its robot came from.
        Some(RobotSource { name: Some(name), base_link, tip_link, .. }) if arguments.robot.is_none() => {
            let chain = ChainArguments {
                base_link: arguments.chain.base_link.clone().or(base_link),
                tip_link: arguments.chain.tip_link.clone().or(tip_link),
            };
            chain.load(&name).map_err(|error| error.of_an_estimate(&text.name, "--robot ROBOT says where it is now"))?
        }
        _ => arguments.chain.load(arguments.robot.as_deref().unwrap_or(&estimate.robot))?,
    };
    let searched = estimate.termination.was_successful();
    if !searched {
        console.alarm(&format!("the estimate is not what was sought: its search {}", estimate.termination));
    }
    let destination = destination(&loaded, arguments.to, console)?;
    let base = base_of(&text, &estimate, &loaded)?;
    let format = match arguments.to {
        Target::Model(format) => format,
        Target::Source(language) => {
            let source = SourceAnswer::new(&text.name, &estimate, &base, &loaded, language)?;
            console.deliver(&destination, &source.text)?;
            console.show(&source.answer(&destination))?;
            return Ok(if searched && source.is_sound() { Ending::Done } else { Ending::Negative });
        }
    };
    let set = consistent(&text, &estimate, &base, &loaded)?;
    let (written, remarks) = format.write(&loaded, &set.parameters, &header(&estimate, &set))?;
    let reloaded = Reloaded::compare(format, &written, &loaded, &set.parameters)?;
    console.deliver(&destination, &written)?;
    let snapping = Snapping::of(&loaded, &set.parameters)?;
    let sound = searched && set.is_within() && set.termination.was_successful() && reloaded.is_sound();
    let joints = loaded.robot.joints().iter().map(|joint| joint.name.clone()).collect();
    let remarks = loaded.remarks.iter().cloned().chain(remarks).collect();
    let done = Done { estimate: &estimate, format, set, reloaded, snapping, remarks, joints, destination };
    console.show(&Answer { text: done.text(), json: done.json() })?;
    Ok(if sound { Ending::Done } else { Ending::Negative })
}

/// Where the model goes: `-o`, or `reports/NAME-identified/NAME.ENDING`.
fn destination(loaded: &LoadedRobot, target: Target, console: &Console) -> Result<Destination> {
    console.text_or(|| {
        let name = loaded.robot.name();
        let folder = report_folder("name of the robot", &format!("{name}-identified"))?;
        Ok(folder.join(format!("{name}.{}", target.extension())))
    })
}

/// The base parameters that an estimate of this very robot is of.
fn base_of(text: &Text, estimate: &Estimate, loaded: &LoadedRobot) -> Result<BaseReduction> {
    let robot = &loaded.robot;
    check_robot(estimate, &text.name, loaded)?;
    let Some(columns) = Columns::parse(&estimate.columns) else {
        let expected = Columns::ALL.map(|columns| columns.to_string()).join(", ");
        let found = &estimate.columns;
        let message = format!("{}: the set of columns is \"{found}\", expected one of {expected}", text.name);
        return Err(Error::new(message).into());
    };
    let base = reduce(robot, columns, Method::Structural, Seed::new(0))
        .map_err(|error| Error::new(format!("robot \"{}\": {error}", robot.name())))?;
    Ok(base)
}

/// The consistent set of an estimate.
fn consistent(text: &Text, estimate: &Estimate, base: &BaseReduction, loaded: &LoadedRobot) -> Result<ConsistentSet> {
    let Some(guess) = loaded.guess() else {
        let name = loaded.robot.name();
        let message = format!("\"{name}\" has no nominal parameters for what torque does not identify");
        let help = "write nominal.toml beside robot.toml; `--to c` and `--to rust` need none";
        return Err(Error::new(message).help(help).into());
    };
    Ok(consistent_set(base, estimate, guess).map_err(|error| Error::new(format!("{}: {error}", text.name)))?)
}

/// The comment at the top of the file.
fn header(estimate: &Estimate, set: &ConsistentSet) -> String {
    format!(
        "{} identified by {} ({} columns, {} base parameters, {} samples, {} periods); armid {}.\nPhysically consistent; \
         base parameters {}.",
        estimate.robot,
        estimate.estimator,
        estimate.columns,
        estimate.base.len(),
        estimate.samples,
        estimate.periods,
        env!("CARGO_PKG_VERSION"),
        verdict(set),
    )
}

fn verdict(set: &ConsistentSet) -> String {
    let (found, limit) = (number(set.chi_squared), number(set.chi_squared_limit));
    if set.is_exact {
        return "exactly the estimated ones".to_owned();
    }
    let outside = if set.outside.is_empty() {
        String::new()
    } else {
        format!("; outside their own 95 % intervals: {}", set.outside.join(", "))
    };
    let joint = if set.is_within() { "in the joint 95 % region of the estimate" } else { "no real arm has them" };
    format!("{joint} (chi squared {found}, limit {limit}){outside}")
}

/// The largest distance of a base parameter from its estimate, in standard deviations.
fn worst(set: &ConsistentSet) -> f64 {
    set.deviations.iter().fold(0.0_f64, |worst, x| worst.max(x.abs()))
}

struct Done<'a> {
    estimate: &'a Estimate,
    format: Exchange,
    set: ConsistentSet,
    reloaded: Reloaded,
    snapping: Option<Snapping>,
    remarks: Vec<String>,
    joints: Vec<String>,
    destination: Destination,
}

impl Done<'_> {
    fn json(&self) -> Value {
        json!({
            "robot": self.estimate.robot,
            "estimator": self.estimate.estimator,
            "to": self.format.name(),
            "file": self.destination.path(),
            "consistent": consistent_links(&self.set.parameters),
            "exact": self.set.is_exact,
            "largest_deviation_std": worst(&self.set),
            "chi_squared": self.set.chi_squared,
            "chi_squared_limit": self.set.chi_squared_limit,
            "parameters": self.parameters(),
            "outside": self.set.outside,
            "termination": self.set.termination,
            "reload": {
                "states": self.reloaded.states,
                "largest_relative_difference": self.reloaded.difference,
                "largest_friction_difference": self.reloaded.friction,
            },
            "left_out": self.reloaded.left_out.as_ref().map(|left| json!({
                "terms": left.meanings,
                "missing_torque_relative_rms": left.missing,
            })),
            "snapped": self.snapping.as_ref().map(Snapping::json),
            "remarks": self.remarks,
        })
    }

    /// Every parameter that is written, with its standard deviation from the covariance of the estimate.
    fn parameters(&self) -> Vec<Value> {
        let of = |(id, std): &(ParameterId, f64)| json!({ "name": id.to_string(), "value": self.set.parameters.get(*id), "std": std });
        self.set.std.iter().map(of).collect()
    }

    fn text(&self) -> String {
        let mut text = format!("{}\n{}: {}\n", self.destination, self.estimate.robot, verdict(&self.set));
        let _ = writeln!(text, "the search for the nearest consistent set {}", self.set.termination);
        let _ = writeln!(
            text,
            "read back, its torque is that of the regressor to {} of the largest, over {} random states",
            number(self.reloaded.difference),
            self.reloaded.states
        );
        if let Some(left) = &self.reloaded.left_out {
            let worst = (0..left.missing.len()).max_by(|&a, &b| left.missing[a].total_cmp(&left.missing[b]));
            let worst = worst.map_or_else(String::new, |i| {
                format!(", {} % of the torque of joint \"{}\"", number(100.0 * left.missing[i]), self.joints[i])
            });
            let _ = writeln!(text, "{} has no place for: {}{worst}", self.format.name(), left.meanings.join(", "));
        }
        for remark in &self.remarks {
            let _ = writeln!(text, "{remark}");
        }
        text.extend(self.snapping.iter().map(Snapping::text));
        text
    }
}

fn consistent_links(set: &StandardParameters) -> bool {
    set.links.iter().all(|link| link.check().is_ok())
}
