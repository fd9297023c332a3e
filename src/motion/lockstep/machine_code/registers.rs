//! Keeps values in registers: of those that must leave, the value whose next use is furthest away (L. A. Belady, IBM Systems
//! Journal 5 (1966) 78, doi:10.1147/sj.52.0078). A value that leaves waits in a cell that nothing else needs.

use std::collections::BTreeSet;

use super::encode::{Encoded, Encoder, Operand};
use super::lower::{Id, Line, Lowered, MachineOperation, Value};
use crate::graph::Cell;

/// A value that is read again within this number of lines is loaded into a register, if one is free.
const SOON: u32 = 40;

/// The registers during the lines of a program.
struct Registers<'e> {
    encoder: &'e mut Encoder,
    /// The value in each register.
    holds: Vec<Option<Id>>,
    values: Vec<Value>,
    /// The cells of values that no later code reads. A value that leaves its register waits in the lowest free one.
    free: BTreeSet<Cell>,
}

/// Writes the code of the lines.
pub(super) fn assign(lowered: Lowered, encoder: &mut Encoder, cells: usize) -> Encoded {
    let Lowered { lines, mut values } = lowered;
    if values.iter().any(|value| value.cell as usize >= cells) {
        return None;
    }
    let cell = |line: &Line| values[line.result as usize].cell;
    let (stored, others): (Vec<&Line>, Vec<&Line>) = lines.iter().partition(|line| line.stores);
    let stored: BTreeSet<Cell> = stored.into_iter().map(cell).collect();
    let others: BTreeSet<Cell> = others.into_iter().map(cell).collect();
    let free = others.difference(&stored).copied().collect();
    values.iter_mut().for_each(|value| value.is_stored = stored.contains(&value.cell));
    let holds = vec![None; encoder.registers()];
    let mut registers = Registers { encoder, holds, values, free };
    (0..).zip(&lines).try_for_each(|(at, line)| registers.line(at, line))
}

