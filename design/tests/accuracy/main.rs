//! Accuracy: sensitivities by two ways, worst cases, the choice of tolerances.

mod arm;
mod dual_numbers;
mod five_bar;
mod four_bar;
