//! The closed loop in intervals, and estimators that begin there.

use armid::estimation::{
    ClosedLoop, ClosedLoopInterval, ClosedLoopNode, ClosedLoopReference, Estimate, EstimatorKind, Finding,
};
use armid::experiment::{ExperimentPlan, Sensing};
use armid::model::{ParameterId, StandardParameters};
use armid::observer::Unobserved;
use armid::signal::{Processing, process};
use armid_sim::closed_loop;
use nalgebra::DVector;

use crate::arm::{Arm, short, slow};

/// Nodes at the states that the arm passes: each is the end of the interval before.
fn passed(known: &dyn ClosedLoop, arm: &Arm, block: usize, apart: usize) -> Vec<ClosedLoopNode> {
    let intervals = known.in_intervals().unwrap();
    let motion = known.motion(&arm.truth, &Unobserved).unwrap();
    let mut nodes = intervals.nodes(&motion.states, &motion.tau, block, apart);
    for k in 1..nodes.len() {
        let end = intervals.intervals(&arm.truth, &[], block, &nodes[k - 1..k], &Unobserved).unwrap().remove(0).end;
        if nodes[k].follows {
            nodes[k].state = end;
        }
    }
    nodes
}

#[test]
fn identity_intervals_between_passed_states_are_the_motion() {
    // Positions are known at samples alone, and the TX40's servo takes five steps between them. No current is at its limit.
    for (name, most) in [("planar-2r", 1e-9), ("crs-a460", 1e-9), ("staubli-tx40", 1e-3)] {
        let arm = Arm::new(name);
        let plan = ExperimentPlan { rate_hz: 1000.0, discarded_periods: 3, ..slow(&arm.robot).with_periods(1) };
        let known = closed_loop(&arm.robot, &arm.nominal, ClosedLoopReference::Plans(&[plan])).unwrap();
        let motion = known.motion(&arm.truth, &Unobserved).unwrap();
        let (n, block) = (arm.robot.dof(), 50);
        let intervals = known.in_intervals().unwrap();
        // One interval along the whole motion; its servo's memory is that of ideal sensors, its integrals those of the torque.
        let nodes = intervals.nodes(&motion.states, &motion.tau, block, motion.states.len());
        let whole = &intervals.intervals(&arm.truth, &[], block, &nodes, &Unobserved).unwrap()[0];
        let mean = |table: &[f64], m: usize, i: usize| {
            (0..block).map(|k| table[(m * block + k) * n + i]).sum::<f64>() / block as f64
        };
        let blocks = motion.states.len() / block;
        assert_eq!(nodes[0].blocks, 1..blocks, "{name}");
        let spread = motion.states.q.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
        for m in 1..blocks {
            for i in 0..n {
                let difference = whole.q[(m - 1) * n + i] - mean(&motion.states.q, m, i);
                assert!(difference.abs() < most * spread, "{name} {m} {i}: {difference}");
            }
        }
        // In intervals whose ends meet nothing but rounding is left.
        let nodes = passed(&*known, &arm, block, 7);
        let found = intervals.intervals(&arm.truth, &[], block, &nodes, &Unobserved).unwrap();
        let joined: Vec<f64> = found.iter().flat_map(|own| own.q.iter().copied()).collect();
        let torque: Vec<f64> = found.iter().flat_map(|own| own.tau.iter().copied()).collect();
        assert_eq!(joined, whole.q, "{name}");
        assert_eq!(torque, whole.tau, "{name}");
    }
}

#[test]
fn analytic_slopes_of_intervals_are_central_differences() {
    for (name, rate_hz) in [("planar-2r", 500.0), ("crs-a460", 500.0), ("staubli-tx40", 1000.0)] {
        let arm = Arm::new(name);
        let plan = ExperimentPlan { rate_hz, discarded_periods: 1, ..short(&arm.robot).with_periods(1) };
        let known = closed_loop(&arm.robot, &arm.nominal, ClosedLoopReference::Plans(&[plan])).unwrap();
        let block = 10;
        let nodes = passed(&*known, &arm, block, 5);
        let node = &nodes[1];
        let by: Vec<ParameterId> = arm.base.kept.iter().step_by(7).map(|&j| arm.base.parameters[j]).collect();
        let simulate = |truth: &StandardParameters, state: &DVector<f64>| {
            let node = ClosedLoopNode { state: state.clone(), ..node.clone() };
            known.in_intervals().unwrap().intervals(truth, &by, block, &[node], &Unobserved).unwrap().remove(0)
        };
        let at = simulate(&arm.truth, &node.state);
        let check = |direction: usize, low: &ClosedLoopInterval, high: &ClosedLoopInterval, h: f64| {
            for (exact, low, high) in [
                (&at.slopes.q, &low.q, &high.q),
                (&at.slopes.tau, &low.tau, &high.tau),
                (&at.end_slopes, &low.end.as_slice().to_vec(), &high.end.as_slice().to_vec()),
            ] {
                let size = exact.column(direction).amax();
                let rounding = low.iter().fold(1.0_f64, |most, x| most.max(x.abs())) * 1e-14 / h;
                for (row, (low, high)) in low.iter().zip(high).enumerate() {
                    let (difference, found) = ((high - low) / (2.0 * h), exact[(row, direction)]);
                    assert!(
                        (difference - found).abs() < 1e-4 * size + rounding,
                        "{name} {direction} {row}: {difference} {found}"
                    );
                }
            }
        };
        for (j, &id) in by.iter().enumerate() {
            let value = arm.truth.get(id);
            let h = 1e-5 * value.abs().max(0.1);
            let moved = |step: f64| {
                let mut moved = arm.truth.clone();
                moved.set(id, value + step);
                simulate(&moved, &node.state)
            };
            let (low, high) = (moved(-h), moved(h));
            check(j, &low, &high, h);
        }
        for i in 0..node.state.len() {
            let h = 1e-5 * node.state[i].abs().max(0.1);
            let moved = |step: f64| {
                let mut state = node.state.clone();
                state[i] += step;
                simulate(&arm.truth, &state)
            };
            let (low, high) = (moved(-h), moved(h));
            check(by.len() + i, &low, &high, h);
        }
    }
}

/// Errors of all parameters but offsets, which positions do not show, over their standard deviations.
fn errors(arm: &Arm, found: &Estimate) -> Vec<(String, f64)> {
    let beta = arm.beta();
    let shown = found.base.iter().zip(&beta).filter(|(p, _)| !p.name.starts_with("Fo"));
    shown.map(|(p, truth)| (p.name.clone(), (p.value - truth) / p.std)).collect()
}

#[test]
fn analytic_a_motion_that_runs_away_is_found_in_intervals() {
    // Torque in a unit that is too large: the servo of an arm so heavy does not hold it.
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&slow(&arm.robot), Sensing::default(), 0);
    let mut samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    samples.tau.iter_mut().for_each(|tau| *tau *= 100.0);
    let found = arm.estimate(EstimatorKind::Cloe, &recording, &samples);
    let shooting = found.findings.iter().find(|finding| matches!(finding, Finding::MultipleShooting { .. }));
    assert!(shooting.is_some_and(|finding| finding.to_string().contains("over 10 intervals")), "{:?}", found.findings);
    assert!(found.termination.was_successful(), "{:?}", found.termination);
    // Eleven parameters by positions alone, none of which the unit of torque is in.
    let errors = errors(&arm, &found);
    assert!(errors.len() == 11 && errors.iter().all(|(_, error)| error.abs() < 3.0), "{errors:?}");
}
