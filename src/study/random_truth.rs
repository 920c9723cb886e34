//! Truths drawn at random around one guess of the arm, so that no conclusion depends on that guess.
//!
//! ```text
//! U' = U E            each link: U the log-Cholesky factor of its pseudo-inertia, E that of
//!                     (½ s_m z, s_i z, s_i z, …): every draw is a body that can exist
//! x' = x exp(s z)     rotor inertia, and the coefficient of every other term
//! effects             their seed, where `draw_effects` says so: signs, phases and directions, never a magnitude
//! ```
//! with z independent standard normal numbers. `s_m` is the standard deviation of ln m. `s_i` is that of the logarithm
//! of the body's lengths, and the centre of mass moves by `s_i` times the body's own radius along each axis.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::truth::Truth;
use crate::model::Columns;
use crate::model::term::Term;
use crate::seed::Seed;
use crate::spatial::{Inertia, InertiaError, LogCholesky};

/// Random truths: how many, around what, and how far.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomTruths {
    /// How many are drawn; run r of every design has truth r modulo this number.
    pub count: usize,
    /// What they are drawn around.
    #[serde(default)]
    pub around: Centre,
    /// Standard deviation of ln m of each link.
    #[serde(default = "mass_spread")]
    pub mass_spread: f64,
    /// Standard deviation of each other coordinate of a link, in the link's own size.
    #[serde(default = "inertia_spread")]
    pub inertia_spread: f64,
    /// Standard deviation of the logarithm of each rotor inertia.
    #[serde(default = "rotor_spread")]
    pub rotor_spread: f64,
    /// Standard deviation of the logarithm of the coefficient of every other torque term.
    #[serde(default = "friction_spread")]
    pub friction_spread: f64,
    /// Whether each truth has signs, phases and directions of effects of its own, in place of those that the effects' seed gives to
    /// all. Designs are then compared over designs and draws.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub draw_effects: bool,
}

/// What random truths are drawn around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Centre {
    /// The robot's `truth.toml`.
    #[default]
    Truth,
    /// The robot's `nominal.toml`.
    Nominal,
}

const fn mass_spread() -> f64 {
    0.2
}

const fn inertia_spread() -> f64 {
    0.15
}

const fn rotor_spread() -> f64 {
    0.3
}

const fn friction_spread() -> f64 {
    0.3
}

/// A link around which nothing can be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no truth can be drawn around link {link}: {fault}")]
pub struct TruthError {
    /// Number of the link, from one.
    pub link: usize,
    /// What is wrong with it.
    pub fault: InertiaError,
}

impl RandomTruths {
    /// So many draws, with the default spreads of a study.
    pub const fn new(count: usize) -> Self {
        Self {
            count,
            around: Centre::Truth,
            mass_spread: mass_spread(),
            inertia_spread: inertia_spread(),
            rotor_spread: rotor_spread(),
            friction_spread: friction_spread(),
            draw_effects: false,
        }
    }

    /// Every truth of a study with this seed. A draw depends on the seed and its own number alone.
    ///
    /// # Errors
    /// [`TruthError`] where a link of `centre` is physically inconsistent.
    pub fn draw(&self, centre: &Truth, seed: Seed) -> Result<Vec<Truth>, TruthError> {
        let draw = |index| {
            let truth = self.draw_one(centre, &mut seed.stream("truth", index))?;
            let effects = seed.child("effects of a truth", index);
            Ok(if self.draw_effects { Truth { effects: truth.effects.with_seed(effects), ..truth } } else { truth })
        };
        (0..self.count as u64).map(draw).collect()
    }

    fn draw_one(&self, centre: &Truth, rng: &mut impl Rng) -> Result<Truth, TruthError> {
        let mut parameters = centre.parameters.clone();
        for (index, link) in parameters.links.iter_mut().enumerate() {
            *link = self.link(link, rng).map_err(|fault| TruthError { link: index + 1, fault })?;
        }
        // The terms of every arm first, those that this one has beside them after all others: what is drawn for the former
        // does not depend on the latter.
        let usual = Columns::default();
        let others = usual.with_terms_of(&parameters);
        for drive in &mut parameters.drives {
            for term in usual.terms() {
                drive[term] *= libm::exp(self.spread_of(term) * normal(rng));
            }
        }
        for drive in &mut parameters.drives {
            for term in others.terms().filter(|&term| !usual.has(term)) {
                drive[term] *= libm::exp(self.spread_of(term) * normal(rng));
            }
        }
        Ok(Truth { parameters, ..centre.clone() })
    }

    fn spread_of(&self, term: Term) -> f64 {
        if term.is_inertia() { self.rotor_spread } else { self.friction_spread }
    }

