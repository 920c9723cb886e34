//! A frame: pure, so that a test can look at it.

use armid_hardware::guard::Activity;
use ratatui::Frame;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Paragraph, Row, Table};

use super::bar;
use super::view::{JointView, View};

/// A state that is older than this is shown as old, s.
const OLD_S: f64 = 0.1;
/// A guard that is silent for longer is shown as gone, s.
const GONE_S: f64 = 2.0;
/// Width of the guard's bars.
const BAR: usize = 24;

const GOOD: Style = Style::new().fg(Color::Green);
const WARN: Style = Style::new().fg(Color::Yellow).add_modifier(Modifier::BOLD);
const BAD: Style = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);

/// Draws one frame.
pub(crate) fn draw(frame: &mut Frame<'_>, view: &View) {
    let joints = view.joints.len() as u16 + 3;
    let areas = Layout::vertical([Constraint::Length(5), Constraint::Length(joints), Constraint::Min(5)]);
    let [head, body, foot] = areas.areas(frame.area());
    frame.render_widget(link(view), head);
    draw_joints(frame, body, view);
    frame.render_widget(guard(view), foot);
}

fn block(title: &str) -> Block<'static> {
    Block::new().borders(Borders::ALL).title(format!(" {title} "))
}

/// Rates, ages, and what the stamps reported.
fn link(view: &View) -> Paragraph<'_> {
    let snapshot = &view.snapshot;
    let age = if snapshot.age_s.is_finite() {
        let style = if snapshot.age_s > OLD_S { BAD } else { GOOD };
        Span::styled(format!("{:.0} ms old", 1e3 * snapshot.age_s), style)
    } else {
        Span::styled("no joint states", BAD)
    };
    let stamps = &snapshot.stamps;
    let count = |what: &str, count: usize| {
        Span::styled(format!("   {what} {count}"), if count > 0 { WARN } else { Style::new() })
    };
    let controller = match snapshot.controller_state.as_deref() {
        None => Span::raw("not reported"),
        Some(state) => Span::styled(state.to_owned(), if state.starts_with("enabled") { GOOD } else { BAD }),
    };
    let mut order = vec![
        Span::raw(format!("               latest by {:.1} ms", 1e3 * stamps.latest_s)),
        count("twice", stamps.duplicates),
        count("out of order", stamps.reordered),
        count("clock jumps", stamps.clock_jumps),
    ];
    if let Some(fault) = &snapshot.fault {
        order.push(Span::styled(format!("   {fault}"), BAD));
    }
    let lines = vec![
        Line::from(vec![
            Span::raw(format!("joint states   {:5.0} Hz   ", snapshot.rate_hz)),
            age,
            Span::raw("   robot controller: "),
            controller,
        ]),
        Line::from(vec![
            Span::raw(format!("stamps         {:5} messages", stamps.messages)),
            count("lost", stamps.lost),
            Span::raw(format!("   longest gap {:.1} ms", 1e3 * stamps.longest_gap_s)),
        ]),
        Line::from(order),
    ];
    Paragraph::new(lines)
        .block(block(&format!("{} on {}", view.robot, view.place)).title_top(Line::from(" q ends ").right_aligned()))
}

fn draw_joints(frame: &mut Frame<'_>, area: Rect, view: &View) {
    let widths = [
        Constraint::Length(12),
        Constraint::Length(11),
        Constraint::Length(8),
        Constraint::Fill(3),
        Constraint::Length(8),
        Constraint::Length(11),
        Constraint::Fill(1),
    ];
    // What the columns of fixed width, the gaps between them and the border leave, in four parts.
    let fill = usize::from(area.width.saturating_sub(12 + 11 + 8 + 8 + 11 + 6 + 2));
    let rows = view.joints.iter().map(|joint| joint_row(joint, fill * 3 / 4, fill / 4));
    let effort = view.joints.first().map_or("", |joint| if joint.effort_unit == "A" { "current" } else { "effort" });
    let head = Row::new(["joint", "   position", "   limit", "", "limit", effort, "clamp"])
        .style(Style::new().add_modifier(Modifier::BOLD));
    frame.render_widget(Table::new(rows, widths).header(head).block(block("joints")), area);
}

