//! A load that is known, from estimates and from simulated logs.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use super::fixtures::estimate_of;
use super::{NegativeMassCause, Payload, payload};
use crate::base::{BaseReduction, LOAD_UNITS, Method, reduce};
use crate::chains::{ChainRecipe, crs_a460, crs_a460_nominal, planar_2r, random_inertia, random_state};
use crate::dynamics::{Dynamics, States};
use crate::estimation::{Estimate, EstimationError, EstimatorKind, Identification};
use crate::linalg::LeastSquares;
use crate::model::term::{COULOMB, LOAD_FRICTION, OFFSET, ROTOR, ShapeParameter, VISCOUS};
use crate::model::{Columns, DeclaredUncertainty, Robot, StandardParameters};
use crate::seed::Seed;
use crate::signal::Samples;
use crate::spatial::Inertia;

const COLUMNS: Columns = Columns::RIGID_ROTOR_FRICTION;

/// The parameters with a load on the last link.
fn loaded(parameters: &StandardParameters, load: &Inertia) -> StandardParameters {
    let mut loaded = parameters.clone();
    let last = loaded.links.last_mut().unwrap();
    let sum: Vec<f64> = last.to_array().iter().zip(load.to_array()).map(|(a, b)| a + b).collect();
    *last = Inertia::from_array(&sum.try_into().unwrap());
    loaded
}

