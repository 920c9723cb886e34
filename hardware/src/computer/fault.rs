//! Faults that can be injected, and when.

/// Every fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The controller hangs: nothing is sent, received or commanded any more. The drives miss their servo and brake.
    Freeze,
    /// 98 of 100 joint states are lost on the way.
    Drop,
    /// Joint states are late by 0 to 200 ms, and overtake each other.
    Jitter,
    /// The encoder of the first joint jumps by 0.3 rad (m).
    Jump,
    /// The first joint draws half as much again as its drive allows.
    Overcurrent,
    /// The emergency stop is pressed.
    Estop,
    /// The process ends at once.
    Die,
    /// The values of the first two joints change places, their names do not.
    Order,
    /// The first joint's position is not a number.
    Nan,
    /// Motions are taken at once, and said to be taken a second later.
    LateAnswer,
    /// How a motion ended is never said.
    LostResult,
    /// The reported state is an unknown text.
    StrangeState,
    /// Every second state says that the first joint draws all that its drive allows, and the others that it draws none.
    Oscillation,
    /// The robot's clock is stepped by so many seconds: the stamps of its states, and its reading of those of motions.
    Clock,
    /// The robot lives so many times as fast as real time: its clock, its states and its motions.
    Rate,
    /// The joint states name a gripper's joint as well.
    Gripper,
    /// Every goal is taken so many seconds late.
    LateExecution,
    /// The next goal is lost and sent again: it comes so many seconds late, and goals behind it wait for it.
    LostGoal,
}

armid::input::named! { FaultKind {
    Freeze: "freeze", Drop: "drop", Jitter: "jitter", Jump: "jump", Overcurrent: "overcurrent", Estop: "estop",
    Die: "die", Order: "order", Nan: "nan", LateAnswer: "late-answer", LostResult: "lost-result",
    StrangeState: "strange-state", Oscillation: "oscillation", Clock: "clock", Rate: "rate", Gripper: "gripper",
    LateExecution: "late-execution", LostGoal: "lost-goal"
} }

impl FaultKind {
    /// Its size where none is given; zero for a fault without one.
    const fn usual(self) -> f64 {
        match self {
            Self::Clock => -2.0,
            Self::Rate => 2.0,
            Self::LateExecution | Self::LostGoal => 0.4,
            _ => 0.0,
        }
    }
}

/// A fault at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Which.
    pub kind: FaultKind,
    /// Its size, in the unit of its kind.
    pub size: f64,
    /// When, s.
    pub at_s: f64,
    /// Whether time counts from the beginning of the first motion; otherwise from the start of the controller.
    pub of_motion: bool,
}

impl Fault {
    /// Reads `NAME@SECONDS` or `NAME@motion+SECONDS`, where `NAME` may be `NAME:SIZE`.
    ///
    /// # Errors
    /// What was found and what was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let names = || FaultKind::ALL.map(FaultKind::name).join(", ");
        let (name, time) = text.split_once('@').ok_or(format!("\"{text}\", expected NAME@SECONDS"))?;
        let (name, size) = name.split_once(':').map_or((name, None), |(name, size)| (name, Some(size)));
        let kind = FaultKind::parse(name);
        let kind = kind.ok_or_else(|| format!("fault \"{name}\", expected one of {}", names()))?;
        let size = match size {
            None => kind.usual(),
            Some(size) => match size.parse::<f64>() {
                Ok(found) if kind.usual() != 0.0 && (1e-3..=1e4).contains(&found.abs()) => found,
                _ => return Err(format!("size \"{size}\", expected 0.001 to 10000 of a fault that has one")),
            },
        };
        if size < 0.0 && kind != FaultKind::Clock {
            return Err(format!("size {size}, expected a positive one"));
        }
        let (of_motion, time) = time.strip_prefix("motion+").map_or((false, time), |rest| (true, rest));
        match time.parse::<f64>() {
            Ok(at_s) if at_s.is_finite() && at_s >= 0.0 => Ok(Self { kind, size, at_s, of_motion }),
            _ => Err(format!("\"{time}\", expected seconds, as in {name}@3.5 or {name}@motion+3.5")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_is_read_by_its_name() {
        for kind in FaultKind::ALL {
            let fault = Fault::parse(&format!("{}@2.5", kind.name())).unwrap();
            assert_eq!(fault, Fault { kind, size: kind.usual(), at_s: 2.5, of_motion: false });
        }
        assert!(Fault::parse("die@motion+0.25").unwrap().of_motion);
        assert_eq!(Fault::parse("clock:-0.05@1").unwrap().size, -0.05);
        for (text, word) in [
            ("die", "NAME@SECONDS"),
            ("rust@1", "one of freeze"),
            ("die@-1", "seconds"),
            ("die@soon", "seconds"),
            ("die:2@1", "of a fault that has one"),
            ("rate:0@1", "0.001 to 10000"),
            ("rate:-2@1", "positive"),
        ] {
            assert!(Fault::parse(text).unwrap_err().contains(word), "{text}");
        }
    }
}