fn joint_row(joint: &JointView, wide: usize, narrow: usize) -> Row<'static> {
    let limit = |value: f64| if value.is_finite() { format!("{value:.0}{}", joint.unit) } else { String::new() };
    let outside = joint.position.is_some_and(|q| !(q >= joint.soft.0 && q <= joint.soft.1));
    let part = joint.effort.map_or(f64::NAN, |effort| effort.abs() / joint.clamp);
    let value = |value: Option<f64>, digits: usize, unit: &str| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$} {unit}"))
    };
    Row::new([
        Span::raw(joint.name.clone()),
        Span::styled(format!("{:>11}", value(joint.position, 2, joint.unit)), if outside { BAD } else { Style::new() }),
        Span::raw(format!("{:>8}", limit(joint.hard.0))),
        Span::styled(bar::position(joint.position, joint.hard, joint.soft, wide), if outside { BAD } else { GOOD }),
        Span::raw(limit(joint.hard.1)),
        Span::raw(format!("{:>11}", value(joint.effort, 3, joint.effort_unit))),
        Span::styled(bar::share(part, narrow), if part > 1.0 { BAD } else { GOOD }),
    ])
}

/// What the guard does, and how much of each line was used.
fn guard(view: &View) -> Paragraph<'_> {
    let Some((state, age_s)) = view.guard() else {
        return Paragraph::new("no guard reports: no run is under way in this domain").block(block("guard"));
    };
    let (word, style) = match (&state.trip, state.doing) {
        (Some(_), _) => ("TRIPPED", BAD),
        (None, Activity::Ended) => ("ended", GOOD),
        (None, _) if age_s > GONE_S => ("silent", BAD),
        (None, Activity::Approach) => ("watching the approach", GOOD),
        (None, Activity::Experiment) => ("watching", GOOD),
    };
    let at = format!(
        "   {} at t = {:.1} s, {} mode, reported {:.1} s ago",
        state.phase.name(),
        state.t_s,
        state.mode.name(),
        age_s
    );
    let mut lines = vec![Line::from(vec![Span::styled(word, style), Span::raw(at)])];
    if let Some(trip) = &state.trip {
        lines.push(Line::styled(trip.clone(), BAD));
    }
    for (name, used) in &state.used {
        let style = if *used >= 1.0 {
            BAD
        } else if *used > 0.7 {
            WARN
        } else {
            GOOD
        };
        lines.push(Line::from(vec![
            Span::raw(format!("{name:<16}")),
            Span::styled(bar::share(*used, BAR), style),
            Span::raw(format!(" {:3.0} %", 100.0 * used)),
        ]));
    }
    Paragraph::new(lines).block(block("guard: largest part of each limit used so far"))
}