/// Two estimates of an arm, the second with a load and so many times the Coulomb friction; each scattered by its standard deviations
/// times `noise`.
fn two(
    (robot, columns): (&Robot, Columns),
    parameters: &StandardParameters,
    (load, warmth): (&Inertia, f64),
    noise: f64,
    rng: &mut impl Rng,
) -> (BaseReduction, Estimate, Estimate) {
    let base = reduce(robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let mut with = loaded(parameters, load);
    for drive in &mut with.drives {
        drive[COULOMB] *= warmth;
    }
    let mut draw = |parameters: &StandardParameters| {
        let beta = base.beta(&parameters.vector(robot, columns));
        let b = beta.len();
        // Correlated: R Rᵀ of a random R near the identity, in units of the parameters.
        let size =
            |row: usize| base.parameters[base.kept[row]].kind.link_place().map_or(0.01, |place| LOAD_UNITS[place]);
        let mixing = DMatrix::from_fn(b, b, |i, j| {
            let x: f64 = StandardNormal.sample(rng);
            0.02 * size(i) * if i == j { 1.0 } else { 0.2 * x }
        });
        let white = DMatrix::from_fn(b, 1, |_, _| StandardNormal.sample(rng));
        let scattered = &beta + (&mixing * white).column(0) * noise;
        estimate_of(&base, &scattered, &(&mixing * mixing.transpose()))
    };
    let (without, with) = (draw(parameters), draw(&with));
    (base, without, with)
}

#[test]
fn identity_the_load_is_found_without_noise() {
    let mut rng = Seed::new(31).stream("payload", 0);
    let load = random_inertia(&mut rng);
    let (base, without, with) = two((&crs_a460(), COLUMNS), &crs_a460_nominal(), (&load, 1.0), 0.0, &mut rng);
    let found = payload(&base, &without, &with).unwrap();
    assert_eq!(found.base.rank(), 10);
    assert!(found.chi_squared < 1e-12 && found.widened_by <= 1.0 + 1e-12, "{}", found.chi_squared);
    for (parameter, expected) in found.parameters.iter().zip(load.to_array()) {
        let shown = parameter.shown.unwrap();
        assert!(
            (shown.value - expected).abs() < 1e-9 && (parameter.consistent - expected).abs() < 0.05 * shown.std,
            "{parameter:?}"
        );
        assert!(shown.ci95[0] < expected && expected < shown.ci95[1]);
    }
}

/// 7 joints, some prismatic: what K reveals of the last link is found, and 95 % intervals hold the truth at 95 %.
#[test]
fn intervals_cover_and_the_body_is_consistent() {
    let mut rng = Seed::new(32).stream("payload", 0);
    let mut recipe = ChainRecipe::new(7);
    recipe.prismatic = 0.0;
    let (robot, parameters) = recipe.draw(&mut rng);
    let (mut inside, mut all, mut rejected) = (0, 0, 0);
    for _ in 0..60 {
        let load = random_inertia(&mut rng);
        let (base, without, with) = two((&robot, COLUMNS), &parameters, (&load, 1.3), 1.0, &mut rng);
        let found = payload(&base, &without, &with).unwrap();
        assert!(found.body.inertia.check().is_ok());
        rejected += usize::from(found.chi_squared > found.chi_squared_limit);
        for (parameter, expected) in found.parameters.iter().zip(load.to_array()) {
            let Some(shown) = parameter.shown else { continue };
            all += 1;
            inside += usize::from(shown.ci95[0] <= expected && expected <= shown.ci95[1]);
        }
    }
    // 600 intervals at 95 % that are correlated in tens; widened ones cover a little more.
    let share = f64::from(inside as u32) / f64::from(all as u32);
    assert!(all == 600 && share > 0.93 && rejected < 10, "{share} of {all}, {rejected} rejected");
}

/// Where the change scatters w times as far as the covariances say, intervals are those of covariances w² as large.
#[test]
fn identity_widened_intervals_are_those_of_covariances_that_say_so() {
    let mut rng = Seed::new(34).stream("payload", 0);
    let load = random_inertia(&mut rng);
    let (base, without, mut with) =
        two((&crs_a460(), Columns::RIGID_ROTOR), &crs_a460_nominal(), (&load, 1.0), 1.0, &mut rng);
    with.base[0].value += 50.0 * with.base[0].std;
    let found = payload(&base, &without, &with).unwrap();
    let factor = found.widened_by;
    assert!(factor > 2.0);
    let larger = |estimate: Estimate| {
        let covariance = estimate.covariance_matrix() * (factor * factor);
        estimate.with_covariance(&covariance)
    };
    let other = payload(&base, &larger(without), &larger(with)).unwrap();
    assert!((other.widened_by - 1.0).abs() < 1e-9, "{}", other.widened_by);
    for (found, other) in found.combinations.base.iter().zip(&other.combinations.base) {
        assert!((found.std / other.std - 1.0).abs() < 1e-9, "{}: {} {}", found.name, found.std, other.std);
    }
}

#[test]
fn published_intervals_have_the_fewer_degrees_of_freedom() {
    let mut rng = Seed::new(35).stream("payload", 0);
    let load = random_inertia(&mut rng);
    let (base, without, with) = two((&crs_a460(), COLUMNS), &crs_a460_nominal(), (&load, 1.0), 0.0, &mut rng);
    for (first, second) in [(8.0, 1e9), (1e9, 8.0)] {
        let of = |estimate: &Estimate, degrees_of_freedom| Estimate { degrees_of_freedom, ..estimate.clone() };
        let found = payload(&base, &of(&without, first), &of(&with, second)).unwrap();
        for shown in found.parameters.iter().filter_map(|parameter| parameter.shown) {
            // Student's t at 0.975 with 8 degrees of freedom.
            let half = 0.5 * (shown.ci95[1] - shown.ci95[0]);
            assert!((half / shown.std - 2.306_004).abs() < 1e-5, "{}", half / shown.std);
        }
    }
}

#[test]
fn a_planar_arm_shows_four_combinations_and_what_is_no_load_is_told() {
    let mut rng = Seed::new(33).stream("payload", 0);
    let robot = planar_2r();
    let mut parameters = StandardParameters::zero(2);
    parameters.links = vec![random_inertia(&mut rng), random_inertia(&mut rng)];
    let load = random_inertia(&mut rng);
    let (base, without, with) = two((&robot, COLUMNS), &parameters, (&load, 1.0), 0.0, &mut rng);
    let found = payload(&base, &without, &with).unwrap();
    let shown: Vec<&str> = found.parameters.iter().filter(|p| p.shown.is_some()).map(|p| p.name.as_str()).collect();
    // Out of the plane nothing turns or weighs.
    assert_eq!(shown, ["m", "mcx", "mcy", "Izz"]);
    assert!(found.body.inertia.check().is_ok());
    // The first link of a 6-axis arm changes: no load on the last one.
    let (robot, parameters) = (crs_a460(), crs_a460_nominal());
    let (base, without, mut with) = two((&robot, COLUMNS), &parameters, (&load, 1.0), 0.0, &mut rng);
    with.base[0].value += 50.0 * with.base[0].std;
    let found = payload(&base, &without, &with).unwrap();
    assert!(found.chi_squared > found.chi_squared_limit && found.widened_by > 2.0, "{}", found.chi_squared);
    let other = Estimate { robot: "other".to_owned(), ..with };
    assert!(matches!(payload(&base, &without, &other), Err(EstimationError::OtherRobot { .. })));
}

/// The joint fit solves `min |y₀ − W₀ β|² + |y₁ − W₁ (β + K θ)|²` at once.
#[test]
fn identity_what_both_logs_share_is_as_in_the_joint_fit_of_all_equations() {
    let mut rng = Seed::new(36).stream("payload", 0);
    let columns = Columns::RIGID_ROTOR.with_term(OFFSET);
    let base = reduce(&crs_a460(), columns, Method::Structural, Seed::new(0)).unwrap();
    let (b, rows) = (base.rank(), 150);
    let k = base.k.select_columns(&base.columns_of_last_link());
    let mut draw = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| StandardNormal.sample(&mut rng));
    let (w, y): (Vec<DMatrix<f64>>, Vec<DMatrix<f64>>) = (0..2).map(|_| (draw(rows, b), draw(rows, 1))).unzip();
    let estimates: Vec<Estimate> = (0..2)
        .map(|log| {
            let fit = LeastSquares::solve(&w[log], &y[log].column(0).into_owned()).unwrap();
            Estimate { degrees_of_freedom: 1e9, ..estimate_of(&base, fit.solution(), &fit.inverse_information()) }
        })
        .collect();
    let found = payload(&base, &estimates[0], &estimates[1]).unwrap();
    let mut all = DMatrix::zeros(2 * rows, b + 10);
    all.view_mut((0, 0), (rows, b)).copy_from(&w[0]);
    all.view_mut((rows, 0), (rows, b)).copy_from(&w[1]);
    all.view_mut((rows, b), (rows, 10)).copy_from(&(&w[1] * k));
    let right = DVector::from_iterator(2 * rows, y.iter().flat_map(|y| y.iter().copied()));
    let joint = LeastSquares::solve(&all, &right).unwrap();
    let (theta, inverse) = (joint.solution().rows(b, 10), joint.inverse_information());
    for (j, one) in found.combinations.base.iter().enumerate() {
        let std = inverse[(b + j, b + j)].sqrt();
        assert!((one.value - theta[j]).abs() < 1e-9 * std, "{}: {} {}", one.name, one.value, theta[j]);
        assert!((one.std / (std * found.widened_by) - 1.0).abs() < 1e-9, "{}: {} {std}", one.name, one.std);
    }
}

