//! Formwork: smooth differential forms on OpenSubdiv surfaces.

pub mod cochain;
pub mod hierarchy;
pub mod io;
pub mod field;
pub mod laws;
pub mod osd;
pub mod scheme;
pub mod sparse;
pub mod topology;
