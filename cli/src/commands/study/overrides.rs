//! Which study, and what stands in place of its plan's values.

use armid::study::{OwnMethods, RandomTruths};
use armid_io::Error;
use armid_io::study::load_plans;
use armid_sim::Engine;
use miette::Result;

use super::request::Request;
use crate::arguments::one_of;

/// What a command line may put in place of a plan's values.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct Overrides {
    /// Runs of each design, in place of the plan's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    runs: Option<u32>,
    /// Draw this many simulated arms around the robot's own
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    truths: Option<u32>,
    /// Which simulated arms perform the experiments, in place of the plan's
    #[arg(
        long,
        value_name = "ARM,…",
        value_delimiter = ',',
        value_parser = one_of(&Engine::ALL, Engine::name)
    )]
    arm: Option<Vec<Engine>>,
    /// One robot of the plan's `robots`
    #[arg(long, value_name = "ROBOT")]
    robot: Option<String>,
}

impl Overrides {
    /// The study that is asked for.
    pub(crate) fn request(&self, study: &str) -> Result<Request> {
        let (mut plans, beside) = load_plans(study, &Engine::ALL.map(Engine::name), &OwnMethods::default())?;
        for plan in plans.plans_mut() {
            if let Some(runs) = self.runs {
                plan.scale_runs(runs as usize);
            }
            if let Some(truths) = self.truths {
                let count = truths as usize;
                let spread = plan.truths.take();
                plan.truths = Some(spread.map_or(RandomTruths::new(count), |spread| RandomTruths { count, ..spread }));
            }
            if let Some(arms) = &self.arm {
                plan.engines = arms.iter().map(|arm| arm.name().to_owned()).collect();
                plan.check().map_err(Error::new)?;
            }
        }
        let request = Request { study: study.to_owned(), plans, beside, below: None };
        Ok(if let Some(robot) = &self.robot { request.for_robot(robot)? } else { request })
    }

    /// These overrides as words of a command line.
    pub(crate) fn words(&self) -> Vec<String> {
        let number = |key: &str, value: Option<u32>| value.map(|value| [key.to_owned(), value.to_string()]);
        let arms = self.arm.as_ref().map(|arms| arms.iter().map(|arm| arm.name()).collect::<Vec<_>>().join(","));
        let text = |key: &str, value: Option<String>| value.map(|value| [key.to_owned(), value]);
        let all = [number("--runs", self.runs), number("--truths", self.truths), text("--arm", arms)];
        all.into_iter().chain([text("--robot", self.robot.clone())]).flatten().flatten().collect()
    }
}