/// A single joint without friction, which would tell the errors of two logs apart: a torque constant that is off by 3 % scales all that is
/// estimated, and so the load by 3 %, whatever the arm weighs.
#[test]
fn analytic_a_declared_torque_constant_scales_the_load_alone() {
    const STD: f64 = 0.03;
    let mut rng = Seed::new(41).stream("one joint", 0);
    let (robot, parameters) = ChainRecipe { prismatic: 0.0, ..ChainRecipe::new(1) }.draw(&mut rng);
    let parameters = parameters.links_alone();
    let declared = DeclaredUncertainty::new(BTreeMap::from([("torque_constant".to_owned(), STD)])).unwrap();
    let robot = robot.with_uncertainty(declared);
    let identification = Identification::new(&robot, Columns::RIGID).unwrap();
    let load = Inertia::with_gyration(0.02 * parameters.links[0].mass, [0.03, -0.02, 0.06], 0.04);
    let mut estimate = |parameters: &StandardParameters| {
        let (mut states, mut tau) = (States::new(1), Vec::new());
        for _ in 0..500 {
            let (q, qd, qdd) = random_state(&mut rng, 1);
            let mut one = [0.0];
            Dynamics::new(&robot, parameters).inverse(&q, &qd, &qdd, &mut one);
            let z: f64 = StandardNormal.sample(&mut rng);
            tau.push(one[0] + 1e-6 * z);
            states.push(&q, &qd, &qdd);
        }
        let samples = Samples::exact(states, tau, vec!["N·m".to_owned()], 100.0);
        identification.estimate(&samples, EstimatorKind::Wls.estimator()).unwrap()
    };
    let (without, with) = (estimate(&parameters), estimate(&loaded(&parameters, &load)));
    let found = payload(identification.base(), &without, &with).unwrap();
    // Of two constants, one for each log, the arm's own parameters would count.
    let alone = |estimate: &Estimate| Estimate { motor_errors: Vec::new(), ..estimate.clone() };
    let apart = payload(identification.base(), &alone(&without), &alone(&with)).unwrap();
    assert!(found.combinations.base.len() >= 2);
    for (row, (one, two)) in found.combinations.base.iter().zip(&apart.combinations.base).enumerate() {
        let of_arm = libm::hypot(without.base[row].value, with.base[row].value);
        for (std, size) in [(one.std, one.value.abs()), (two.std, of_arm)] {
            assert!((std / (STD * size) - 1.0).abs() < 0.01, "{}: {std} of {size}", one.name);
        }
    }
}

