//! Numbers of a state.

use serde_json::Value;

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The greater speed of the driven joints [rad/s].
pub(crate) fn speed(state: &Value) -> f64 {
    let [one, four] = [0, 1].map(|joint| number(&state["velocity"][joint]).abs());
    one.max(four)
}

/// The controller's time [s] of a state.
pub(crate) fn time(state: &Value) -> f64 {
    number(&state["time"])
}
