//! Comparison of designs, Pareto fronts, surrogates and Sobol' indices.

mod comparison;
mod over_points;
mod pareto;
mod sobol_indices;
mod surrogate;
