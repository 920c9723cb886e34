//! Values that are read through the checks of their making.

/// Writes a type, which derives both traits of serde with `remote = "Self"`, as its fields, and reads it through a check
/// `fn(Self) -> Result<Self, impl Display>`.
#[doc(hidden)]
#[macro_export]
macro_rules! checked_when_read {
    ($of:ident, $check:expr) => {
        impl serde::Serialize for $of {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                $of::serialize(self, serializer)
            }
        }

        impl<'de> serde::Deserialize<'de> for $of {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let check: fn(Self) -> Result<Self, _> = $check;
                check($of::deserialize(deserializer)?).map_err(serde::de::Error::custom)
            }
        }
    };
}
