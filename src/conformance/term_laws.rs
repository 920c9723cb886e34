//! What every torque term obeys.
//!
//! - inverse dynamics are the regressor times the parameters, and forward dynamics undo them, by both recursions;
//! - the regressor's gradient is its central difference;
//! - the law is affine in acceleration, with a constant slope;
//! - it dissipates as its entry says, or stores what [`TermLaw::energy`](crate::model::term::TermLaw::energy) says;
//! - the structural reduction has the columns and the coefficients of a QR on random states;
//! - its prior, units and keys are there.
//!
//! Terms of the list obey one more: a parameter file gives back what was written.

use rand::RngExt;

use super::chains::{ChainRecipe, random_state};
use super::law_error::LawError;
use crate::base::{BaseReduction, Method, reduce};
use crate::dynamics::{Dynamics, States};
use crate::model::format::{parse_parameters, write_parameters};
use crate::model::term::{COULOMB, Dissipation, Scale, Sign, Term, TermInput};
use crate::model::{Columns, JointKind, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
use crate::seed::{Seed, Stream};

/// Random arms that a term is shown on.
const ARMS: u64 = 16;

/// Checks a term, from the list or from outside.
///
/// ```
/// use armid::conformance::term_laws;
/// use armid::model::term::VISCOUS;
/// term_laws::check(VISCOUS)?;
/// # Ok::<(), armid::conformance::LawError>(())
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold, with what was found.
pub fn check(term: Term) -> Result<(), LawError> {
    entry(term)?;
    affine(term)?;
    energy_and_dissipation(term)?;
    for run in 0..ARMS {
        let arm = Arm::draw(term, run);
        arm.inverse_is_regressor_times_parameters()?;
        arm.forward_undoes_inverse()?;
        arm.gradient()?;
        arm.structural_reduction()?;
    }
    Ok(())
}

/// Checks that parameter files carry a term of the list.
///
/// # Errors
/// [`LawError`] where what is read is not what was written.
pub fn check_files(term: Term) -> Result<(), LawError> {
    let law = "a parameter file gives back what was written";
    for run in 0..ARMS {
        let Arm { robot, parameters, .. } = Arm::draw(term, run);
        let text = write_parameters(&robot, &parameters, "a test");
        let read = parse_parameters(&text, &robot, false);
        let read = read.map_err(|fault| LawError::failed(law, &fault, text.clone()))?;
        LawError::unless(law, read.parameters == parameters, format!("{:?}", read.parameters.drives), text)?;
    }
    Ok(())
}

fn entry(term: Term) -> Result<(), LawError> {
    let law = "an entry is complete";
    let entry = term.entry();
    for text in [entry.symbol, entry.name, entry.meaning, entry.group, entry.unit.revolute, entry.prior.key] {
        LawError::unless(law, !text.is_empty(), "an empty text", "a text")?;
    }
    let alike = Term::ALL.iter().filter(|other| other.symbol() == term.symbol()).count();
    LawError::unless(law, alike <= 1, term.symbol(), "a symbol of its own")?;
    for kind in [JointKind::Revolute, JointKind::Prismatic] {
        let alike = Term::ALL.iter().filter(|other| **other != term && other.entry().key.is(entry.key.for_kind(kind)));
        LawError::unless(law, alike.count() == 0, entry.key.for_kind(kind), "a key of its own")?;
    }
    Ok(())
}

/// A coordinate at random, with every channel.
fn random_input(rng: &mut Stream) -> TermInput<f64> {
    let mut draw = |bound: f64| rng.random_range(-bound..bound);
    let (q, qd, qdd, load) = (draw(2.5), draw(0.6), draw(10.0), draw(30.0));
    let warmth = 0.5 + draw(0.5);
    TermInput { q, qd, qdd, load, warmth, shape: [Scale::new(0.05 + 0.04 * draw(1.0)), Scale::new(0.1)] }
}

fn affine(term: Term) -> Result<(), LawError> {
    let law = "slopes are central differences, and that by acceleration is constant";
    let mut rng = Seed::new(0).stream("term laws", 0);
    let constant = term.slopes(&random_input(&mut rng))[2];
    for _ in 0..50 {
        let x = random_input(&mut rng);
        let slopes = term.slopes(&x);
        LawError::unless(law, slopes[2] == constant, slopes[2].to_string(), constant.to_string())?;
        let h = 1e-6;
        let at = |part: usize, step: f64| {
            let mut moved = x;
            *[&mut moved.q, &mut moved.qd, &mut moved.qdd, &mut moved.load][part] += step;
            term.torque(&moved)
        };
        for (part, slope) in slopes.into_iter().enumerate() {
            let found = (at(part, h) - at(part, -h)) / (2.0 * h);
            // Truncation h² g‴/6, with g‴ up to 2/v_s³ = 1e6 times a load of 30; rounding 1e-16 · 30 / h.
            LawError::unless_at_most(law, (found - slope).abs(), 1e-4)?;
        }
    }
    Ok(())
}

fn energy_and_dissipation(term: Term) -> Result<(), LawError> {
    let mut rng = Seed::new(0).stream("term laws", 1);
    for _ in 0..200 {
        let x = random_input(&mut rng);
        let power = term.torque(&x) * x.qd;
        match term.entry().dissipation {
            Dissipation::Always => {
                let law = "a term that dissipates takes power at every speed";
                LawError::unless_at_most(law, -power, 0.0)?;
                let signed = term.entry().sign == Sign::NotNegative;
                LawError::unless(law, signed, "a coefficient of any sign", "one that is not negative")?;
            }
            Dissipation::Beside(other) => {
                let law = "beside the term that it names, as large, a term takes power at every speed";
                let found = Term::ALL.iter().copied().find(|term| term.symbol() == other);
                let Some(other) = found else {
                    return Err(LawError { law, found: other.to_owned(), expected: "a term of the list".into() });
                };
                // Shape parameters by key: the other term's may stand in another order.
                let own = term.entry().shapes;
                let shape = std::array::from_fn(|k| {
                    let wanted = other.entry().shapes.get(k).map(|shape| shape.key);
                    own.iter().position(|shape| Some(shape.key) == wanted).map_or(x.shape[k], |at| x.shape[at])
                });
                let beside = other.torque(&TermInput { shape, ..x }) * x.qd;
                LawError::unless_at_most(law, power.abs() - beside, 1e-15)?;
            }
            Dissipation::Stores => {
                let law = "the power of a term that stores is the rate of its energy";
                let h = 1e-5;
                let at = |t: f64| {
                    let (q, qd) = (x.q + x.qd * t + 0.5 * x.qdd * t * t, x.qd + x.qdd * t);
                    term.law().energy(&TermInput { q, qd, ..x })
                };
                let rate = (at(h) - at(-h)) / (2.0 * h);
                LawError::unless_at_most(law, (rate - power).abs(), 1e-6)?;
            }
            Dissipation::No(reason) => {
                let law = "a term that may give energy says why";
                LawError::unless(law, !reason.is_empty(), "nothing", "a reason")?;
            }
        }
    }
    Ok(())
}

/// A random arm with coefficients of every usual term and of the one that is looked at.
struct Arm {
    robot: Robot,
    parameters: StandardParameters,
    columns: Columns,
    rng: Stream,
}

impl Arm {
    fn draw(term: Term, run: u64) -> Self {
        let mut rng = Seed::new(2).stream("term laws", run);
        let dof = 1 + usize::try_from(run % 6).expect("a small number");
        let recipe =
            ChainRecipe { coupled: run.is_multiple_of(2), tilted: run.is_multiple_of(3), ..ChainRecipe::new(dof) };
        let (robot, mut parameters) = recipe.draw(&mut rng);
        for (index, drive) in parameters.drives.iter_mut().enumerate() {
            if term.is_at(&robot, index) {
                let size = if term.entry().dimension.effort == 0 { 2.0 } else { 0.1 };
                drive[term] = size * rng.random_range(0.2..1.0) * drive[COULOMB].min(1.0);
            }
        }
        Self { robot, parameters, columns: Columns::default().with_term(term), rng }
    }

    fn regressor(&self) -> JointTorqueRegressor {
        JointTorqueRegressor::with_load(&self.robot, self.columns, &self.parameters)
    }

    fn inverse_is_regressor_times_parameters(&self) -> Result<(), LawError> {
        let law = "inverse dynamics are the regressor times the parameters";
        let (regressor, phi) = (self.regressor(), self.parameters.vector(&self.robot, self.columns));
        let mut dynamics = Dynamics::new(&self.robot, &self.parameters);
        let mut rng = self.rng.clone();
        let (n, p) = (regressor.rows(), regressor.cols());
        let (mut y, mut tau) = (vec![0.0; n * p], vec![0.0; n]);
        for _ in 0..5 {
            let (q, qd, qdd) = random_state(&mut rng, n);
            regressor.evaluate(&q, &qd, &qdd, &mut y);
            dynamics.inverse(&q, &qd, &qdd, &mut tau);
            let size = tau.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            for (row, tau) in y.chunks_exact(p).zip(&tau) {
                let found: f64 = row.iter().zip(&phi).map(|(y, phi)| y * phi).sum();
                // Rounding of some hundred operations on torques of this size.
                LawError::unless_at_most(law, (found - tau).abs(), 1e-12 * size)?;
            }
        }
        Ok(())
    }

    fn forward_undoes_inverse(&self) -> Result<(), LawError> {
        let law = "forward dynamics undo inverse dynamics";
        let mut dynamics = Dynamics::new(&self.robot, &self.parameters);
        let mut rng = self.rng.clone();
        let n = self.robot.dof();
        let [mut tau, mut a, mut b] = std::array::from_fn(|_| vec![0.0; n]);
        for _ in 0..5 {
            let (q, qd, qdd) = random_state(&mut rng, n);
            dynamics.inverse(&q, &qd, &qdd, &mut tau);
            dynamics.forward_composite(&q, &qd, &tau, &mut a);
            dynamics.forward_articulated(&q, &qd, &tau, &mut b);
            for i in 0..n {
                // Rounding times the condition number of the mass matrix, at most some thousands.
                LawError::unless_at_most(law, (a[i] - qdd[i]).abs(), 1e-8)?;
                LawError::unless_at_most(law, (b[i] - qdd[i]).abs(), 1e-8)?;
            }
        }
        Ok(())
    }

    fn gradient(&self) -> Result<(), LawError> {
        let law = "the gradient of the regressor is its central difference";
        let regressor = self.regressor();
        let mut rng = self.rng.clone();
        let n = regressor.rows();
        let (q, qd, qdd) = random_state(&mut rng, n);
        let state = [q, qd, qdd];
        let g: Vec<f64> = (0..n * regressor.cols()).map(|_| rng.random_range(-1.0..1.0)).collect();
        let [mut dq, mut dqd, mut dqdd] = std::array::from_fn(|_| vec![0.0; n]);
        regressor.adjoint([&state[0], &state[1], &state[2]], &g, [&mut dq, &mut dqd, &mut dqdd]);
        let mut y = vec![0.0; g.len()];
        for (part, found) in [&dq, &dqd, &dqdd].into_iter().enumerate() {
            for j in 0..n {
                let mut along = |step: f64| {
                    let mut moved = state.clone();
                    moved[part][j] += step;
                    regressor.evaluate(&moved[0], &moved[1], &moved[2], &mut y);
                    y.iter().zip(&g).map(|(y, g)| y * g).sum::<f64>()
                };
                // Richardson: error h⁴ times a fifth derivative, which a smooth sign times a load makes large.
                let h = 1e-4;
                let wide = (along(2.0 * h) - along(-2.0 * h)) / (4.0 * h);
                let narrow = (along(h) - along(-h)) / (2.0 * h);
                let expected = (4.0 * narrow - wide) / 3.0;
                LawError::unless_at_most(law, (found[j] - expected).abs(), 1e-6 * expected.abs().max(100.0))?;
            }
        }
        Ok(())
    }

    fn structural_reduction(&self) -> Result<(), LawError> {
        let law = "the structural reduction is that of a QR on random states";
        let regressor = self.regressor();
        let mut rng = self.rng.clone();
        let n = regressor.rows();
        let mut states = States::new(n);
        for sample in 0..40 * n + 200 {
            let (q, mut qd, qdd) = random_state(&mut rng, n);
            // Half of them where smooth signs turn over.
            if sample % 2 == 0 {
                qd.iter_mut().for_each(|qd| *qd *= 0.05);
            }
            states.push(&q, &qd, &qdd);
        }
        // A law of temperature shows nothing where none is recorded.
        if self.columns.terms().any(|term| term.entry().needs.warmth) {
            return Ok(());
        }
        let qr = BaseReduction::from_stack(regressor.parameters(), &regressor.stack(&states), Method::Qr);
        let structural = reduce(&self.robot, self.columns, Method::Structural, Seed::new(0))
            .map_err(|fault| LawError::failed(law, &fault, "a reduction"))?;
        LawError::unless(law, structural.names() == qr.names(), structural.names().join(" "), qr.names().join(" "))?;
        let error = (&structural.k - &qr.k).amax() / qr.k.amax().max(1.0);
        LawError::unless_at_most(law, error, 1e-7)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_term_of_the_list_obeys() {
        for &term in Term::ALL {
            check(term).unwrap_or_else(|broken| panic!("{}: {broken}", term.symbol()));
            check_files(term).unwrap_or_else(|broken| panic!("{}: {broken}", term.symbol()));
        }
    }
}
