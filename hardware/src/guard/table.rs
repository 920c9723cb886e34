//! Which trip exists in which mode, what it does, and how soon: the table of the README.

use std::fmt::Write;

use super::{GuardSettings, Mode, Trip};

/// The table in Markdown, with the bounds for states that come at `rate_hz`.
pub fn table(settings: &GuardSettings, rate_hz: f64) -> String {
    let mut text =
        "| trip | what is wrong | trajectory handed over | set-points streamed | robot controller | bound, ms |\n\
                    |---|---|---|---|---|---|\n"
            .to_owned();
    for trip in Trip::ALL {
        let action = |mode: Mode| if trip.exists_in(mode) { trip.action(mode).name() } else { "–" };
        let controller = if trip.in_robot_controller() { "yes" } else { "–" };
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} | {controller} | {:.0} |",
            trip.name(),
            trip.meaning(),
            action(Mode::Trajectory),
            action(Mode::Stream),
            trip.bound_ms(settings, rate_hz),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_the_readme_holds_this_table() {
        let table = table(&GuardSettings::default(), 500.0);
        let readme = include_str!("../../README.md");
        assert!(readme.contains(&table), "README.md of hardware should hold\n{table}");
    }
}
