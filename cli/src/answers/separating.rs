//! Experiments that show what the residual of a design's own motion cannot.
//!
//! What a robot file declares as uncertain lies in the span of the regressor along any motion of the arm alone. A second experiment in
//! which it acts otherwise tells it from the parameters.

use armid::model::DeclaredUncertainty;
use serde_json::{Value, json};

use super::findings::paragraph;
use crate::terminal::{number, stated};

/// Of each key of `[uncertainty]`: what is done and why that shows it, and what to type, ROBOT and PERIOD to be filled in.
const EXPERIMENTS: [(&str, &str, &[&str]); 5] = [
    (
        DeclaredUncertainty::TORQUE_CONSTANT,
        "one motion without and with a load of known mass, whose weight is the scale that currents lack",
        &[
            "armid design ROBOT --payload KG -o L.toml",
            "armid identify --drive-gains --without A.mcap --with B.mcap --payload-mass KG",
        ],
    ),
    (
        DeclaredUncertainty::CURRENT_LAG,
        "another motion at half the speed: what a lag s adds to viscous friction, -s I ω², falls to a quarter, friction itself stays",
        &["armid design ROBOT --criterion d-optimal --period PERIOD -o S.toml"],
    ),
    ("viscous", WARM, &["armid validate COLD.json WARM.mcap"]),
    ("coulomb", WARM, &["armid validate COLD.json WARM.mcap"]),
    (
        "offset_nm",
        "the currents with brakes on and drives off: what they show then is the converter's offset, the rest is the joint's",
        &[],
    ),
];

const WARM: &str =
    "this motion with cold gears and again after half an hour of it: the estimates differ by what temperature is worth";

/// A second experiment, for one quantity that is declared as uncertain.
pub(crate) struct SeparatingExperiment {
    /// Key in `[uncertainty]`.
    declared: &'static str,
    /// Its standard deviation.
    std: f64,
    experiment: &'static str,
    /// What to type.
    commands: Vec<String>,
}

impl SeparatingExperiment {
    /// One for each quantity that is declared; `robot` as it was given, `period_s` of the design.
    pub(crate) fn of(declared: &DeclaredUncertainty, robot: &str, period_s: f64) -> Vec<Self> {
        let fill = |command: &&str| command.replace("ROBOT", robot).replace("PERIOD", &stated(2.0 * period_s));
        let stated = EXPERIMENTS.into_iter().filter(|(key, ..)| declared.std(key) > 0.0);
        stated
            .map(|(key, experiment, commands)| Self {
                declared: key,
                std: declared.std(key),
                experiment,
                commands: commands.iter().map(fill).collect(),
            })
            .collect()
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "declared": self.declared, "std": self.std, "experiment": self.experiment, "commands": self.commands })
    }

    /// Lines for a person.
    pub(crate) fn text(&self) -> String {
        let sentence = format!("{} (declared {}): {}", self.declared, number(self.std), self.experiment);
        let commands = self.commands.iter().map(|command| format!("      {command}\n"));
        std::iter::once(paragraph(&sentence, 4)).chain(commands).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_quantity_that_can_be_declared_has_an_experiment() {
        for key in DeclaredUncertainty::KEYS {
            let declared: DeclaredUncertainty = toml::from_str(&format!("{key} = 0.1")).unwrap();
            let [one] = &SeparatingExperiment::of(&declared, "arm.toml", 10.0)[..] else { panic!("{key}") };
            assert_eq!(one.declared, key);
            assert!(!one.commands.iter().any(|command| command.contains("ROBOT") || command.contains("PERIOD")));
        }
        assert!(SeparatingExperiment::of(&DeclaredUncertainty::default(), "arm.toml", 10.0).is_empty());
    }
}
