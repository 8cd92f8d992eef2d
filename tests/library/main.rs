//! One feature per module, through the library or as the command prints it, compared with cases worked out by hand.

#[cfg(feature = "accuracy")]
mod accuracy;
mod architecture;
mod budget;
mod built;
#[cfg(feature = "accuracy")]
mod compliant;
mod constraints;
mod courses;
mod csv;
mod forces;
mod ground;
mod lecture;
mod limits;
mod loader;
mod maps;
mod recycled;
mod reductions;
mod regression;
mod resting;
#[path = "../support/mod.rs"]
mod support;
mod sweep;
mod touchdowns;
mod uncertainty;
