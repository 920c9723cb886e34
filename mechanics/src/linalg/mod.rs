//! Rank, condition and normal equations of stacked regressors, with stated tolerances.
//!
//! ```text
//! W = Q R        columns scaled to unit length first, so that no choice of units decides a rank
//! ```
//! A column counts as independent of others when its distance from dependence on them is more than a stated fraction
//! of its length ([`RankTolerance`], with the reasons for its default).
//!
//! Every sum here runs in an order fixed by the size of the input alone. nalgebra's product of two dynamic matrices
//! picks its kernel by the CPU and is therefore not used where the bits of a result are stored: [`product()`],
//! [`transpose_product`], [`Gram`], [`ColumnProducts`] and [`RowFactor`] take its place.
//!
//! Reference: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., 2013, ch. 5.

mod block_whitening;
pub(crate) mod column_products;
mod condition;
mod definite;
mod dot;
mod gram;
mod least_squares;
mod left_to_right;
pub mod product;
mod reflection;
mod rank;
mod row_factor;
mod symmetric_eigen;
mod tolerance;
mod triangular;
mod upper_root;

pub use block_whitening::BlockWhitening;
pub use column_products::ColumnProducts;
pub use condition::{condition, condition_scaled, normalised_columns, singular_values};
pub use definite::definite_inverse;
pub use dot::dot;
pub use gram::Gram;
pub use least_squares::{LeastSquares, LeastSquaresError};
pub use left_to_right::LeftToRight;
pub use product::{column_squares, product, transpose_product};
pub use rank::RankRevealingQr;
pub use row_factor::RowFactor;
pub use symmetric_eigen::symmetric_eigen;
pub use tolerance::RankTolerance;
pub use triangular::{solve_upper, triangular_factor};
pub use upper_root::UpperRoot;
