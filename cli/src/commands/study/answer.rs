//! What `armid study` says at the end.

use std::fmt::Write;

use armid_workflow::numbers::{error_percent, number};
use armid_workflow::study::{Looks, Part, Stage, StudyAnswer};
use miette::Result;

use crate::answers::{robots, study};
use crate::terminal::{Answer, Console, Ending};

/// Says how a study ended.
pub(super) fn show(answer: &StudyAnswer, console: &Console) -> Result<Ending> {
    match answer {
        StudyAnswer::Whole(whole) => {
            if let Some(looks) = &whole.looks {
                console.note(looks_text(looks).trim_end());
            }
            console.show(&study::answer(whole, console.global.verbose))?;
            Ok(if whole.is_positive() { Ending::Done } else { Ending::Negative })
        }
        StudyAnswer::OnRobots(answer) => {
            console.show(&robots::answer(&answer.summary, &answer.report)?)?;
            Ok(if answer.without_result.is_empty() { Ending::Done } else { Ending::Negative })
        }
        StudyAnswer::Part { part: Part { stage, shard }, folder } => {
            let (k, n) = shard.map_or((1, 1), |shard| (shard.k, shard.n));
            let what = stage.map_or(String::new(), |stage| format!(" of the {}", stage.name()));
            console.show(&Answer {
                text: format!(
                    "part {k} of {n}{what} is in {}; put the parts together with armid study merge\n",
                    folder.display()
                ),
                json: serde_json::json!({ "shard": folder, "k": k, "n": n, "stage": stage.map(Stage::name) }),
            })?;
            Ok(Ending::Done)
        }
        StudyAnswer::Interrupted { folder } => {
            console.note(format!("interrupted; go on with --resume -o {}", folder.display()));
            Ok(Ending::Interrupted)
        }
    }
}

/// Every look in a line.
fn looks_text(looks: &Looks) -> String {
    let end = if looks.is_met() { "met" } else { "not met with all starts of the plan" };
    let mut text = format!("{}: {end}\n", looks.until);
    for look in &looks.looks {
        let interval =
            look.interval.map_or("no interval yet".to_owned(), |i| format!("[{}, {}]", number(i.low), number(i.high)));
        let share = look.share.map_or(String::new(), |share| format!(", ±{}", error_percent(share)));
        let _ = writeln!(text, "{:>5} starts: ratio {} {interval}{share}", look.starts, number(look.ratio));
    }
    text
}
