//! Why a quadratic program has no solution.

/// Why a quadratic program has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum QuadraticError {
    /// The matrix H is not positive definite.
    #[error("the inverse Hessian is not positive definite")]
    NotConvex,
    /// No step satisfies all rows.
    #[error("no step satisfies all rows; one is violated by {excess:.3e} at every step")]
    Infeasible { excess: f64 },
    /// More iterations than allowed, which means cycling by rounding.
    #[error("more than {limit} rows added and dropped")]
    Iterations { limit: usize },
}
