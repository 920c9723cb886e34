//! An arm of one's own: anything that takes a plan and returns time-stamped samples. Here a stand-in for a driver, which
//! follows its command exactly and reports the torque of the model; the rest of the method does not notice.
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;

use armid::dynamics::Dynamics;
use armid::estimation::{EstimatorKind, Identification};
use armid::experiment::{Arm, ArmError, Command, Ending, ExperimentPlan, RawSample, Recording, Rest, Sink, record};
use armid::model::{Columns, Robot, StandardParameters};
use armid::signal::{Processing, process};
use armid_io::{LoadedRobot, robot, trajectory};

struct Exact {
    robot: Robot,
    parameters: StandardParameters,
}

impl Arm for Exact {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        let (n, layout) = (self.robot.dof(), plan.check(self.robot.dof())?);
        sink.begin(&Recording {
            effort_unit: armid::model::EffortInterface::Torque,
            ..Recording::empty(&self.robot, "", plan, &layout, None)
        });
        let (command, mut dynamics) = (Command::new(plan, &layout), Dynamics::new(&self.robot, &self.parameters));
        let [mut q, mut qd, mut qdd, mut tau] = [(); 4].map(|()| vec![0.0; n]);
        for index in 0..layout.samples() {
            let (t, phase) = (index as f64 / plan.rate_hz, layout.phase(index));
            // A driver would send the command here, and read positions and efforts.
            command.evaluate(t, &mut q, &mut qd, &mut qdd);
            dynamics.inverse(&q, &qd, &qdd, &mut tau);
            let sample = RawSample { index, t, phase, q: &q, effort: &tau, voltage: &[], link_q: &[], command: &q };
            if sink.sample(&sample).ends() {
                return Ok(Ending::Stopped { t, phase, rest: Rest::Simulated });
            }
        }
        Ok(Ending::Completed)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let loaded: LoadedRobot = robot::find("crs-a460")?;
    let parameters = loaded.truth()?.parameters;
    let plan = ExperimentPlan::new(trajectory::load("table-one", None, &loaded.robot)?).with_periods(2);
    let mut arm = Exact { robot: loaded.robot.clone(), parameters: parameters.clone() };
    let (recording, ending) = record(&mut arm, &plan)?;
    println!("{} samples, {ending:?}", recording.len());

    let samples = process(&recording, &loaded.robot, &Processing::default())?;
    let identification = Identification::new(&loaded.robot, Columns::RIGID_ROTOR_FRICTION)?;
    let estimate = identification.estimate(&samples, EstimatorKind::Ols.estimator())?;
    let exact = identification.base().beta(&parameters.vector(&loaded.robot, Columns::RIGID_ROTOR_FRICTION));
    let worst = (estimate.beta() - exact).amax();
    println!("{} base parameters, the largest error is {worst:.2e}", estimate.base.len());
    if worst < 1e-3 { Ok(()) } else { Err("an exact arm should give its parameters back".into()) }
}