    fn link(&self, link: &Inertia, rng: &mut impl Rng) -> Result<Inertia, InertiaError> {
        let own = LogCholesky::from_inertia(link)?;
        let mut change = LogCholesky([0.0; 10].map(|_| self.inertia_spread * normal(rng)));
        change.0[0] = 0.5 * self.mass_spread * normal(rng);
        let drawn = own.moved(&change);
        drawn.check()?;
        Ok(drawn)
    }
}

fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::StandardParameters;
    use crate::model::bundled;
    use crate::model::format::{parse_parameters, parse_robot};
    use crate::model::term::{COULOMB, ROTOR};
    use crate::statistics::{mean, variance};
    use crate::study::truth_text;

    fn a460() -> StandardParameters {
        let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
        let robot = parse_robot(entry.robot).unwrap();
        parse_parameters(truth_text(entry.name).unwrap(), &robot, true).unwrap().parameters
    }

    #[test]
    fn statistics_of_a_thousand_draws_are_those_stated_and_every_body_can_exist() {
        let centre = a460();
        let truths = RandomTruths::new(1000).draw(&Truth::without_effects(centre.clone()), Seed::new(11)).unwrap();
        let mut logs = vec![Vec::new(); 4];
        for truth in &truths {
            for (i, (link, own)) in truth.parameters.links.iter().zip(&centre.links).enumerate() {
                link.check().unwrap();
                // Apart from the pseudo-inertia: principal moments about the centre of mass keep the triangle.
                let moments = nalgebra::SymmetricEigen::new(link.about_com()).eigenvalues;
                assert!(moments.min() > 0.0 && moments.sum() > 2.0 * moments.max(), "link {}", i + 1);
                logs[0].push((link.mass / own.mass).ln());
                // The centre's shift, whitened by the covariance of the mass, which comes from the inertia directly.
                let moment = own.about_com();
                let covariance = (nalgebra::Matrix3::from_diagonal_element(0.5 * moment.trace()) - moment) / own.mass;
                let shift = link.com().unwrap() - own.com().unwrap();
                logs[1].push(shift.dot(&covariance.cholesky().unwrap().solve(&shift)));
            }
            for (drive, own) in truth.parameters.drives.iter().zip(&centre.drives) {
                logs[2].push((drive[ROTOR] / own[ROTOR]).ln());
                logs[3].push((drive[COULOMB] / own[COULOMB]).ln());
            }
        }
        // 6000 draws: a mean strays by 0.013 σ, a variance by 1.8 %; four times that.
        for (values, sigma) in [(&logs[0], 0.2), (&logs[2], 0.3), (&logs[3], 0.3)] {
            assert!(mean(values).abs() < 0.055 * sigma, "{}", mean(values));
            assert!((variance(values).sqrt() / sigma - 1.0).abs() < 0.04, "{}", variance(values).sqrt());
        }
        // A squared length of three normal numbers of standard deviation 0.15.
        let size = 3.0 * 0.15 * 0.15;
        assert!((mean(&logs[1]) / size - 1.0).abs() < 0.045, "{}", mean(&logs[1]) / size);
    }

    #[test]
    fn identity_a_draw_depends_on_its_number_alone_and_no_spread_is_the_centre() {
        let centre = Truth::without_effects(a460());
        let (few, many) = (RandomTruths::new(2), RandomTruths::new(5));
        let seed = Seed::new(3);
        let drawn = many.draw(&centre, seed).unwrap();
        assert_eq!(few.draw(&centre, seed).unwrap()[..], drawn[..2]);
        assert_ne!(drawn[0], drawn[1]);
        let none = RandomTruths {
            mass_spread: 0.0,
            inertia_spread: 0.0,
            rotor_spread: 0.0,
            friction_spread: 0.0,
            ..RandomTruths::new(1)
        };
        let same = &none.clone().draw(&centre, seed).unwrap()[0].parameters;
        assert_eq!(same.drives, centre.parameters.drives);
        for (a, b) in same.links.iter().zip(&centre.parameters.links) {
            assert!(a.to_array().iter().zip(b.to_array()).all(|(a, b)| (a - b).abs() < 1e-14));
        }
        // Signs and phases of effects are drawn apart from the parameters.
        let effects = RandomTruths { draw_effects: true, ..none }.draw(&centre, seed).unwrap().remove(0);
        assert_eq!((&effects.parameters, drawn[0].effects.seed), (same, Seed::new(0)));
        assert_ne!(effects.effects.seed, Seed::new(0));
        let mut impossible = centre;
        impossible.parameters.links[2] = Inertia::zero();
        let fault = few.draw(&impossible, seed).unwrap_err().to_string();
        assert!(fault.contains("link 3"), "{fault}");
    }
}
