//! How long a search may take, in evaluations and steps, and how finely its result is looked at.

/// Default budget of one design: criterion evaluations, of which a gradient is one more.
pub const DEFAULT_EVALUATIONS: usize = 400;

/// Samples of one period in a certificate, by default.
const CERTIFICATE_SAMPLES: usize = 5000;

/// How much work one design is. A [`DesignProblem`](super::DesignProblem) takes no budget without evaluations or without
/// samples in the certificate.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::DesignBudget;
/// let budget = DesignBudget { evaluations: 60, iterations: 20, ..DesignBudget::default() };
/// assert_eq!(budget.certificate_samples, 5000);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DesignBudget {
    /// Evaluations of the criterion; a gradient counts as one more.
    pub evaluations: usize,
    /// Steps of the optimiser; with none the first guess is what is found.
    pub iterations: usize,
    /// Samples of one period in the certificate.
    pub certificate_samples: usize,
}

impl Default for DesignBudget {
    /// [`DEFAULT_EVALUATIONS`], as many steps as they allow, and 5000 samples in the certificate.
    fn default() -> Self {
        Self { evaluations: DEFAULT_EVALUATIONS, iterations: usize::MAX, certificate_samples: CERTIFICATE_SAMPLES }
    }
}
