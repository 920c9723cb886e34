//! The optimiser on problems whose solution is known in closed form, with a curved limit.

use super::{
    CombinedLimits, LinearLimits, Objective, Progress, Row, RowSource, Sequential, SequentialSettings, SmoothLimits,
    SmoothRow, nearest_inside,
};

/// `f = s (x² + y² − 1) − w·(x, y)`.
struct Bowl {
    s: f64,
    w: [f64; 2],
    at: [f64; 2],
}

impl Objective for Bowl {
    fn value(&mut self, x: &[f64]) -> f64 {
        self.at = [x[0], x[1]];
        self.s * (x[0] * x[0] + x[1] * x[1] - 1.0) - self.w[0] * x[0] - self.w[1] * x[1]
    }

    fn gradient(&mut self, gradient: &mut [f64]) {
        for i in 0..2 {
            gradient[i] = 2.0 * self.s * self.at[i] - self.w[i];
        }
    }
}

/// `x² + y² ≤ 1`.
struct Disc;

impl SmoothLimits for Disc {
    fn excess(&mut self, x: &[f64]) -> f64 {
        (x[0] * x[0] + x[1] * x[1] - 1.0).max(0.0)
    }

    fn linearise(&mut self, x: &[f64], rows: &mut Vec<SmoothRow>) {
        let normal = vec![2.0 * x[0], 2.0 * x[1]];
        let row = Row { start: 0, normal, bound: 1.0 - x[0] * x[0] - x[1] * x[1] };
        rows.push(SmoothRow { row, limit: 0, at: 0.0 });
    }
}

/// `x_i ≤ 10`.
#[derive(Default)]
struct Far {
    center: Vec<f64>,
}

impl RowSource for Far {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        for (start, (x, d)) in self.center.iter().zip(step).enumerate() {
            if x + d > 10.0 {
                rows.push(Row { start, normal: vec![1.0], bound: 10.0 - x });
            }
        }
    }
}

impl LinearLimits for Far {
    fn recenter(&mut self, x: &[f64]) {
        self.center = x.to_vec();
    }
}

/// Where the optimiser ends, and after how many evaluations.
fn minimum(mut objective: Bowl, start: [f64; 2]) -> (Sequential, Progress) {
    let settings = SequentialSettings { tolerance: 1e-12, max_evaluations: 60, ..SequentialSettings::default() };
    let mut linear = Far::default();
    let mut state = Sequential::new(start.to_vec(), &mut objective, &mut Disc, settings);
    loop {
        let progress = state.step(&mut objective, &mut linear, &mut Disc);
        if progress != Progress::Moved {
            return (state, progress);
        }
    }
}

#[test]
fn analytic_a_straight_slope_ends_where_the_limit_bends_away_from_it() {
    // All curvature is the limit's: an optimiser with the curvature of the objective alone crawls along it.
    let (state, progress) = minimum(Bowl { s: 0.0, w: [1.0, 2.0], at: [0.0; 2] }, [0.3, -0.4]);
    let size = 5.0_f64.sqrt();
    assert!((state.x[0] - 1.0 / size).abs() < 1e-6 && (state.x[1] - 2.0 / size).abs() < 1e-6, "{:?}", state.x);
    assert!(progress == Progress::Stationary && state.excess < 1e-9, "{progress:?} after {}", state.evaluations);
}

#[test]
fn analytic_steps_along_a_bend_are_not_cut() {
    // From a point on the circle the full step to the solution (1, 0) leaves the disc, and raises f as well where s > 0
    // (N. Maratos's effect, Nocedal and Wright, section 15.4).
    let (sin, cos) = libm::sincos(0.8);
    let (state, progress) = minimum(Bowl { s: 0.4, w: [1.0, 0.0], at: [0.0; 2] }, [cos, sin]);
    assert!((state.x[0] - 1.0).abs() < 1e-6 && state.x[1].abs() < 1e-6, "{:?}", state.x);
    assert!(progress == Progress::Stationary && state.evaluations <= 30, "{progress:?} after {}", state.evaluations);
}

#[test]
fn analytic_a_point_a_little_outside_a_linear_limit_moves_along_it() {
    // Coming back to x = 10 raises f by 0.1, more than the 0.045 that y can gain on the way to its best value, 0.3.
    let mut bowl = Bowl { s: 0.5, w: [110.0, 0.3], at: [0.0; 2] };
    let (mut linear, mut free) = (Far::default(), CombinedLimits::default());
    let settings = SequentialSettings { tolerance: 1e-12, max_evaluations: 60, ..SequentialSettings::default() };
    let mut state = Sequential::new(vec![10.001, 0.0], &mut bowl, &mut free, settings);
    while state.step(&mut bowl, &mut linear, &mut free) == Progress::Moved {}
    assert!((state.x[0] - 10.0).abs() < 1e-12 && (state.x[1] - 0.3).abs() < 1e-6, "{:?}", state.x);
}

#[test]
fn analytic_the_nearest_point_of_a_disc_is_on_the_ray_through_its_centre() {
    let found = nearest_inside(&[1.02, 0.34], &mut Far::default(), &mut Disc, 1e-9).unwrap();
    let size = libm::hypot(1.02, 0.34);
    assert!((found[0] - 1.02 / size).abs() < 1e-8 && (found[1] - 0.34 / size).abs() < 1e-8, "{found:?}");
    // A disc out of reach of the linear limits.
    struct Beyond;
    impl SmoothLimits for Beyond {
        fn excess(&mut self, x: &[f64]) -> f64 {
            (20.0 - x[0]).max(0.0)
        }

        fn linearise(&mut self, x: &[f64], rows: &mut Vec<SmoothRow>) {
            let row = Row { start: 0, normal: vec![-1.0, 0.0], bound: x[0] - 20.0 };
            rows.push(SmoothRow { row, limit: 0, at: 0.0 });
        }
    }
    assert_eq!(nearest_inside(&[9.0, 0.0], &mut Far::default(), &mut Beyond, 1e-9), None);
}
