//! The error of predicted torque where the arm has effects that the model lacks: variance and bias together.
//!
//! Two criteria share it. `model-error` predicts the torque of the arm without its effects, each of the declared size.
//! `measured-torque` predicts what the arm with its effects measures, over several sizes of each effect.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::prediction::{Carried, Prediction};

/// `f = Σ_s ½ ln J_s² / (number of scenarios)`, over the scenario without effects and one for each that is expected.
///
/// An effect adds d to the torque of the arm, and with it A d to the estimate, A = M⁻¹ W_bᵀ Σ⁻¹ / rows. With the moments
/// c = W_bᵀ Σ⁻¹ d / rows and G of the evaluation motions ([`Prediction`])
///
/// ```text
/// J_0² = tr(G M⁻¹) / rows                                 what noise leaves of predicted torque, (N·m)²
/// J_s² = J_0² + Σ_{e ∈ s} p_eᵀ G p_e − 2 p_eᵀ h_e + s_e    p_e = M⁻¹ c_e
/// ∂J_s²/∂c_e = 2 t_e      ∂J_s²/∂M = −M⁻¹ G M⁻¹/rows − Σ (t_e p_eᵀ + p_e t_eᵀ)      t_e = M⁻¹ (G p_e − h_e)
/// ```
/// h and s are zero where the estimate is to be that of the arm without the effects. For measured torque a scenario is an
/// effect of one size: a share ℓ of the declared effect has ℓ² of its bias. J² is Box and Draper's integrated
/// mean squared error. Errors by effects differ by orders of magnitude, so that their sum would be that of the largest;
/// the mean of logarithms weights a factor won under one the same as a factor lost under another, and needs no
/// magnitudes to compare. The number that people read is the geometric mean of J_s, N·m. Source: G. E. P. Box,
/// N. R. Draper, "A basis for the selection of a response surface design", *JASA* 54(287), 1959.
#[derive(Clone, Debug, Default)]
pub struct ModelError {
    prediction: Option<Prediction>,
    /// Whether the torque to predict is what the arm with its effects measures, whose size is not known. Else it is that of the arm without its
    /// effects, which are of the declared size.
    measured: bool,
}

impl ModelError {
    /// The error of these predictions.
    pub const fn new(prediction: Prediction) -> Self {
        Self { prediction: Some(prediction), measured: false }
    }

    /// The error of the torque that the arm with its effects measures, over several sizes of each effect.
    pub const fn of_measured_torque() -> Self {
        Self { prediction: None, measured: true }
    }

    /// Sizes of an effect, as shares of the declared one, of which each counts alike.
    ///
    /// Below a hundredth the noise of most experiments hides an effect, as the scenario without effects does.
    const fn levels(&self) -> &'static [f64] {
        if self.measured { &[0.01, 0.1, 1.0] } else { &[1.0] }
    }

    /// J of every scenario, N·m: without effects first, then under each that is expected, at each of its sizes; empty where
    /// M is not positive definite.
    pub fn errors(&self, m: &DMatrix<f64>, moments: &DMatrix<f64>) -> Vec<f64> {
        let levels = self.levels();
        let parts = Parts::new(self.prediction.as_ref(), m, moments);
        let roots = |parts: Parts<'_>| parts.scenarios(levels).into_iter().map(f64::sqrt).collect();
        parts.map_or_else(Vec::new, roots)
    }
}

/// What value and gradient share.
struct Parts<'a> {
    prediction: Option<&'a Prediction>,
    inverse: DMatrix<f64>,
    /// M⁻¹ G M⁻¹ / rows.
    spread: DMatrix<f64>,
    variance: f64,
    /// p, b × E.
    bias: DMatrix<f64>,
    /// G p − h, b × E.
    pull: DMatrix<f64>,
    /// Mean square of the error by each discrepancy.
    squares: Vec<f64>,
}

