//! What a table of settings states of each of its numbers, and the macro that reads such a table.

use core::fmt;

/// A setting that is a number: its keys, its unit, its bounds, its default and its meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Its key in a robot file, as `section.key`; empty if a robot file has none.
    pub key: &'static str,
    /// Its field in [`Settings`](super::Settings), as `part.field`. `axes` and `links` stand for
    /// each of their members.
    pub path: &'static str,
    /// Its unit; empty for a number without one.
    pub unit: &'static str,
    /// What the unit refers to; often empty.
    pub note: &'static str,
    /// What it is, as the beginning of a sentence.
    pub meaning: &'static str,
    /// What it must be.
    pub must: Must,
    /// The bounds that it has on every arm; infinite where they follow from other settings.
    pub range: [f64; 2],
    /// Its value where a robot file leaves it out, if that is the same for every arm.
    pub default: Option<f64>,
}

/// What a value must be, as the rest of a sentence. The keys of other settings stand in backticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Must(pub(super) &'static str);

impl Must {
    /// Whether the sentence names this unit.
    pub(super) fn names(&self, unit: &str) -> bool {
        let mut words = self.0.split(' ');
        words.any(|word| word.trim_end_matches(',') == unit)
    }
}

impl fmt::Display for Must {
    /// With spaces between the thousands, as in "10 000".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_digit = |letter: char| letter.is_ascii_digit();
        let mut before = "";
        for part in self.0.trim_end().split('_') {
            let thousands = before.ends_with(is_digit) && part.starts_with(is_digit);
            f.write_str(match before {
                "" => "",
                _ if thousands => " ",
                _ => "_",
            })?;
            f.write_str(part)?;
            before = part;
        }
        Ok(())
    }
}

impl Row {
    /// A number that is checked with others, or of which every value is valid.
    pub(super) const fn explained(
        path: &'static str,
        unit: &'static str,
        note: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self {
            key: "",
            path,
            unit,
            note,
            meaning,
            must: Must(""),
            range: [f64::NEG_INFINITY, f64::INFINITY],
            default: None,
        }
    }
}

/// The bounds of a value that has none of its own.
pub(super) const EVERY: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

#[inline(never)]
pub(super) fn within([least, greatest]: [f32; 2], value: f32) -> bool {
    least <= value && value <= greatest
}

/// The values of a field that not all settings have.
pub(super) fn all_within<const N: usize>(range: [f32; 2], values: Option<[f32; N]>) -> bool {
    values.is_none_or(|values| values.iter().all(|&value| within(range, value)))
}

/// The first value that is not in the range; if all are, the first; if there is none, 0.
pub(super) fn first_outside<const N: usize>(range: [f32; 2], values: Option<[f32; N]>) -> f32 {
    let values = values.iter().flatten();
    let outside = values.clone().find(|&&value| !within(range, value));
    *outside.or_else(|| values.clone().next()).unwrap_or(&0.0)
}

