//! Expressions of the motion, each held once, in the order in which they can be computed.

use std::collections::BTreeMap;

/// Place of an expression in its list.
pub(super) type Id = usize;

/// One operation; its operands stand before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Expression {
    /// A number, by its bits.
    Number(u64),
    /// Of a joint: q, q̇, q̈, τ.
    Position(usize),
    Velocity(usize),
    Acceleration(usize),
    Effort(usize),
    Sine(usize),
    Cosine(usize),
    /// The smooth sign of an expression with a velocity scale, by its bits.
    SmoothSign(Id, u64),
    Negative(Id),
    Magnitude(Id),
    Reciprocal(Id),
    Sum(Id, Id),
    Difference(Id, Id),
    Product(Id, Id),
}

impl Expression {
    /// The coordinate that it reads: its name and its joint.
    pub(super) const fn coordinate(self) -> Option<(&'static str, usize)> {
        match self {
            Self::Position(i) | Self::Sine(i) | Self::Cosine(i) => Some(("q", i)),
            Self::Velocity(i) => Some(("qd", i)),
            Self::Acceleration(i) => Some(("qdd", i)),
            Self::Effort(i) => Some(("tau", i)),
            _ => None,
        }
    }

    /// The expressions that it is made from.
    pub(super) fn operands(self) -> impl Iterator<Item = Id> {
        let two = match self {
            Self::SmoothSign(a, _) | Self::Negative(a) | Self::Magnitude(a) | Self::Reciprocal(a) => [Some(a), None],
            Self::Sum(a, b) | Self::Difference(a, b) | Self::Product(a, b) => [Some(a), Some(b)],
            Self::Number(_)
            | Self::Position(_)
            | Self::Velocity(_)
            | Self::Acceleration(_)
            | Self::Effort(_)
            | Self::Sine(_)
            | Self::Cosine(_) => [None, None],
        };
        two.into_iter().flatten()
    }
}

/// Expressions; equal ones are one.
#[derive(Clone, Debug, Default)]
pub(super) struct Expressions {
    pub(super) list: Vec<Expression>,
    places: BTreeMap<Expression, Id>,
}

impl Expressions {
    pub(super) fn intern(&mut self, expression: Expression) -> Id {
        *self.places.entry(expression).or_insert_with(|| {
            self.list.push(expression);
            self.list.len() - 1
        })
    }

    pub(super) fn number(&mut self, x: f64) -> Id {
        // No minus before a zero.
        self.intern(Expression::Number((x + 0.0).to_bits()))
    }

    fn known(&self, a: Id) -> Option<f64> {
        if let Expression::Number(bits) = self.list[a] { Some(f64::from_bits(bits)) } else { None }
    }

    fn is(&self, a: Id, x: f64) -> bool {
        self.known(a).is_some_and(|known| known.to_bits() == x.to_bits())
    }

    pub(super) fn negative(&mut self, a: Id) -> Id {
        match (self.known(a), self.list[a]) {
            (Some(x), _) => self.number(-x),
            (None, Expression::Negative(b)) => b,
            (None, Expression::Difference(b, c)) => self.difference(c, b),
            _ => self.intern(Expression::Negative(a)),
        }
    }

    pub(super) fn sum(&mut self, a: Id, b: Id) -> Id {
        match (self.known(a), self.known(b)) {
            (Some(x), Some(y)) => self.number(x + y),
            _ if self.is(a, 0.0) => b,
            _ if self.is(b, 0.0) => a,
            _ => match (self.list[a], self.list[b]) {
                (_, Expression::Negative(b)) => self.difference(a, b),
                (Expression::Negative(a), _) => self.difference(b, a),
                _ => self.intern(Expression::Sum(a.min(b), a.max(b))),
            },
        }
    }

    pub(super) fn difference(&mut self, a: Id, b: Id) -> Id {
        match (self.known(a), self.known(b)) {
            (Some(x), Some(y)) => self.number(x - y),
            _ if a == b => self.number(0.0),
            _ if self.is(b, 0.0) => a,
            _ if self.is(a, 0.0) => self.negative(b),
            _ => match self.list[b] {
                Expression::Negative(b) => self.sum(a, b),
                _ => self.intern(Expression::Difference(a, b)),
            },
        }
    }

    pub(super) fn product(&mut self, a: Id, b: Id) -> Id {
        match (self.known(a), self.known(b)) {
            (Some(x), Some(y)) => self.number(x * y),
            _ if self.is(a, 0.0) || self.is(b, 0.0) => self.number(0.0),
            _ if self.is(a, 1.0) => b,
            _ if self.is(b, 1.0) => a,
            _ if self.is(a, -1.0) => self.negative(b),
            _ if self.is(b, -1.0) => self.negative(a),
            _ => match (self.list[a], self.list[b]) {
                (Expression::Negative(a), _) => {
                    let product = self.product(a, b);
                    self.negative(product)
                }
                (_, Expression::Negative(b)) => {
                    let product = self.product(a, b);
                    self.negative(product)
                }
                _ => self.intern(Expression::Product(a.min(b), a.max(b))),
            },
        }
    }

    pub(super) fn smooth_sign(&mut self, a: Id, scale: f64) -> Id {
        if self.is(a, 0.0) { a } else { self.intern(Expression::SmoothSign(a, scale.to_bits())) }
    }

    pub(super) fn magnitude(&mut self, a: Id) -> Id {
        match (self.known(a), self.list[a]) {
            (Some(x), _) => self.number(x.abs()),
            (None, Expression::Negative(b)) => self.magnitude(b),
            _ => self.intern(Expression::Magnitude(a)),
        }
    }

    pub(super) fn reciprocal(&mut self, a: Id) -> Id {
        match self.known(a) {
            Some(x) if x != 0.0 => self.number(1.0 / x),
            _ => self.intern(Expression::Reciprocal(a)),
        }
    }

    /// Whether each expression is needed for some of these.
    pub(super) fn needed_for(&self, outputs: impl Iterator<Item = Id>) -> Vec<bool> {
        let mut needed = vec![false; self.list.len()];
        for output in outputs {
            needed[output] = true;
        }
        for id in (0..self.list.len()).rev() {
            if needed[id] {
                for operand in self.list[id].operands() {
                    needed[operand] = true;
                }
            }
        }
        needed
    }
}
