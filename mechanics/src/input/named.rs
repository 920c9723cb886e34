//! Enumerations whose variants have names in files and on the command line.

/// Gives an enumeration `ALL`, `name` and `parse`, by a list of its variants and their names.
///
/// ```
/// # use armid_mechanics as armid;
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// enum Side {
///     Left,
///     Right,
/// }
/// armid::input::named! { Side { Left: "left", Right: "right" } }
/// assert_eq!(Side::ALL.map(Side::name), ["left", "right"]);
/// assert_eq!((Side::parse("right"), Side::parse("up")), (Some(Side::Right), None));
/// ```
#[doc(hidden)]
#[macro_export]
macro_rules! named_variants {
    ($of:ident { $($variant:ident: $name:literal),* $(,)? }) => {
        impl $of {
            /// All, in the order of the list.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// Its name in files and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// The one of this name.
            #[must_use]
            pub fn parse(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.name() == name)
            }
        }
    };
}
