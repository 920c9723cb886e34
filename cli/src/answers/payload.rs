//! What `armid identify --payload` says.

use std::fmt::Write;

use armid::estimation::{NegativeMass, NegativeMassCause};
use armid_workflow::PayloadAnswer;

use crate::terminal::{Align, Table, number};

/// A load with everything that is said of it.
pub(crate) fn text(answer: &PayloadAnswer) -> String {
    let PayloadAnswer { found, robot, without, with } = answer;
    let (without, with) = (&without.name, &with.name);
    let mut text =
        format!("load on link \"{}\" of \"{}\", in its frame: {with} against {without}\n", answer.link(), robot.name());
    text += &found.negative_mass.map(negative).unwrap_or_default();
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
    let body = found.body.inertia;
    let centre: Vec<String> = (body.first_moment / body.mass).iter().map(|&x| number(x)).collect();
    let _ = writeln!(
        text,
        "\nthe physically consistent body that agrees best: {} kg at ({}) m; chi squared {}, limit {}",
        number(body.mass),
        centre.join(", "),
        number(found.body.chi_squared),
        number(found.body.chi_squared_limit)
    );
    let _ = writeln!(
        text,
        "between the logs friction changed by {} %, and offsets by {} of the residual of their joints, as both logs show",
        number(100.0 * found.friction_change),
        number(found.offset_change)
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
    if !found.is_of_a_load() {
        text += "→ record both logs on the same day with the same motion, or look for what else changed\n";
    }
    text
}

/// Why there is no mass.
fn negative(mass: NegativeMass) -> String {
    let NegativeMass { free, cause } = mass;
    let [low, high] = free.ci95.map(number);
    let (why, action) = match cause {
        NegativeMassCause::ArmChanged => (
            "the arm changed by more than a load explains",
            "record both logs on the same day, with one calibration of the torques",
        ),
        NegativeMassCause::Lighter => (
            "the arm is lighter in the log with the load",
            "exchange --without and --with, or reverse the torques in --map (tau=… sign=-)",
        ),
        NegativeMassCause::NotShown => (
            "this motion does not show the mass, or there is no load",
            "move the joints that lift the load further: `armid design ROBOT --payload KG` makes a motion",
        ),
    };
    format!("no mass: both logs give {} kg ({low} to {high}); {why}\n→ {action}\n\n", number(free.value))
}
