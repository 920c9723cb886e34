//! A periodic motion from outside the list, in the place of one of the list.

use std::any::Any;
use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::definition::PeriodicMotion;

/// What a motion must be able to do to stand in a [`PeriodicTrajectory`](super::PeriodicTrajectory): every motion that is
/// `Clone`, `Debug` and `Serialize` can.
trait AnyMotion: PeriodicMotion + fmt::Debug + Any {
    fn copy(&self) -> Box<dyn AnyMotion>;

    fn to_toml(&self) -> String;
}

impl<M: PeriodicMotion + Clone + fmt::Debug + Serialize + 'static> AnyMotion for M {
    fn copy(&self) -> Box<dyn AnyMotion> {
        Box::new(self.clone())
    }

    fn to_toml(&self) -> String {
        toml::to_string(self).expect("a motion of names and finite numbers has a TOML form")
    }
}

/// A periodic motion that is not on the list.
///
/// Two are equal if they are written alike. It writes itself; reading it back takes the program that has its type.
#[derive(Debug)]
pub struct CustomTrajectory(Box<dyn AnyMotion>);

impl CustomTrajectory {
    /// Takes a motion in.
    ///
    /// Its serialised form is a table of names, numbers and lists of them, as TOML has it, and should have a key `family`
    /// with a name of its own.
    pub fn new<M: PeriodicMotion + Clone + fmt::Debug + Serialize + 'static>(motion: M) -> Self {
        Self(Box::new(motion))
    }

    /// The motion, if it is one of this type.
    pub fn downcast_ref<M: PeriodicMotion + 'static>(&self) -> Option<&M> {
        let any: &dyn Any = &*self.0;
        any.downcast_ref()
    }

    /// The motion.
    pub fn motion(&self) -> &(dyn PeriodicMotion + 'static) {
        &*self.0
    }

    pub(super) fn motion_mut(&mut self) -> &mut (dyn PeriodicMotion + 'static) {
        &mut *self.0
    }

    /// The motion as its own type writes it.
    ///
    /// # Panics
    /// If it has no TOML form.
    pub fn to_toml(&self) -> String {
        self.0.to_toml()
    }
}

impl Clone for CustomTrajectory {
    fn clone(&self) -> Self {
        Self(self.0.copy())
    }
}

impl PartialEq for CustomTrajectory {
    fn eq(&self, other: &Self) -> bool {
        self.to_toml() == other.to_toml()
    }
}

/// How it stands among values in other forms.
#[derive(Serialize)]
struct Written {
    toml: String,
}

impl Serialize for CustomTrajectory {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Written { toml: self.to_toml() }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for CustomTrajectory {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        let message =
            "a trajectory of family \"custom\", expected one of the list: the program that has its type reads it";
        Err(serde::de::Error::custom(message))
    }
}
