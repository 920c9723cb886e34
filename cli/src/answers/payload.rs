//! What `armid identify --payload` answers.

use std::fmt::Write;

use armid::estimation::Payload;
use armid::model::Robot;
use armid_io::Inputs;
use serde_json::{Value, json};

use crate::terminal::{Align, Table, number};

/// Standard deviations wider than by this factor: the arm changed in more than a load.
const TOO_WIDE: f64 = 3.0;

/// A load with everything that is said of it.
pub(crate) struct PayloadAnswer<'a> {
    pub(crate) found: &'a Payload,
    pub(crate) robot: &'a Robot,
    /// Without and with the load: name, and what it was made from.
    pub(crate) sides: [(&'a String, Option<&'a Inputs>); 2],
}

impl PayloadAnswer<'_> {
    /// Whether the arm changed as a load on its last link changes it.
    pub(crate) fn is_of_a_load(&self) -> bool {
        self.found.widened_by <= TOO_WIDE
    }

    fn link(&self) -> &str {
        self.robot.link_name(self.robot.dof())
    }

    pub(crate) fn json(&self) -> Value {
        let found = self.found;
        let body = found.inertia();
        let centre = body.first_moment / body.mass;
        let combinations: Vec<Value> = found
            .combinations
            .base
            .iter()
            .enumerate()
            .map(|(row, parameter)| {
                let mut value = json!(parameter);
                let terms = found.base.terms(row);
                value["terms"] = terms
                    .iter()
                    .map(|(id, coefficient)| json!({ "parameter": id.kind.symbol(), "coefficient": coefficient }))
                    .collect();
                value["name"] = json!(terms[0].0.kind.symbol());
                value
            })
            .collect();
        json!({
            "robot": self.robot.name(),
            "link": self.link(),
            "without": self.sides[0].0,
            "with": self.sides[1].0,
            "parameters": found.parameters,
            "combinations": combinations,
            "covariance": found.combinations.covariance,
            "body": {
                "mass_kg": body.mass,
                "com_m": centre.as_slice(),
                "first_moment_kg_m": body.first_moment.as_slice(),
                "inertia_kg_m2": body.to_array()[4..],
                "chi_squared": found.body.chi_squared,
                "chi_squared_limit": found.body.chi_squared_limit,
                "termination": found.body.termination,
            },
            "consistent": body.check().is_ok(),
            "chi_squared": found.chi_squared,
            "chi_squared_limit": found.chi_squared_limit,
            "widened_by": found.widened_by,
            "inputs": { "without": self.sides[0].1, "with": self.sides[1].1 },
        })
    }

    pub(crate) fn text(&self) -> String {
        let found = self.found;
        let [(without, _), (with, _)] = self.sides;
        let mut text = format!(
            "load on link \"{}\" of \"{}\", in its frame: {with} against {without}\n",
            self.link(),
            self.robot.name()
        );
        let mut table = Table::new(&[
            ("parameter", Align::Left),
            ("value", Align::Right),
            ("std", Align::Right),
            ("95 % interval", Align::Right),
            ("", Align::Right),
            ("unit", Align::Left),
            ("of the body", Align::Right),
        ]);
        for parameter in &found.parameters {
            let [value, std, low, high] = match parameter.shown {
                Some(shown) => [shown.value, shown.std, shown.ci95[0], shown.ci95[1]].map(number),
                None => ["not shown", "", "", ""].map(str::to_owned),
            };
            let unit = parameter.unit.to_owned();
            table.row([parameter.name.clone(), value, std, low, high, unit, number(parameter.consistent)]);
        }
        text += &table.render(2);
        let body = found.inertia();
        let centre: Vec<String> = (body.first_moment / body.mass).iter().map(|&x| number(x)).collect();
        let _ = writeln!(
            text,
            "\nthe physically consistent body that agrees best: {} kg at ({}) m; chi squared {}, limit {}",
            number(body.mass),
            centre.join(", "),
            number(found.body.chi_squared),
            number(found.body.chi_squared_limit)
        );
        if found.chi_squared > found.chi_squared_limit {
            let _ = writeln!(
                text,
                "the arm changed by more than a load explains (chi squared {}, limit {}): intervals are {} times as wide",
                number(found.chi_squared),
                number(found.chi_squared_limit),
                number(found.widened_by)
            );
        }
        if !self.is_of_a_load() {
            text += "→ record both logs on the same day with the same motion, or look for what else changed\n";
        }
        text
    }
}
