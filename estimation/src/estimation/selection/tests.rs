//! Terms of simulated arms are found, and no others; figures of SciPy.

use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};

use super::evidence::{HeldOutData, Selection, TermEvidence, Verdict};
use super::restriction::Restriction;
use super::select;
use super::step::effective_equations;
use crate::base::{BaseReduction, Method};
use crate::chains::random_robot;
use crate::dynamics::{Dynamics, States};
use crate::estimation::tests::synthetic;
use crate::estimation::{EstimationError, EstimationProblem, EstimatorKind, Identification, Observation};
use crate::model::term::{COULOMB, LOAD_FRICTION, OFFSET, QUADRATIC_VISCOUS, ROTOR, SPRING, STRIBECK, Term, VISCOUS};
use crate::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters};
use crate::seed::Seed;
use crate::signal::Samples;

/// A drawn arm of three joints with these terms alone, and its torque on a slow periodic motion with noise of 0.2 N·m, each sample's `memory`
/// times the one before it and a new one.
fn recording(seed: u64, terms: &[Term], memory: f64) -> (Robot, Samples) {
    let coefficient = |&term: &Term| {
        (
            term,
            if term == ROTOR {
                0.3
            } else if term == SPRING {
                20.0
            } else {
                4.0
            },
        )
    };
    recording_of(seed, &terms.iter().map(coefficient).collect::<Vec<_>>(), memory)
}

/// A recording of an arm with these coefficients.
fn recording_of(seed: u64, terms: &[(Term, f64)], memory: f64) -> (Robot, Samples) {
    let source = Seed::new(seed);
    let (robot, drawn) = random_robot(&mut source.stream("arm", 0), 3);
    let mut truth = StandardParameters { links: drawn.links, ..StandardParameters::zero(3) };
    for drive in &mut truth.drives {
        for &(term, value) in terms {
            drive[term] = value;
        }
    }
    let mut noise = source.stream("noise", 0);
    let (count, mut states, mut tau, mut last) = (600, States::new(3), Vec::new(), [0.0; 3]);
    for k in 0..count {
        let t = f64::from(k) / 60.0;
        let (mut q, mut qd, mut qdd) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for i in 0..3 {
            for l in 1..=5 {
                let (w, phase) = (0.628 * f64::from(l), 1.3 * f64::from(l) + 2.1 * i as f64);
                let amplitude = 0.5 / f64::from(l);
                q[i] += amplitude * libm::sin(w * t + phase);
                qd[i] += amplitude * w * libm::cos(w * t + phase);
                qdd[i] -= amplitude * w * w * libm::sin(w * t + phase);
            }
        }
        let mut one = [0.0; 3];
        Dynamics::new(&robot, &truth).inverse(&q, &qd, &qdd, &mut one);
        states.push(&q, &qd, &qdd);
        for (last, tau_i) in last.iter_mut().zip(one) {
            let z: f64 = StandardNormal.sample(&mut noise);
            *last = memory * *last + 0.2 * (1.0 - memory * memory).sqrt() * z;
            tau.push(tau_i + *last);
        }
    }
    (robot, Samples::exact(states, tau, vec!["N·m".to_owned(); 3], 60.0))
}

fn candidates() -> Columns {
    [ROTOR, VISCOUS, COULOMB, OFFSET, STRIBECK, QUADRATIC_VISCOUS, SPRING]
        .into_iter()
        .fold(Columns::RIGID, Columns::with_term)
}

fn selected(seed: u64, terms: &[Term], memory: f64) -> Selection {
    let (robot, samples) = recording(seed, terms, memory);
    select(|columns| Identification::new(&robot, columns), &samples, &[], candidates()).unwrap()
}

fn of(selection: &Selection, term: Term) -> &TermEvidence {
    selection.terms.iter().find(|one| one.term == term.entry().name).unwrap()
}

#[test]
fn analytic_terms_of_the_arm_are_reported_and_no_others() {
    let present = [ROTOR, VISCOUS, COULOMB, SPRING];
    let mut wrong = 0;
    for seed in 0..30 {
        // White noise, and noise that remembers half of itself.
        let selection = selected(seed, &present, if seed % 2 == 0 { 0.0 } else { 0.5 });
        for term in [VISCOUS, COULOMB, SPRING] {
            assert_eq!(of(&selection, term).verdict, Verdict::Supported, "{seed}: {:?}", of(&selection, term));
        }
        for term in [OFFSET, STRIBECK, QUADRATIC_VISCOUS] {
            wrong += usize::from(of(&selection, term).verdict == Verdict::Supported);
        }
        // Words of the selected columns: those of the supported terms, no more and no less.
        let mut words: Vec<&str> =
            Columns::parse(&selection.columns).unwrap().terms().map(|term| term.entry().name).collect();
        words.sort_unstable();
        words.dedup();
        let supported = selection.terms.iter().filter(|term| term.verdict == Verdict::Supported);
        let mut reported: Vec<&str> = supported.map(|term| term.term.as_str()).collect();
        reported.sort_unstable();
        assert_eq!(words, reported, "{seed}");
    }
    // At a level of 5 % for each recording one or two of thirty are expected by the F-test alone.
    assert!(wrong <= 2, "{wrong}");
}

