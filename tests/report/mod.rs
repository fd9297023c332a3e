//! Figures for papers.

mod figures;
