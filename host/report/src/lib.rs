#![doc = include_str!("../README.md")]

pub mod export;
pub mod html;
pub mod output;
pub mod pages;
pub mod picture;
pub mod study;
pub mod text;
