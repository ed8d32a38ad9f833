//! Studies of arms and linkages, and what is made of their answers: pages, pictures, text, files for
//! other programs.
//!
//! | module | content |
//! |---|---|
//! | [`study`] | analyses: accuracy, clearance, linkages, mobility, workspace, queries |
//! | [`html`] | the parts of a page: charts, tables, the arm in motion |
//! | [`text`] | answers as text |
//! | [`picture`] | answers as SVG and PNG |
//! | [`pages`] | the report of each study and run |
//! | [`export`] | files for other programs: URDF, MJCF, tables, logs |
//! | [`output`] | files that are written whole or not at all |

pub mod export;
pub mod html;
pub mod output;
pub mod pages;
pub mod picture;
pub mod study;
pub mod text;
