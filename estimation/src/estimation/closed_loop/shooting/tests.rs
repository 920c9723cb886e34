//! Multiple shooting on a problem whose motion runs away, with its solution in closed form.
//!
//! ```text
//! ẋ₁ = x₂        ẋ₂ = μ² x₁ − (μ² + β²) sin β t        x₁ = sin β t + a e^{−μt} + b e^{μ(t−1)}
//! ```
//! with β = π and a = b = 0 on [0, 1]: H. G. Bock, "Randwertproblemmethoden zur Parameteridentifizierung in Systemen nichtlinearer
//! Differentialgleichungen", Bonner Mathematische Schriften 183, 1987. With μ = 60 an error at the beginning has grown by 10²⁶ at
//! the end.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, dmatrix, dvector};

use super::interval::{End, Interval, Point};
use super::search::{CLOSED, Found, search};
use crate::linalg::LeastSquares;

const MU: f64 = 60.0;
const INTERVALS: usize = 10;
const H: f64 = 1.0 / INTERVALS as f64;

/// The particular solution and its derivative by β.
fn particular(beta: f64, t: f64) -> (DVector<f64>, DVector<f64>) {
    let (sin, cos) = (libm::sin(beta * t), libm::cos(beta * t));
    (dvector![sin, beta * cos], dvector![t * cos, cos - beta * t * sin])
}

/// Every interval is measured at its beginning.
fn linearise(measured: &[DVector<f64>], point: &Point) -> Vec<Interval> {
    let (sinh, cosh) = (libm::sinh(MU * H), libm::cosh(MU * H));
    let growth = dmatrix![cosh, sinh / MU; MU * sinh, cosh];
    let beta = point.beta[0];
    let nodes = point.nodes.iter().zip(measured).enumerate();
    nodes
        .map(|(j, (x, measured))| {
            let ((from, from_slope), (to, to_slope)) =
                (particular(beta, j as f64 * H), particular(beta, (j + 1) as f64 * H));
            Interval {
                residual: measured - x,
                by_state: DMatrix::identity(2, 2),
                by_parameters: DMatrix::zeros(2, 1),
                end: (j + 1 < point.nodes.len()).then(|| End {
                    state: to + &growth * (x - from),
                    by_state: growth.clone(),
                    by_parameters: DMatrix::from_column_slice(2, 1, (to_slope - &growth * from_slope).as_slice()),
                }),
            }
        })
        .collect()
}

const SIZES: [f64; 2] = [0.7, 2.2];

fn from(measured: &[DVector<f64>], point: Point) -> Found {
    let at = linearise(measured, &point);
    let sizes = DVector::from_row_slice(&SIZES);
    search((point, at), (&sizes, 1), &|point| Ok(linearise(measured, point)), |_| false).unwrap()
}

/// Least squares over β, a and b, whose parts of the motion do not exceed their size anywhere: an independent route.
fn directly(measured: &[DVector<f64>], weights: &DVector<f64>) -> f64 {
    let mut theta = dvector![PI, 0.0, 0.0];
    for _ in 0..50 {
        let rows = 2 * measured.len();
        let (mut jacobian, mut residual) = (DMatrix::zeros(rows, 3), DVector::zeros(rows));
        for (j, measured) in measured.iter().enumerate() {
            let t = j as f64 * H;
            let (x, slope) = particular(theta[0], t);
            let (falls, grows) = (libm::exp(-MU * t), libm::exp(MU * (t - 1.0)));
            let parts = [[slope[0], falls, grows], [slope[1], -MU * falls, MU * grows]];
            for i in 0..2 {
                let motion = x[i] + parts[i][1] * theta[1] + parts[i][2] * theta[2];
                residual[2 * j + i] = weights[i] * (measured[i] - motion);
                for (k, part) in parts[i].iter().enumerate() {
                    jacobian[(2 * j + i, k)] = weights[i] * part;
                }
            }
        }
        theta += LeastSquares::solve(&jacobian, &residual).unwrap().solution();
    }
    theta[0]
}

#[test]
fn analytic_the_unstable_problem_of_bock_is_solved_from_far_away() {
    let exact: Vec<DVector<f64>> = (0..INTERVALS).map(|j| particular(PI, j as f64 * H).0).collect();
    let start = |measured: &[DVector<f64>], beta: f64| Point { beta: dvector![beta], nodes: measured.to_vec() };
    for beta in [0.5, 1.0, 4.0] {
        let found = from(&exact, start(&exact, beta));
        assert!((found.point.beta[0] - PI).abs() < 1e-10 && found.gap < CLOSED, "{beta}: {found:?}");
    }
    let noise = |j: usize, i: usize| 0.05 * libm::sin((7 * j + 3 * i + 1) as f64 * 1.7);
    let noisy: Vec<DVector<f64>> =
        exact.iter().enumerate().map(|(j, x)| dvector![x[0] + noise(j, 0), x[1] + noise(j, 1)]).collect();
    let found = from(&noisy, start(&noisy, 1.0));
    // Outputs weigh by the sizes of their residuals, to first order those at the end.
    let squares = found.point.nodes.iter().zip(&noisy).map(|(x, measured)| (measured - x).map(|r| r * r));
    let expected = directly(&noisy, &squares.sum::<DVector<f64>>().map(|square| 1.0 / square.sqrt()));
    assert!((expected - PI).abs() > 1e-3 && found.gap < CLOSED, "{expected} {found:?}");
    assert!((found.point.beta[0] - expected).abs() < 1e-4, "{found:?} {expected}");
}
