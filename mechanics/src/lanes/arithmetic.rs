//! The four operators of a number.

/// Gives a type `+`, `-`, `*` and the sign, each as an expression of its operands.
#[doc(hidden)]
#[macro_export]
macro_rules! arithmetic_of {
    (impl[$($generics:tt)*] $of:ty, |$a:ident, $b:ident| $sum:expr, $difference:expr, $product:expr, $negative:expr) => {
        $crate::arithmetic_of! { @binary [$($generics)*] $of, Add, add, $a, $b, $sum }
        $crate::arithmetic_of! { @binary [$($generics)*] $of, Sub, sub, $a, $b, $difference }
        $crate::arithmetic_of! { @binary [$($generics)*] $of, Mul, mul, $a, $b, $product }

        impl<$($generics)*> std::ops::Neg for $of {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let $a = self;
                $negative
            }
        }
    };
    (@binary [$($generics:tt)*] $of:ty, $trait:ident, $method:ident, $a:ident, $b:ident, $value:expr) => {
        impl<$($generics)*> std::ops::$trait for $of {
            type Output = Self;
            #[allow(clippy::suspicious_arithmetic_impl, reason = "the product rule is a sum")]
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self, other);
                $value
            }
        }
    };
}
