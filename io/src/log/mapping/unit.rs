//! Units that logs are written in.

use std::f64::consts::{PI, TAU};

/// A unit that values of a log may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Second.
    S,
    /// Millisecond.
    Ms,
    /// Microsecond.
    Us,
    /// Nanosecond.
    Ns,
    /// Radian.
    Rad,
    /// Degree.
    Deg,
    /// Milliradian.
    Mrad,
    /// Revolution.
    Rev,
    /// Metre.
    M,
    /// Millimetre.
    Mm,
    /// rad/s
    RadPerS,
    /// deg/s
    DegPerS,
    /// rpm
    RevPerMin,
    /// m/s
    MPerS,
    /// mm/s
    MmPerS,
    /// Ampere.
    A,
    /// Milliampere.
    Ma,
    /// N·m
    Nm,
    /// mN·m
    MilliNm,
    /// Newton.
    N,
    /// Percent of a rated value, which `rated=` says.
    Percent,
}

impl Unit {
    /// Its name in a mapping.
    pub const fn name(self) -> &'static str {
        match self {
            Self::S => "s",
            Self::Ms => "ms",
            Self::Us => "us",
            Self::Ns => "ns",
            Self::Rad => "rad",
            Self::Deg => "deg",
            Self::Mrad => "mrad",
            Self::Rev => "rev",
            Self::M => "m",
            Self::Mm => "mm",
            Self::RadPerS => "rad/s",
            Self::DegPerS => "deg/s",
            Self::RevPerMin => "rpm",
            Self::MPerS => "m/s",
            Self::MmPerS => "mm/s",
            Self::A => "A",
            Self::Ma => "mA",
            Self::Nm => "Nm",
            Self::MilliNm => "mNm",
            Self::N => "N",
            Self::Percent => "%",
        }
    }

    /// Other ways of writing it, in small letters.
    const fn other_names(self) -> &'static [&'static str] {
        match self {
            Self::S => &["sec", "seconds"],
            Self::Ms => &["msec", "milliseconds"],
            Self::Us => &["µs", "usec", "microseconds"],
            Self::Ns => &["nsec", "nanoseconds"],
            Self::Rad => &["radians"],
            Self::Deg => &["degrees", "°"],
            Self::Rev => &["turns", "revolutions"],
            Self::RadPerS => &["rad_s", "rads", "rad_per_s"],
            Self::DegPerS => &["deg_s", "degs", "deg_per_s", "°/s"],
            Self::RevPerMin => &["1/min", "rev/min"],
            Self::MPerS => &["m_s"],
            Self::MmPerS => &["mm_s"],
            Self::A => &["amps", "ampere"],
            Self::Nm => &["n·m", "n*m", "n.m", "n_m"],
            Self::MilliNm => &["mn·m", "mn_m"],
            Self::Percent => &["percent", "pct"],
            Self::Mrad | Self::M | Self::Mm | Self::Ma | Self::N => &[],
        }
    }

    /// One of these units by what it is called, capitals or not.
    pub fn parse(name: &str, among: &[Self]) -> Option<Self> {
        let small = name.to_lowercase();
        among
            .iter()
            .copied()
            .find(|unit| unit.name().to_lowercase() == small || unit.other_names().contains(&small.as_str()))
    }

    /// The SI value of one of it; of one percent, a hundredth.
    pub const fn si(self) -> f64 {
        match self {
            Self::S | Self::Rad | Self::M | Self::RadPerS | Self::MPerS | Self::A | Self::Nm | Self::N => 1.0,
            Self::Ms | Self::Mrad | Self::Mm | Self::MmPerS | Self::Ma | Self::MilliNm => 1e-3,
            Self::Us => 1e-6,
            Self::Ns => 1e-9,
            Self::Deg | Self::DegPerS => PI / 180.0,
            Self::Rev => TAU,
            Self::RevPerMin => TAU / 60.0,
            Self::Percent => 0.01,
        }
    }

    /// The unit that a heading ends with, `pos_deg` or `pos [deg]`, and what stands in front of it.
    pub fn in_heading<'a>(heading: &'a str, among: &[Self]) -> Option<(Self, &'a str)> {
        let heading = heading.trim();
        for (open, close) in [('[', ']'), ('(', ')')] {
            if let Some((front, word)) = heading.strip_suffix(close).and_then(|inner| inner.rsplit_once(open))
                && let Some(unit) = Self::parse(word.trim(), among)
            {
                return Some((unit, front.trim_end_matches(['_', ' '])));
            }
        }
        // The longest ending first: `rad_s` before `s`.
        let mut at: Vec<usize> = heading.match_indices(['_', ' ']).map(|(at, _)| at).collect();
        at.sort_unstable();
        at.into_iter().find_map(|at| {
            Self::parse(&heading[at + 1..], among).map(|unit| (unit, heading[..at].trim_end_matches(['_', ' '])))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Quantity;
    use super::Unit;

    #[test]
    fn names_are_unique_and_read_back() {
        for quantity in Quantity::ALL {
            for unit in quantity.units() {
                assert_eq!(Unit::parse(unit.name(), quantity.units()), Some(*unit));
            }
        }
        assert_eq!(Unit::parse("DEG", Quantity::Position.units()), Some(Unit::Deg));
        assert_eq!(Unit::parse("deg", Quantity::Torque.units()), None);
    }

    #[test]
    fn headings_may_end_with_their_unit() {
        let position = Quantity::Position.units();
        assert_eq!(Unit::in_heading("joint_1_pos_deg", position), Some((Unit::Deg, "joint_1_pos")));
        assert_eq!(Unit::in_heading("joint 1 [deg]", position), Some((Unit::Deg, "joint 1")));
        assert_eq!(Unit::in_heading("pos_1", position), None);
        assert_eq!(Unit::in_heading("time_ms", Quantity::Time.units()), Some((Unit::Ms, "time")));
        assert_eq!(Unit::in_heading("vel_1_rad_s", Quantity::Velocity.units()), Some((Unit::RadPerS, "vel_1")));
        assert_eq!(Unit::in_heading("tau1_Nm", Quantity::Torque.units()), Some((Unit::Nm, "tau1")));
    }
}
