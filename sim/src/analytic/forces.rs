//! The forces of the torque terms on joints and coupled motors, in lanes, and how stiff they are.

use armid::model::term::{Shapes, Term, TermInput};
use armid::model::{Columns, Robot, StandardParameters};

use super::jet::Jet;
use super::law_numbers::{Lanes, Rates};
use armid::lanes::Lane;

/// One term of N coordinates, of the joints or of the motors.
#[derive(Clone, Debug)]
struct Bank<const N: usize> {
    term: Term,
    values: [f64; N],
    shapes: [Shapes; N],
    /// 1 / v_s of the velocity in which the law turns over; 0 where there is none.
    per_speed: [f64; N],
}

impl<const N: usize> Bank<N> {
    fn new(robot: &Robot, parameters: &StandardParameters, term: Term) -> Self {
        let drive = |i: usize| &robot.joints()[i].drive;
        let values = std::array::from_fn(|i| if term.is_at(robot, i) { parameters.drives[i][term] } else { 0.0 });
        let turning = term.entry().shapes.iter().position(|shape| shape.smooths);
        Self {
            term,
            values,
            shapes: std::array::from_fn(|i| drive(i).shapes_of(term)),
            per_speed: std::array::from_fn(|i| match turning {
                Some(shape) if values[i] != 0.0 => drive(i).shapes_of(term)[shape].reciprocal,
                _ => 0.0,
            }),
        }
    }

    #[inline(always)]
    fn add_torques<V: Lane>(&self, q: &[V; N], v: &[V; N], out: &mut [V; N]) {
        let zero = Lanes(v[0].splat(0.0));
        let g = self.term.torques_of_runs::<Lanes<V>, N>(
            #[inline(always)]
            |i| TermInput {
                q: Lanes(q[i]),
                qd: Lanes(v[i]),
                qdd: zero,
                load: zero,
                warmth: zero,
                shape: self.shapes[i],
            },
        );
        for i in 0..N {
            out[i] = out[i] + v[i].splat(self.values[i]) * g[i].0;
        }
    }

    /// 1 where a speed may come within `reach` of its `v_s` while each changes by `change` at most; else `other`.
    #[inline(always)]
    fn turns<V: Lane>(&self, v: &[V; N], change: &[V; N], reach: f64, other: V) -> V {
        let mut flag = other;
        for i in 0..N {
            if self.per_speed[i] != 0.0 {
                let nearest = (v[i].magnitude() - change[i]) * v[i].splat(self.per_speed[i]);
                flag = flag.splat(reach).less(nearest, flag, flag.splat(1.0));
            }
        }
        flag
    }

    /// Adds the largest slope of each torque over these speeds, N·m·s/rad: at the one nearest to standstill, away from
    /// which friction flattens. A slope below zero brakes nothing.
    #[inline(always)]
    fn add_slopes<V: Lane>(&self, q: &[V; N], v: &[V; N], change: &[V; N], out: &mut [V; N]) {
        let zero = v[0].splat(0.0);
        let none = Rates::fixed(zero);
        let g = self.term.torques_of_runs::<Rates<V>, N>(
            #[inline(always)]
            |i| {
                let nearest = v[i].magnitude() - change[i];
                TermInput {
                    q: Rates::fixed(q[i]),
                    qd: Rates::velocity(zero.less(nearest, nearest, zero)),
                    qdd: none,
                    load: none,
                    warmth: none,
                    shape: self.shapes[i],
                }
            },
        );
        for i in 0..N {
            let slope = zero.splat(self.values[i]) * g[i].slope;
            out[i] = out[i] + zero.less(slope, slope, zero);
        }
    }
}

/// The forces of the terms of a robot with N joints.
#[derive(Clone, Debug)]
pub(crate) struct Forces<const N: usize> {
    joints: Vec<Bank<N>>,
    motors: Option<Box<Motors<N>>>,
}

/// Forces on coupled motors: `τ = Cᵀ f(C q, C q̇)`.
#[derive(Clone, Debug)]
struct Motors<const N: usize> {
    banks: Vec<Bank<N>>,
    coupling: [[f64; N]; N],
}

