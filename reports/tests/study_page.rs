//! The page of one small stored study: its text and one figure of each kind byte for byte, and marks where the stored numbers are.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod golden;

use armid::experiment::{EffectKind, Effects};
use armid::statistics::Interval;
use armid::study::{
    Comparison, CriterionRatios, EffectLevels, Examples, FamilyScore, HarmonicsPlan, Lead, Metric, ReportInput,
    RobotsSummary, StudyResult,
};
use armid_reports::{
    Axis, Bar, BarFigure, BarRow, Document, Figure, Group, Heading, Level, Section, criteria_figure, levels_figure,
    robots_document, study_document,
};
use golden::{assert_golden, folder, text_of};

/// Figures whose SVG is stored: one of each kind.
const STORED: [&str; 7] = [
    "error-by-criterion",
    "criterion-and-error",
    "differences-by-condition",
    "coverage",
    "atlas-ols",
    "convergence",
    "limits-d-optimal",
];

/// How far rounding moves a mark from where two ticks say: half a unit of the view box for each of the three, and a unit is a tenth of a pixel.
const ROUNDING: f64 = 1.5;

fn input() -> ReportInput {
    let text = |name: &str| std::fs::read_to_string(folder().join(name)).unwrap();
    let result: StudyResult = serde_json::from_str(&text("summary.json")).unwrap();
    let examples: Examples = serde_json::from_str(&text("examples.json")).unwrap();
    ReportInput { result, examples }
}

fn svg(document: &Document, name: &str) -> String {
    let figure = document.figures().find(|figure| figure.name == name);
    figure.unwrap_or_else(|| panic!("no figure {name}")).svg.clone()
}

#[test]
fn golden_page_and_figures_of_a_study() {
    let document = study_document(&input()).unwrap();
    assert_golden("page.txt", &text_of(&document));
    for name in STORED {
        assert_golden(&format!("{name}.svg"), &svg(&document, name));
    }
}

#[test]
fn golden_page_of_a_study_on_two_robots() {
    // The second robot says the opposite of the first: significantly in the exact scenario, not so in the other.
    let mut first = input().result;
    let mut second = first.clone();
    second.plan.robot = "other".to_owned();
    second.provenance.robot = "other".to_owned();
    for part in &mut second.conditions {
        for c in &mut part.findings.comparisons {
            let pair = [c.first.clone(), c.second.clone()];
            *c = c.over(&pair[0]).unwrap();
            [c.first, c.second] = pair;
        }
    }
    let decided = [&mut first.conditions[..], &mut second.conditions[..1]];
    for c in decided.into_iter().flatten().flat_map(|part| &mut part.findings.comparisons) {
        c.better = Some(if c.difference < 1.0 { c.first.clone() } else { c.second.clone() });
    }
    let figure = criteria_figure(&[&first, &second].map(CriterionRatios::from_result));
    assert_golden("criteria.svg", &figure.svg().unwrap());
    let summary = RobotsSummary::from_results(&[first, second]);
    assert_golden("robots.txt", &text_of(&robots_document(&summary).unwrap()));
}

#[test]
fn golden_criteria_over_the_size_of_an_effect() {
    // With an exact model every criterion errs twice as much as D-optimality; at each further size 0.6 times as much as before.
    let mut result = input().result;
    let exact = result.conditions[0].clone();
    result.conditions.clear();
    for (step, size) in [0.0, 0.0005, 0.005, 0.05].into_iter().enumerate() {
        let mut part = exact.clone();
        part.condition.effects = Effects::none().with_effect(EffectKind::LoadFriction, size);
        for c in &mut part.findings.comparisons {
            if let Some(over) = c.over("d-optimal") {
                let ratio = 2.0 * 0.6_f64.powi(step as i32);
                let interval = Some(Interval { low: ratio / 1.2, high: ratio * 1.2 });
                *c = Comparison { difference: ratio, interval, ..over };
            }
        }
        result.conditions.push(part);
    }
    let levels = EffectLevels::from_result(&result);
    // ln ρ falls by ln 0.6 in a decade from 1.2 at 0.0005: 1 is reached after ln 1.2 / ln(1/0.6) of one.
    let expected = 0.0005 * 10.0_f64.powf(1.2_f64.ln() / (1.0 / 0.6_f64).ln());
    let lead =
        levels[0].ratios.iter().find(|r| r.criterion == "condition" && r.metric == Metric::Prediction).unwrap().lead;
    assert!(matches!(lead, Lead::Ends { size, .. } if (size / expected - 1.0).abs() < 1e-9), "{lead:?}");
    assert_golden("levels.svg", &levels_figure(&levels[0]).svg().unwrap());
    let page = text_of(&study_document(&ReportInput { result, examples: input().examples }).unwrap());
    assert!(page.contains("From which size of an effect on?") && page.contains("load friction"), "{page}");
}

