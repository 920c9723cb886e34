//! How operations are written in a language.

use std::fmt::Write;

use super::base_model::BaseModel;
use super::expression::{Expression, Id};

/// A language of source code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C99, with `math.h`.
    C,
    /// Rust, with its standard library.
    Rust,
}

crate::input::named! { Language { C: "c", Rust: "rust" } }

impl Language {
    /// How its files end.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::C => "c",
            Self::Rust => "rs",
        }
    }
}

/// The smooth sign, as `armid` has it.
const C_SMOOTH_SIGN: &str = "\nstatic double smooth_sign(double v, double scale)\n{\n    \
    return scale > 0.0 ? tanh(v / scale) : (double)((v > 0.0) - (v < 0.0));\n}\n";

/// The smooth sign function in Rust.
const RUST_SMOOTH_SIGN: &str = "\nfn smooth_sign(v: f64, scale: f64) -> f64 {\n    \
    if scale > 0.0 { (v / scale).tanh() } else if v == 0.0 { 0.0 } else { v.signum() }\n}\n";

impl BaseModel {
    /// The source: `inverse_dynamics`, `gravity` and `mass_matrix` (in C with `armid_` before their names), SI, in the order of
    /// the joints. `header` stands on top as a comment.
    pub fn source(&self, language: Language, header: &str) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        for line in header.lines() {
            let _ = match language {
                Language::C => writeln!(out, "/* {} */", line.replace("*/", "* /")),
                Language::Rust => writeln!(out, "// {line}"),
            };
        }
        if language == Language::C {
            out.push_str("#include <math.h>\n");
        }
        let outputs = self.torque.iter().chain(&self.gravity).chain(&self.mass).copied();
        let needed = self.expressions.needed_for(outputs);
        let signs = self.expressions.list.iter().zip(&needed);
        if signs.into_iter().any(|(expression, &needed)| needed && matches!(expression, Expression::SmoothSign(..))) {
            out.push_str(match language {
                Language::C => C_SMOOTH_SIGN,
                Language::Rust => RUST_SMOOTH_SIGN,
            });
        }
        let meaning = "Joint torques, N m (N), of a motion: q, qd, qdd in rad (m) and s.";
        self.function(&mut out, language, "inverse_dynamics", meaning, &["q", "qd", "qdd"], &self.torque);
        self.function(&mut out, language, "gravity", &self.meaning_of_gravity(), &["q"], &self.gravity);
        let meaning = "Mass matrix by rows, rotors among it.";
        self.function(&mut out, language, "mass_matrix", meaning, &["q"], &self.mass);
        out
    }

    fn meaning_of_gravity(&self) -> String {
        let meaning = "Joint torques of the links' weight at rest";
        let joints: Vec<String> = self.offset_in_weight.iter().map(|joint| (joint + 1).to_string()).collect();
        match joints.as_slice() {
            [] => format!("{meaning}."),
            joints => {
                format!(
                    "{meaning}, and the constant offset of joint {}: no motion tells them apart.",
                    joints.join(", ")
                )
            }
        }
    }

    fn function(
        &self,
        out: &mut String,
        language: Language,
        name: &str,
        meaning: &str,
        inputs: &[&str],
        outputs: &[Id],
    ) {
        let (n, size) = (self.dof, outputs.len());
        let number = match language {
            Language::C => {
                let typed: Vec<String> = inputs.iter().map(|input| format!("const double {input}[{n}]")).collect();
                let _ =
                    write!(out, "\n/* {meaning} */\nvoid armid_{name}({}, double out[{size}])\n{{\n", typed.join(", "));
                for input in inputs {
                    let _ = writeln!(out, "    (void){input};");
                }
                "const double"
            }
            Language::Rust => {
                let typed: Vec<String> = inputs.iter().map(|input| format!("{input}: &[f64; {n}]")).collect();
                let _ = write!(out, "\n/// {meaning}\npub fn {name}({}) -> [f64; {size}] {{\n", typed.join(", "));
                for input in inputs {
                    let _ = writeln!(out, "    let _ = {input};");
                }
                "let"
            }
        };
        let needed = self.expressions.needed_for(outputs.iter().copied());
        let list = &self.expressions.list;
        for (id, &expression) in list.iter().enumerate().filter(|(id, _)| needed[*id]) {
            let of = |id: Id| self.operand(id);
            let text = match expression {
                Expression::Number(_)
                | Expression::Position(_)
                | Expression::Velocity(_)
                | Expression::Acceleration(_) => continue,
                Expression::Sine(i) if language == Language::C => format!("sin(q[{i}])"),
                Expression::Sine(i) => format!("q[{i}].sin()"),
                Expression::Cosine(i) if language == Language::C => format!("cos(q[{i}])"),
                Expression::Cosine(i) => format!("q[{i}].cos()"),
                Expression::SmoothSign(a, scale) => format!("smooth_sign({}, {:?})", of(a), f64::from_bits(scale)),
                Expression::Negative(a) => format!("-{}", of(a)),
                Expression::Magnitude(a) if language == Language::C => format!("fabs({})", of(a)),
                Expression::Magnitude(a) => format!("{}.abs()", of(a)),
                Expression::Sum(a, b) => format!("{} + {}", of(a), of(b)),
                Expression::Difference(a, b) => format!("{} - {}", of(a), of(b)),
                Expression::Product(a, b) => format!("{} * {}", of(a), of(b)),
            };
            let _ = writeln!(out, "    {number} t{id} = {text};");
        }
        match language {
            Language::C => {
                for (place, &id) in outputs.iter().enumerate() {
                    let _ = writeln!(out, "    out[{place}] = {};", self.operand(id));
                }
            }
            Language::Rust => {
                let values: Vec<String> = outputs.iter().map(|&id| self.operand(id)).collect();
                let _ = writeln!(out, "    [{}]", values.join(", "));
            }
        }
        out.push_str("}\n");
    }

    /// An expression where it is used: numbers and coordinates by themselves, others by their names.
    fn operand(&self, id: Id) -> String {
        match self.expressions.list[id] {
            Expression::Number(bits) => {
                let x = f64::from_bits(bits);
                if x < 0.0 { format!("({x:?})") } else { format!("{x:?}") }
            }
            Expression::Position(i) => format!("q[{i}]"),
            Expression::Velocity(i) => format!("qd[{i}]"),
            Expression::Acceleration(i) => format!("qdd[{i}]"),
            _ => format!("t{id}"),
        }
    }
}
