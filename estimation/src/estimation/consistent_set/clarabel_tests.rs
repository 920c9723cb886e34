//! The agreement with the data against a semidefinite program.
//!
//! Clarabel solves `min χ²(φ)` over a cone that holds all consistent sets: pairs of rows of each pseudo-inertia as
//! second-order cones, and after each solution a half space for every negative eigenvector. Its value is a lower bound of that of the
//! semidefinite program, and rises to it.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector, Matrix4, Matrix4x2, SymmetricEigen, Vector4};
use rand::RngExt;

use super::{Prior, ShapeBounds, constrained_fit, definite_inverse};
use crate::base::{BaseReduction, Method, reduce};
use crate::chains::random_robot;
use crate::model::term::Sign;
use crate::model::{Columns, DriveParameters, ParameterKind, StandardParameters};
use crate::seed::Seed;
use crate::spatial::{Inertia, PseudoInertia};

/// Rounds of half spaces.
const ROUNDS: usize = 60;

/// Beyond this many times the size of the true link or drive nobody looks: without an end, Clarabel would. Farther than the horizon.
const FAR: f64 = 1e5;

/// The linear form `uᵀ X v` of a link's X = L⁻¹ P L⁻ᵀ, which is of size 1 where P is near L Lᵀ.
fn form(p: usize, at: usize, inverse: &Matrix4<f64>, u: &Vector4<f64>, v: &Vector4<f64>) -> DVector<f64> {
    let mut row = DVector::zeros(p);
    for k in 0..10 {
        let mut ten = [0.0; 10];
        ten[k] = 1.0;
        let x = inverse * Inertia::from_array(&ten).pseudo().0 * inverse.transpose();
        row[at + k] = (u.transpose() * x * v)[0];
    }
    row
}

/// The size of each parameter of an arm, so that Clarabel sees numbers near one.
fn sizes(base: &BaseReduction, truth: &StandardParameters) -> DVector<f64> {
    DVector::from_iterator(
        base.parameters.len(),
        base.parameters.iter().map(|id| {
            let p = truth.links[id.index].pseudo().0;
            let reach = p.diagonal().rows(0, 3).max();
            match id.kind {
                ParameterKind::M => p[(3, 3)],
                ParameterKind::Mcx | ParameterKind::Mcy | ParameterKind::Mcz => (p[(3, 3)] * reach).sqrt(),
                ParameterKind::Term(term) => {
                    Some(truth.drives[id.index][term].abs()).filter(|&x| x > 0.0).unwrap_or(1.0)
                }
                ParameterKind::Ixx
                | ParameterKind::Ixy
                | ParameterKind::Ixz
                | ParameterKind::Iyy
                | ParameterKind::Iyz
                | ParameterKind::Izz => reach,
            }
        }),
    )
}

/// The least χ² over all consistent sets, from below; `goal` is what it is compared with.
fn lower_bound(
    base: &BaseReduction,
    beta: &DVector<f64>,
    information: &DMatrix<f64>,
    truth: &StandardParameters,
    goal: f64,
) -> f64 {
    let p = base.parameters.len();
    let size = sizes(base, truth);
    let links: Vec<usize> = (0..p).filter(|&c| base.parameters[c].kind == ParameterKind::M).collect();
    let inverses: Vec<Matrix4<f64>> =
        truth.links.iter().map(|link| link.pseudo().0.cholesky().unwrap().l().try_inverse().unwrap()).collect();
    // Rows and what is added to them: in second-order cones by threes, and not below zero.
    let mut rows: Vec<DVector<f64>> = Vec::new();
    let mut half_spaces: Vec<(DVector<f64>, f64)> = Vec::new();
    for (&at, inverse) in links.iter().zip(&inverses) {
        let of = |u: usize, v: usize| form(p, at, inverse, &Vector4::ith(u, 1.0), &Vector4::ith(v, 1.0));
        for i in 0..4 {
            for j in 0..i {
                rows.extend([of(i, i) + of(j, j), of(i, i) - of(j, j), of(i, j) * 2.0]);
            }
            half_spaces.push((-of(i, i), FAR));
        }
    }
    for (c, id) in base.parameters.iter().enumerate() {
        if id.kind.term().is_some_and(|term| term.entry().sign == Sign::NotNegative) {
            let one = DVector::from_fn(p, |k, _| if k == c { 1.0 / size[c] } else { 0.0 });
            half_spaces.extend([(one.clone(), 0.0), (-one, FAR)]);
        }
    }
    // Variables φ and w = F (K φ − β), so that the objective is ½ wᵀ w.
    let root = information.clone().cholesky().unwrap().l().transpose();
    let (whitened, target) = (&root * &base.k, &root * beta);
    let b = beta.len();
    let upper: Vec<Vec<f64>> =
        (0..p + b).map(|i| (0..p + b).map(|j| f64::from(u8::from(i == j && i >= p))).collect()).collect();
    let mut bound = 0.0_f64;
    for _ in 0..ROUNDS {
        let equal = (0..b).map(|i| {
            let phi = whitened.row(i).iter().zip(&size).map(|(x, size)| x * size).collect::<Vec<_>>().into_iter();
            phi.chain((0..b).map(move |j| -f64::from(u8::from(i == j)))).collect::<Vec<f64>>()
        });
        let cones = rows.iter().chain(half_spaces.iter().map(|(row, _)| row));
        let cones = cones.map(|row| {
            row.iter().zip(&size).map(|(x, size)| -x * size).chain((0..b).map(|_| 0.0)).collect::<Vec<f64>>()
        });
        let all: Vec<Vec<f64>> = equal.chain(cones).collect();
        let mut right: Vec<f64> = target.iter().copied().chain(rows.iter().map(|_| 0.0)).collect();
        right.extend(half_spaces.iter().map(|(_, offset)| *offset));
        let mut kinds: Vec<SupportedConeT<f64>> = vec![SupportedConeT::ZeroConeT(b)];
        kinds.extend((0..rows.len() / 3).map(|_| SupportedConeT::SecondOrderConeT(3)));
        kinds.push(SupportedConeT::NonnegativeConeT(half_spaces.len()));
        let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
        let gradient = vec![0.0; p + b];
        let (upper, all) = (CscMatrix::from(&upper), CscMatrix::from(&all));
        let mut solver = DefaultSolver::new(&upper, &gradient, &all, &right, &kinds, settings).unwrap();
        solver.solve();
        let status = solver.solution.status;
        assert!(matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved), "{status:?}");
        let phi = DVector::from_column_slice(&solver.solution.x[..p]).component_mul(&size);
        let r = &base.k * &phi - beta;
        bound = bound.max(r.dot(&(information * &r)));
        if goal <= 1.02 * bound {
            break;
        }
        let known = half_spaces.len();
        for (&at, inverse) in links.iter().zip(&inverses) {
            let ten: [f64; 10] = std::array::from_fn(|k| phi[at + k]);
            let x = inverse * Inertia::from_array(&ten).pseudo().0 * inverse.transpose();
            let eigen = SymmetricEigen::new(x);
            for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
                if *value < -1e-9 {
                    let u = vector.into_owned();
                    half_spaces.push((form(p, at, inverse, &u, &u), 0.0));
                }
            }
        }
        if half_spaces.len() == known {
            break;
        }
    }
    bound
}

