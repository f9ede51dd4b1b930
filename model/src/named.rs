//! Enumerations whose values have names.

/// Declares an enumeration with a name beside each value, and its `ALL` and `name`.
///
/// ```
/// crepitus_model::named! {
///     /// Where to.
///     #[derive(Clone, Copy, Debug, PartialEq)]
///     pub enum Way {
///         /// To the end.
///         Forth => "forth",
///         /// To the beginning.
///         Back => "back",
///     }
/// }
/// assert_eq!(Way::ALL.map(Way::name), ["forth", "back"]);
/// ```
#[macro_export]
macro_rules! named {
    (
        $(#[$about:meta])*
        $visible:vis enum $Enum:ident {
            $( $(#[$about_value:meta])* $Value:ident => $name:literal, )+
        }
    ) => {
        $(#[$about])*
        $visible enum $Enum {
            $( $(#[$about_value])* $Value, )+
        }

        impl $Enum {
            /// All values, in the order of their declaration.
            $visible const ALL: [Self; [$( $name ),+].len()] = [$( Self::$Value ),+];

            /// Name of the value, in files and for people.
            $visible const fn name(self) -> &'static str {
                match self {
                    $( Self::$Value => $name, )+
                }
            }
        }
    };
}