#[test]
fn a_mass_below_zero_is_not_given_and_has_a_cause() {
    let mut rng = Seed::new(37).stream("payload", 0);
    let load = random_inertia(&mut rng);
    let (base, without, with) = two((&crs_a460(), COLUMNS), &crs_a460_nominal(), (&load, 1.0), 0.0, &mut rng);
    let cause = |found: &Payload| found.negative_mass.map(|negative| negative.cause);
    assert_eq!(cause(&payload(&base, &without, &with).unwrap()), None);
    let exchanged = payload(&base, &with, &without).unwrap();
    assert_eq!(cause(&exchanged), Some(NegativeMassCause::Lighter));
    assert!(exchanged.parameters[0].shown.is_none() && exchanged.body.inertia.check().is_ok());
    // The same in intervals that are so wide that there may be no load at all.
    let wide = |estimate: &Estimate| estimate.clone().with_covariance(&(estimate.covariance_matrix() * 1e8));
    assert_eq!(cause(&payload(&base, &wide(&with), &wide(&without)).unwrap()), Some(NegativeMassCause::NotShown));
    let found = payload(&base, &wide(&without), &wide(&with)).unwrap().parameters[0].shown.unwrap();
    assert!(found.ci95[0] >= 0.0 && found.ci95[1] > found.value, "{found:?}");
    let mut changed = without.clone();
    changed.base[0].value += 50.0 * changed.base[0].std;
    assert_eq!(cause(&payload(&base, &with, &changed).unwrap()), Some(NegativeMassCause::ArmChanged));
}

/// Torque of the A460 on a motion of some degrees, with soft onset, friction of the load, offsets and noise.
fn narrow_log(robot: &Robot, parameters: &StandardParameters, run: u64, log: u64) -> Samples {
    let (mut rng, mut noise) =
        (Seed::new(38).stream("narrow motion", run), Seed::new(39).stream("noise", 2 * run + log));
    let centre: [f64; 6] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
    let waves: [[[f64; 3]; 3]; 6] = std::array::from_fn(|_| {
        std::array::from_fn(|_| {
            [rng.random_range(0.5..3.0), rng.random_range(0.0..6.3), 0.08 * rng.random_range(0.2..0.5)]
        })
    });
    let (mut states, mut tau, mut dynamics) = (States::new(6), Vec::new(), Dynamics::new(robot, parameters));
    for k in 0..1000 {
        let t = 0.02 * f64::from(k);
        let sum = |of: &dyn Fn(f64, f64, f64) -> f64| -> [f64; 6] {
            std::array::from_fn(|i| waves[i].iter().map(|&[w, phase, size]| of(w, w * t + phase, size)).sum())
        };
        let (swing, qd) = (sum(&|_, x, a| a * libm::sin(x)), sum(&|w, x, a| a * w * libm::cos(x)));
        let (q, qdd): ([f64; 6], _) =
            (std::array::from_fn(|i| centre[i] + swing[i]), sum(&|w, x, a| -a * w * w * libm::sin(x)));
        let mut one = [0.0; 6];
        dynamics.inverse(&q, &qd, &qdd, &mut one);
        tau.extend(one.map(|torque| {
            let z: f64 = StandardNormal.sample(&mut noise);
            torque + 0.05 * z
        }));
        states.push(&q, &qd, &qdd);
    }
    Samples::exact(states, tau, vec!["N·m".to_owned(); 6], 50.0)
}

/// The columns lack friction of the load, which is there.
#[test]
fn analytic_a_narrow_motion_gives_the_mass_within_its_interval() {
    let robot = crs_a460().with_joints(|joint| {
        joint.drive.set_shape(&ShapeParameter::COULOMB_VELOCITY, 0.05);
    });
    let robot = robot.unwrap();
    let identification = Identification::new(&robot, COLUMNS).unwrap();
    let (mut inside, mut widest) = (0, 0.0_f64);
    for run in 0..8 {
        let mut rng = Seed::new(40).stream("arm", run);
        let mut parameters = crs_a460_nominal();
        for drive in &mut parameters.drives {
            for (term, value) in [(ROTOR, 0.1), (VISCOUS, 2.0), (COULOMB, 2.0), (LOAD_FRICTION, 0.05)] {
                drive[term] = value * rng.random_range(0.5..1.5);
            }
            drive[OFFSET] = rng.random_range(-1.0..1.0);
        }
        let load = Inertia::with_gyration(rng.random_range(0.3..1.5), [0.03, -0.02, 0.06], 0.04);
        let estimate = |parameters: &StandardParameters, log| {
            let samples = narrow_log(&robot, parameters, run, log);
            identification.estimate(&samples, EstimatorKind::Wls.estimator()).unwrap()
        };
        let (without, with) = (estimate(&parameters, 0), estimate(&loaded(&parameters, &load), 1));
        let found = payload(identification.base(), &without, &with).unwrap();
        let [low, high] = found.parameters[0].shown.unwrap().ci95;
        inside += usize::from(low <= load.mass && load.mass <= high);
        widest = widest.max(high - low);
        assert!(found.body.inertia.check().is_ok() && found.is_of_a_load(), "{}", found.widened_by);
    }
    // Fewer than six of eight intervals of 95 % have a probability of 6e-3.
    assert!(inside >= 6 && widest < 0.2, "{inside} of 8, {widest} kg");
}
