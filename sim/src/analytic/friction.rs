//! Friction and offset of joints and coupled motors, and how stiff it is.

use armid::model::{Robot, StandardParameters};

use super::elementary::tanh;
use super::forward::Factor;
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

    /// 1 where the speed may come within `reach` of `v_s` if it is `v` and changes by `change` at most; else `other`.
    #[inline(always)]
    fn turns<V: Lane>(&self, v: V, change: V, reach: f64, other: V) -> V {
        if self.per_speed == 0.0 {
            return other;
        }
        let nearest = (v.magnitude() - change) * v.splat(self.per_speed);
        v.splat(reach).less(nearest, other, v.splat(1.0))
    }

    /// Largest slope of the torque over these speeds, N·m·s/rad.
    #[inline(always)]
    fn slope<V: Lane>(&self, v: V, change: V) -> V {
        let zero = v.splat(0.0);
        let nearest = v.magnitude() - change;
        let t = tanh(zero.less(nearest, nearest, zero) * v.splat(self.per_speed));
        v.splat(self.viscous) + v.splat(self.coulomb * self.per_speed) * (v.splat(1.0) - t * t)
    }
}

/// Torques of N coordinates that move with the speeds `v`.
#[inline(always)]
fn torques<const N: usize, V: Lane>(rubs: &[Rub; N], v: &[V; N]) -> [V; N] {
    let mut scaled = *v;
    for i in 0..N {
        scaled[i] = v[i] * v[i].splat(rubs[i].per_speed);
    }
    let mut out = V::tangents(&scaled);
    for i in 0..N {
        out[i] = v[i].splat(rubs[i].viscous) * v[i] + v[i].splat(rubs[i].coulomb) * out[i];
    }
    out
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
            out[i] = out[i] + v[i].splat(self.offset[i]);
        }
        if let Some(motors) = &self.motors {
            let c = &motors.coupling;
            let mut speeds = [v[0].splat(0.0); N];
            for i in 0..N {
                for j in 0..N {
                    speeds[i] = speeds[i] + v[j].splat(c[i][j]) * v[j];
                }
            }
            let torques = torques(&motors.rubs, &speeds);
            for j in 0..N {
                for i in 0..N {
                    out[j] = out[j] + v[j].splat(c[i][j]) * torques[i];
                }
            }
        }
        out
    }

    /// 1 where a coordinate with Coulomb friction may come within `reach` of its `v_s` while each joint's speed `v`
    /// changes by `change` at most, 0 where none can.
    #[inline(always)]
    pub(crate) fn turns<V: Lane>(&self, v: &[V; N], change: &[V; N], reach: f64) -> V {
        let mut flag = v[0].splat(0.0);
        for i in 0..N {
            flag = self.joints[i].turns(v[i], change[i], reach, flag);
        }
        if let Some(motors) = &self.motors {
            for i in 0..N {
                let (speed, swing) = motors.speed(i, v, change);
                flag = motors.rubs[i].turns(speed, swing, reach, flag);
            }
        }
        flag
    }

    /// Bound on the rate at which friction makes velocities decay while each joint's speed `v` changes by `change` at
    /// most, 1/s: `λ ≤ tr(M⁻¹ D) = Σ D_k d_kᵀ M⁻¹ d_k`, `D` the slopes, `d` joint axes and rows of the coupling.
    #[inline(always)]
    pub(crate) fn decay<V: Lane>(&self, v: &[V; N], change: &[V; N], factor: &Factor<N, V>) -> V {
        let zero = v[0].splat(0.0);
        let mut rate = zero;
        for i in 0..N {
            let mut axis = [zero; N];
            axis[i] = zero.splat(1.0);
            rate = rate + self.joints[i].slope(v[i], change[i]) * factor.mobility(axis);
        }
        if let Some(motors) = &self.motors {
            for i in 0..N {
                let mut row = [zero; N];
                for j in 0..N {
                    row[j] = zero.splat(motors.coupling[i][j]);
                }
                let (speed, swing) = motors.speed(i, v, change);
                rate = rate + motors.rubs[i].slope(speed, swing) * factor.mobility(row);
            }
        }
        rate
    }
}

impl<const N: usize> Motors<N> {
    /// Speed of a motor, and by how much it may change.
    #[inline(always)]
    fn speed<V: Lane>(&self, i: usize, v: &[V; N], change: &[V; N]) -> (V, V) {
        let zero = v[0].splat(0.0);
        let (mut speed, mut swing) = (zero, zero);
        for j in 0..N {
            let c = self.coupling[i][j];
            speed = speed + zero.splat(c) * v[j];
            swing = swing + zero.splat(c.abs()) * change[j];
        }
        (speed, swing)
    }
}
