//! Random programs give the same bits as machine code and in the interpreter, and their tangents are those of dual numbers.

use fearless_simd::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{MachineCode, Width};
use crate::graph::{Builder, Cell, Instruction, Product, Program, tangent};
use crate::model::{Dual, Elementary, Number};
use crate::motion::lockstep::run::interpret;
use crate::motion::lockstep::simd_level::{baseline, with_each_level};
use crate::motion::lockstep::vector::Vector;
use crate::motion::lockstep::{LANES, Lanes};

/// A million programs were run once.
const PROGRAMS: usize = 2000;

/// Returns a program in which each cell is written at most once.
fn program(random: &mut ChaCha8Rng) -> Program {
    let inputs = random.random_range(3..30);
    let mut builder = Builder::with_cells(inputs);
    let mut known: Vec<Cell> = (0..inputs as Cell).collect();
    for _ in 0..random.random_range(1..80) {
        let mut cell = || known[random.random_range(0..known.len())];
        let [a, b, c, d] = [(); 4].map(|()| cell());
        let products: Vec<_> = (0..random.random_range(0..18))
            .map(|_| [(); 2].map(|()| known[random.random_range(0..known.len())]))
            .collect();
        let start = random.random::<bool>().then_some(a);
        let out = match random.random_range(0..20) {
            0 => builder.quotient(a, b),
            1 => builder.choice([a, b], c, d),
            2 => {
                let root = builder.cell();
                builder.add(Instruction::SquareRoot { out: root, of: a });
                root
            }
            3 => {
                let [sine, cosine] = [(); 2].map(|()| builder.cell());
                builder.add(Instruction::SineCosine { sine, cosine, of: a });
                known.push(sine);
                cosine
            }
            4 => builder.size(a),
            5..8 => builder.difference(start, &products),
            8..12 => builder.sum(start, &products),
            _ => {
                let out = builder.cell();
                let sign = |factors| Product { factors, subtracts: random.random() };
                let products: Vec<_> = products.into_iter().map(sign).collect();
                builder.combine(out, start, products);
                out
            }
        };
        known.push(out);
    }
    let kept: Vec<Cell> = known.into_iter().filter(|_| random.random()).collect();
    builder.finish(kept)
}

#[test]
fn random_programs() {
    with_each_level!(simd => agree_with_the_interpreter(simd));
}

fn assert_same([left, right]: [f64; 2], of: impl Fn() -> String) {
    let same = left.to_bits() == right.to_bits() || left.is_nan() && right.is_nan();
    assert!(same, "{left} and {right} in program {}", of());
}

fn agree_with_the_interpreter(simd: impl Vector) {
    let widths = [Width::Eight, Width::Four].into_iter().filter(|width| width.is_here());
    let widths: Vec<_> = widths.collect();
    let mut random = ChaCha8Rng::seed_from_u64(17);
    for number in 0..PROGRAMS {
        let program = program(&mut random);
        let mut start: Vec<_> = (0..program.cells)
            .map(|_| {
                let values = [(); LANES].map(|()| random.random_range(-2.0..2.0));
                Lanes::from_slice(simd, &values)
            })
            .collect();
        for (cell, number) in program.numbers.iter() {
            start[*cell as usize] = Lanes::splat(simd, *number);
        }
        let mut expected = start.clone();
        interpret(simd, &program, &mut expected);
        for width in &widths {
            let mut found = start.clone();
            let code = MachineCode::new(&program, *width).expect("this system allows machine code");
            code.run(simd, &mut found);
            for cell in (0..program.cells).filter(|cell| program.kept[*cell]) {
                for lane in 0..LANES {
                    let both = [expected[cell][lane], found[cell][lane]];
                    assert_same(both, || {
                        format!("{number}, {width:?}, {cell}, {lane} {program:?}")
                    });
                }
            }
        }
        let mut interpreted: Vec<f64> = start.iter().map(|all| all[0]).collect();
        let mut found = interpreted.clone();
        interpret(simd, &program, &mut interpreted);
        if let Some(code) = MachineCode::new(&program, Width::One) {
            code.run(simd, &mut found);
        } else {
            found.clone_from(&interpreted);
        }
        for cell in (0..program.cells).filter(|cell| program.kept[*cell]) {
            for value in [interpreted[cell], found[cell]] {
                assert_same([expected[cell][0], value], || format!("{number}, {cell} {program:?}"));
            }
        }
    }
}

/// Runs a program with dual numbers.
fn run_dual(program: &Program, cells: &mut [Dual]) {
    for instruction in &program.instructions {
        let at = |cell: Cell| cells[cell as usize];
        let value = match *instruction {
            Instruction::Sum { start, products, .. } => {
                let start = start.map_or(Dual::constant(0.0), at);
                let products = program.products(products).iter();
                products.fold(start, |sum, &Product { factors: [a, b], subtracts }| {
                    let product = at(a) * at(b);
                    if subtracts { sum - product } else { sum + product }
                })
            }
            Instruction::Quotient { of, by, .. } => at(of) * at(by).reciprocal(),
            Instruction::SquareRoot { of, .. } => at(of).sqrt(),
            Instruction::Size { of, .. } if at(of).value > 0.0 => at(of),
            Instruction::Size { of, .. } => -at(of),
            Instruction::Choice { less: [a, b], then, other, .. } => {
                at(if at(a).value < at(b).value { then } else { other })
            }
            Instruction::SineCosine { sine, of, .. } => {
                let (of_sine, of_cosine) = at(of).sin_cos();
                cells[sine as usize] = of_sine;
                of_cosine
            }
            Instruction::Function { function, of, .. } => at(of).function(function),
        };
        // The last cell that an instruction writes.
        if let Some(out) = instruction.writes().last() {
            cells[out as usize] = value;
        }
    }
}

#[test]
fn tangents_are_those_of_dual_numbers() {
    let simd = baseline();
    let mut random = ChaCha8Rng::seed_from_u64(18);
    let mut compared = 0;
    for number in 0..PROGRAMS / 4 {
        let program = program(&mut random);
        let inputs: Cell = 3;
        let along = tangent(&program, 0..inputs, 0..program.cells as Cell);
        let mut memory = vec![Lanes::splat(simd, 0.0); along.cells];
        let mut dual = vec![Dual::constant(0.0); program.cells];
        for cell in 0..program.cells {
            let value = random.random_range(-2.0..2.0);
            let slope = if (cell as Cell) < inputs { random.random_range(-2.0..2.0) } else { 0.0 };
            memory[cell] = Lanes::splat(simd, value);
            memory[cell + program.cells] = Lanes::splat(simd, slope);
            dual[cell] = Dual { value, slope };
        }
        for (cell, number) in program.numbers.iter().chain(along.numbers.iter()) {
            memory[*cell as usize] = Lanes::splat(simd, *number);
            if let Some(dual) = dual.get_mut(*cell as usize) {
                *dual = Dual::constant(*number);
            }
        }
        interpret(simd, &program, &mut memory);
        interpret(simd, &along, &mut memory);
        run_dual(&program, &mut dual);
        for cell in (0..program.cells).filter(|cell| along.kept[cell + program.cells]) {
            let [value, slope] = [cell, cell + program.cells].map(|cell| memory[cell][0]);
            let expected = dual[cell];
            // Rounding errors grow with the sizes of the terms.
            let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (1.0 + a.abs().max(b.abs()));
            if [value, slope, expected.slope].iter().all(|part| part.abs() < 1e6) {
                assert!(
                    is_near(value, expected.value) && is_near(slope, expected.slope),
                    "program {number}, cell {cell}: {slope} and {expected:?} {program:?}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 1000, "{compared}");
}
