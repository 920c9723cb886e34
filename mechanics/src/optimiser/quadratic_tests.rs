//! The quadratic program against closed forms and an interior-point solver.

use nalgebra::{DMatrix, DVector};

use super::{QuadraticError, QuadraticSolution, Row, RowSource, solve_quadratic};
use crate::seed::Seed;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SupportedConeT};
use rand::RngExt;

/// A fixed list of rows, each held to a tolerance.
struct FixedRows {
    rows: Vec<Row>,
    /// Largest excess that counts as none.
    tolerance: f64,
}

impl RowSource for FixedRows {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        rows.extend(self.rows.iter().filter(|row| row.excess(step) > self.tolerance).cloned());
    }
}

struct Program {
    hessian: DMatrix<f64>,
    gradient: Vec<f64>,
    rows: Vec<Row>,
}

impl Program {
    fn inverse(&self) -> DMatrix<f64> {
        self.hessian.clone().try_inverse().unwrap()
    }
}

fn random(n: usize, count: usize, run: u64) -> Program {
    let mut rng = Seed::new(5).stream("quadratic program", run);
    let root = DMatrix::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0));
    let hessian = &root * root.transpose() + DMatrix::identity(n, n) * 0.1;
    let gradient = (0..n).map(|_| rng.random_range(-3.0..3.0)).collect();
    let rows = (0..count)
        .map(|k| {
            let (start, length) = if k % 3 == 0 { (0, n) } else { (n / 3, n / 2) };
            Row {
                start,
                normal: (0..length).map(|_| rng.random_range(-1.0..1.0)).collect(),
                bound: rng.random_range(0.0..0.3),
            }
        })
        .collect();
    Program { hessian, gradient, rows }
}

fn clarabel(program: &Program) -> Vec<f64> {
    let n = program.gradient.len();
    let upper = DMatrix::from_fn(n, n, |i, j| if i <= j { program.hessian[(i, j)] } else { 0.0 });
    let dense = |m: &DMatrix<f64>| {
        let rows: Vec<Vec<f64>> = m.row_iter().map(|row| row.iter().copied().collect()).collect();
        CscMatrix::from(&rows)
    };
    let mut a = DMatrix::zeros(program.rows.len(), n);
    for (r, row) in program.rows.iter().enumerate() {
        for (k, &value) in row.normal.iter().enumerate() {
            a[(r, row.start + k)] = value;
        }
    }
    let bounds: Vec<f64> = program.rows.iter().map(|row| row.bound).collect();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [SupportedConeT::NonnegativeConeT(bounds.len())];
    let mut solver =
        DefaultSolver::new(&dense(&upper), &program.gradient, &dense(&a), &bounds, &cones, settings).unwrap();
    solver.solve();
    solver.solution.x.clone()
}

fn check_optimality(program: &Program, solution: &QuadraticSolution) {
    let sum = solution.lagrangian_gradient(&DVector::from_column_slice(&program.gradient));
    let residual = &program.hessian * &solution.step + sum;
    for (row, multiplier) in &solution.active {
        assert!(*multiplier >= 0.0 && row.excess(solution.step.as_slice()).abs() < 1e-9);
    }
    assert!(residual.norm() < 1e-8, "stationarity {}", residual.norm());
    for row in &program.rows {
        assert!(row.excess(solution.step.as_slice()) < 1e-9);
    }
}

#[test]
fn identity_solution_equals_an_interior_point_solver() {
    for run in 0..12 {
        let (n, count) = [(6, 40), (20, 200), (40, 600)][run as usize % 3];
        let program = random(n, count, run);
        let mut source = FixedRows { rows: program.rows.clone(), tolerance: 1e-10 };
        let solution = solve_quadratic(&program.inverse(), &program.gradient, Vec::new(), &mut source).unwrap();
        check_optimality(&program, &solution);
        let other = clarabel(&program);
        for (x, y) in solution.step.iter().zip(&other) {
            // The interior-point solver stops at relative gaps of 1e-8.
            assert!((x - y).abs() < 1e-5, "{x} against {y}");
        }
    }
}

#[test]
fn identity_warm_start_changes_the_path_not_the_solution() {
    let program = random(40, 600, 77);
    let mut source = FixedRows { rows: program.rows.clone(), tolerance: 1e-10 };
    let cold = solve_quadratic(&program.inverse(), &program.gradient, Vec::new(), &mut source).unwrap();
    let active: Vec<Row> = cold.active.iter().map(|(row, _)| row.clone()).collect();
    let same = solve_quadratic(&program.inverse(), &program.gradient, active.clone(), &mut source).unwrap();
    assert!((&same.step - &cold.step).norm() < 1e-9 && same.iterations == 0);
    // A wrong guess: some of the active rows, others that are not, one of them twice.
    let mut wrong: Vec<Row> = active[..active.len() / 2].to_vec();
    wrong.extend(program.rows[..30].iter().cloned());
    wrong.push(wrong[0].clone());
    let other = solve_quadratic(&program.inverse(), &program.gradient, wrong, &mut source).unwrap();
    check_optimality(&program, &other);
    assert!((&other.step - &cold.step).norm() < 1e-8);
}

#[test]
fn analytic_box_projection() {
    // The point of the unit box nearest to (2, −3, 0.5).
    let rows: Vec<Row> =
        (0..3).flat_map(|i| [1.0, -1.0].map(|sign| Row { start: i, normal: vec![sign], bound: 1.0 })).collect();
    let mut source = FixedRows { rows, tolerance: 1e-12 };
    let solution = solve_quadratic(&DMatrix::identity(3, 3), &[-2.0, 3.0, -0.5], Vec::new(), &mut source).unwrap();
    assert!((&solution.step - DVector::from_vec(vec![1.0, -1.0, 0.5])).norm() < 1e-14);
    let mut multipliers: Vec<f64> = solution.active.iter().map(|active| active.1).collect();
    multipliers.sort_by(f64::total_cmp);
    assert!((multipliers[0] - 1.0).abs() < 1e-14 && (multipliers[1] - 2.0).abs() < 1e-14);
}

#[test]
fn contradicting_rows_and_concave_problems_are_faults() {
    let rows = vec![
        Row { start: 0, normal: vec![1.0, 0.0], bound: -1.0 },
        Row { start: 0, normal: vec![-1.0, 0.0], bound: -1.0 },
    ];
    let mut source = FixedRows { rows, tolerance: 1e-12 };
    let fault = solve_quadratic(&DMatrix::identity(2, 2), &[0.0, 0.0], Vec::new(), &mut source).unwrap_err();
    assert!(matches!(fault, QuadraticError::Infeasible { excess } if excess > 1.0));
    let concave = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, -1.0]));
    assert_eq!(solve_quadratic(&concave, &[0.0, 0.0], Vec::new(), &mut source).unwrap_err(), QuadraticError::NotConvex);
}