#[test]
fn golden_bars_of_the_use_of_limits() {
    let result = input().result;
    let designs: Vec<_> = result.designs.iter().filter(|design| design.start == 0).collect();
    let bars = |use_of: fn(&armid::excitation::WorstLimitUse) -> f64| {
        designs.iter().map(|design| Some(Bar::new(100.0 * use_of(&design.certificate.worst_limit_use)))).collect()
    };
    let figure = BarFigure {
        heading: Heading::new("limit-use", "Use of each limit"),
        value: Axis::linear("share of the limit", "%"),
        groups: Group::assign(designs.iter().map(|design| result.plan.designs[design.family].name.clone())),
        rows: vec![
            BarRow { label: "position".into(), bars: bars(|used| used.position) },
            BarRow { label: "velocity".into(), bars: bars(|used| used.velocity) },
            BarRow { label: "acceleration".into(), bars: bars(|used| used.acceleration) },
        ],
        levels: vec![Level::new(100.0, "limit")],
        digits: Some(1),
    };
    let document = Document::new("Bars").section(Section::new("Limits").figure(&figure).unwrap());
    assert_golden("limit-use.svg", &svg(&document, "limit-use"));
}

#[test]
fn golden_page_of_a_study_with_more_designs_than_colours() {
    let mut input = input();
    let result = &mut input.result;
    let (plan, scores) = (result.plan.designs[1].clone(), result.conditions[0].findings.families.clone());
    let scores: Vec<&FamilyScore> = scores.iter().filter(|score| score.family == plan.name).collect();
    result.plan.designs.clear();
    result.conditions.truncate(1);
    result.conditions[0].findings.families.clear();
    for criterion in ["condition", "d-optimal", "a-optimal"] {
        for (family, harmonics) in [("fourier", 2), ("fourier", 4), ("spline", 2)] {
            let index = result.plan.designs.len();
            let name = format!("{criterion} {family} {harmonics}");
            for score in &scores {
                let mut score = FamilyScore { family: name.clone(), ..(*score).clone() };
                // Each an error of its own, and one that has none.
                score.values =
                    score.values.iter().map(|value| value.map(|value| value * 1.25_f64.powi(index as i32))).collect();
                if index == 4 {
                    score.values[0] = None;
                }
                result.conditions[0].findings.families.push(score);
            }
            result.plan.designs.push(armid::study::FamilyPlan {
                name,
                criterion: Some(criterion.to_owned()),
                family: Some(family.to_owned()),
                harmonics: Some(HarmonicsPlan::Every(harmonics)),
                ..plan.clone()
            });
        }
    }
    let document = study_document(&input).unwrap();
    assert_golden("grid.txt", &text_of(&document));
    assert_golden("prediction-by-design.svg", &svg(&document, "prediction-by-design"));
}

/// A horizontal axis, read back from the labels of its ticks.
struct Ruler {
    from: (f64, f64),
    to: (f64, f64),
    is_logarithmic: bool,
    /// Where the axis is, below the marks.
    bottom: f64,
}

impl Ruler {
    fn of(page: &roxmltree::Document<'_>, is_logarithmic: bool) -> Self {
        let ticks: Vec<(f64, f64, f64)> = page
            .descendants()
            .filter(|node| node.has_tag_name("text") && node.attribute("text-anchor") == Some("middle"))
            .filter_map(|node| {
                let value: f64 = node.text()?.trim().replace('−', "-").parse().ok()?;
                Some((value, number(node, "x"), number(node, "y")))
            })
            .collect();
        let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
        Self { from: (first.0, first.1), to: (last.0, last.1), is_logarithmic, bottom: first.2 }
    }

    /// Where a value is drawn.
    fn place(&self, value: f64) -> f64 {
        let scale = |value: f64| if self.is_logarithmic { value.ln() } else { value };
        let share = (scale(value) - scale(self.from.0)) / (scale(self.to.0) - scale(self.from.0));
        self.from.1 + share * (self.to.1 - self.from.1)
    }
}

