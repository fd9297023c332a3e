//! Programs of straight-line arithmetic, which know no mechanics.
//!
//! A [`Program`] computes cells from other cells. Another program, made from it, computes the changes of the cells along a
//! displacement (`tangent`). Both run as machine code or in an interpreter ([`crate::motion`]), with the same bits.
//!
//! Read `program` first: the steps of a program and its cells. `builder` then writes programs without repeated steps, and
//! `tangent` makes the program of the changes.

mod builder;
mod program;
mod tangent;

pub(crate) use builder::Builder;
pub(crate) use program::{Cell, Instruction, Product, Program};
pub(crate) use tangent::tangent;
