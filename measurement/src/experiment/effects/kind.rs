//! The list of effects: name, unit, two levels, and what each means.

use super::level::Level;

/// What one effect is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectEntry {
    /// Name in files.
    pub name: &'static str,
    /// Unit of its magnitude, as text; empty for a share.
    pub unit: &'static str,
    /// Magnitude on an arm in good order.
    pub realistic: f64,
    /// Magnitude on a worn or carelessly built arm.
    pub severe: f64,
    /// Largest magnitude that the model of the effect is made for.
    pub most: f64,
    /// What the magnitude says, one line.
    pub meaning: &'static str,
}

/// Makes the enum, and everything that enumerates it, from one list.
macro_rules! effects {
    ($($(#[$doc:meta])* $kind:ident: $name:literal, $unit:literal, $realistic:literal, $severe:literal, $most:literal, $meaning:literal;)*) => {
        /// An effect of the real arm that the identification model leaves out, listed once.
        ///
        /// ```
        /// # use armid_measurement as armid;
        /// use armid::experiment::EffectKind;
        /// assert_eq!(EffectKind::parse("stribeck"), Some(EffectKind::Stribeck));
        /// for kind in EffectKind::ALL {
        ///     let entry = kind.entry();
        ///     assert!(0.0 < entry.realistic && entry.realistic < entry.severe && entry.severe <= entry.most);
        ///     assert_eq!(EffectKind::parse(kind.name()), Some(*kind));
        /// }
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum EffectKind {
            $($(#[$doc])* $kind,)*
        }

        impl EffectKind {
            /// Every effect, in the order from the friction of a joint to the clock of the samples.
            pub const ALL: &'static [Self] = &[$(Self::$kind,)*];

            /// Name, unit, levels, meaning.
            pub const fn entry(self) -> EffectEntry {
                match self {
                    $(Self::$kind => EffectEntry {
                        name: $name,
                        unit: $unit,
                        realistic: $realistic,
                        severe: $severe,
                        most: $most,
                        meaning: $meaning,
                    },)*
                }
            }
        }
    };
}

effects! {
    /// Friction that falls as a joint starts to move.
    Stribeck: "stribeck", "", 0.3, 0.8, 2.0,
        "friction at standstill above Coulomb friction, as a share of it";
    /// Coulomb friction that grows with the torque that goes through the gear.
    LoadFriction: "load-friction", "", 0.05, 0.15, 0.5,
        "Coulomb friction per transmitted torque";
    /// Coulomb friction that differs between the two directions.
    DirectionFriction: "direction-friction", "", 0.2, 0.45, 0.9,
        "half the difference of Coulomb friction in both directions, as a share of its mean";
    /// Coulomb friction that depends on position.
    PositionFriction: "position-friction", "", 0.1, 0.3, 0.9,
        "amplitude of Coulomb friction over a turn of the joint, as a share of it";
    /// Coulomb friction that follows displacement before it slides.
    Presliding: "presliding", "mrad", 0.1, 0.5, 10.0,
        "displacement in which friction comes nearer to sliding by the factor e";
    /// Viscous friction that falls as the gear warms up.
    Warming: "warming", "", 0.2, 0.6, 0.95,
        "share of viscous friction that a warm gear has lost";
    /// Harmonic drives that wind up under torque: motor and link have states of their own.
    Elasticity: "elasticity", "mrad", 2.0, 6.0, 30.0,
        "wind-up of each drive at its torque rating";
    /// Wind-up that depends on where it came from, on the spring of elasticity (its realistic one where it is off).
    Hysteresis: "hysteresis", "mrad", 0.3, 1.2, 10.0,
        "width of the loop of wind-up at zero torque";
    /// A gap between the flanks, on the spring of elasticity (its realistic one where it is off).
    Backlash: "backlash", "mrad", 0.3, 1.5, 20.0,
        "gap that a motor crosses before it moves its link the other way";
    /// Harmonic drives whose links lead and lag their motors twice and once in a turn of the wave generator.
    TransmissionError: "transmission-error", "mrad", 0.15, 0.5, 1.0,
        "amplitude of the link's lead twice a motor turn; half as much once";
    /// Motor torque that varies with the motor's angle, in proportion to the current.
    TorqueRipple: "torque-ripple", "", 0.02, 0.08, 0.5,
        "amplitude as a share of the torque, twice and six times a motor turn";
    /// Torque that pulls a motor into rest positions, current or none.
    Cogging: "cogging", "", 0.01, 0.05, 0.5,
        "amplitude as a share of the rating, once and twelve times a motor turn";
    /// Torque constants other than those of the robot file.
    TorqueConstant: "torque-constant", "", 0.03, 0.1, 0.5,
        "relative error of every torque constant, up or down by joint";
    /// Current that follows its set point late, while the controller reports the set point.
    CurrentLag: "current-lag", "ms", 0.5, 3.0, 20.0,
        "time constant of the current loop";
    /// Current that is set some servo steps late, while the controller reports the set point.
    CurrentDelay: "current-delay", "steps", 1.0, 5.0, 20.0,
        "servo steps between a set point and its current";
    /// A tool at the flange that the model does not have.
    Tool: "tool", "kg", 0.2, 1.0, 10.0,
        "mass, centred 60 mm before and 20 mm beside the flange";
    /// A hose or a bundle of cables along each joint.
    Cable: "cable", "", 0.01, 0.05, 0.5,
        "torque a radian from rest, as a share of the rating";
    /// A base that does not stand level.
    BaseTilt: "base-tilt", "deg", 0.5, 3.0, 30.0,
        "angle between the base's axis and the plumb line";
    /// Links of other lengths and angles than the robot file's.
    Kinematics: "kinematics", "mm", 0.5, 3.0, 20.0,
        "error of each length of the kinematic table, and of each angle in mrad";
    /// Encoders with fewer lines than the robot file's.
    EncoderStep: "encoder-step", "steps", 4.0, 32.0, 1000.0,
        "encoder counts that are one";
    /// Encoder discs off the axes of their motors.
    MotorEccentricity: "motor-eccentricity", "mrad", 5.0, 20.0, 200.0,
        "error of the motor's angle, once a motor turn";
    /// Gears whose ratio varies once a turn of their joint.
    JointEccentricity: "joint-eccentricity", "mrad", 0.2, 1.0, 20.0,
        "error of the joint's angle, once a joint turn";
    /// Samples taken off the clock that they are stamped with.
    ClockJitter: "clock-jitter", "us", 20.0, 200.0, 500.0,
        "standard deviation of the time of a sample";
    /// Samples that get lost; the one before stands in their place.
    DroppedSamples: "dropped-samples", "", 0.001, 0.02, 0.5,
        "share of samples that repeat the one before";
    /// Stretches of samples that were measured earlier than their stamps say.
    ClockSlips: "clock-slips", "", 0.001, 0.01, 0.5,
        "share of samples, in slips of 50 ms, that were measured 20 ms before their stamps";
    /// Current converters whose zero is not zero.
    AdcOffset: "adc-offset", "", 0.001, 0.01, 0.1,
        "offset as a share of the converter's range";
    /// Current converters with fewer bits than the robot file's.
    AdcStep: "adc-step", "steps", 4.0, 16.0, 256.0,
        "converter steps that are one";
    /// Correlated current noise of equal variance.
    ColouredNoise: "coloured-noise", "ms", 5.0, 100.0, 10000.0,
        "time in which the correlation of the noise falls to 1/e";
    /// White noise of the encoders' positions, which the controller acts on too.
    EncoderNoise: "encoder-noise", "deg", 0.001, 0.01, 1.0,
        "standard deviation at each revolute joint, ahead of the encoder's counts";
    /// White noise of the currents beside the robot file's.
    TorqueNoise: "torque-noise", "N·m", 0.05, 0.2, 10.0,
        "standard deviation of each motor's torque at its joint by what is added to its current";
    /// Readings of currents that have nothing to do with them.
    TorqueSpikes: "torque-spikes", "", 0.001, 0.01, 0.5,
        "share of readings of each current that are anything within the converter's range";
}

impl EffectKind {
    /// Its name in files.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// The effect of this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Its magnitude at a level, in the effect's unit.
    pub const fn magnitude(self, level: Level) -> f64 {
        match level {
            Level::Realistic => self.entry().realistic,
            Level::Severe => self.entry().severe,
        }
    }

    /// The level that a magnitude is, where it is one.
    pub fn level(self, magnitude: f64) -> Option<Level> {
        Level::ALL.into_iter().find(|&level| self.magnitude(level).to_bits() == magnitude.to_bits())
    }
}
