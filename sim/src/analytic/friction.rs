//! Friction and offset of joints and coupled motors, and how stiff it is.

use armid::model::{Robot, StandardParameters};

use super::elementary::tanh;
use super::lane::Lane;

/// Friction of one coordinate, a joint's or a motor's.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rub {
    viscous: f64,
    coulomb: f64,
    /// 1 / v_s of the smooth sign; 0 where there is no Coulomb friction.
    per_speed: f64,
}

impl Rub {
    fn new(viscous: f64, coulomb: f64, speed: f64) -> Self {
        Self { viscous, coulomb, per_speed: if coulomb == 0.0 { 0.0 } else { 1.0 / speed } }
    }

    /// Slope of the torque at the speed `v`, at most; N·m·s/rad.
    fn slope(&self, v: f64) -> f64 {
        let t = tanh(v * self.per_speed);
        self.viscous + self.coulomb * self.per_speed * (1.0 - t * t)
    }
}

/// Torques of N coordinates that move with the speeds `v`.
#[inline(always)]
fn torques<const N: usize, V: Lane>(rubs: &[Rub; N], v: &[V; N]) -> [V; N] {
    let signs: [V; N] = V::tangents(&std::array::from_fn(|i| v[i] * V::splat(rubs[i].per_speed)));
    std::array::from_fn(|i| V::splat(rubs[i].viscous) * v[i] + V::splat(rubs[i].coulomb) * signs[i])
}

/// Friction of a robot with N joints.
#[derive(Clone, Debug)]
pub(crate) struct Friction<const N: usize> {
    joints: [Rub; N],
    offset: [f64; N],
    motors: Option<Box<Motors<N>>>,
}

/// Friction of coupled motors: `τ = Cᵀ f(C q̇)`.
#[derive(Clone, Debug)]
struct Motors<const N: usize> {
    rubs: [Rub; N],
    coupling: [[f64; N]; N],
}

impl<const N: usize> Friction<N> {
    pub(crate) fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let drives = &parameters.drives;
        let speed = |i: usize| robot.joints()[i].drive.coulomb_velocity;
        let motors = robot.coupling().map(|c| {
            Box::new(Motors {
                rubs: std::array::from_fn(|i| {
                    if robot.is_coupled(i) {
                        Rub::new(drives[i].motor_viscous, drives[i].motor_coulomb, speed(i))
                    } else {
                        Rub::default()
                    }
                }),
                coupling: std::array::from_fn(|i| std::array::from_fn(|j| c[(i, j)])),
            })
        });
        Self {
            joints: std::array::from_fn(|i| Rub::new(drives[i].viscous, drives[i].coulomb, speed(i))),
            offset: std::array::from_fn(|i| drives[i].offset),
            motors,
        }
    }

    /// Torque that friction and offset take, N·m.
    #[inline(always)]
    pub(crate) fn torque<V: Lane>(&self, v: &[V; N]) -> [V; N] {
        let mut out = torques(&self.joints, v);
        for i in 0..N {
            out[i] = out[i] + V::splat(self.offset[i]);
        }
        if let Some(motors) = &self.motors {
            let c = &motors.coupling;
            let mut speeds = [V::splat(0.0); N];
            for i in 0..N {
                for j in 0..N {
                    speeds[i] = speeds[i] + V::splat(c[i][j]) * v[j];
                }
            }
            let torques = torques(&motors.rubs, &speeds);
            for j in 0..N {
                for i in 0..N {
                    out[j] = out[j] + V::splat(c[i][j]) * torques[i];
                }
            }
        }
        out
    }

    /// Whether any coordinate with Coulomb friction may come within `reach` of the scale `v_s` while each joint's
    /// speed `v` changes by `change` at most.
    pub(crate) fn may_turn(&self, v: &[f64; N], change: &[f64; N], reach: f64) -> bool {
        let near = |rub: &Rub, v: f64, change: f64| {
            let nearest = (v.abs() - change) * rub.per_speed;
            rub.per_speed > 0.0 && (nearest <= reach || nearest.is_nan())
        };
        (0..N).any(|i| near(&self.joints[i], v[i], change[i]))
            || self.motors.as_ref().is_some_and(|motors| {
                (0..N).any(|i| {
                    let (speed, swing) = motors.speed(i, v, change);
                    near(&motors.rubs[i], speed, swing)
                })
            })
    }

    /// Bound on the rate at which friction makes velocities decay while each joint's speed `v` changes by `change` at
    /// most, 1/s: `λ ≤ tr(M⁻¹ D) = Σ D_k d_kᵀ M⁻¹ d_k`, `D` the slopes, `d` joint axes and rows of the coupling.
    pub(crate) fn decay(&self, v: &[f64; N], change: &[f64; N], inverse: &[[f64; N]; N]) -> f64 {
        let closest = |v: f64, change: f64| (v.abs() - change).max(0.0);
        let mut rate = 0.0;
        for i in 0..N {
            rate += self.joints[i].slope(closest(v[i], change[i])) * inverse[i][i];
        }
        if let Some(motors) = &self.motors {
            for i in 0..N {
                let row = &motors.coupling[i];
                let (speed, swing) = motors.speed(i, v, change);
                let mut mobility = 0.0;
                for j in 0..N {
                    for k in 0..N {
                        mobility += row[j] * inverse[j][k] * row[k];
                    }
                }
                rate += motors.rubs[i].slope(closest(speed, swing)) * mobility;
            }
        }
        rate
    }
}

impl<const N: usize> Motors<N> {
    fn speed(&self, i: usize, v: &[f64; N], change: &[f64; N]) -> (f64, f64) {
        let row = &self.coupling[i];
        let speed = (0..N).map(|j| row[j] * v[j]).sum();
        let swing = (0..N).map(|j| row[j].abs() * change[j]).sum();
        (speed, swing)
    }
}