/// Makes an enum of the fields of a part of the settings. A row has these parts:
///
/// ```text
/// Name {
///     "its key in a robot file" as "its path in the settings"
///         beside [fields that it is compared with] axes [fields of the axes likewise],
///     "meaning" ["unit", "what the unit refers to"] = default;
///     value => rule
/// }
/// ```
///
/// and one of these rules:
///
/// ```text
/// value => least to greatest                   numbers; the sentence follows from them
/// value => least to greatest, "must be …"      with a sentence of its own
/// value => least to greatest, and condition, "be … as well"
/// value => bounds, "must be …"                 bounds that follow from other settings
/// value => if condition, "must be …"
/// each values => least to greatest …           an option of several values
/// ```
macro_rules! fields {
    (
        $(#[$about:meta])*
        $name:ident of $of:ident: $type:ty;
        $($field:ident {
            $key:literal as $path:literal
                $(beside [$($beside:ident),*])? $(axes [$($axis:ident),*])?,
            $meaning:literal [$unit:literal $(, $note:literal)?] $(= $default:literal)?;
            $($rule:tt)*
        })*
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum $name {
            $(#[doc = concat!($meaning, ".")] $field,)*
        }

        impl $name {
            /// Every field, in the order of the check.
            pub const ALL: &'static [Self] = &[$(Self::$field),*];

            /// What the table states of the field.
            pub const fn row(self) -> $crate::settings::row::Row {
                match self {
                    $(Self::$field => $crate::settings::row::Row {
                        key: $key,
                        path: $path,
                        unit: $unit,
                        note: concat!($($note)?),
                        meaning: $meaning,
                        must: $crate::settings::row::Must(
                            $crate::settings::row::must!($unit; $($rule)*)
                        ),
                        range: $crate::settings::row::range!($($rule)*),
                        default: $crate::settings::row::default!($($default)?),
                    },)*
                }
            }

            /// Whether the field is valid.
            #[inline(never)]
            pub(super) fn holds(self, $of: &$type) -> bool {
                match self {
                    $(Self::$field => $crate::settings::row::holds!($($rule)*),)*
                }
            }

            /// The field's value; of several, the first that is not valid.
            pub fn value(self, $of: &$type) -> f32 {
                match self {
                    $(Self::$field => $crate::settings::row::value!($($rule)*),)*
                }
            }

            /// The bounds of the field beside these settings; infinite where there is none.
            pub fn bounds(self, $of: &$type) -> [f32; 2] {
                match self {
                    $(Self::$field => $crate::settings::row::bounds!($($rule)*),)*
                }
            }

            /// The fields that this one is compared with: outside the axes, and of the axes.
            pub(super) fn beside(self) -> (&'static [Field], &'static [AxisField]) {
                match self {
                    $(Self::$field => (
                        &[$($(Field::$beside),*)?],
                        &[$($(AxisField::$axis),*)?],
                    ),)*
                }
            }
        }
    };
}

/// Makes the struct of the numbers that fit most arms, from their names and their rows.
macro_rules! advanced {
    ($($name:ident: $field:ident,)*) => {
        /// Numbers of the controller that fit most arms. They are the last of the settings.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct AdvancedSettings {
            $(#[doc = concat!("[`Field::", stringify!($field), "`]")] pub $name: f32,)*
        }

        impl AdvancedSettings {
            /// The defaults of the table.
            pub const DEFAULT: Self = Self {
                $($name: match Field::$field.row().default {
                    Some(default) => default as f32,
                    None => f32::NAN,
                },)*
            };

            /// How many they are.
            pub const COUNT: usize = Self::FIELDS.len();
            const FIELDS: &[Field] = &[$(Field::$field),*];

            /// All of them, in their order.
            pub fn values_mut(&mut self) -> [&mut f32; Self::COUNT] {
                [$(&mut self.$name),*]
            }
        }

        impl Default for AdvancedSettings {
            fn default() -> Self {
                Self::DEFAULT
            }
        }
    };
}

macro_rules! default {
    () => {
        None
    };
    ($default:literal) => {
        Some($default)
    };
}

macro_rules! must {
    ($unit:literal; each $values:expr => $($rule:tt)*) => {
        $crate::settings::row::must!($unit; $values => $($rule)*)
    };
    ($unit:literal; $value:expr => $least:literal to $most:literal) => {
        concat!("must lie in ", stringify!($least), " to ", stringify!($most), " ", $unit)
    };
    ($unit:literal; $value:expr => $least:literal to $most:literal, $must:literal) => {
        $must
    };
    ($unit:literal; $value:expr => $least:literal to $most:literal, and $holds:expr, $and:literal) => {
        concat!("must lie in ", stringify!($least), " to ", stringify!($most), " ", $unit, ", and ", $and)
    };
    ($unit:literal; $value:expr => if $holds:expr, $must:literal) => {
        $must
    };
    ($unit:literal; $value:expr => $bounds:expr, $must:literal) => {
        $must
    };
}

macro_rules! range {
    (each $values:expr => $($rule:tt)*) => {
        $crate::settings::row::range!($values => $($rule)*)
    };
    ($value:expr => $least:literal to $most:literal $($rest:tt)*) => {
        [$least as f64, $most as f64]
    };
    ($value:expr => $($rest:tt)*) => {
        [f64::NEG_INFINITY, f64::INFINITY]
    };
}

macro_rules! bounds {
    (each $values:expr => $($rule:tt)*) => {
        $crate::settings::row::bounds!($values => $($rule)*)
    };
    ($value:expr => $least:literal to $most:literal $($rest:tt)*) => {
        [$least as f32, $most as f32]
    };
    ($value:expr => if $($rest:tt)*) => {
        $crate::settings::row::EVERY
    };
    ($value:expr => $bounds:expr, $must:literal) => {
        $bounds
    };
}

macro_rules! holds {
    (each $values:expr => $least:literal to $most:literal $(, and $holds:expr, $and:literal)?) => {
        $crate::settings::row::all_within([$least as f32, $most as f32], $values) $(&& $holds)?
    };
    ($value:expr => $least:literal to $most:literal $(, $must:literal)?) => {
        $crate::settings::row::within([$least as f32, $most as f32], $value)
    };
    ($value:expr => $least:literal to $most:literal, and $holds:expr, $and:literal) => {
        $crate::settings::row::within([$least as f32, $most as f32], $value) && $holds
    };
    ($value:expr => if $holds:expr, $must:literal) => {
        $holds
    };
    ($value:expr => $bounds:expr, $must:literal) => {
        $crate::settings::row::within($bounds, $value)
    };
}

macro_rules! value {
    (each $values:expr => $least:literal to $most:literal $($rest:tt)*) => {
        $crate::settings::row::first_outside([$least as f32, $most as f32], $values)
    };
    ($value:expr => $($rest:tt)*) => {
        $value
    };
}

pub(super) use {advanced, bounds, default, fields, holds, must, range, value};