impl<const N: usize> Forces<N> {
    pub(crate) fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let columns = Columns::default().with_terms_of(parameters);
        let banks = |at_motors: bool| -> Vec<Bank<N>> {
            let terms = columns.terms().filter(|term| !term.is_inertia() && term.is_motors() == at_motors);
            let all = terms.map(|term| Bank::new(robot, parameters, term));
            all.filter(|bank| bank.values.iter().any(|&value| value != 0.0)).collect()
        };
        let motors = robot.coupling().map(|c| {
            let coupling = std::array::from_fn(|i| std::array::from_fn(|j| c[(i, j)]));
            Box::new(Motors { banks: banks(true), coupling })
        });
        let mut joints = banks(false);
        if motors.is_none() {
            // A motor that is not coupled is its joint.
            joints.extend(banks(true));
        }
        Self { joints, motors }
    }

    /// Torque that the terms take, N·m.
    #[inline(always)]
    pub(crate) fn torque<V: Lane>(&self, q: &[V; N], v: &[V; N]) -> [V; N] {
        let zero = v[0].splat(0.0);
        let mut out = [zero; N];
        for bank in &self.joints {
            bank.add_torques(q, v, &mut out);
        }
        if let Some(motors) = &self.motors {
            let (positions, speeds) = (motors.along(q), motors.along(v));
            let mut torques = [zero; N];
            for bank in &motors.banks {
                bank.add_torques(&positions, &speeds, &mut torques);
            }
            for j in 0..N {
                for i in 0..N {
                    out[j] = out[j] + zero.splat(motors.coupling[i][j]) * torques[i];
                }
            }
        }
        out
    }

    /// Torque that the terms take, with its derivatives by the coordinates and velocities, K = 2 N. A term takes what its own
    /// coordinate and velocity say, so that a law is evaluated with two derivatives.
    pub(crate) fn torque_and_slopes<const K: usize>(&self, q: &[f64; N], v: &[f64; N]) -> [Jet<K>; N] {
        let mut out = [Jet::fixed(0.0); N];
        for (i, own) in slopes_of(&self.joints, q, v).into_iter().enumerate() {
            (out[i].value, out[i].by[i], out[i].by[N + i]) = (own.value, own.by[0], own.by[1]);
        }
        if let Some(motors) = &self.motors {
            let c = &motors.coupling;
            for (i, own) in slopes_of(&motors.banks, &motors.along(q), &motors.along(v)).into_iter().enumerate() {
                for j in 0..N {
                    out[j].value += c[i][j] * own.value;
                    for k in 0..N {
                        out[j].by[k] += c[i][j] * own.by[0] * c[i][k];
                        out[j].by[N + k] += c[i][j] * own.by[1] * c[i][k];
                    }
                }
            }
        }
        out
    }

    /// 1 where a coordinate with friction that turns over may come within `reach` of its velocity scale while each joint's
    /// speed `v` changes by `change` at most, 0 where none can.
    #[inline(always)]
    pub(crate) fn turns<V: Lane>(&self, v: &[V; N], change: &[V; N], reach: f64) -> V {
        let mut flag = v[0].splat(0.0);
        for bank in &self.joints {
            flag = bank.turns(v, change, reach, flag);
        }
        if let Some(motors) = &self.motors {
            let (speeds, swings) = (motors.along(v), motors.swing(change));
            for bank in &motors.banks {
                flag = bank.turns(&speeds, &swings, reach, flag);
            }
        }
        flag
    }

    /// Bound on the rate at which friction makes velocities decay while each joint's speed `v` changes by `change` at most, 1/s.
    ///
    /// Of joints `λ ≤ (Σ λᵢ²)½ = (Σ (H⁻¹)ᵢⱼ² Dᵢ Dⱼ)½`, all eigenvalues of `H⁻¹ D` being positive, `D` the slopes. Of coupled
    /// motors `C H⁻¹ Cᵀ` stands for `H⁻¹`, and their bound is added.
    #[inline(always)]
    pub(crate) fn decay<V: Lane>(&self, q: &[V; N], v: &[V; N], change: &[V; N], inverse: &[[V; N]; N]) -> V {
        let zero = v[0].splat(0.0);
        let mut slopes = [zero; N];
        for bank in &self.joints {
            bank.add_slopes(q, v, change, &mut slopes);
        }
        let mut rate = largest(inverse, &slopes);
        if let Some(motors) = &self.motors {
            let mut slopes = [zero; N];
            for bank in &motors.banks {
                bank.add_slopes(&motors.along(q), &motors.along(v), &motors.swing(change), &mut slopes);
            }
            let mut mobility = *inverse;
            for row in &mut mobility {
                *row = motors.along(row);
            }
            rate = rate + largest(&motors.congruent(&mobility), &slopes);
        }
        rate
    }
}

/// Torques of banks with their derivatives by the own coordinate and velocity; compiled once.
#[inline(never)]
fn slopes_of<const N: usize>(banks: &[Bank<N>], q: &[f64; N], v: &[f64; N]) -> [Jet<2>; N] {
    let mut out = [Jet::fixed(0.0); N];
    let (q, v) = (q.map(|q| Jet::variable(q, 0)), v.map(|v| Jet::variable(v, 1)));
    for bank in banks {
        bank.add_torques(&q, &v, &mut out);
    }
    out
}

/// `(Σ Aᵢⱼ² dᵢ dⱼ)½` of a symmetric matrix: at least the largest eigenvalue of `A diag(d)`, A positive definite and d not negative.
#[inline(always)]
fn largest<const N: usize, V: Lane>(a: &[[V; N]; N], d: &[V; N]) -> V {
    let mut sum = d[0].splat(0.0);
    for i in 0..N {
        sum = sum + (a[i][i] * d[i]) * (a[i][i] * d[i]);
        for j in 0..i {
            let product = a[i][j] * a[i][j] * d[i] * d[j];
            sum = sum + (product + product);
        }
    }
    V::each([sum], |[sum]| sum.sqrt())
}

impl<const N: usize> Motors<N> {
    /// `C x`.
    #[inline(always)]
    fn along<V: Lane>(&self, x: &[V; N]) -> [V; N] {
        let zero = x[0].splat(0.0);
        let mut out = [zero; N];
        for i in 0..N {
            for j in 0..N {
                out[i] = out[i] + zero.splat(self.coupling[i][j]) * x[j];
            }
        }
        out
    }

    /// `C X`, its columns as rows.
    #[inline(always)]
    fn congruent<V: Lane>(&self, x: &[[V; N]; N]) -> [[V; N]; N] {
        let mut out = *x;
        for j in 0..N {
            let mut column = x[0];
            for k in 0..N {
                column[k] = x[k][j];
            }
            out[j] = self.along(&column);
        }
        out
    }

    /// By how much each motor's speed may change while each joint's changes by `change` at most.
    #[inline(always)]
    fn swing<V: Lane>(&self, change: &[V; N]) -> [V; N] {
        let zero = change[0].splat(0.0);
        let mut out = [zero; N];
        for i in 0..N {
            for j in 0..N {
                out[i] = out[i] + zero.splat(self.coupling[i][j].abs()) * change[j];
            }
        }
        out
    }
}
