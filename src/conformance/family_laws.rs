//! What every family of trajectories obeys.
//!
//! ```text
//! q_j(θ) = Σ_c x_jc N_c(θ) and its derivatives      coefficients(trajectory(x)) = x      Σ_c k_c N_c = 1
//! ```
//! - a member has the period and the joints that it was made with, and moves as its coefficients times the shape functions
//!   say, in position and all derivatives;
//! - its coefficients are those that it was made with, to the last bit;
//! - standing still is a member;
//! - the shape functions are independent, so that no motion is written in two ways;
//! - on the grid of the shape functions no peak of speed or acceleration hides;
//! - the scale of every coefficient is a finite number above zero.
//!
//! Each member is a motion, whose own laws are in [`super::trajectory_laws`].

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use rand::RngExt;

use super::law_error::LawError;
use crate::seed::{Seed, Stream};
use crate::trajectory::{MotionScale, Quantity, ShapeFunctions, TrajectoryFamily};

/// Members that each law is looked at on.
const RUNS: u64 = 6;

/// What a peak may hide between two points of the grid, of the largest value.
const HIDDEN: f64 = 0.1;

/// Checks one family.
///
/// ```
/// use armid::conformance::family_laws;
/// use armid::trajectory::Family;
/// family_laws::check(&Family::QuinticBSpline).unwrap();
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold, with what was found.
pub fn check(family: &dyn TrajectoryFamily) -> Result<(), LawError> {
    LawError::unless("a family has a name", !family.name().is_empty(), "none", "one")?;
    let least = family.least_harmonics();
    LawError::unless("a joint that moves has a harmonic", least > 0, least.to_string(), "one or more")?;
    for run in 0..RUNS {
        let mut rng = Seed::new(43).stream("family laws", run);
        let case = Case {
            family,
            period_s: rng.random_range(0.5..12.0),
            harmonics: [least + usize::try_from(run).expect("a small number"), least + 1],
        };
        case.members(&mut rng)?;
        for harmonics in case.harmonics {
            shapes(&*family.shape(case.period_s, harmonics), case.period_s)?;
        }
    }
    Ok(())
}

/// Two joints of different numbers of harmonics.
struct Case<'a> {
    family: &'a dyn TrajectoryFamily,
    period_s: f64,
    harmonics: [usize; 2],
}

impl Case<'_> {
    fn members(&self, rng: &mut Stream) -> Result<(), LawError> {
        let shapes = self.harmonics.map(|harmonics| self.family.shape(self.period_s, harmonics));
        let blocks: Vec<Vec<f64>> =
            shapes.iter().map(|shape| (0..shape.count()).map(|_| rng.random_range(-1.0..1.0)).collect()).collect();
        let names = ["first", "second"].map(str::to_owned);
        let member = self.family.trajectory(self.period_s, names.iter().cloned().zip(blocks.iter().cloned()).collect());
        let law = "a member has the period and the joints that it was made with";
        let found = format!("{} s, {:?}", member.period_s(), member.names());
        LawError::unless(
            law,
            (member.period_s() / self.period_s - 1.0).abs() < 1e-15 && member.names() == names,
            found,
            format!("{} s, {names:?}", self.period_s),
        )?;
        for (joint, ((shape, block), harmonics)) in shapes.iter().zip(&blocks).zip(self.harmonics).enumerate() {
            let law = "the coefficients of a member are those that it was made with";
            let found = self.family.coefficients(&member, joint, harmonics);
            LawError::unless(law, found.as_ref() == Ok(block), format!("{found:?}"), format!("{block:?}"))?;
            let mut row = vec![0.0; shape.count()];
            for order in 0..=3 {
                let curve = member.derivative(joint, order);
                let size =
                    [curve.minimum(), curve.maximum()].map(|end| end.value.abs()).into_iter().fold(1.0, f64::max);
                for k in 0..101 {
                    let phase = TAU * (f64::from(k) + 0.37) / 101.0;
                    shape.fill(phase, order, &mut row);
                    let sum: f64 = row.iter().zip(block).map(|(shape, x)| shape * x).sum();
                    let law = "a member moves as its coefficients times the shape functions say";
                    // Rounding of sums of terms that cancel.
                    LawError::unless_at_most(law, (sum - curve.value(phase)).abs() / size, 1e-9)?;
                }
            }
            for quantity in [Quantity::Velocity, Quantity::Acceleration] {
                let curve = member.curve(joint, quantity);
                let grid = shape.grid();
                let on_grid = (0..grid).map(|k| curve.value(TAU * k as f64 / grid as f64).abs()).fold(0.0, f64::max);
                let most = curve.peak();
                let law = "on the grid of the shape functions no peak of speed or acceleration hides";
                LawError::unless_at_most(law, (most - on_grid) / most, HIDDEN)?;
            }
        }
        Ok(())
    }
}

