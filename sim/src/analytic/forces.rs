//! The forces of the torque terms on joints and coupled motors, in lanes, and how stiff they are.

use armid::model::term::{Shapes, Term, TermInput};
use armid::model::{Columns, Robot, StandardParameters};

use super::jet::Jet;
use super::law_numbers::{Lanes, Rates};
use armid::lanes::Lane;

/// Where a speed changes by `v_s`, the method errs most by the bend of the friction, and needs parts that are shorter by this share.
const BEND: f64 = 0.25;

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
        self.term.torques_of_runs::<Lanes<V>, N>(
            #[inline(always)]
            |i| TermInput {
                q: Lanes(q[i]),
                qd: Lanes(v[i]),
                qdd: zero,
                load: zero,
                warmth: zero,
                shape: self.shapes[i],
            },
            #[inline(always)]
            |i, g| out[i] = out[i] + g.0.splat(self.values[i]) * g.0,
        );
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
    /// which friction flattens. A slope below zero brakes nothing. One whose speed changes by `v_s` or more counts for more by [`BEND`].
    #[inline(always)]
    fn add_slopes<V: Lane>(&self, q: &[V; N], v: &[V; N], change: &[V; N], out: &mut [V; N]) {
        let zero = v[0].splat(0.0);
        let none = Rates::fixed(zero);
        self.term.torques_of_runs::<Rates<V>, N>(
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
            #[inline(always)]
            |i, g| {
                let slope = zero.splat(self.values[i]) * g.slope;
                let one = zero.splat(1.0);
                let swing = one.smaller(change[i] * zero.splat(self.per_speed[i]));
                out[i] = out[i] + zero.less(slope, slope, zero) * (one + zero.splat(BEND) * swing);
            },
        );
    }
}

/// Torque (N·m) with its derivatives by coordinates (N·m/rad) and velocities (N·m·s/rad), a row for each joint.
pub(crate) struct Slopes<const N: usize> {
    pub(crate) torque: [f64; N],
    pub(crate) by_q: [[f64; N]; N],
    pub(crate) by_v: [[f64; N]; N],
}

/// Where a term acts: its place in what is known of both.
const JOINTS: usize = 0;
const MOTORS: usize = 1;

/// The forces of the terms of a robot with N joints. A motor that is not coupled is its joint.
#[derive(Clone, Debug)]
pub(crate) struct Forces<const N: usize> {
    /// At joints, and at coupled motors.
    banks: [Vec<Bank<N>>; 2],
    /// `τ = Cᵀ f(C q, C q̇)` of coupled motors.
    coupling: Option<Box<Coupling<N>>>,
}

/// The matrix `C` of the robot, joints to motors.
#[derive(Clone, Debug)]
struct Coupling<const N: usize>([[f64; N]; N]);

