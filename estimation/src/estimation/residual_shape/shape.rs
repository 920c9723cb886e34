//! Shapes that a residual may have, and what each would be a sign of.
//!
//! Most are torque terms that the model may lack: their law is the term's own.

use crate::model::JointKind;
use crate::model::term::{
    COULOMB, Dimension, LOAD_FRICTION, POSITION_COSINE, POSITION_SINE, QUADRATIC_VISCOUS, SPRING, STRIBECK, Scale,
    Term, TermInput, VISCOUS,
};

/// What a residual is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// Time since the beginning.
    Time,
    /// Speed of the joint.
    Speed,
    /// What its links take, by the estimate.
    Load,
    /// Position of the joint.
    Position,
}

crate::input::named! { Against { Time: "time", Speed: "speed", Load: "load", Position: "position" } }

/// Stribeck velocity, as a part of the RMS of the speed, of the friction near rest that is looked for.
const NEAR_REST: f64 = 0.3;

/// A joint at one equation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// From −½ at the beginning to ½ at the end.
    pub(super) time: f64,
    pub(super) velocity: f64,
    /// RMS of the velocity over all equations.
    pub(super) speed_rms: f64,
    pub(super) load: f64,
    pub(super) position: f64,
}

/// What a shape is in proportion to.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// The law of a term, with the plain sign in place of a smooth one.
    Term(Term),
    /// The time.
    Time,
    /// The load.
    Load,
}

/// What belongs to one shape.
struct Entry {
    against: Against,
    law: Law,
    /// How the residual goes, and what would show so: where the coefficient is negative, and where it is positive.
    words: [[&'static str; 2]; 2],
}

macro_rules! shapes {
    ($($(#[$doc:meta])* $shape:ident: $against:ident, $law:expr, $more:literal => $more_of:literal, $less:literal => $less_of:literal;)*) => {
        /// What a term that the model lacks would add to the torque.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum ResidualShape {
            $($(#[$doc])* $shape,)*
        }

        impl ResidualShape {
            /// Every one.
            pub const ALL: &'static [Self] = &[$(Self::$shape,)*];

            const fn entry(self) -> Entry {
                match self {
                    $(Self::$shape => Entry {
                        against: Against::$against,
                        law: $law,
                        words: [[$less, $less_of], [$more, $more_of]],
                    },)*
                }
            }
        }
    };
}

shapes! {
    /// t/T: a change over the whole record.
    Drift: Time, Law::Time,
        "rises over the record" => "a sensor that drifts or a gear that warms up",
        "falls over the record" => "a sensor that drifts or a gear that warms up";
    /// sgn q̇.
    Coulomb: Speed, Law::Term(COULOMB),
        "steps up where the speed changes its sign" => "Coulomb friction that is not in the model",
        "steps down where the speed changes its sign" => "too much friction in the model";
    /// q̇.
    Viscous: Speed, Law::Term(VISCOUS),
        "grows with speed" => "viscous friction that is not in the model",
        "falls with speed" => "too much friction in the model";
    /// q̇ |q̇|.
    Quadratic: Speed, Law::Term(QUADRATIC_VISCOUS),
        "grows with the square of speed" => "quadratic friction that is not in the model",
        "falls with the square of speed" => "friction that flattens out at speed";
    /// sgn q̇ exp(−(q̇/v)²), v 0.3 of the RMS.
    NearRest: Speed, Law::Term(STRIBECK),
        "is along the motion near rest" => "Stribeck friction that is not in the model",
        "is against the motion near rest" => "friction that sets in softly from rest";
    /// τ_l.
    Gain: Load, Law::Load,
        "grows with load" => "a wrong torque constant or gear ratio of this joint",
        "falls with load" => "a wrong torque constant or gear ratio of this joint";
    /// |τ_l| sgn q̇.
    LoadFriction: Load, Law::Term(LOAD_FRICTION),
        "grows with load along the motion" => "load-dependent friction that is not in the model",
        "grows with load against the motion" => "too much load-dependent friction in the model";
    /// q.
    Spring: Position, Law::Term(SPRING),
        "grows with position" => "a spring or a cable that is not in the model",
        "falls with position" => "a spring that pushes away from zero, a gravity compensator say,";
    /// cos q sgn q̇.
    CosineFriction: Position, Law::Term(POSITION_COSINE),
        "along the motion changes with position" => "friction that depends on position",
        "along the motion changes with position" => "friction that depends on position";
    /// sin q sgn q̇.
    SineFriction: Position, Law::Term(POSITION_SINE),
        "along the motion changes with position" => "friction that depends on position",
        "along the motion changes with position" => "friction that depends on position";
}

impl ResidualShape {
    /// The quantity against which the residual shows it.
    pub const fn against(self) -> Against {
        self.entry().against
    }

    /// How the residual goes, and what would show so.
    pub(super) fn words(self, positive: bool) -> [&'static str; 2] {
        self.entry().words[usize::from(positive)]
    }

    /// The shape at one equation.
    pub(super) fn value(self, point: &Point) -> f64 {
        let near_rest = (NEAR_REST * point.speed_rms).max(f64::MIN_POSITIVE);
        let shape = [0.0, if self == Self::NearRest { near_rest } else { 1.0 }].map(Scale::new);
        let Point { time, velocity: qd, load, position: q, .. } = *point;
        match self.entry().law {
            Law::Time => time,
            Law::Load => load,
            Law::Term(term) => term.torque(&TermInput { q, qd, qdd: 0.0, load, warmth: 0.0, shape }),
        }
    }

    /// Unit of its coefficient.
    pub(super) fn unit(self, kind: JointKind) -> String {
        let (effort, coordinate) = match kind {
            JointKind::Revolute => ("N·m", "rad"),
            JointKind::Prismatic => ("N", "m"),
        };
        let dimension = match self.entry().law {
            Law::Time => COULOMB.entry().dimension,
            Law::Load => LOAD_FRICTION.entry().dimension,
            Law::Term(term) => term.entry().dimension,
        };
        match dimension {
            Dimension { effort: 1, .. } => format!("{effort} per {effort}"),
            Dimension { coordinate: 1, per_time: 1, .. } => format!("{effort} per {coordinate}/s"),
            Dimension { coordinate: 2, per_time: 2, .. } => format!("{effort} per ({coordinate}/s)²"),
            Dimension { coordinate: 1, .. } => format!("{effort} per {coordinate}"),
            _ => effort.to_owned(),
        }
    }
}
