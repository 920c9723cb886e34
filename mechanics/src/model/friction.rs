//! The friction law that simulation and identification share.

/// The sign of a velocity, made smooth: `tanh(v / v_s)`, and the plain sign where `v_s` is zero.
///
/// Coulomb friction is `Fc · smooth_sign(q̇)`. A plain sign makes a simulated joint chatter at standstill; the smooth
/// one is Lipschitz with constant `1 / v_s`. `v` and `v_s` in rad/s (m/s for a prismatic joint).
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::smooth_sign;
/// assert_eq!(smooth_sign(-2.0, 0.0), -1.0);
/// assert_eq!(smooth_sign(0.0, 0.0), 0.0);
/// assert!(smooth_sign(0.05, 0.01) > 0.9999);
/// ```
#[inline]
pub fn smooth_sign(v: f64, v_s: f64) -> f64 {
    if v_s > 0.0 {
        let x = v / v_s;
        // Beyond 20 tanh is 1 to the last bit.
        if x.abs() > 20.0 { x.signum() } else { libm::tanh(x) }
    } else if v == 0.0 {
        0.0
    } else {
        v.signum()
    }
}
