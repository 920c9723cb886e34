//! A criterion of one's own: in the law suite, and in a design that it makes.

use std::sync::Arc;

use armid::conformance::chains::planar_2r;
use armid::conformance::criterion_laws::{self, Invariance};
use armid::excitation::criterion::{Criterion, Score};
use armid::excitation::{CriterionKind, DesignBudget, DesignLimits, DesignProblem, best_of, design};
use armid::model::Columns;
use armid::seed::Seed;
use nalgebra::{DMatrix, SymmetricEigen};

/// The trace of `M⁻²`: variances count by their square, so that the worst of them counts most (Kiefer's Φ_p with p = 2;
/// F. Pukelsheim, *Optimal Design of Experiments*, 2006, ch. 6).
///
/// ```text
/// f = ½ ln tr M⁻²      S = −M⁻³ / tr M⁻²
/// ```
#[derive(Debug)]
struct SquaredVariances;

impl Criterion for SquaredVariances {
    fn name(&self) -> &'static str {
        "squared-variances"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        let eigen = SymmetricEigen::new(m.clone());
        if eigen.eigenvalues.iter().any(|value| value.is_nan() || *value <= 0.0) {
            if let Some(s) = sensitivity {
                s.fill(0.0);
            }
            return Score::exact(f64::INFINITY);
        }
        let trace: f64 = eigen.eigenvalues.iter().map(|value| 1.0 / (value * value)).sum();
        if let Some(s) = sensitivity {
            let weights = eigen.eigenvalues.map(|value| -1.0 / (trace * value * value * value));
            let turned = &eigen.eigenvectors * DMatrix::from_diagonal(&weights) * eigen.eigenvectors.transpose();
            s.copy_from(&(0.5 * (&turned + turned.transpose())));
        }
        Score::exact(0.5 * trace.ln())
    }

    fn is_weighted(&self) -> bool {
        true
    }
}

#[test]
fn a_criterion_from_outside_obeys_the_laws() {
    criterion_laws::check(&SquaredVariances, Invariance::Order).unwrap();
}

#[test]
fn a_criterion_from_outside_makes_a_design_that_is_best_by_it() {
    let designed = |criterion: Arc<dyn Criterion>| {
        let mut problem = DesignProblem::new(planar_2r(), Columns::RIGID, criterion, DesignLimits::motion()).unwrap();
        problem
            .set_budget(DesignBudget { evaluations: 200, certificate_samples: 500, ..DesignBudget::default() })
            .unwrap();
        let designs: Vec<_> = (0..3).map(|start| design(&problem, Seed::new(3), start).unwrap()).collect();
        let best = best_of(&designs).expect("a design inside the limits").clone();
        let m = problem.information(&best.trajectory).unwrap();
        (best, m)
    };
    let (own, by_own) = designed(Arc::new(SquaredVariances));
    assert_eq!((own.criterion.as_str(), own.larger_is_better), ("squared-variances", false));
    assert!(own.value < 0.5 * own.history[0].value, "{} {}", own.value, own.history[0].value);
    // Another route to its value: the entries of the inverse. After the last evaluation the trajectory was shrunk by
    // what the optimiser's tolerance of 1e-4 of a limit had left.
    let inverse = by_own.clone().cholesky().expect("an information").inverse();
    assert!((own.value / inverse.norm() - 1.0).abs() < 1e-5, "{} {}", own.value, inverse.norm());
    let (listed, by_listed) = designed(CriterionKind::DOptimal.into());
    let of = |m: &DMatrix<f64>| SquaredVariances.evaluate(m, None).value;
    assert!(of(&by_own) < of(&by_listed), "{} {}", of(&by_own), of(&by_listed));
    // And the other way round.
    assert!(by_listed.determinant() > by_own.determinant() && listed.criterion == "d-optimal");
}
