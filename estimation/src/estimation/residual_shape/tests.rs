//! Residuals of known shapes, and residuals without any.

use rand_distr::{Distribution, StandardNormal};

use super::shape::Point;
use super::{Against, ResidualShape, ResidualTests, ResidualTrends};
use crate::chains::random_robot;
use crate::dynamics::{Dynamics, States};
use crate::estimation::{EstimatorKind, Identification};
use crate::model::{Columns, EffortInterface, JointKind};
use crate::seed::Seed;
use crate::signal::{AperiodicRecord, Processing, Samples, process_aperiodic};

const COUNT: usize = 600;
const RATE_HZ: f64 = 60.0;
const NOISE: f64 = 0.2;
/// The joint whose torque has something that the model lacks.
const JOINT: usize = 1;

/// What the residual of an ordinary fit shows, of an arm of three joints with noise of 0.2 N·m, each sample's `memory` times the one
/// before and a new one, and a coefficient times a shape in the torque of one joint.
fn trends(seed: u64, columns: Columns, memory: f64, added: Option<(ResidualShape, f64)>) -> ResidualTrends {
    let source = Seed::new(seed);
    let (robot, truth) = random_robot(&mut source.stream("arm", 0), 3);
    let mut noise = source.stream("noise", 0);
    let (mut states, mut tau, mut load, mut last) = (States::new(3), Vec::new(), Vec::new(), [0.0; 3]);
    let mut own = truth.clone();
    if !columns.has(crate::model::term::VISCOUS) {
        own.drives.iter_mut().for_each(|drive| *drive = Default::default());
    }
    let mut links = truth;
    links.drives.iter_mut().for_each(|drive| *drive = Default::default());
    // In a narrow motion the weight of the links is much like a spring.
    let reach = if matches!(added, Some((ResidualShape::Spring, _))) { 2.5 } else { 0.8 };
    for k in 0..COUNT {
        let t = k as f64 / RATE_HZ;
        let (mut q, mut qd, mut qdd) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for i in 0..3 {
            for l in 1..=5 {
                let (w, phase) = (0.628 * f64::from(l), 1.3 * f64::from(l) + 2.1 * i as f64);
                let amplitude = reach / f64::from(l);
                q[i] += amplitude * libm::sin(w * t + phase);
                qd[i] += amplitude * w * libm::cos(w * t + phase);
                qdd[i] -= amplitude * w * w * libm::sin(w * t + phase);
            }
        }
        let (mut one, mut of_links) = ([0.0; 3], [0.0; 3]);
        Dynamics::new(&robot, &own).inverse(&q, &qd, &qdd, &mut one);
        Dynamics::new(&robot, &links).inverse(&q, &qd, &qdd, &mut of_links);
        states.push(&q, &qd, &qdd);
        load.push(of_links[JOINT]);
        for (last, tau_i) in last.iter_mut().zip(one) {
            let z: f64 = StandardNormal.sample(&mut noise);
            *last = memory * *last + NOISE * (1.0 - memory * memory).sqrt() * z;
            tau.push(tau_i + *last);
        }
    }
    if let Some((shape, coefficient)) = added {
        let speeds = || (0..COUNT).map(|k| states.qd(k)[JOINT]);
        let speed_rms = (speeds().map(|v| v * v).sum::<f64>() / COUNT as f64).sqrt();
        for k in 0..COUNT {
            let (velocity, position) = (states.qd(k)[JOINT], states.q(k)[JOINT]);
            let time = k as f64 / (COUNT - 1) as f64 - 0.5;
            tau[3 * k + JOINT] +=
                coefficient * shape.value(&Point { time, velocity, speed_rms, load: load[k], position });
        }
    }
    let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); 3], RATE_HZ);
    let identification = Identification::new(&robot, columns).unwrap();
    let kinds = [EstimatorKind::Wls, EstimatorKind::Ols];
    let estimates = kinds.map(|kind| identification.estimate(&samples, kind.estimator()).unwrap());
    let tests = ResidualTests::new(&robot, identification.observation(&samples).unwrap()).unwrap();
    let mut together = tests.trends(&samples, &estimates).unwrap();
    // Estimates that are tested together say what each says alone.
    for (together, alone) in together.iter().zip(&estimates) {
        assert_eq!(*together, tests.trends(&samples, std::slice::from_ref(alone)).unwrap()[0]);
    }
    together.swap_remove(0)
}

