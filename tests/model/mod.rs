mod closed_forms;
mod dual;
mod existence;
mod extended_lagrange;
mod held_contacts;
mod natural_frequencies;
mod registry;
mod thesis_matrices;
