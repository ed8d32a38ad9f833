#![doc = include_str!("../README.md")]

#[cfg(target_family = "wasm")]
pub mod exports;
mod request;
mod watched;

pub use request::answer;
