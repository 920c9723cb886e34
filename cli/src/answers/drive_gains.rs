//! What `armid identify --drive-gains` answers.

use std::fmt::Write;

use armid::estimation::{DriveGain, DriveGains, Estimate, GainMethod};
use armid::model::Robot;
use armid::spatial::Inertia;
use armid_io::Inputs;
use serde_json::{Map, Value, json};

use super::findings::paragraph;
use crate::terminal::{Align, Table, number};

/// Parameters that are listed for each joint.
const LISTED: usize = 6;

/// Standard deviations below which a parameter's change in per cent says nothing.
const SHOWN: f64 = 3.0;

/// The torque constants of all drives with everything that is said of them.
pub(crate) struct DriveGainsAnswer<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) load: &'a Inertia,
    /// The constants by which currents became torques, N·m/A.
    pub(crate) constants: &'a [f64],
    /// Whether `--map` states them.
    pub(crate) of_mapping: bool,
    /// By every method.
    pub(crate) found: &'a [DriveGains],
    /// The base parameters by the stated constants, without the load.
    pub(crate) stated: &'a Estimate,
    /// How each of them follows the gains, ∂β/∂ ln κ, b of n.
    pub(crate) moved: Vec<Vec<f64>>,
    /// Without and with the load: name, and what it was made from.
    pub(crate) sides: [(String, &'a Inputs); 2],
}

impl DriveGainsAnswer<'_> {
    /// The result that has no bias by the noise of the currents, where it was found.
    fn taken(&self) -> &DriveGains {
        let total = self.found.iter().find(|found| found.method == GainMethod::Total);
        let total = total.filter(|found| found.termination.was_successful());
        total.unwrap_or(&self.found[0])
    }

    /// Whether every gain was found.
    pub(crate) fn is_sound(&self) -> bool {
        let converged = self.found.iter().all(|found| found.termination.was_successful());
        converged && self.taken().hidden().is_empty()
    }

    fn joint(&self, joint: usize) -> &str {
        &self.robot.joints()[joint].name
    }

    fn joints(&self, which: &[usize]) -> String {
        which.iter().map(|&joint| self.joint(joint)).collect::<Vec<_>>().join(", ")
    }

    /// The constant of a joint by a gain.
    fn constant(&self, joint: usize, gain: &DriveGain) -> DriveGain {
        let stated = self.constants[joint];
        DriveGain { value: stated * gain.value, std: stated * gain.std, ci95: gain.ci95.map(|end| stated * end) }
    }

    pub(crate) fn json(&self) -> Value {
        let taken = self.taken();
        let joints: Vec<Value> = (0..self.robot.dof())
            .map(|joint| {
                let by: Map<String, Value> = self
                    .found
                    .iter()
                    .map(|found| {
                        let gain = &found.gains[joint];
                        let shown = json!({ "ratio": gain, "torque_constant_nm_a": self.constant(joint, gain) });
                        (found.method.name().to_owned(), shown)
                    })
                    .collect();
                json!({ "joint": self.joint(joint), "stated_nm_a": self.constants[joint], "by": by })
            })
            .collect();
        let base: Vec<Value> = self
            .stated
            .base
            .iter()
            .enumerate()
            .map(|(row, parameter)| {
                json!({
                    "name": parameter.name,
                    "unit": parameter.unit,
                    "by_stated_constants": parameter.value,
                    "std": parameter.std,
                    "by_found_constants": taken.beta[row],
                    "moved_per_unit_of_gain": self.moved[row],
                })
            })
            .collect();
        let methods: Vec<Value> = self
            .found
            .iter()
            .map(|found| {
                json!({
                    "method": found.method,
                    "degrees_of_freedom": found.degrees_of_freedom,
                    "termination": found.termination,
                })
            })
            .collect();
        let names = |which: Vec<usize>| which.into_iter().map(|joint| self.joint(joint).to_owned()).collect::<Vec<_>>();
        json!({
            "robot": self.robot.name(),
            "without": self.sides[0].0,
            "with": self.sides[1].0,
            "load": { "mass_kg": self.load.mass, "parameters": self.load.to_array() },
            "taken": taken.method,
            "methods": methods,
            "joints": joints,
            "wrong": names(taken.wrong()),
            "not_shown": names(taken.hidden()),
            "base": base,
            "corrected": self.corrected(),
            "inputs": { "without": self.sides[0].1, "with": self.sides[1].1 },
        })
    }

    /// The lines that state the constants that were found; none where one was not.
    fn corrected(&self) -> Option<String> {
        let taken = self.taken();
        if !taken.hidden().is_empty() {
            return None;
        }
        let value = |(joint, gain): (usize, &DriveGain)| format!("{:.6}", self.constant(joint, gain).value);
        let values: Vec<String> = taken.gains.iter().enumerate().map(value).collect();
        if self.of_mapping {
            return Some(format!("constant={}", values.join("/")));
        }
        let line = |(joint, value): (usize, &String)| {
            format!("torque_constant_nm_a = {value}  # joint \"{}\", was {}", self.joint(joint), self.constants[joint])
        };
        Some(values.iter().enumerate().map(line).collect::<Vec<_>>().join("\n"))
    }

    pub(crate) fn text(&self) -> String {
        let [(without, _), (with, _)] = &self.sides;
        let mut text = format!(
            "torque constants of \"{}\" by a load of {} kg on link \"{}\": {with} against {without}\n",
            self.robot.name(),
            number(self.load.mass),
            self.robot.link_name(self.robot.dof())
        );
        text += &self.constants_table();
        text.push('\n');
        for sentence in self.sentences() {
            text += &paragraph(&sentence, 2);
            text.push('\n');
        }
        text += "\nwhat a wrong constant moves: per cent of a parameter for each per cent of the joint's constant\n";
        text += &self.moves_table();
        let wrong = self.taken().wrong();
        match (self.corrected(), self.of_mapping) {
            (Some(_), _) if wrong.is_empty() => {}
            (Some(lines), true) => {
                let _ = writeln!(text, "\n→ in --map, beside the currents: {lines}");
            }
            (Some(lines), false) => {
                text += "\n→ in the table [joint.drive] of each joint in robot.toml:\n";
                let of_wrong = lines.lines().enumerate().filter(|(joint, _)| wrong.contains(joint));
                of_wrong.for_each(|(_, line)| text += &format!("  {line}\n"));
            }
            (None, _) => {
                text += "\n→ put the load further from the axes, take a heavier one, or a motion of `armid design ROBOT --payload KG`\n";
            }
        }
        text
    }

    fn constants_table(&self) -> String {
        let mut table = Table::new(&[
            ("joint", Align::Left),
            ("by", Align::Left),
            ("torque constant", Align::Right),
            ("95 % interval", Align::Right),
            ("", Align::Right),
            ("stated", Align::Right),
            ("over stated", Align::Right),
            ("95 % interval", Align::Right),
            ("", Align::Right),
        ]);
        for joint in 0..self.robot.dof() {
            for (k, found) in self.found.iter().enumerate() {
                let gain = &found.gains[joint];
                let constant = self.constant(joint, gain);
                let first = |text: String| if k == 0 { text } else { String::new() };
                let five = |value: f64| format!("{value:.5}");
                table.row([
                    first(self.joint(joint).to_owned()),
                    found.method.name().to_owned(),
                    format!("{} N·m/A", five(constant.value)),
                    five(constant.ci95[0]),
                    five(constant.ci95[1]),
                    first(number(self.constants[joint])),
                    format!("{:.4}", gain.value),
                    format!("{:.4}", gain.ci95[0]),
                    format!("{:.4}", gain.ci95[1]),
                ]);
            }
        }
        table.render(2)
    }

    fn sentences(&self) -> Vec<String> {
        let taken = self.taken();
        let mut all = vec![format!(
            "The noise of the currents draws ols, wls and ridge towards zero, and tls not; what follows is by {}. The load is taken as \
             exact: a mass that is one per cent too large makes every constant one per cent too large.",
            taken.method.name()
        )];
        let (wrong, hidden) = (taken.wrong(), taken.hidden());
        if !hidden.is_empty() {
            all.push(format!("Not shown, the interval holds zero: {}.", self.joints(&hidden)));
        }
        let wrong: Vec<usize> = wrong.into_iter().filter(|joint| !hidden.contains(joint)).collect();
        all.push(if wrong.is_empty() {
            "No constant differs from the stated one at 5 % over all joints together.".to_owned()
        } else {
            format!("Other than stated, at 5 % over all joints together: {}.", self.joints(&wrong))
        });
        for found in self.found.iter().filter(|found| !found.termination.was_successful()) {
            all.push(format!("{}: {}.", found.method.name(), found.termination));
        }
        all
    }

    /// The parameters that each joint's constant moves most, in standard deviations, of those that differ from zero.
    fn moves_table(&self) -> String {
        let mut table = Table::new(&[("joint", Align::Left), ("parameters", Align::Left)]);
        for joint in 0..self.robot.dof() {
            let moved = self.stated.base.iter().zip(self.moved.iter().map(|row| row[joint]));
            let mut moved: Vec<_> = moved
                .filter(|(parameter, _)| parameter.value.abs() > SHOWN * parameter.std && parameter.std > 0.0)
                .collect();
            moved.sort_by(|(a, x), (b, y)| (y.abs() / b.std).total_cmp(&(x.abs() / a.std)));
            let listed = moved.iter().take(LISTED);
            let listed = listed.map(|(parameter, x)| format!("{} {:+.2}", parameter.name, x / parameter.value));
            table.row([self.joint(joint).to_owned(), listed.collect::<Vec<_>>().join(", ")]);
        }
        table.render(2)
    }
}