impl<'a> Parts<'a> {
    fn new(prediction: Option<&'a Prediction>, m: &DMatrix<f64>, moments: &DMatrix<f64>) -> Option<Self> {
        let inverse = m.clone().cholesky()?.inverse();
        let rows = prediction.map_or(1.0, |prediction| prediction.rows);
        let by_gram = |x: &DMatrix<f64>| prediction.map_or_else(|| x.clone(), |prediction| &prediction.gram * x);
        let weighted = by_gram(&inverse) / rows;
        let bias = &inverse * moments;
        let mut pull = by_gram(&bias);
        let mut squares: Vec<f64> = (0..bias.ncols()).map(|e| bias.column(e).dot(&pull.column(e))).collect();
        if let Some(Carried { moments, squares: whole }) = prediction.and_then(|prediction| prediction.carried.as_ref())
        {
            for (e, square) in squares.iter_mut().enumerate() {
                *square += whole[e] - 2.0 * bias.column(e).dot(&moments.column(e));
            }
            pull -= moments;
        }
        Some(Self {
            prediction,
            spread: &inverse * &weighted,
            variance: weighted.trace(),
            inverse,
            bias,
            pull,
            squares,
        })
    }

    fn effects(&self) -> &[std::ops::Range<usize>] {
        self.prediction.map_or(&[], |prediction| &prediction.effects)
    }

    /// J² of every scenario; the bias grows with the size of its effect.
    fn scenarios(&self, levels: &[f64]) -> Vec<f64> {
        let effects = self.effects().iter().flat_map(|own| {
            let whole = self.squares[own.clone()].iter().sum::<f64>();
            levels.iter().map(move |level| self.variance + level * level * whole)
        });
        std::iter::once(self.variance).chain(effects).collect()
    }
}