/// One frame as text, for output that is not a terminal.
pub(crate) fn text(view: &View, width: u16) -> String {
    let guard = view.guard().map_or(1, |(state, _)| state.used.len() + 2);
    let height = 5 + view.joints.len() + 3 + (guard + 2).max(5);
    // A backend in memory cannot fail.
    let Ok(mut terminal) = Terminal::new(TestBackend::new(width, height as u16));
    let Ok(_) = terminal.draw(|frame| draw(frame, view));
    let buffer = terminal.backend().buffer();
    let row = |y: u16| {
        let cells: String = (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect();
        cells.trim_end().to_owned() + "\n"
    };
    (0..buffer.area.height).map(row).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use armid::experiment::Phase;
    use armid::model::{bundled, format::parse_robot};
    use armid_hardware::guard::{GuardSettings, GuardState, Mode};
    use armid_hardware::link::{JointRow, StampFindings};
    use armid_hardware::monitor::Snapshot;

    use super::*;

    fn view(change: impl FnOnce(&mut Snapshot)) -> View {
        let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
        let robot = parse_robot(entry.robot).unwrap();
        let q = [-20.0, 80.0, 0.0, 179.0, -50.0, 12.0].map(f64::to_radians).to_vec();
        let row = JointRow { stamp_ns: 7, q, qd: Vec::new(), effort: vec![0.5, 4.2, -1.1, 0.2, 0.1, -2.9] };
        let used = [("following-error", 0.12), ("soft-limit", 0.94), ("stale-state", 0.3)];
        let used: BTreeMap<String, f64> = used.into_iter().map(|(name, used)| (name.to_owned(), used)).collect();
        let state = GuardState {
            mode: Mode::Trajectory,
            doing: Activity::Experiment,
            phase: Phase::Record,
            t_s: 12.3,
            used,
            trip: None,
        };
        let mut snapshot = Snapshot {
            row: Some(row),
            age_s: 0.002,
            rate_hz: 499.6,
            stamps: StampFindings { messages: 6150, longest_gap_s: 0.0021, latest_s: 4e-4, ..StampFindings::default() },
            controller_state: Some("enabled".to_owned()),
            guard: Some((state, 0.05)),
            fault: None,
        };
        change(&mut snapshot);
        View::new(&robot, &GuardSettings::default(), "ROS domain 42, loopback", &snapshot)
    }

    #[test]
    fn a_healthy_run_is_shown_whole() {
        let shown = text(&view(|_| {}), 100);
        for word in [
            "crs-a460 on ROS domain 42",
            "500 Hz   2 ms old",
            "6150 messages   lost 0   longest gap 2.1 ms",
            "robot controller: enabled",
            "latest by 0.4 ms   twice 0   out of order 0   clock jumps 0",
            "wrist_pitch ",
            "waist",
            "-20.00 °",
            "-175°",
            "175°",
            "0.500 A",
            "watching   record at t = 12.3 s, trajectory mode",
            "soft-limit      ███████████████████████░  94 %",
        ] {
            assert!(shown.contains(word), "\"{word}\" not in\n{shown}");
        }
        assert!(shown.lines().all(|line| line.chars().count() <= 100), "{shown}");
        // Each joint has its mark on its bar.
        assert_eq!(shown.matches('┃').count(), 6, "{shown}");
    }

    #[test]
    fn what_is_wrong_is_shown() {
        let shown = text(
            &view(|snapshot| {
                (snapshot.age_s, snapshot.rate_hz, snapshot.stamps.lost) = (f64::INFINITY, 0.0, 17);
                snapshot.controller_state = Some("estop".to_owned());
                snapshot.row.as_mut().unwrap().q[1] = 2.0;
                snapshot.row.as_mut().unwrap().effort[0] = 9.0;
                let (state, _) = snapshot.guard.as_mut().unwrap();
                state.trip = Some("position-jump: joint \"shoulder\": position moved".to_owned());
            }),
            100,
        );
        for word in ["no joint states", "lost 17", "estop", "▶", "TRIPPED", "position-jump: joint \"shoulder\""] {
            assert!(shown.contains(word), "\"{word}\" not in\n{shown}");
        }
        // Nothing is cut off at the usual width of a terminal.
        let shown = text(&view(|_| {}), 80);
        for word in ["clock jumps 0 ", "robot controller: enabled ", "wrist_pitch ", "0.500 A", " s ago "] {
            assert!(shown.contains(word), "\"{word}\" not in\n{shown}");
        }
        let shown = text(&view(|snapshot| (snapshot.row, snapshot.guard) = (None, None)), 80);
        assert!(shown.contains("no guard reports") && shown.matches('–').count() == 12, "{shown}");
    }

    #[test]
    fn a_narrow_terminal_is_no_reason_to_fail() {
        for width in [1, 10, 40] {
            text(&view(|_| {}), width);
        }
    }
}