impl Registers<'_> {
    fn of(&self, id: Id) -> &Value {
        &self.values[id as usize]
    }

    /// Returns a free register, which is none of `keep`.
    fn take(&mut self, keep: &[usize]) -> Encoded<usize> {
        let mut furthest = (None, 0);
        for (register, held) in self.holds.iter().enumerate() {
            if keep.contains(&register) {
                continue;
            }
            let Some(id) = held else { return Some(register) };
            let next = self.of(*id).next_read().unwrap_or(u32::MAX);
            if furthest.0.is_none() || next > furthest.1 {
                furthest = (Some((register, *id)), next);
            }
        }
        let (register, id) = furthest.0?;
        let value = &mut self.values[id as usize];
        if !value.is_in_memory && value.next_read().is_some() {
            if !value.is_stored {
                value.cell = self.free.pop_first()?;
                value.is_waiting = true;
            }
            value.is_in_memory = true;
            self.encoder.store(value.cell, register)?;
        }
        value.register = None;
        self.holds[register] = None;
        Some(register)
    }

    fn hold(&mut self, register: usize, id: Id) {
        self.holds[register] = Some(id);
        self.values[id as usize].register = Some(register);
    }

    /// Returns the register of a value, which is loaded if it is in memory. `keep` gets the register.
    fn load(&mut self, id: Id, keep: &mut Vec<usize>) -> Encoded<usize> {
        let register = match self.of(id).register {
            Some(register) => register,
            None => {
                let register = self.take(keep)?;
                self.encoder.load(register, self.of(id).cell)?;
                self.hold(register, id);
                register
            }
        };
        keep.push(register);
        Some(register)
    }

    /// Returns where an instruction reads a value that it can read in memory.
    fn place(&mut self, id: Id, line: u32, keep: &mut Vec<usize>) -> Encoded<Operand> {
        let value = self.of(id);
        let later = value.reads[value.past..].iter().find(|read| **read > line);
        let later = later.copied().filter(|read| read - line < SOON);
        let is_sooner = |later: u32| {
            let makes_way = |held: &Option<Id>| {
                held.is_none_or(|id| {
                    let held = self.of(id);
                    held.is_in_memory && held.next_read().is_none_or(|next| next > later)
                })
            };
            self.holds.iter().enumerate().any(|(at, held)| !keep.contains(&at) && makes_way(held))
        };
        if value.register.is_none() && !later.is_some_and(is_sooner) {
            return Some(Operand::Cell(value.cell));
        }
        self.load(id, keep).map(Operand::Register)
    }

    /// Returns two operands, the first in a register; they may be exchanged if they are `factors`.
    fn operands(
        &mut self,
        [a, b]: [Id; 2],
        factors: bool,
        line: u32,
        keep: &mut Vec<usize>,
    ) -> Encoded<(usize, Operand)> {
        let swaps = factors && self.of(a).register.is_none() && self.of(b).register.is_some();
        let [a, b] = if swaps { [b, a] } else { [a, b] };
        Some((self.load(a, keep)?, self.place(b, line, keep)?))
    }

    /// Returns a register for a result: that of a value which no later line reads, or a free one.
    fn result(&mut self, reads: &[Id], line: u32, keep: &[usize]) -> Encoded<usize> {
        let ends = |id: &&Id| self.of(**id).ends_at(line) && self.of(**id).register.is_some();
        let ending = reads.iter().find(ends).and_then(|id| self.of(*id).register);
        ending.or_else(|| self.take(keep))
    }

    fn line(&mut self, at: u32, line: &Line) -> Encoded {
        let mut keep: Vec<usize> =
            line.operation.reads().filter_map(|id| self.of(id).register).collect();
        let result = match line.operation {
            MachineOperation::Product(of)
            | MachineOperation::Quotient(of)
            | MachineOperation::Smaller(of)
            | MachineOperation::Larger(of) => {
                let factors = matches!(line.operation, MachineOperation::Product(_));
                let (a, b) = self.operands(of, factors, at, &mut keep)?;
                let result = self.result(&of, at, &keep)?;
                match line.operation {
                    MachineOperation::Smaller(_) => self.encoder.smaller(result, a, b)?,
                    MachineOperation::Larger(_) => self.encoder.larger(result, a, b)?,
                    MachineOperation::Quotient(_) => self.encoder.quotient(result, a, b)?,
                    _ => self.encoder.product(result, a, b)?,
                }
                result
            }
            MachineOperation::Fused { factors, sum, subtracts } => {
                let (a, b) = self.operands(factors, true, at, &mut keep)?;
                let held = self.of(sum);
                let is_last = held.ends_at(at) && !factors.contains(&sum);
                let result = match held.register {
                    Some(register) if is_last => register,
                    Some(register) => {
                        let result = self.take(&keep)?;
                        self.encoder.copy(result, register)?;
                        result
                    }
                    None => {
                        let result = self.take(&keep)?;
                        self.encoder.load(result, self.of(sum).cell)?;
                        result
                    }
                };
                self.encoder.fused(result, a, b, subtracts)?;
                result
            }
            MachineOperation::SquareRoot(of)
            | MachineOperation::Size(of)
            | MachineOperation::Copy(of) => {
                let register = self.load(of, &mut keep)?;
                let result = self.result(&[of], at, &keep)?;
                match line.operation {
                    MachineOperation::SquareRoot(_) => {
                        self.encoder.square_root(result, register)?
                    }
                    MachineOperation::Size(_) => self.encoder.size(result, register)?,
                    _ if result != register => self.encoder.copy(result, register)?,
                    _ => {}
                }
                result
            }
            MachineOperation::Choice(all) => {
                let mut of = [0; 4];
                for (register, id) in of.iter_mut().zip(all) {
                    *register = self.load(id, &mut keep)?;
                }
                let result = self.take(&keep)?;
                self.encoder.choice(result, of)?;
                result
            }
        };
        self.after(at, line, result)
    }

    /// Frees the registers of values that no later line reads, and stores the result.
    fn after(&mut self, at: u32, line: &Line, result: usize) -> Encoded {
        for id in line.operation.reads() {
            let value = &mut self.values[id as usize];
            while value.next_read().is_some_and(|read| read <= at) {
                value.past += 1;
            }
            if value.next_read().is_none() {
                if let Some(register) = value.register.take() {
                    self.holds[register] = None;
                }
                if std::mem::take(&mut value.is_waiting) {
                    self.free.insert(value.cell);
                }
            }
        }
        let value = &mut self.values[line.result as usize];
        if line.stores {
            self.encoder.store(value.cell, result)?;
            value.is_in_memory = true;
        }
        if value.next_read().is_some() {
            self.hold(result, line.result);
        }
        Some(())
    }
}