impl<const N: usize> Forces<N> {
    pub(crate) fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let columns = Columns::default().with_terms_of(parameters);
        let coupling = robot.coupling();
        let coupling =
            coupling.map(|c| Box::new(Coupling(std::array::from_fn(|i| std::array::from_fn(|j| c[(i, j)])))));
        let mut banks = [Vec::new(), Vec::new()];
        for at_motors in [false, true] {
            let place = if at_motors && coupling.is_some() { MOTORS } else { JOINTS };
            let terms = columns.terms().filter(|term| !term.is_inertia() && term.is_motors() == at_motors);
            let all = terms.map(|term| Bank::new(robot, parameters, term));
            banks[place].extend(all.filter(|bank| bank.values.iter().any(|&value| value != 0.0)));
        }
        Self { banks, coupling }
    }

    /// What is known of joints, and `of` it where motors are coupled.
    #[inline(always)]
    fn of_both<T: Copy>(&self, joints: &T, of: impl Fn(&Coupling<N>, &T) -> T) -> [T; 2] {
        let mut out = [*joints; 2];
        if let Some(coupling) = &self.coupling {
            out[MOTORS] = of(coupling, joints);
        }
        out
    }

    /// Torque that the terms take, N·m, into `out`.
    #[inline(always)]
    pub(crate) fn torque<V: Lane>(&self, q: &[V; N], v: &[V; N], out: &mut [V; N]) {
        let zero = v[0].splat(0.0);
        out.fill(zero);
        for bank in &self.banks[JOINTS] {
            bank.add_torques(q, v, out);
        }
        if let Some(coupling) = &self.coupling {
            let (positions, speeds) = (coupling.along(q), coupling.along(v));
            let mut torques = [zero; N];
            for bank in &self.banks[MOTORS] {
                bank.add_torques(&positions, &speeds, &mut torques);
            }
            for j in 0..N {
                for i in 0..N {
                    out[j] = out[j] + zero.splat(coupling.0[i][j]) * torques[i];
                }
            }
        }
    }

    /// Torque that the terms take, with its derivatives by the coordinates and velocities. A term takes what its own coordinate and
    /// velocity say, so that a law is evaluated with two derivatives.
    pub(crate) fn torque_and_slopes(&self, q: &[f64; N], v: &[f64; N]) -> Slopes<N> {
        let (q, v) = (self.of_both(q, Coupling::along), self.of_both(v, Coupling::along));
        let mut own = [[Jet::<2>::fixed(0.0); N]; 2];
        for place in [JOINTS, MOTORS] {
            for bank in &self.banks[place] {
                for i in 0..N {
                    let law = law_and_slopes(bank.term, q[place][i], v[place][i], bank.shapes[i]);
                    own[place][i] = own[place][i] + Jet::fixed(bank.values[i]) * law;
                }
            }
        }
        let mut out = Slopes { torque: [0.0; N], by_q: [[0.0; N]; N], by_v: [[0.0; N]; N] };
        for (i, own) in own[JOINTS].iter().enumerate() {
            (out.torque[i], out.by_q[i][i], out.by_v[i][i]) = (own.value, own.by[0], own.by[1]);
        }
        if let Some(coupling) = &self.coupling {
            let c = &coupling.0;
            for (i, own) in own[MOTORS].iter().enumerate() {
                for j in 0..N {
                    out.torque[j] += c[i][j] * own.value;
                    for k in 0..N {
                        out.by_q[j][k] += c[i][j] * own.by[0] * c[i][k];
                        out.by_v[j][k] += c[i][j] * own.by[1] * c[i][k];
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
        for bank in &self.banks[JOINTS] {
            flag = bank.turns(v, change, reach, flag);
        }
        if let Some(coupling) = &self.coupling {
            let (speeds, swings) = (coupling.along(v), coupling.swing(change));
            for bank in &self.banks[MOTORS] {
                flag = bank.turns(&speeds, &swings, reach, flag);
            }
        }
        flag
    }

    /// Bound on the rate at which friction makes velocities decay while each joint's speed `v` changes by `change` at most, 1/s.
    ///
    /// Of joints `λ ≤ (Σ λᵢ⁴)¼ = (Σ Tᵢⱼ² Dᵢ Dⱼ)¼` with `T = H⁻¹ D H⁻¹`, all eigenvalues of `H⁻¹ D` being positive, `D` the slopes.
    /// Of coupled motors `C H⁻¹ Cᵀ` stands for `H⁻¹`, and their bound is added.
    #[inline(always)]
    pub(crate) fn decay<V: Lane>(&self, q: &[V; N], v: &[V; N], change: &[V; N], inverse: &[[V; N]; N]) -> V {
        let mut slopes = [[v[0].splat(0.0); N]; 2];
        let (q, v) = (self.of_both(q, Coupling::along), self.of_both(v, Coupling::along));
        let change = self.of_both(change, Coupling::swing);
        for place in [JOINTS, MOTORS] {
            for bank in &self.banks[place] {
                bank.add_slopes(&q[place], &v[place], &change[place], &mut slopes[place]);
            }
        }
        let mut rate = largest(inverse, &slopes[JOINTS]);
        if let Some(coupling) = &self.coupling {
            let mut mobility = *inverse;
            for row in &mut mobility {
                *row = coupling.along(row);
            }
            rate = rate + largest(&coupling.congruent(&mobility), &slopes[MOTORS]);
        }
        rate
    }
}

/// The law of a term at one coordinate, with its derivatives by coordinate and velocity; compiled once for any number of joints.
#[inline(never)]
fn law_and_slopes(term: Term, q: f64, v: f64, shape: Shapes) -> Jet<2> {
    let none = Lanes(Jet::fixed(0.0));
    let (q, qd) = (Lanes(Jet::variable(q, 0)), Lanes(Jet::variable(v, 1)));
    let at = TermInput { q, qd, qdd: none, load: none, warmth: none, shape };
    let mut torque = none.0;
    term.torques_of_runs::<Lanes<Jet<2>>, 1>(|_| at, |_, of_law| torque = of_law.0);
    torque
}

/// `(Σ Tᵢⱼ² dᵢ dⱼ)¼` with `T = A diag(d) A`: at least the largest eigenvalue of `A diag(d)`, A positive definite and d not negative.
#[inline(always)]
fn largest<const N: usize, V: Lane>(a: &[[V; N]; N], d: &[V; N]) -> V {
    let mut sum = d[0].splat(0.0);
    for i in 0..N {
        let mut row = a[i];
        for k in 0..N {
            row[k] = a[i][k] * d[k];
        }
        for j in 0..=i {
            let mut t = row[0] * a[j][0];
            for k in 1..N {
                t = t + row[k] * a[j][k];
            }
            let square = t * t * d[i] * d[j];
            sum = sum + if j < i { square + square } else { square };
        }
    }
    V::each([sum], |[sum]| sum.sqrt().sqrt())
}

impl<const N: usize> Coupling<N> {
    /// `C x`.
    #[inline(always)]
    fn along<V: Lane>(&self, x: &[V; N]) -> [V; N] {
        let zero = x[0].splat(0.0);
        let mut out = [zero; N];
        for i in 0..N {
            for j in 0..N {
                out[i] = out[i] + zero.splat(self.0[i][j]) * x[j];
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
                out[i] = out[i] + zero.splat(self.0[i][j].abs()) * change[j];
            }
        }
        out
    }
}
