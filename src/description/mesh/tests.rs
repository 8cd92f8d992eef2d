//! Readers of mesh files, against shapes written by hand.