fn number(node: roxmltree::Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// Lines of a width between the axis and the legend, whose marks are above 80 px: where each begins and ends.
fn lines(page: &roxmltree::Document<'_>, width: &str, ruler: &Ruler) -> Vec<[(f64, f64); 2]> {
    let of_width = page.descendants().filter(|node| node.has_tag_name("polyline"));
    let of_width = of_width.filter(|node| node.attribute("stroke-width") == Some(width));
    let points = of_width.map(|node| -> Vec<(f64, f64)> {
        let words = node.attribute("points").unwrap().split_whitespace();
        let point = words.map(|word| word.split_once(',').unwrap());
        point.map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).collect()
    });
    let two = points.filter_map(|points| <[(f64, f64); 2]>::try_from(points).ok());
    two.filter(|[(_, y), _]| (800.0..ruler.bottom).contains(y)).collect()
}

fn assert_near(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= ROUNDING, "{what}: drawn at {found}, expected at {expected}");
}

/// Every interval of a figure, row by row and group by group, is drawn from its lower to its upper end.
#[test]
fn identity_intervals_are_drawn_where_their_numbers_are() {
    let input = input();
    let (result, document) = (&input.result, study_document(&input).unwrap());
    let estimator = result.shown_estimator();
    let families: Vec<&FamilyScore> =
        result.findings().families.iter().filter(|score| score.estimator == estimator).collect();
    let mut figures: Vec<(&str, bool, Vec<Interval>)> = Vec::new();
    let of_part = |part: &armid::study::ConditionResult| -> Vec<Interval> {
        let all = part.findings.comparisons.iter();
        let all = all.filter(|c| c.metric == Metric::Prediction && c.estimator == estimator);
        all.map(|c| c.interval.unwrap()).collect()
    };
    let of_parts: Vec<Vec<Interval>> = result.conditions.iter().map(of_part).collect();
    let by_condition = (0..of_parts[0].len()).flat_map(|row| of_parts.iter().map(move |part| part[row]));
    figures.push(("differences-by-condition", true, by_condition.collect()));
    let of_parameters = |interval: fn(&FamilyScore, usize, f64) -> Interval| -> Vec<Interval> {
        let units = result.parameters.iter().map(|parameter| parameter.reference_unit).enumerate();
        units.flat_map(|(i, unit)| families.iter().map(move |score| interval(score, i, unit))).collect()
    };
    figures.push((
        "bias",
        false,
        of_parameters(|score, i, unit| {
            let Interval { low, high } = score.parameters[i].bias_interval.unwrap();
            Interval { low: low / unit, high: high / unit }
        }),
    ));
    figures.push((
        "coverage",
        false,
        of_parameters(|score, i, _| {
            let Interval { low, high } = score.parameters[i].coverage_interval.unwrap();
            Interval { low: 100.0 * low, high: 100.0 * high }
        }),
    ));
    for (name, is_logarithmic, intervals) in figures {
        let svg = svg(&document, name);
        let page = roxmltree::Document::parse(&svg).unwrap();
        let ruler = Ruler::of(&page, is_logarithmic);
        let drawn = lines(&page, "16", &ruler);
        assert_eq!(drawn.len(), intervals.len(), "{name}");
        for ([(low, y), (high, same)], interval) in drawn.iter().zip(&intervals) {
            assert_near(*low, ruler.place(interval.low), name);
            assert_near(*high, ruler.place(interval.high), name);
            assert!((y - same).abs() < f64::EPSILON, "{name}");
        }
        // Rows stand below each other in their order.
        assert!(drawn.windows(2).all(|pair| pair[0][0].1 < pair[1][0].1), "{name}");
    }
}

#[test]
fn identity_boxes_are_drawn_where_their_quantiles_are() {
    let input = input();
    let (result, document) = (&input.result, study_document(&input).unwrap());
    for (name, spread) in [
        ("error-by-criterion", (|score| score.prediction_spread) as fn(&FamilyScore) -> _),
        ("parameter-error-by-criterion", |score| score.reference_spread),
    ] {
        let svg = svg(&document, name);
        let page = roxmltree::Document::parse(&svg).unwrap();
        let ruler = Ruler::of(&page, true);
        let medians = lines(&page, "20", &ruler);
        let whiskers: Vec<_> = lines(&page, "12", &ruler).into_iter().filter(|[from, to]| from.0 < to.0).collect();
        let families = &result.findings().families;
        assert_eq!((medians.len(), whiskers.len()), (families.len(), 2 * families.len()), "{name}");
        for (k, score) in families.iter().enumerate() {
            let s = spread(score).unwrap();
            assert_near(medians[k][0].0, ruler.place(s.median), name);
            for (line, ends) in
                whiskers[2 * k..2 * k + 2].iter().zip([[s.low, s.lower_quartile], [s.upper_quartile, s.high]])
            {
                assert_near(line[0].0, ruler.place(ends[0]), name);
                assert_near(line[1].0, ruler.place(ends[1]), name);
            }
        }
    }
}