impl Criterion for ModelError {
    fn name(&self) -> &'static str {
        if self.measured { "measured-torque" } else { "model-error" }
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        let columns =
            self.prediction.as_ref().and_then(|prediction| prediction.effects.last()).map_or(0, |last| last.end);
        let moments = DMatrix::zeros(m.nrows(), columns);
        let mut unused = moments.clone();
        self.evaluate_with_effects(m, &moments, sensitivity.map(|by_m| (by_m, &mut unused)))
    }

    fn evaluate_with_effects(
        &self,
        m: &DMatrix<f64>,
        moments: &DMatrix<f64>,
        sensitivity: Option<(&mut DMatrix<f64>, &mut DMatrix<f64>)>,
    ) -> Score {
        let Some(parts) = Parts::new(self.prediction.as_ref(), m, moments) else {
            if let Some((by_m, by_moments)) = sensitivity {
                by_m.fill(0.0);
                by_moments.fill(0.0);
            }
            return Score::exact(f64::INFINITY);
        };
        let levels = self.levels();
        let scenarios = parts.scenarios(levels);
        let share = 0.5 / scenarios.len() as f64;
        let value = scenarios.iter().map(|square| share * libm::log(*square)).sum();
        if let Some((by_m, by_moments)) = sensitivity {
            let slopes: Vec<f64> = scenarios.iter().map(|square| share / square).collect();
            by_m.copy_from(&(&parts.spread * -slopes.iter().sum::<f64>()));
            by_moments.fill(0.0);
            let turned = &parts.inverse * &parts.pull;
            let by_effect = slopes[1..].chunks_exact(levels.len());
            for (slopes, own) in by_effect.zip(parts.effects()) {
                let slope: f64 = slopes.iter().zip(levels).map(|(slope, level)| slope * level * level).sum();
                for e in own.clone() {
                    let (t, p) = (turned.column(e), parts.bias.column(e));
                    by_m.ger(-slope, &t, &p, 1.0);
                    by_m.ger(-slope, &p, &t, 1.0);
                    by_moments.column_mut(e).axpy(2.0 * slope, &t, 0.0);
                }
            }
            let symmetric = (&*by_m + by_m.transpose()) * 0.5;
            by_m.copy_from(&symmetric);
        }
        Score::exact(value)
    }

    fn is_weighted(&self) -> bool {
        true
    }

    fn asks_for_prediction(&self) -> bool {
        true
    }

    fn for_prediction(&self, prediction: Prediction) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { prediction: Some(prediction), ..*self }))
    }

    fn expects_effects(&self) -> bool {
        true
    }

    fn predicts_measured_torque(&self) -> bool {
        self.measured
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use nalgebra::DVector;
    use rand::RngExt;

    struct Case {
        w: DMatrix<f64>,
        evaluated: DMatrix<f64>,
        /// Discrepancies on both, three of two effects.
        d: DMatrix<f64>,
        d_evaluated: DMatrix<f64>,
    }

    fn case() -> Case {
        let mut rng = Seed::new(62).stream("case", 0);
        let mut draw =
            |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0));
        Case { w: draw(30, 5), evaluated: draw(20, 5), d: draw(30, 3), d_evaluated: draw(20, 3) }
    }

    impl Case {
        fn criterion(&self, carries: bool) -> ModelError {
            let per_row = 1.0 / 20.0;
            let carried = carries.then(|| Carried {
                moments: self.evaluated.tr_mul(&self.d_evaluated) * per_row,
                squares: DVector::from_fn(3, |e, _| self.d_evaluated.column(e).norm_squared() * per_row),
            });
            let gram = self.evaluated.tr_mul(&self.evaluated) * per_row;
            let of = if carries { ModelError::of_measured_torque() } else { ModelError::default() };
            let prediction = Prediction { gram, rows: 30.0, effects: vec![0..1, 1..3], carried };
            ModelError { prediction: Some(prediction), ..of }
        }

        fn moments(&self) -> (DMatrix<f64>, DMatrix<f64>) {
            (self.w.tr_mul(&self.w) / 30.0, self.w.tr_mul(&self.d) / 30.0)
        }
    }

    #[test]
    fn identity_errors_are_those_of_least_squares_fits_to_the_disturbed_torque() {
        let case = case();
        for carries in [false, true] {
            let (m, c) = case.moments();
            let found = case.criterion(carries).errors(&m, &c);
            // By singular values of W: the fit to each discrepancy, and the covariance for unit noise.
            let pseudo = case.w.clone().pseudo_inverse(1e-12).unwrap();
            let variance = (&case.evaluated * &pseudo).norm_squared() / 20.0;
            let square = |e: usize| {
                let mut error = &case.evaluated * (&pseudo * case.d.column(e));
                if carries {
                    error -= case.d_evaluated.column(e);
                }
                error.norm_squared() / 20.0
            };
            let sizes: &[f64] = if carries { &[0.01, 0.1, 1.0] } else { &[1.0] };
            let mut expected = vec![variance];
            for whole in [square(0), square(1) + square(2)] {
                expected.extend(sizes.iter().map(|size| variance + size * size * whole));
            }
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected.sqrt()).abs() < 1e-11, "{found} {}", expected.sqrt());
            }
            let value = case.criterion(carries).evaluate_with_effects(&m, &c, None).value;
            let geometric = expected.iter().map(|square| 0.5 * square.ln()).sum::<f64>() / expected.len() as f64;
            assert!((value - geometric).abs() < 1e-11);
        }
    }

    #[test]
    fn identity_both_sensitivities_match_central_differences() {
        let case = case();
        let mut rng = Seed::new(63).stream("direction", 0);
        for carries in [false, true] {
            let criterion = case.criterion(carries);
            let (m, c) = case.moments();
            let (mut s, mut s_c) = (DMatrix::zeros(5, 5), DMatrix::zeros(5, 3));
            criterion.evaluate_with_effects(&m, &c, Some((&mut s, &mut s_c)));
            assert!((&s - s.transpose()).norm() < 1e-14 * (1.0 + s.norm()));
            let along = DMatrix::from_fn(5, 5, |_, _| rng.random_range(-0.1..0.1));
            let along = &along + along.transpose();
            let along_c = DMatrix::from_fn(5, 3, |_, _| rng.random_range(-0.1..0.1));
            let at = |h: f64| criterion.evaluate_with_effects(&(&m + &along * h), &(&c + &along_c * h), None).value;
            let h = 1e-3;
            let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            let expected = s.component_mul(&along).sum() + s_c.component_mul(&along_c).sum();
            assert!((difference - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{difference} {expected}");
        }
    }

    #[test]
    fn analytic_without_effects_it_is_half_of_i_optimality_per_row() {
        let case = case();
        let (m, _) = case.moments();
        let prediction = Prediction { effects: Vec::new(), ..case.criterion(false).prediction.unwrap() };
        let i_optimal = super::super::IOptimal::new(prediction.gram.clone()).evaluate(&m, None).value;
        let value = ModelError::new(prediction).evaluate(&m, None).value;
        assert!((value - 0.5 * (i_optimal - libm::log(30.0))).abs() < 1e-12);
    }
}
