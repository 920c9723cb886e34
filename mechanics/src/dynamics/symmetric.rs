//! A symmetric 3 × 3 matrix by its six numbers.

use nalgebra::Vector3;

/// A symmetric matrix; turning it about a coordinate axis takes 8 products.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Symmetric3 {
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) xz: f64,
    pub(crate) yy: f64,
    pub(crate) yz: f64,
    pub(crate) zz: f64,
}

impl Symmetric3 {
    pub(crate) const ZERO: Self = Self { xx: 0.0, xy: 0.0, xz: 0.0, yy: 0.0, yz: 0.0, zz: 0.0 };

    /// `s · 1`.
    pub(crate) const fn scalar(s: f64) -> Self {
        Self { xx: s, yy: s, zz: s, ..Self::ZERO }
    }

    /// `M x`.
    #[inline]
    pub(crate) fn times(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let row = |m: [f64; 3]| m[0] * v.x + m[1] * v.y + m[2] * v.z;
        Vector3::new(
            row([self.xx, self.xy, self.xz]),
            row([self.xy, self.yy, self.yz]),
            row([self.xz, self.yz, self.zz]),
        )
    }

    #[inline]
    pub(crate) fn plus(&self, o: &Self) -> Self {
        Self {
            xx: self.xx + o.xx,
            xy: self.xy + o.xy,
            xz: self.xz + o.xz,
            yy: self.yy + o.yy,
            yz: self.yz + o.yz,
            zz: self.zz + o.zz,
        }
    }

    /// `M − x yᵀ` where the product is known to be symmetric.
    #[inline]
    pub(crate) fn minus_outer(&self, x: &Vector3<f64>, y: &Vector3<f64>) -> Self {
        Self {
            xx: self.xx - x.x * y.x,
            xy: self.xy - x.x * y.y,
            xz: self.xz - x.x * y.z,
            yy: self.yy - x.y * y.y,
            yz: self.yz - x.y * y.z,
            zz: self.zz - x.z * y.z,
        }
    }

    /// `Rz M Rzᵀ`: with `e = s (xx − yy) + 2 c xy`, `xx' = xx − s e`, `yy' = yy + s e`, `xy' = c e − xy`.
    #[inline]
    pub(crate) fn turned_about_z(&self, s: f64, c: f64) -> Self {
        let e = s * (self.xx - self.yy) + c * (self.xy + self.xy);
        let d = s * e;
        Self {
            xx: self.xx - d,
            yy: self.yy + d,
            zz: self.zz,
            xy: c * e - self.xy,
            xz: c * self.xz - s * self.yz,
            yz: s * self.xz + c * self.yz,
        }
    }

    /// `Rx M Rxᵀ`, the same in the plane of y and z.
    #[inline]
    pub(crate) fn turned_about_x(&self, s: f64, c: f64) -> Self {
        let e = s * (self.yy - self.zz) + c * (self.yz + self.yz);
        let d = s * e;
        Self {
            xx: self.xx,
            yy: self.yy - d,
            zz: self.zz + d,
            yz: c * e - self.yz,
            xy: c * self.xy - s * self.xz,
            xz: s * self.xy + c * self.xz,
        }
    }
}