fn joints() -> Vec<String> {
    ["one", "two", "three"].map(str::to_owned).to_vec()
}

/// All but a gain: what is left of a joint's load when its links' parameters have taken theirs is too little for a coefficient.
#[test]
fn analytic_each_shape_in_the_torque_of_one_joint_is_named_with_its_coefficient() {
    for &shape in ResidualShape::ALL.iter().filter(|&&shape| shape != ResidualShape::Gain) {
        // Friction is a shape of its own where the model has none.
        let in_friction = matches!(shape, ResidualShape::Coulomb | ResidualShape::Viscous);
        let columns = if in_friction { Columns::RIGID } else { Columns::RIGID_ROTOR_FRICTION };
        let coefficient = match shape {
            ResidualShape::Gain | ResidualShape::LoadFriction => 0.05,
            // Weight still takes a part of a spring.
            ResidualShape::Spring => 5.0,
            ResidualShape::Drift
            | ResidualShape::Coulomb
            | ResidualShape::Viscous
            | ResidualShape::Quadratic
            | ResidualShape::NearRest
            | ResidualShape::CosineFriction
            | ResidualShape::SineFriction => 1.0,
        };
        let found = trends(3, columns, 0.0, Some((shape, coefficient)));
        let own: Vec<_> = found.trends.iter().filter(|trend| trend.joint == JOINT).collect();
        let trend = own.iter().find(|trend| trend.shape == shape).unwrap_or_else(|| panic!("{shape:?}: {own:?}"));
        let std = (trend.ci95[1] - trend.ci95[0]) / 3.9;
        // The load is that of the estimate, which has taken up a part of what was added.
        let of_load = if shape.against() == Against::Load { 0.15 * coefficient } else { 0.0 };
        assert!((trend.slope - coefficient).abs() < 4.0 * std + of_load && std < 0.3 * coefficient, "{trend:?}");
        // Of all that resemble it, it takes the most.
        assert!(own.iter().all(|other| other.share <= trend.share), "{own:?}");
        let sentences = found.sentences(shape.against(), &joints());
        let [course, cause] = shape.words(true);
        let named = format!("two: the residual {course}");
        assert!(sentences.iter().any(|sentence| sentence.starts_with(&named)), "{sentences:?}");
        assert!(sentences.iter().any(|sentence| sentence.contains(cause)), "{sentences:?}");
    }
}

#[test]
fn analytic_shapes_are_the_functions_of_their_descriptions() {
    let (velocity, speed_rms, load, position) = (-0.4, 0.5, -3.0, 0.7);
    let point = |velocity| Point { time: 0.25, velocity, speed_rms, load, position };
    let near_rest = -libm::exp(-(velocity / 0.15) * (velocity / 0.15));
    let (cosine, sine) = (libm::cos(position), libm::sin(position));
    // Drift, Coulomb, viscous, quadratic, near rest, gain, friction of the load, spring, cosine and sine of friction.
    let expected = [0.25, -1.0, velocity, -0.16000000000000003, near_rest, load, load, position, -cosine, -sine];
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let at = |velocity| ResidualShape::ALL.iter().map(|shape| shape.value(&point(velocity))).collect::<Vec<f64>>();
    assert_eq!(bits(&at(velocity)), bits(&expected));
    // At rest friction is undecided.
    assert_eq!(at(0.0), [0.25, 0.0, 0.0, 0.0, 0.0, load, 0.0, position, 0.0, 0.0]);
    let units = ["N·m", "N·m", "N·m per rad/s", "N·m per (rad/s)²", "N·m", "N·m per N·m", "N·m per N·m", "N·m per rad"];
    for (shape, unit) in ResidualShape::ALL.iter().zip(units.into_iter().chain(["N·m"; 2])) {
        assert_eq!(shape.unit(JointKind::Revolute), unit, "{shape:?}");
    }
    assert_eq!(ResidualShape::Quadratic.unit(JointKind::Prismatic), "N per (m/s)²");
}

