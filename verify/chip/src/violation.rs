//! What a program must not do with a peripheral.

use std::fmt;

/// A rule of the reference manual that an access broke.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The register, such as `RCC_CFGR`, or the address.
    pub register: String,
    /// The value that was written; none if the register was read.
    pub written: Option<u32>,
    /// The rule.
    pub rule: String,
}

/// An access to a register: its result, or the rule that it broke.
pub type Access<T> = Result<T, Violation>;

/// A violation by a write.
pub(crate) fn refuse<T>(register: &str, value: u32, rule: impl Into<String>) -> Access<T> {
    Err(Violation {
        register: register.to_owned(),
        written: Some(value),
        rule: rule.into(),
    })
}

/// A violation by a read.
pub(crate) fn refuse_read<T>(register: &str, rule: impl Into<String>) -> Access<T> {
    Err(Violation {
        register: register.to_owned(),
        written: None,
        rule: rule.into(),
    })
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.written {
            Some(value) => write!(f, "{} = {value:#010x}: {}", self.register, self.rule),
            None => write!(f, "{} is read: {}", self.register, self.rule),
        }
    }
}
