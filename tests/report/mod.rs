//! What the figures of a report show, by their marks.

/// Where balls come to rest.
mod preferred;