#[test]
fn analytic_friction_of_the_load_is_supported_where_it_is_there() {
    // Of 2 % of the load, half of these arms show too little beside a noise of 0.2 N·m that remembers half of itself: 5 of 10.
    for (of_load, least, most) in [(0.0, 0, 1), (0.05, 6, 10)] {
        let supported = (200..210)
            .filter(|&seed| {
                let terms = [(ROTOR, 0.3), (VISCOUS, 4.0), (COULOMB, 4.0), (LOAD_FRICTION, of_load)];
                let (robot, samples) = recording_of(seed, &terms, 0.5);
                let of = |columns| Identification::new(&robot, columns);
                let selection = select(of, &samples, &[], candidates().with_term(LOAD_FRICTION)).unwrap();
                let load = selection.terms.iter().find(|one| one.term == LOAD_FRICTION.entry().name).unwrap();
                load.verdict == Verdict::Supported
            })
            .count();
        assert!((least..=most).contains(&supported), "{of_load}: {supported} of 10");
    }
}

#[test]
fn analytic_bic_counts_equations_that_are_independent() {
    for memory in [0.0, 0.5] {
        let found = selected(3, &[ROTOR, VISCOUS, COULOMB], memory);
        let viscous = of(&found, VISCOUS);
        // BIC − AIC = r (ln N − 2). Of 3 · 600 equations whose noise remembers m of itself, (1 − m)/(1 + m) are independent.
        let (aic, bic) = (viscous.aic.unwrap(), viscous.bic.unwrap());
        let count = libm::exp((bic - aic) / viscous.coefficients as f64 + 2.0);
        let expected = 1800.0 * (1.0 - memory) / (1.0 + memory);
        assert!((count / expected - 1.0).abs() < 0.2, "{memory}: {count} {expected}");
    }
}

#[test]
fn analytic_a_term_that_is_there_is_found_among_its_like() {
    for (seed, term) in [(31, STRIBECK), (32, QUADRATIC_VISCOUS), (33, OFFSET)] {
        let selection = selected(seed, &[ROTOR, VISCOUS, COULOMB, term], 0.0);
        let evidence = of(&selection, term);
        assert_eq!(evidence.verdict, Verdict::Supported, "{evidence:?}");
        let change = evidence.held_out.unwrap();
        assert!(change.data == HeldOutData::Folds && change.with < change.without && change.change_ci95[0] < 0.0);
        assert_eq!(of(&selection, SPRING).verdict, Verdict::NotSupported);
    }
}

#[test]
fn a_selection_can_be_written_and_read() {
    let selection = selected(5, &[VISCOUS], 0.0);
    let text = serde_json::to_string(&selection).unwrap();
    assert_eq!(serde_json::from_str::<Selection>(&text).unwrap(), selection);
}

#[test]
fn held_out_samples_are_what_is_predicted_and_a_term_that_errs_there_is_undecided() {
    let (robot, samples) = recording(41, &[VISCOUS, COULOMB], 0.0);
    let other = recording(41, &[VISCOUS, COULOMB], 0.5).1;
    let of_columns = |columns| Identification::new(&robot, columns);
    let found = select(of_columns, &samples, std::slice::from_ref(&other), candidates()).unwrap();
    let coulomb = of(&found, COULOMB);
    assert_eq!((coulomb.verdict, coulomb.held_out.unwrap().data), (Verdict::Supported, HeldOutData::Recording));
    // A recording of an arm without it contradicts the term, whatever the fit says.
    let without = recording(41, &[VISCOUS], 0.0).1;
    let found = select(of_columns, &samples, &[without], candidates()).unwrap();
    let coulomb = of(&found, COULOMB);
    assert_eq!(coulomb.verdict, Verdict::Undecided, "{coulomb:?}");
    assert!(!found.columns.contains("coulomb"));
}