#[test]
fn analytic_a_coefficient_below_zero_is_told_in_other_words() {
    let found = trends(3, Columns::RIGID_ROTOR_FRICTION, 0.0, Some((ResidualShape::Quadratic, -0.5)));
    let sentences = found.sentences(Against::Speed, &joints());
    assert!(sentences[0].starts_with("two: the residual falls with the square of speed, by -0."), "{sentences:?}");
    assert!(sentences[0].contains("flattens out at speed") && sentences[0].contains("p < 1e-6"), "{sentences:?}");
}

/// 5 % for each figure, over all joints and shapes of it; correlated noise may add a little.
#[test]
fn analytic_noise_has_no_shape_in_19_of_20_figures() {
    let (runs, joints) = (40, joints());
    for memory in [0.0, 0.5] {
        let mut alarms = 0;
        for seed in 0..runs {
            let found = trends(100 + seed, Columns::RIGID_ROTOR_FRICTION, memory, None);
            let of = |against| found.trends.iter().any(|trend| trend.shape.against() == against);
            alarms += Against::ALL.into_iter().filter(|&against| of(against)).count();
            for against in Against::ALL.into_iter().filter(|&against| !of(against)) {
                let sentences = found.sentences(against, &joints);
                assert!(
                    sentences.len() == 1 && sentences[0].starts_with("No joint's residual follows"),
                    "{sentences:?}"
                );
            }
        }
        // 160 figures: 8 false alarms are expected at most, 19 or more have a probability below 1e-3 at 5 %.
        assert!(alarms < 19, "memory {memory}: {alarms} of 160");
    }
}

#[test]
fn analytic_white_noise_is_called_white_and_noise_with_memory_is_not() {
    let joints = joints();
    let mut white = 0;
    for seed in 0..20 {
        let found = trends(200 + seed, Columns::RIGID_ROTOR_FRICTION, 0.0, None);
        white += usize::from(found.whiteness.iter().flatten().all(super::Whiteness::is_white));
        let found = trends(200 + seed, Columns::RIGID_ROTOR_FRICTION, 0.8, None);
        for (of, sentence) in found.whiteness.iter().zip(found.whiteness_sentences(&joints)) {
            let of = of.as_ref().unwrap();
            // ρ_l = 0.8^l, less what 27 parameters take with them.
            assert!((of.autocorrelation[0] - 0.8).abs() < 0.15 && !of.is_white(), "{of:?}");
            assert!(
                sentence.contains("not white: lag-1 autocorrelation 0.") && sentence.contains("p < 1e-6"),
                "{sentence}"
            );
            assert!(sentence.contains("times too narrow"), "{sentence}");
        }
    }
    // At 5 % over the joints: 15 or fewer of 20 have a probability below 3e-3.
    assert!(white > 15, "{white} of 20");
}

