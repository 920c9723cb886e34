//! How operations are written in a language.

use std::collections::{BTreeMap, BTreeSet};
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
    /// Joint i's number among those called `name`, in a function.
    fn coordinate(self, name: &str, i: usize) -> String {
        match self {
            Self::C => format!("{name}{i}"),
            Self::Rust => format!("{name}[{i}]"),
        }
    }

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
    /// The source: `inverse_dynamics`, `gravity`, `mass_matrix`, `forward_dynamics`, `regressor` and the numbers `base_parameters` that it
    /// belongs to (in C with `armid_` before their names, in Rust the last in capitals), SI, in the order of the joints. Where
    /// friction depends on the load, there is no `forward_dynamics`. `header` stands on top as a comment.
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
        let outputs = self.torque.iter().chain(&self.gravity).chain(&self.mass).chain(&self.regressor);
        let outputs = outputs.chain(self.forward.iter().flatten()).copied();
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
        if let Some(forward) = &self.forward {
            let meaning =
                "Joint accelerations under torques tau, N m (N), from the mass matrix, which must have an inverse.";
            self.function(&mut out, language, "forward_dynamics", meaning, &["q", "qd", "tau"], forward);
        }
        let meaning = "Regressor by rows, a column for each base parameter: its product with them is the joint torque.";
        self.function(&mut out, language, "regressor", meaning, &["q", "qd", "qdd"], &self.regressor);
        let values: Vec<String> = self.beta.iter().map(|value| format!("{value:?}")).collect();
        let (count, values) = (values.len(), values.join(", "));
        let _ = match language {
            Language::C => writeln!(out, "\nconst double armid_base_parameters[{count}] = {{{values}}};"),
            Language::Rust => writeln!(out, "\npub const BASE_PARAMETERS: [f64; {count}] = [{values}];"),
        };
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
        if language == Language::C {
            // A result is written as soon as it is there, and may stand where a coordinate did: these are read first.
            let read = list.iter().zip(&needed).filter(|(_, needed)| **needed).filter_map(|(e, _)| e.coordinate());
            for (name, i) in read.collect::<BTreeSet<_>>() {
                let _ = writeln!(out, "    {number} {name}{i} = {name}[{i}];");
            }
        }
        let mut places: BTreeMap<Id, Vec<usize>> = BTreeMap::new();
        for (place, &id) in outputs.iter().enumerate() {
            places.entry(id).or_default().push(place);
        }
        let at = |name: &str, i: usize| language.coordinate(name, i);
        let of = |id: Id| self.operand(language, id);
        for (id, &expression) in list.iter().enumerate().filter(|(id, _)| needed[*id]) {
            let text = match expression {
                Expression::Number(_)
                | Expression::Position(_)
                | Expression::Velocity(_)
                | Expression::Acceleration(_)
                | Expression::Effort(_) => continue,
                Expression::Sine(i) if language == Language::C => format!("sin({})", at("q", i)),
                Expression::Sine(i) => format!("{}.sin()", at("q", i)),
                Expression::Cosine(i) if language == Language::C => format!("cos({})", at("q", i)),
                Expression::Cosine(i) => format!("{}.cos()", at("q", i)),
                Expression::SmoothSign(a, scale) => format!("smooth_sign({}, {:?})", of(a), f64::from_bits(scale)),
                Expression::Negative(a) => format!("-{}", of(a)),
                Expression::Magnitude(a) if language == Language::C => format!("fabs({})", of(a)),
                Expression::Magnitude(a) => format!("{}.abs()", of(a)),
                Expression::Reciprocal(a) => format!("1.0 / {}", of(a)),
                Expression::Sum(a, b) => format!("{} + {}", of(a), of(b)),
                Expression::Difference(a, b) => format!("{} - {}", of(a), of(b)),
                Expression::Product(a, b) => format!("{} * {}", of(a), of(b)),
            };
            let _ = writeln!(out, "    {number} t{id} = {text};");
            if language == Language::C {
                write_results(out, &places.remove(&id).unwrap_or_default(), &of(id));
            }
        }
        match language {
            // What is no operation: numbers and coordinates.
            Language::C => places.iter().for_each(|(&id, places)| write_results(out, places, &of(id))),
            Language::Rust => {
                let values: Vec<String> = outputs.iter().map(|&id| of(id)).collect();
                let _ = writeln!(out, "    [{}]", values.join(", "));
            }
        }
        out.push_str("}\n");
    }

    /// An expression where it is used: numbers and coordinates by themselves, others by their names.
    fn operand(&self, language: Language, id: Id) -> String {
        match self.expressions.list[id] {
            Expression::Number(bits) => {
                let x = f64::from_bits(bits);
                if x < 0.0 { format!("({x:?})") } else { format!("{x:?}") }
            }
            Expression::Sine(_) | Expression::Cosine(_) => format!("t{id}"),
            expression => {
                expression.coordinate().map_or_else(|| format!("t{id}"), |(name, i)| language.coordinate(name, i))
            }
        }
    }
}

fn write_results(out: &mut String, places: &[usize], value: &str) {
    for place in places {
        let _ = writeln!(out, "    out[{place}] = {value};");
    }
}