#[test]
fn clarabel_chi_squared_is_that_of_the_semidefinite_program() {
    let (mut contradicted, mut unfinished) = (0, 0);
    for run in 0..20 {
        let mut rng = Seed::new(71).stream("consistent arms", run);
        let (robot, mut truth) = random_robot(&mut rng, 3 + (run % 4) as usize);
        let columns = Columns::RIGID_ROTOR_FRICTION;
        let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
        if run % 3 == 0 {
            // Links that are nearly rods, on the edge of what is possible.
            for link in &mut truth.links {
                let size = [0.2, 0.2, 0.2, 1.0];
                let a = Matrix4x2::from_fn(|i, _| size[i] * rng.random_range(-1.7..1.7));
                *link = PseudoInertia(a * a.transpose() + Matrix4::identity() * 1e-4).inertia();
            }
        }
        // A guess as a URDF has it: inertias a third off, every second one without friction and rotors.
        let mut guess = truth.clone();
        for link in &mut guess.links {
            let factor = rng.random_range(0.7..1.4);
            *link = Inertia::from_array(&link.to_array().map(|x| factor * x));
        }
        if run % 2 == 0 {
            guess.drives.fill(DriveParameters::default());
        }
        // Noise that parameters share, from a thousandth of their size to all of it: the smaller, the further outside of
        // what is possible a shift of two friction coefficients leads.
        let exact = base.beta(&truth.vector(&robot, columns));
        let b = exact.len();
        let level = [1e-3, 1e-2, 0.1, 1.0][(run % 4) as usize];
        let std = exact.map(|x| level * (0.2 * x.abs() + 1e-2));
        let root = DMatrix::from_fn(b, b, |i, j| f64::from(u8::from(i == j)) + 0.3 * rng.random_range(-1.0..1.0));
        let mixed = DMatrix::from_diagonal(&std) * &root;
        let covariance = &mixed * mixed.transpose();
        let mut beta = &exact + &mixed * DVector::from_fn(b, |_, _| rng.random_range(-1.7..1.7));
        for (row, name) in base.names().iter().enumerate() {
            if name.starts_with("Fv1") || name.starts_with("Fc2") {
                beta[row] = -3.0 * covariance[(row, row)].sqrt();
            }
        }
        let information = definite_inverse(&covariance).unwrap();
        let data = (&beta, information.clone(), &covariance);
        let fit = constrained_fit(&base, (&guess, &ShapeBounds::default()), data, Prior::None).unwrap();
        // Noise as large as the parameters asks for links a thousand times the guess; the search then says that it did not end.
        unfinished += usize::from(!fit.termination.was_successful());
        let links = (0..fit.phi.len()).filter(|&c| base.parameters[c].kind == ParameterKind::M);
        for at in links {
            let ten: [f64; 10] = std::array::from_fn(|k| fit.phi[at + k]);
            assert!(Inertia::from_array(&ten).check().is_ok(), "{run}: {ten:?}");
        }
        let off = base.beta(&fit.phi) - &beta;
        let chi_squared = off.dot(&(&information * &off));
        let least = lower_bound(&base, &beta, &information, &truth, chi_squared);
        assert!(
            chi_squared <= 1.02 * least + 1e-6 && chi_squared >= (1.0 - 1e-4) * least - 1e-6,
            "{run}: {chi_squared} against {least} of the semidefinite program, {:?}",
            fit.termination
        );
        contradicted += usize::from(chi_squared > 1.0);
    }
    assert!(unfinished <= 2, "{unfinished} searches did not end");
    assert!(contradicted >= 15, "only {contradicted} estimates were impossible");
}
