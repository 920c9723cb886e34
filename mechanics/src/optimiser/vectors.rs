//! Sums over slices in a fixed order, so that their last bit depends on nothing but the numbers.

/// Scalar product `Σ x y` in a fixed order.
#[inline(always)]
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    sum(x, y, |x, y| x * y)
}

/// `Σ y x²` in a fixed order.
pub fn square(x: &[f64], y: &[f64]) -> f64 {
    sum(x, y, |x, y| x * x * y)
}

/// Four running sums, then the rest.
#[inline(always)]
fn sum(x: &[f64], y: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let (xs, ys) = (x.chunks_exact(4), y.chunks_exact(4));
    let rest: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(a, b)| term(*a, *b)).sum();
    let mut sum = [0.0; 4];
    for (a, b) in xs.zip(ys) {
        for i in 0..4 {
            sum[i] += term(a[i], b[i]);
        }
    }
    (sum[0] + sum[2]) + (sum[1] + sum[3]) + rest
}

/// `y += factor · x`.
#[inline(always)]
pub(super) fn axpy(factor: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}
