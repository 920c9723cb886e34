//! How long a search may take, in evaluations and steps, and how finely its result is looked at.

use crate::excitation::error::ExcitationError;

/// Default budget of one design: criterion evaluations, of which a gradient is one more.
pub const DEFAULT_EVALUATIONS: usize = 400;

/// Samples of one period in a certificate, by default.
const CERTIFICATE_SAMPLES: usize = 5000;

/// How much work one design is.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::DesignBudget;
/// let budget = DesignBudget::new(60).unwrap().with_iterations(20);
/// assert_eq!((budget.evaluations(), budget.iterations()), (60, 20));
/// assert!(DesignBudget::new(0).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DesignBudget {
    evaluations: usize,
    iterations: usize,
    certificate_samples: usize,
}

impl DesignBudget {
    /// This many evaluations of the criterion, a gradient counting as one more; as many steps as they allow, and 5000
    /// samples of one period in the certificate.
    ///
    /// # Errors
    /// [`ExcitationError::TooFew`] of none.
    pub const fn new(evaluations: usize) -> Result<Self, ExcitationError> {
        if evaluations == 0 {
            return Err(ExcitationError::TooFew { quantity: "evaluations", found: 0, least: 1 });
        }
        Ok(Self { evaluations, iterations: usize::MAX, certificate_samples: CERTIFICATE_SAMPLES })
    }

    /// No more than this many steps of the optimiser; with none the first guess is what is found.
    #[must_use]
    pub const fn with_iterations(self, iterations: usize) -> Self {
        Self { iterations, ..self }
    }

    /// This many samples of one period in the certificate.
    ///
    /// # Errors
    /// [`ExcitationError::TooFew`] of none.
    pub const fn with_certificate_samples(self, certificate_samples: usize) -> Result<Self, ExcitationError> {
        if certificate_samples == 0 {
            return Err(ExcitationError::TooFew { quantity: "certificate samples", found: 0, least: 1 });
        }
        Ok(Self { certificate_samples, ..self })
    }

    /// Criterion evaluations allowed; a gradient counts as one more.
    pub const fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// Steps of the optimiser allowed.
    pub const fn iterations(&self) -> usize {
        self.iterations
    }

    /// Samples of one period in the certificate.
    pub const fn certificate_samples(&self) -> usize {
        self.certificate_samples
    }
}

impl Default for DesignBudget {
    /// [`DEFAULT_EVALUATIONS`].
    fn default() -> Self {
        Self { evaluations: DEFAULT_EVALUATIONS, iterations: usize::MAX, certificate_samples: CERTIFICATE_SAMPLES }
    }
}