#[test]
fn what_the_motion_does_not_show_is_said() {
    // No joint moves as fast as it would take: at a constant speed viscous and Coulomb friction are one.
    let (robot, mut samples) = recording(51, &[VISCOUS, COULOMB], 0.0);
    for value in &mut samples.states.qd {
        *value = 0.7 * value.signum();
    }
    let selection = select(|columns| Identification::new(&robot, columns), &samples, &[], candidates()).unwrap();
    let one_of = [VISCOUS, COULOMB, STRIBECK, QUADRATIC_VISCOUS].map(|term| of(&selection, term).verdict);
    assert!(one_of.contains(&Verdict::NotExcited), "{one_of:?}");
    // Nothing but links, and of those too few equations.
    let mut few = recording(52, &[VISCOUS], 0.0).1;
    few.used.iter_mut().skip(6).for_each(|used| *used = false);
    let refused = select(|columns| Identification::new(&robot, columns), &few, &[], candidates());
    assert!(matches!(refused, Err(EstimationError::TooFewEquations { .. })), "{refused:?}");
}

/// The equations that `tests/scipy/generate.py` draws.
fn drawn() -> Observation {
    let mut state = 20_261_123_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let table = DMatrix::from_row_iterator(60, 6, (0..360).map(|_| next()));
    let w = table.columns(0, 5).into_owned();
    let y = &w * DVector::from_vec(vec![1.0, -2.0, 0.5, 0.4, -0.3]) + table.column(5) * 0.5;
    let (observation, _) = synthetic(60, 5, &mut Seed::new(1).stream("unused", 0));
    let ids: Vec<ParameterId> = (0..5).map(|index| ParameterId { kind: ParameterKind::M, index }).collect();
    let base = BaseReduction::from_stack(&ids, &DMatrix::identity(5, 5), Method::Qr);
    Observation { regressor: w, y, used: vec![true; 60], dof: 1, units: vec!["N·m".to_owned()], base, ..observation }
}

#[test]
fn scipy_f_and_its_tail() {
    let observation = drawn();
    let estimate = EstimatorKind::Ols.estimator().estimate(&EstimationProblem::new(&observation)).unwrap();
    // White noise by its own residual: whether the lags are found to be zero is not the question here.
    let residual = observation.residual(&estimate.beta());
    let variance = residual.norm_squared() / 55.0;
    let inverse = (observation.regressor.transpose() * &observation.regressor).try_inverse().unwrap();
    let covariance = &inverse * variance;
    let std = covariance.diagonal().map(f64::sqrt);
    for line in include_str!("f_test.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let gone: Vec<usize> = fields[0].split('+').map(|c| c.parse().unwrap()).collect();
        let [f, tail, aic, bic] = fields[1..].iter().map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let restriction = Restriction::of(&observation.base, |c| gone.contains(&c), &std);
        assert_eq!(restriction.len(), gone.len());
        let wald = restriction.wald(&estimate.beta(), &covariance).unwrap();
        let found = restriction.test(wald, 55.0);
        assert!(
            (found.value / f - 1.0).abs() < 1e-10 && (found.p_value / tail - 1.0).abs() < 1e-8,
            "{line}: {found:?}"
        );
        // AIC and BIC by the same likelihood.
        let gain = 60.0 * libm::log1p(wald / 55.0);
        let r = gone.len() as f64;
        assert!((2.0 * r - gain - aic).abs() < 1e-9 && (r * libm::log(60.0) - gain - bic).abs() < 1e-9, "{line}");
        // Two routes to the solution without the columns.
        let restricted = restriction.restricted(&estimate.beta(), &inverse).unwrap();
        let kept: Vec<usize> = (0..5).filter(|c| !gone.contains(c)).collect();
        let w = observation.regressor.select_columns(&kept);
        let less = (w.transpose() * &w).try_inverse().unwrap() * w.transpose() * &observation.y;
        for (at, &c) in kept.iter().enumerate() {
            assert!((restricted[c] - less[at]).abs() < 1e-12, "{line}");
        }
        assert!(gone.iter().all(|&c| restricted[c].abs() < 1e-12));
    }
}

#[test]
fn analytic_the_effective_number_of_correlated_equations() {
    // A first-order process with coefficient a has (1 + a)/(1 − a) times fewer independent samples.
    let mut rng = Seed::new(7).stream("noise", 0);
    for memory in [0.0, 0.6, 0.8] {
        let count = 40_000;
        let (mut observation, _) = synthetic(1, 1, &mut rng);
        let mut last = 0.0;
        let y: Vec<f64> = (0..count)
            .map(|_| {
                let z: f64 = StandardNormal.sample(&mut rng);
                last = memory * last + z;
                last
            })
            .collect();
        observation.regressor = DMatrix::from_element(count, 1, 1.0);
        (observation.y, observation.used, observation.dof) = (DVector::from_vec(y), vec![true; count], 1);
        let beta = DVector::from_element(1, observation.y.mean());
        let found = effective_equations(&observation, &beta) / count as f64;
        let expected = (1.0 - memory) / (1.0 + memory);
        assert!((found / expected - 1.0).abs() < 0.12, "{memory}: {found} {expected}");
    }
}
