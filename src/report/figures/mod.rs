//! Figures made from tables and closed forms.

pub mod equilibrium_set;