#[test]
fn analytic_autocorrelation_and_statistic_by_hand() {
    // +1, −1, … with two gaps: every neighbour is of the other sign, every second of the same.
    let mut series: Vec<Option<f64>> = (0..40).map(|k| Some(if k % 2 == 0 { 1.0 } else { -1.0 })).collect();
    series[7] = None;
    series[20] = None;
    let found = super::Whiteness::of(&series, 0.1).unwrap();
    assert_eq!(found.autocorrelation.len(), 7);
    for (k, rho) in found.autocorrelation.iter().enumerate() {
        let expected = if k % 2 == 0 { -1.0 } else { 1.0 };
        assert!((rho - expected).abs() < 1e-12, "{found:?}");
    }
    // Neighbours: 39 less the four that touch a gap, of 38 equations; so for the other lags.
    let pairs = [35.0, 34.0, 33.0, 32.0, 31.0, 30.0, 29.0];
    assert!((found.statistic - pairs.iter().sum::<f64>() * 40.0 / 38.0).abs() < 1e-9, "{found:?}");
    assert!(found.p_adjusted < 1e-6 && !found.is_white());
    assert!(super::Whiteness::of(&series[..9], 0.1).is_none());
}

/// Five arms whose logs begin in mid-motion, processed as logs without periods are: motions of one harmonic, in which a spring would be an
/// inertia, and of several. Coulomb friction sets in softly from rest, which the model does not know.
#[test]
fn analytic_no_spring_is_named_where_there_is_none() {
    let joints = joints();
    for (seed, harmonics) in (0..5).flat_map(|seed| [(seed, 1), (seed, 4)]) {
        let source = Seed::new(300 + seed);
        let (robot, truth) = random_robot(&mut source.stream("arm", 0), 3);
        let mut noise = source.stream("noise", 0);
        let mut dynamics = Dynamics::new(&robot, &truth);
        let (mut q, mut effort) = (Vec::new(), Vec::new());
        for k in 0..5000 {
            let t = f64::from(k) / 250.0;
            let (mut at, mut qd, mut qdd) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for i in 0..3 {
                for l in 1..=harmonics {
                    let (w, phase) = (f64::from(l) + 0.4 * i as f64, 1.0 + 1.3 * f64::from(l) + 2.1 * i as f64);
                    let amplitude = 0.8 / f64::from(l);
                    at[i] += amplitude * libm::sin(w * t + phase);
                    qd[i] += amplitude * w * libm::cos(w * t + phase);
                    qdd[i] -= amplitude * w * w * libm::sin(w * t + phase);
                }
            }
            let mut tau = [0.0; 3];
            dynamics.inverse(&at, &qd, &qdd, &mut tau);
            for i in 0..3 {
                let z: [f64; 2] = [StandardNormal.sample(&mut noise), StandardNormal.sample(&mut noise)];
                q.push(at[i] + 2e-5 * z[0]);
                effort.push(tau[i] - qd[i].signum() * libm::exp(-qd[i].abs() / 0.1) + NOISE * z[1]);
            }
        }
        let record = AperiodicRecord::new(3, 250.0, &q, &effort);
        let samples =
            process_aperiodic(&record, &robot, EffortInterface::Torque, 40.0, &Processing::default()).unwrap();
        // The filter's edges are no equations.
        assert!(samples.used[..3].iter().chain(&samples.used[samples.used.len() - 3..]).all(|used| !used));
        let identification = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
        let Ok(estimate) = identification.estimate(&samples, EstimatorKind::Wls.estimator()) else { continue };
        let observation = identification.observation(&samples).unwrap();
        let found =
            ResidualTests::new(&robot, observation).unwrap().trends(&samples, &[estimate]).unwrap().swap_remove(0);
        let said = found.sentences(Against::Position, &joints).join(" ");
        assert!(!said.contains("spring"), "seed {seed}, {harmonics} harmonics: {said}");
        assert!(found.trends.iter().all(|trend| trend.share >= 0.05), "{:?}", found.trends);
    }
}

#[test]
fn a_probability_is_never_written_as_zero() {
    for (p, text) in [(0.123, "p = 0.12"), (0.0031, "p = 0.003"), (2.2e-4, "p = 2e-4"), (1e-9, "p < 1e-6")] {
        assert_eq!(super::whiteness::probability(p), text);
    }
}
