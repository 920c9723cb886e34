//! What `armid identify --drive-gains` says.

use std::fmt::Write;

use armid::estimation::DriveGain;
use armid_io::log::EffortScale;
use armid_workflow::DriveGainsAnswer;

use super::findings::paragraph;
use crate::terminal::{Table, stated};

/// Parameters that are listed for each joint.
const LISTED: usize = 6;

/// Standard deviations below which a parameter's change in per cent says nothing.
const SHOWN: f64 = 3.0;

/// The torque constants of all drives with everything that is said of them.
pub(crate) struct DriveGainsText<'a>(pub(crate) &'a DriveGainsAnswer);

impl DriveGainsText<'_> {
    fn joints(&self, which: &[usize]) -> String {
        which.iter().map(|&joint| self.0.joint(joint)).collect::<Vec<_>>().join(", ")
    }

    /// What one of them is called.
    const fn noun(&self) -> &'static str {
        match self.0.scale {
            EffortScale::RobotConstant | EffortScale::MappedConstant => "torque constant",
            EffortScale::ServoStiffness => "servo gain",
        }
    }

    pub(crate) fn text(&self) -> String {
        let (without, with) = (&self.0.without.0, &self.0.with.0);
        let mut text = format!(
            "{}s of \"{}\" by a load of {} kg on link \"{}\": {with} against {without}\n",
            self.noun(),
            self.0.robot.name(),
            stated(self.0.load.mass),
            self.0.robot.link_name(self.0.robot.dof())
        );
        text += &self.constants_table();
        text.push('\n');
        for sentence in self.sentences() {
            text += &paragraph(&sentence, 2);
            text.push('\n');
        }
        text += "\nwhat a wrong constant moves: per cent of a parameter for each per cent of the joint's constant\n";
        text += &self.moves_table();
        let wrong = self.0.taken().wrong_joints();
        match (self.0.corrected(), self.0.scale) {
            (Some(_), _) if wrong.is_empty() => {}
            (Some(lines), EffortScale::MappedConstant) => {
                let _ = writeln!(text, "\n→ in --map, beside the currents: {lines}");
            }
            (Some(lines), EffortScale::ServoStiffness) => {
                let _ = writeln!(text, "\n→ in --map, for q_cmd: {lines} kd=0");
            }
            (Some(lines), EffortScale::RobotConstant) => {
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
        let head =
            format!("joint | by | #{} | #95 % interval | # | #stated | #over stated | #95 % interval | #", self.noun());
        let mut table = Table::of(&head);
        for joint in 0..self.0.robot.dof() {
            for (k, found) in self.0.found.iter().enumerate() {
                let gain = &found.gains[joint];
                let constant = self.0.constant(joint, gain);
                let first = |text: String| if k == 0 { text } else { String::new() };
                let end = |gain: &DriveGain, k: usize, digits: usize| {
                    gain.ci95.map_or_else(String::new, |ends| format!("{:.digits$}", ends[k]))
                };
                table.row([
                    first(self.0.joint(joint).to_owned()),
                    found.method.name().to_owned(),
                    format!("{:.5} {}", constant.value, self.0.scale.unit()),
                    end(&constant, 0, 5),
                    end(&constant, 1, 5),
                    first(stated(self.0.constants[joint])),
                    format!("{:.4}", gain.value),
                    end(gain, 0, 4),
                    end(gain, 1, 4),
                ]);
            }
        }
        table.render(2)
    }

    fn sentences(&self) -> Vec<String> {
        let taken = self.0.taken();
        let mut all = vec![format!(
            "ols, wls and ridge have no intervals: the noise of the efforts draws them towards zero, by more than they scatter. What \
             follows is by {}. The load is taken as exact: a mass that is one per cent too large makes every constant one per cent too \
             large.",
            taken.method.name()
        )];
        let (wrong, hidden) = (taken.wrong_joints(), taken.hidden_joints());
        if !hidden.is_empty() {
            all.push(format!("Not shown, the interval holds zero: {}.", self.joints(&hidden)));
        }
        let wrong: Vec<usize> = wrong.into_iter().filter(|joint| !hidden.contains(joint)).collect();
        all.push(if wrong.is_empty() {
            "No constant differs from the stated one at 5 % over all joints together.".to_owned()
        } else {
            format!("Other than stated, at 5 % over all joints together: {}.", self.joints(&wrong))
        });
        for found in self.0.found.iter().filter(|found| !found.termination.was_successful()) {
            all.push(format!("{}: {}.", found.method.name(), found.termination));
        }
        all
    }

    /// The parameters that each joint's constant moves most, in standard deviations, of those that differ from zero.
    fn moves_table(&self) -> String {
        let mut table = Table::of("joint | parameters");
        for joint in 0..self.0.robot.dof() {
            let moved = self.0.stated.base.iter().zip(self.0.moved.iter().map(|row| row[joint]));
            let mut moved: Vec<_> = moved
                .filter(|(parameter, _)| parameter.value.abs() > SHOWN * parameter.std && parameter.std > 0.0)
                .collect();
            moved.sort_by(|(a, x), (b, y)| (y.abs() / b.std).total_cmp(&(x.abs() / a.std)));
            let listed = moved.iter().take(LISTED);
            let listed = listed.map(|(parameter, x)| format!("{} {:+.2}", parameter.name, x / parameter.value));
            table.row([self.0.joint(joint).to_owned(), listed.collect::<Vec<_>>().join(", ")]);
        }
        table.render(2)
    }
}