fn shapes(shape: &dyn ShapeFunctions, period_s: f64) -> Result<(), LawError> {
    let count = shape.count();
    let still = shape.constant();
    let law = "standing still is a member";
    LawError::unless(law, still.len() == count, still.len().to_string(), format!("{count} coefficients"))?;
    let samples = 8 * count;
    let mut table = DMatrix::zeros(samples, count);
    let mut row = vec![0.0; count];
    for k in 0..samples {
        for order in 0..=3 {
            shape.fill(TAU * k as f64 / samples as f64, order, &mut row);
            let size = row.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            let sum: f64 = row.iter().zip(&still).map(|(shape, x)| shape * x).sum();
            let expected = if order == 0 { 1.0 } else { 0.0 };
            LawError::unless_at_most(law, (sum - expected).abs() / size, 1e-10)?;
            if order == 0 {
                table.row_mut(k).copy_from_slice(&row);
            }
        }
    }
    for mut column in table.column_iter_mut() {
        let length = column.norm();
        column /= length;
    }
    let smallest = table.singular_values().min();
    let law = "the shape functions are independent";
    LawError::unless(law, smallest > 1e-6, format!("a singular value of {smallest:e}"), "1e-6 or more")?;
    let scale = MotionScale { range: 2.0, speed: 1.5, omega: TAU / period_s };
    let scales = shape.scales(&scale);
    let sound = scales.len() == count && scales.iter().all(|scale| scale.is_finite() && *scale > 0.0);
    LawError::unless("every coefficient has a scale", sound, format!("{scales:?}"), format!("{count} above zero"))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::trajectory::{Family, PeriodicTrajectory, TrajectoryError};

    #[test]
    fn every_family_of_the_list_obeys() {
        for family in Family::ALL {
            check(&family).unwrap_or_else(|broken| panic!("{family:?}: {broken}"));
        }
    }

    /// A family of the list with one thing wrong.
    #[derive(Debug)]
    struct Broken(&'static str);

    #[derive(Debug)]
    struct BrokenShapes(&'static str, Arc<dyn ShapeFunctions>);

    impl TrajectoryFamily for Broken {
        fn name(&self) -> &'static str {
            "broken"
        }

        fn shape(&self, period_s: f64, harmonics: usize) -> Arc<dyn ShapeFunctions> {
            Arc::new(BrokenShapes(self.0, TrajectoryFamily::shape(&Family::Fourier, period_s, harmonics)))
        }

        fn trajectory(&self, period_s: f64, joints: Vec<(String, Vec<f64>)>) -> PeriodicTrajectory {
            let period_s = if self.0 == "period" { 2.0 * period_s } else { period_s };
            Family::Fourier.trajectory(period_s, joints)
        }

        fn coefficients(
            &self,
            trajectory: &PeriodicTrajectory,
            joint: usize,
            harmonics: usize,
        ) -> Result<Vec<f64>, TrajectoryError> {
            let joint = if self.0 == "coefficients" { 0 } else { joint };
            Family::Fourier.coefficients(trajectory, joint, harmonics + usize::from(self.0 == "coefficients"))
        }
    }

    impl ShapeFunctions for BrokenShapes {
        fn count(&self) -> usize {
            self.1.count()
        }

        fn grid(&self) -> usize {
            if self.0 == "grid" { 2 } else { self.1.grid() }
        }

        fn fill(&self, phase: f64, order: usize, out: &mut [f64]) {
            self.1.fill(phase, order, out);
            if self.0 == "slope" && order == 1 {
                out[0] *= 1.01;
            }
        }

        fn constant(&self) -> Vec<f64> {
            let mut values = self.1.constant();
            if self.0 == "still" {
                values[0] = 0.1;
            }
            values
        }
    }

    #[test]
    fn a_broken_family_is_found() {
        assert_eq!(check(&Broken("nothing")), Ok(()));
        for (what, word) in [
            ("period", "has the period"),
            ("coefficients", "coefficients of a member"),
            ("slope", "moves as its coefficients"),
            ("grid", "hides"),
            ("still", "standing still"),
        ] {
            let broken = check(&Broken(what)).unwrap_err();
            assert!(broken.law.contains(word), "{what}: {broken}");
        }
    }
}
