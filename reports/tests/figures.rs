//! Figures with everything that a study's page may leave out, byte for byte: all markers, lines to compare with, two columns of rows,
//! numbers at the edge, bars on both sides.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod golden;

use armid_reports::{
    Axis, Band, Bar, BarFigure, BarRow, Document, Group, GroupStyle, Heading, Interval, IntervalFigure, IntervalRow,
    Level, Ratio, RatioFigure, RatioPanel, Reference, ScatterFigure, ScatterGroup, ScatterPanel, ScatterPoint, Section,
};
use golden::{assert_golden, text_of};

fn scatter() -> ScatterFigure {
    let names = ["one", "two", "three", "four", "five", "six", "seven", "eight", "model-error"];
    let groups = Group::assign(names).into_iter().enumerate().map(|(k, group)| {
        let at = |i: usize| (k as f64 + 3.0 * i as f64, ((5 * k + 7 * i) % 11) as f64);
        let points = (0..4).map(at).map(|(x, y)| ScatterPoint::new(x, y).interval(y - 0.3, y + 0.6)).collect();
        ScatterGroup { label: group.label, style: group.style, points }
    });
    let label = |text: &str| text.to_owned();
    let lines = ScatterPanel {
        title: label("left"),
        x: Axis::linear("x", "rad"),
        y: Axis::linear("y", "N·m"),
        groups: groups.collect(),
        references: vec![
            Reference::X { value: 12.0, label: label("an upright line") },
            Reference::X { value: 25.0, label: label("right of all points") },
            Reference::Y { value: 7.2, label: label("a level line") },
            Reference::Y { value: 7.9, label: label("its neighbour") },
            Reference::Segment { from: (-4.0, 0.0), to: (18.0, 13.0), label: label("fitted") },
            Reference::Segment { from: (2.0, 10.0), to: (17.0, 1.0), label: label("another") },
        ],
    };
    let one =
        ScatterGroup { label: label("one"), style: GroupStyle::nth(0), points: vec![ScatterPoint::new(40.0, 3.0)] };
    let single =
        ScatterPanel { x: Axis::log("x", ""), y: Axis::linear("another y", ""), groups: vec![one], ..lines.clone() };
    let single = ScatterPanel { title: String::new(), references: Vec::new(), ..single };
    let heading = Heading::new("scatter", "All markers");
    ScatterFigure { heading, columns: 2, panels: vec![lines, single.clone(), single] }
}

fn ratios() -> RatioFigure {
    let ratio = |point: f64, reach: f64, is_significant| {
        Some(Ratio { interval: Interval::new(point, point / reach, point * reach), is_significant })
    };
    let panel = |title: &str, cells| RatioPanel { title: title.into(), subtitle: "20 designs".into(), cells };
    RatioFigure {
        heading: Heading::new("two-groups", "No criterion is best everywhere, and this title takes a second line"),
        label: "error relative to the first".into(),
        reference: "D-optimal".into(),
        groups: Group::assign(["condition", "i-optimal"]),
        rows: vec!["exact".into(), "a scenario whose name takes two lines".into(), "third".into()],
        panels: vec![
            panel(
                "first",
                vec![
                    vec![ratio(1.8, 1.2, true), ratio(1.02, 1.1, false)],
                    vec![ratio(0.6, 40.0, true), None],
                    vec![ratio(0.9, 1.3, false), ratio(0.7, 1.1, true)],
                ],
            ),
            panel(
                "second",
                vec![vec![ratio(3.0, 1.5, true), ratio(1.0, 1.4, false)], vec![None, None], vec![None, None]],
            ),
        ],
    }
}

fn intervals() -> IntervalFigure {
    let row = |k: usize| {
        let point = 9000.0 * k as f64 - 1000.0;
        let cell = |shift: f64| Some(Interval::new(point + shift, point + shift - 4000.0, point + shift + 7000.0));
        let label = if k == 3 { "a parameter with a long name".to_owned() } else { format!("parameter {k}") };
        IntervalRow { label, cells: vec![cell(0.0), if k % 5 == 4 { None } else { cell(2500.0) }] }
    };
    IntervalFigure {
        heading: Heading::new("two-columns", "Rows in two columns"),
        value: Axis::linear("value", "N·m").including(&[200_000.0]),
        groups: Group::assign(["ols", "wls"]),
        rows: (0..23).map(row).collect(),
        levels: vec![Level::new(0.0, "none"), Level::new(1e5, "half"), Level::new(1.5e5, "three quarters")],
        band: Some(Band::new(2e4, 5e4, "usual")),
    }
}

fn bars() -> BarFigure {
    let bars = |values: [f64; 2]| values.map(|value| Some(Bar::new(value).interval(value - 4.0, value + 6.0))).to_vec();
    BarFigure {
        heading: Heading::new("both-sides", "Bars on both sides"),
        value: Axis::linear("change", "%"),
        groups: Group::assign(["ols", "wls"]),
        rows: vec![
            BarRow { label: "more".into(), bars: bars([35.5, 80.0]) },
            BarRow { label: "less".into(), bars: bars([-42.25, -1.0]) },
            BarRow { label: "one alone".into(), bars: vec![None, Some(Bar::new(0.0))] },
        ],
        levels: vec![Level::new(88.0, "limit"), Level::new(-50.0, "least")],
        digits: Some(2),
    }
}

#[test]
fn golden_figures_with_all_that_they_can_show() {
    let section = Section::new("All").figure(&scatter()).unwrap().figure(&ratios()).unwrap();
    let section = section.figure(&intervals()).unwrap().figure(&bars()).unwrap();
    let document = Document::new("Figures").section(section);
    assert_golden("figures.txt", &text_of(&document));
    for figure in document.figures() {
        assert_golden(&format!("{}.svg", figure.name), &figure.svg);
    }
}
