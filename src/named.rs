//! Names of the values of an enum, one row for each.

/// Gives an enum without fields its values in order, their names in tables and study files, and the value of a name.
macro_rules! named {
    ($of:ident { $($value:ident: $name:literal),+ $(,)? }) => {
        impl $of {
            /// All values.
            pub const ALL: &[Self] = &[$(Self::$value),+];

            /// Returns the name in tables and study files.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $name),+
                }
            }
        }
    };
}

pub(crate) use named;
