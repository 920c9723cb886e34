//! Links of other lengths and angles than the robot file's.
//!
//! ```text
//! T_i(q) = before · J(q) · after      after ← after · Rz(s₁ε) Tz(s₂δ) Tx(s₃δ) Rx(s₄ε)      s = ±1 drawn
//! ```
//! `δ` in mm and `ε` in as many mrad: errors of the four numbers of a row of the Denavit–Hartenberg table, with the
//! joint's zero among them. The last link's is left out: nothing is fixed to its frame but its own parameters. The
//! plant has the wrong geometry, the identification model the file's; both call their parameters by the same names, each
//! in its own frames.

use super::draw;
use crate::model::Robot;
use crate::seed::Seed;
use crate::spatial::Placement;

/// The robot with every length off by `millimetres` and every angle by as many milliradians.
pub(super) fn disturb(robot: &Robot, millimetres: f64, seed: Seed) -> Robot {
    let error = 1e-3 * millimetres;
    let signs = draw::signs(seed, "kinematic errors", 4 * robot.dof());
    let (sin, cos) = libm::sincos(error);
    let last = robot.dof() - 1;
    let mut row = 0;
    let disturbed = robot.clone().with_joints(|joint| {
        let s = &signs[4 * row..4 * row + 4];
        if row < last {
            let rotation = Placement::rotation_z(s[0] * sin, cos);
            let shift = Placement::translation(s[2] * error, 0.0, s[1] * error);
            let wrong = rotation.compose(&shift).compose(&Placement::rotation_x(s[3] * sin, cos));
            joint.after = joint.after.compose(&wrong);
            joint.dh = None;
        }
        row += 1;
    });
    disturbed.expect("limits and drives are those of a robot that is possible")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::ChainRecipe;

    #[test]
    fn analytic_the_end_is_off_by_lengths_and_by_angles_times_lever() {
        let (robot, _) = ChainRecipe::new(3).draw(&mut Seed::new(2).stream("chain", 0));
        let poses = |robot: &Robot| robot.poses(&[0.3, -0.5, 0.8]);
        let exact = poses(&robot);
        for millimetres in [0.1, 1.0] {
            let off = poses(&disturb(&robot, millimetres, Seed::new(5)));
            let error = 1e-3 * millimetres;
            // The first link's own frame: two lengths and two angles of its own.
            assert!(((off[0].translation - exact[0].translation).norm() - 2.0_f64.sqrt() * error).abs() < 1e-12);
            let turn = (off[0].rotation.transpose() * exact[0].rotation).trace();
            // Two turns of ε about axes at right angles: cos of the whole = (trace − 1)/2 ≈ 1 − ε².
            assert!((0.5 * (turn - 1.0) - (1.0 - error * error)).abs() < 1e-9, "{turn}");
            // The end: two rows of errors, each at a lever of at most the arm's length, and never none.
            let reach: f64 = exact.windows(2).map(|w| (w[1].translation - w[0].translation).norm()).sum();
            let shift = (off[2].translation - exact[2].translation).norm();
            assert!(shift > 0.1 * error && shift < 4.0 * error * (1.0 + reach), "{shift}");
        }
    }
}
