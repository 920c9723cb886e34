//! Effects of the real arm act alike in every engine, and not at all where there are none.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::num::NonZeroU32;

use armid::experiment::{
    ActualArm, EffectKind, Effects, ExperimentPlan, Level, Phase, Plant, Recording, Sensing, Servo, record,
};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Joint, Robot, StandardParameters, bundled};
use armid::seed::Seed;
use armid::study::{Truth, truth_text};
use armid::trajectory::{FourierJoint, FourierTrajectory};
use armid_sim::{AnalyticPlant, BatchRun, Engine, RapierPlant, record_runs};

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

/// The engine's plant; rapier's, whose error goes with its step, in so many steps that an effect shows through it.
fn plant(engine: Engine, arm: &ActualArm) -> Box<dyn Plant> {
    match engine {
        Engine::Rapier => {
            let plant = RapierPlant::new(arm.robot(), arm.parameters()).unwrap();
            Box::new(plant.with_substeps(NonZeroU32::new(32).unwrap()))
        }
        _ => engine.plant(arm.robot(), arm.parameters()).unwrap(),
    }
}

/// The arm behind gears of the same torque per ampere to the last bit: without an effect of the gear nothing changes.
fn geared(robot: Robot) -> Robot {
    let gear = |joint: &mut Joint| (joint.drive.gear, joint.drive.torque_constant) = (64.0, 1.0 / 64.0);
    robot.with_joints(gear).unwrap()
}

fn perform(engine: Engine, effects: &Effects, sensing: &Sensing) -> Recording {
    let (robot, nominal, truth) = planar();
    let robot = if effects.has(EffectKind::TransmissionError) { geared(robot) } else { robot };
    let arm = ActualArm::new(effects, &robot, &truth);
    let mut servo = Servo::new(&robot, &nominal, plant(engine, &arm))
        .unwrap()
        .with_sensing(sensing.clone())
        .with_seed(Seed::new(1), 0)
        .with_effects(arm);
    let (recording, ending) = record(&mut servo, &plan(&robot)).unwrap();
    assert!(ending.is_complete(), "{} {effects}: {ending:?}", engine.name());
    recording
}

/// What an effect changes, sample by sample from the ramp on: currents (A), positions (rad).
type Change = (Vec<f64>, Vec<f64>);

/// What differs between a run with the severe effect and one without.
fn change_from(without: &Recording, engine: Engine, kind: EffectKind) -> Change {
    let with = perform(engine, &Effects::only(kind, Level::Severe).with_seed(Seed::new(3)), &sensing(Some(kind)));
    let from = with.samples(Phase::RampIn).start * with.dof;
    let difference = |a: &[f64], b: &[f64]| a[from..].iter().zip(&b[from..]).map(|(a, b)| a - b).collect();
    (difference(&with.effort, &without.effort), difference(&with.q, &without.q))
}

fn change(engine: Engine, kind: EffectKind) -> Change {
    change_from(&perform(engine, &Effects::none(), &sensing(Some(kind))), engine, kind)
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
/// MuJoCo is measured at 3e-10 and below. rapier, of order one, in steps of 1/64 ms: 1e-3 and below for what is smooth,
/// up to 2e-2 where a spring, a gap or a delay rings at a phase of its own. Steps are 1/32 ms here, so twice that is
/// expected; what is allowed (`coarse`) is three times that, or twice where it rings.
fn alike(kinds: &[EffectKind], coarse: f64) {
    alike_within(kinds, 1e-7, coarse);
}

/// Compares the engines with another allowance for MuJoCo.
fn alike_within(kinds: &[EffectKind], fine: f64, coarse: f64) {
    let plain = Engine::ALL.map(|engine| perform(engine, &Effects::none(), &Sensing::ideal()));
    for &kind in kinds {
        let ideal = sensing(Some(kind)) == Sensing::ideal();
        let changes = Engine::ALL.iter().zip(&plain).map(|(&engine, plain)| {
            let change = if ideal { change_from(plain, engine, kind) } else { change(engine, kind) };
            (engine, change)
        });
        let changes: Vec<(Engine, Change)> = changes.collect();
        let (_, (current, q)) = &changes[0];
        assert!(rms(current.iter().copied()) > 0.0 || rms(q.iter().copied()) > 0.0, "{} does nothing", kind.name());
        for (engine, (other_current, other_q)) in &changes[1..] {
            for (what, first, other) in [("current", current, other_current), ("position", q, other_q)] {
                let size = rms(first.iter().copied());
                let apart = rms(first.iter().zip(other).map(|(a, b)| a - b));
                let allowed = if *engine == Engine::Rapier { coarse } else { fine } * size + 1e-9;
                assert!(apart <= allowed, "{} {} {what}: {apart:e} apart of {size:e}", kind.name(), engine.name());
            }
        }
    }
}

#[test]
fn friction_acts_alike_in_every_engine() {
    let kinds =
        [EffectKind::LoadFriction, EffectKind::DirectionFriction, EffectKind::PositionFriction, EffectKind::Warming];
    alike(&kinds, 6e-3);
    // A term that the engines integrate themselves: near standstill each divides a step in its own way, down to parts on
    // which a method of order 4 errs by some 1e-2 of what friction changes in them. 1.2e-4 is measured.
    alike_within(&[EffectKind::Stribeck], 3e-4, 6e-3);
}

#[test]
fn friction_by_displacement_acts_alike_in_every_engine() {
    // About rest it is a spring, which rings in rapier at a phase of its own: 8e-3 and 9e-3 are measured.
    alike(&[EffectKind::Presliding], 0.02);
}

#[test]
fn errors_of_the_gear_act_alike_in_every_engine() {
    alike(&[EffectKind::TransmissionError], 6e-3);
}

#[test]
fn springs_act_alike_in_every_engine() {
    alike(&[EffectKind::Elasticity, EffectKind::Hysteresis, EffectKind::Backlash], 0.08);
}

#[test]
fn motors_act_alike_in_every_engine() {
    alike(&[EffectKind::TorqueRipple, EffectKind::Cogging, EffectKind::TorqueConstant, EffectKind::CurrentLag], 6e-3);
    // Five steps of delay take most of the loop's phase margin: it rings.
    alike(&[EffectKind::CurrentDelay], 0.08);
}

#[test]
fn loads_and_frames_act_alike_in_every_engine() {
    let kinds = [EffectKind::Tool, EffectKind::Cable, EffectKind::BaseTilt, EffectKind::Kinematics];
    alike(&kinds, 6e-3);
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
        EffectKind::EncoderNoise,
        EffectKind::TorqueNoise,
        EffectKind::TorqueSpikes,
    ];
    alike(&kinds, 6e-3);
    // Counts turn over at other moments in another engine: with coarse ones only the size of what they do is the same.
    for kind in [EffectKind::EncoderStep, EffectKind::AdcStep] {
        let size = |engine| rms(change(engine, kind).0);
        for engine in [Engine::Mujoco, Engine::Rapier] {
            let ratio = size(engine) / size(Engine::Analytic);
            assert!((ratio - 1.0).abs() < 0.3, "{} {}: {ratio}", kind.name(), engine.name());
        }
    }
}

