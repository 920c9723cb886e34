//! Effects of the real arm act alike in every engine, and not at all where there are none.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use armid::excitation::{FourierJoint, FourierTrajectory};
use armid::experiment::{
    ActualArm, EffectKind, Effects, ExperimentPlan, Level, Phase, Recording, Sensing, Servo, record,
};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Joint, Robot, StandardParameters, bundled};
use armid::seed::Seed;
use armid::study::{Truth, truth_text};
use armid_sim::{AnalyticPlant, Engine, record_runs};

fn planar() -> (Robot, StandardParameters, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == "planar-2r").unwrap();
    // Its efforts are torques without a converter: one is put in, for the effects of converters.
    let converter = |joint: &mut Joint| (joint.drive.adc_range, joint.drive.adc_bits) = (50.0, 12);
    let robot = parse_robot(entry.robot).unwrap().with_joints(converter).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
    let truth = Truth::from_toml(truth_text("planar-2r").unwrap(), &robot).unwrap().parameters;
    (robot, nominal, truth)
}

/// A second of motion, with a reversal of each joint.
fn plan(robot: &Robot) -> ExperimentPlan {
    let series = [([0.9, 0.5], [0.3, -0.4]), ([-1.1, 0.6], [0.5, 0.4])];
    let joints = robot.joints().iter().zip(series).map(|(joint, (a, b))| FourierJoint {
        name: joint.name.clone(),
        a: a.to_vec(),
        b: b.to_vec(),
        q0: 0.4,
    });
    ExperimentPlan {
        settle_s: 0.1,
        ramp_s: 0.3,
        discarded_periods: 0,
        periods: 1,
        ..ExperimentPlan::new(FourierTrajectory { period_s: 1.0, joints: joints.collect() })
    }
}

/// Sensors that show an effect, and nothing that hides a small difference where they need not.
fn sensing(kind: Option<EffectKind>) -> Sensing {
    match kind {
        Some(EffectKind::EncoderStep) => Sensing::noise_free(),
        Some(EffectKind::AdcStep) => Sensing { converters: true, ..Sensing::ideal() },
        Some(EffectKind::ColouredNoise) => Sensing { current_noise: true, ..Sensing::ideal() },
        _ => Sensing::ideal(),
    }
}

fn perform(engine: Engine, effects: &Effects, sensing: &Sensing) -> Recording {
    let (robot, nominal, truth) = planar();
    let arm = ActualArm::new(effects, &robot, &truth);
    let plant = engine.plant(arm.robot(), arm.parameters()).unwrap();
    let mut servo = Servo::new(&robot, &nominal, plant)
        .unwrap()
        .with_sensing(sensing.clone())
        .with_seed(Seed::new(1), 0)
        .with_effects(arm);
    let (recording, ending) = record(&mut servo, &plan(&robot)).unwrap();
    assert!(ending.is_complete(), "{} {effects}: {ending:?}", engine.name());
    recording
}

/// What an effect changes, sample by sample from the ramp on: currents (A), then positions scaled to weigh as much.
fn change(engine: Engine, kind: EffectKind, level: Level) -> (Vec<f64>, Vec<f64>) {
    let sensing = sensing(Some(kind));
    let with = perform(engine, &Effects::only(kind, level).with_seed(Seed::new(3)), &sensing);
    let without = perform(engine, &Effects::none(), &sensing);
    let from = with.samples(Phase::RampIn).start * with.dof;
    let difference = |a: &[f64], b: &[f64]| a[from..].iter().zip(&b[from..]).map(|(a, b)| a - b).collect();
    (difference(&with.effort, &without.effort), difference(&with.q, &without.q))
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for value in values {
        sum += value * value;
        count += 1;
    }
    (sum / f64::from(count)).sqrt()
}

/// Difference of the differences over the difference, in currents and positions, each engine against the first.
///
/// MuJoCo is measured at 4e-10 and below. rapier's step is of order one: 1e-3 to 2e-2 for what is smooth, more (`coarse`)
/// where a loop or a delay rings at a phase of its own.
fn alike(kinds: &[EffectKind], coarse: f64) {
    for &kind in kinds {
        let (current, q) = change(Engine::Analytic, kind, Level::Severe);
        assert!(rms(current.iter().copied()) > 0.0 || rms(q.iter().copied()) > 0.0, "{} does nothing", kind.name());
        for engine in [Engine::Mujoco, Engine::Rapier] {
            let (other_current, other_q) = change(engine, kind, Level::Severe);
            for (what, first, other) in [("current", &current, &other_current), ("position", &q, &other_q)] {
                let size = rms(first.iter().copied());
                let apart = rms(first.iter().zip(other).map(|(a, b)| a - b));
                let allowed = if engine == Engine::Rapier { coarse } else { 1e-7 } * size + 1e-9;
                assert!(apart <= allowed, "{} {} {what}: {apart:e} apart of {size:e}", kind.name(), engine.name());
            }
        }
    }
}

