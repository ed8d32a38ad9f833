//! The live page's server in process, by virtual time. Websockets take the place of pages.

#[path = "../arms/mod.rs"]
mod arms;
mod console;
mod crossing;
mod drive_values;
mod held_motion;
mod hostile_files;
mod in_process;
mod kinds;
mod lost_page;
mod own_job;
mod pen_heights;
mod placing;
mod state;
mod stops;
mod teaching;
mod time_optimal;