#[test]
fn identity_a_clock_slips_alike_in_every_engine_and_brings_samples_of_20_ms_before() {
    // Two seconds have few slips at either level.
    let slips = Effects::none().with_effect(EffectKind::ClockSlips, 0.3);
    let slipped = |engine| {
        let (with, without) =
            (perform(engine, &slips, &Sensing::ideal()), perform(engine, &Effects::none(), &Sensing::ideal()));
        let (n, first) = (with.dof, with.samples(Phase::RampIn).start);
        let early = (20.0 * 1e-3 * with.rate_hz).round() as usize;
        let samples = first..with.q.len() / n;
        let found: Vec<bool> = samples.map(|k| with.q[k * n..(k + 1) * n] != without.q[k * n..(k + 1) * n]).collect();
        for (k, slips) in found.iter().enumerate().map(|(k, slips)| (first + k, *slips)) {
            let from = if slips { k - early } else { k };
            assert_eq!(with.q[k * n..(k + 1) * n], without.q[from * n..(from + 1) * n], "{} {k}", engine.name());
            assert_eq!(with.effort[k * n..(k + 1) * n], without.effort[from * n..(from + 1) * n]);
        }
        found
    };
    let all = Engine::ALL.map(slipped);
    assert!(all[0].iter().any(|slips| *slips) && all.iter().all(|found| *found == all[0]));
}

#[test]
fn identity_without_effects_every_bit_is_what_it_was() {
    let (robot, nominal, truth) = planar();
    let plan = plan(&robot);
    let plain = Servo::new(&robot, &nominal, AnalyticPlant::new(&robot, &truth).unwrap()).unwrap();
    let arm = ActualArm::new(&Effects::none(), &robot, &truth);
    assert_eq!((arm.robot(), arm.parameters()), (&robot, &truth));
    let with = plain.clone().with_effects(arm);
    let runs = [0, 1].map(|run| BatchRun { plan: &plan, noise: Seed::new(5).of_run(run) });
    for (a, b) in record_runs(&plain, &runs).iter().zip(record_runs(&with, &runs)) {
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
            .fold(Effects::none(), |effects, &kind| effects.with_effect(kind, kind.magnitude(Level::Realistic)));
        let arm = ActualArm::new(&effects, &robot, &truth);
        let plant = AnalyticPlant::new(arm.robot(), arm.parameters()).unwrap();
        let servo = Servo::new(&robot, &nominal, plant).unwrap().with_effects(arm);
        let runs = [0, 1, 2].map(|run| BatchRun { plan: &plan, noise: Seed::new(5).of_run(run) });
        for (member, together) in runs.iter().zip(record_runs(&servo, &runs)) {
            let (recording, ending) = together.unwrap();
            assert!(ending.is_complete(), "{ending:?}");
            let alone = record(&mut servo.clone().with_noise(member.noise), &plan).unwrap().0;
            assert_eq!((alone.q, alone.effort), (recording.q, recording.effort));
        }
    }
}