#[test]
fn friction_acts_alike_in_every_engine() {
    alike(&[EffectKind::Stribeck, EffectKind::LoadFriction, EffectKind::Warming], 0.06);
}

#[test]
fn springs_act_alike_in_every_engine() {
    alike(&[EffectKind::Elasticity, EffectKind::Hysteresis, EffectKind::Backlash], 0.4);
}

#[test]
fn motors_act_alike_in_every_engine() {
    alike(&[EffectKind::TorqueRipple, EffectKind::Cogging, EffectKind::TorqueConstant, EffectKind::CurrentLag], 0.06);
    // Five steps of delay take most of the loop's phase margin: it rings.
    alike(&[EffectKind::CurrentDelay], 0.4);
}

#[test]
fn loads_and_frames_act_alike_in_every_engine() {
    let kinds = [EffectKind::Tool, EffectKind::BaseTilt, EffectKind::Kinematics];
    alike(&kinds, 0.02);
}

#[test]
fn sensors_act_alike_in_every_engine() {
    let kinds = [
        EffectKind::MotorEccentricity,
        EffectKind::JointEccentricity,
        EffectKind::ClockJitter,
        EffectKind::DroppedSamples,
        EffectKind::AdcOffset,
        EffectKind::ColouredNoise,
    ];
    alike(&kinds, 0.4);
    // Counts turn over at other moments in another engine: with coarse ones only the size of what they do is the same.
    for kind in [EffectKind::EncoderStep, EffectKind::AdcStep] {
        let size = |engine| rms(change(engine, kind, Level::Severe).0);
        for engine in [Engine::Mujoco, Engine::Rapier] {
            let ratio = size(engine) / size(Engine::Analytic);
            assert!((ratio - 1.0).abs() < 0.3, "{} {}: {ratio}", kind.name(), engine.name());
        }
    }
}

#[test]
fn identity_without_effects_every_bit_is_what_it_was() {
    let (robot, nominal, truth) = planar();
    let plan = plan(&robot);
    let plain = Servo::new(&robot, &nominal, AnalyticPlant::new(&robot, &truth).unwrap()).unwrap();
    let arm = ActualArm::new(&Effects::none(), &robot, &truth);
    assert_eq!((arm.robot(), arm.parameters()), (&robot, &truth));
    let with = plain.clone().with_effects(arm);
    let runs = [(Seed::new(5), 0), (Seed::new(5), 1)];
    for (a, b) in record_runs(&plain, &plan, &runs).unwrap().iter().zip(record_runs(&with, &plan, &runs).unwrap()) {
        assert_eq!(a, &b);
    }
}

#[test]
fn identity_runs_beside_each_other_have_the_bits_of_runs_alone_with_every_effect() {
    let (robot, nominal, truth) = planar();
    let plan = plan(&robot);
    // All at once, in two sets: a step of delay in the loop makes the spring of the light elbow ring without end.
    let springs = [EffectKind::Elasticity, EffectKind::Hysteresis, EffectKind::Backlash];
    for left_out in [&[EffectKind::CurrentDelay][..], &springs] {
        let effects = EffectKind::ALL
            .iter()
            .filter(|kind| !left_out.contains(kind))
            .fold(Effects::none(), |effects, &kind| effects.with(kind, kind.magnitude(Level::Realistic)));
        let arm = ActualArm::new(&effects, &robot, &truth);
        let plant = AnalyticPlant::new(arm.robot(), arm.parameters()).unwrap();
        let servo = Servo::new(&robot, &nominal, plant).unwrap().with_effects(arm);
        let runs: Vec<(Seed, u64)> = (0..3).map(|run| (Seed::new(5), run)).collect();
        let together = record_runs(&servo, &plan, &runs).unwrap();
        for (&(seed, run), (recording, ending)) in runs.iter().zip(together) {
            assert!(ending.is_complete(), "{ending:?}");
            let alone = record(&mut servo.clone().with_seed(seed, run), &plan).unwrap().0;
            assert_eq!((alone.q, alone.effort), (recording.q, recording.effort));
        }
    }
}
