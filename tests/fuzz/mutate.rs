//! Generates hostile inputs: corpus files damaged in a few places, and random bytes. The seed and the number of an input
//! determine it.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Length of the longest input, bytes.
const LONGEST: usize = 1 << 18;

/// Pieces of text to insert, between `¦`: extreme numbers, and syntax of YAML, CSV and JSON.
const PIECES: &str = "0¦-1¦1¦9¦1e308¦-1e308¦1e-320¦1e15¦1e16¦0.1¦-0.0¦1e999¦18446744073709551615¦\
     9223372036854775808¦-9223372036854775808¦4294967296¦1000001¦1000000000000000¦NaN¦inf¦.nan¦\
     .inf¦~¦null¦true¦[]¦{}¦[¦]¦{¦}¦:¦: ¦- ¦\n¦\n  ¦&a ¦*a¦!!int ¦\"¦'¦#¦|¦>¦é¦\t¦? ¦<<: ¦,¦;¦\r¦\
     \0¦\u{feff}¦../¦/dev/zero¦table.csv¦---\n¦\\u0000";

fn pieces() -> Vec<&'static str> {
    PIECES.split('¦').collect()
}

/// Numbers to insert into binary files.
const NUMBERS: [u64; 16] = [
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
    0x7ff0_0000_0000_0000,
];

pub fn input(corpus: &[Vec<u8>], seed: u64, number: u64) -> Vec<u8> {
    let mut dice =
        Dice(ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ number));
    // The undamaged corpus comes first.
    if let Some(whole) = usize::try_from(number).ok().and_then(|number| corpus.get(number)) {
        return whole.clone();
    }
    if dice.below(40) == 0 {
        let length = dice.below(300);
        return (0..length).map(|_| dice.below(256) as u8).collect();
    }
    let mut bytes = dice.of(corpus).clone();
    let text = std::str::from_utf8(&bytes).is_ok();
    for _ in 0..=dice.below(4) * dice.below(2) {
        // A text with random damage is usually invalid UTF-8 and rejected early.
        if text && dice.below(4) > 0 {
            dice.edit(&mut bytes);
        } else {
            dice.damage(&mut bytes, corpus);
        }
    }
    bytes.truncate(LONGEST);
    bytes
}

struct Dice(ChaCha8Rng);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        (self.0.next_u64() % end.max(1) as u64) as usize
    }

    fn of<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// Returns two ordered positions in the bytes, usually near each other.
    fn range(&mut self, bytes: &[u8]) -> std::ops::Range<usize> {
        let start = self.below(bytes.len() + 1);
        let most = if self.below(8) == 0 { bytes.len() } else { 16 };
        let end = (start + self.below(most)).min(bytes.len());
        start..end
    }

    fn damage(&mut self, bytes: &mut Vec<u8>, corpus: &[Vec<u8>]) {
        let range = self.range(bytes);
        let at = range.start;
        match self.below(11) {
            // Flip a bit, or replace a byte.
            0 | 1 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            2 if at < bytes.len() => bytes[at] = self.below(256) as u8,
            // Truncate, or remove a part.
            3 => bytes.truncate(at),
            4 => drop(bytes.drain(range)),
            // Repeat a part once or many times.
            5 => {
                let times = 1 + if self.below(8) == 0 { self.below(64) } else { 0 };
                let piece = bytes[range].repeat(times);
                drop(bytes.splice(at..at, piece));
            }
            // Insert a part of another file, or append its end.
            6 => {
                let other = self.of(corpus);
                let range = self.range(other);
                drop(bytes.splice(at..at, other[range].iter().copied()));
            }
            7 => {
                let other = self.of(corpus);
                let from = self.below(other.len() + 1);
                bytes.truncate(at);
                bytes.extend(&other[from..]);
            }
            // Write an extreme number of one to eight bytes, or as a varint.
            8 => {
                let number = self.of(&NUMBERS).to_le_bytes();
                let width = *self.of(&[1, 2, 4, 8]);
                let end = (at + width).min(bytes.len());
                drop(bytes.splice(at..end, number[..width].iter().copied()));
            }
            9 => {
                let mut number = *self.of(&NUMBERS);
                let mut varint = Vec::new();
                while number > 0x7f {
                    varint.push(number as u8 | 0x80);
                    number >>= 7;
                }
                varint.push(number as u8);
                drop(bytes.splice(at..(at + 1).min(bytes.len()), varint));
            }
            // Replace some characters with a piece of text.
            _ => {
                let piece = self.of(&pieces()).bytes();
                drop(bytes.splice(range, piece));
            }
        }
    }

    /// Changes the numbers, words or lines of a text.
    fn edit(&mut self, bytes: &mut Vec<u8>) {
        let number = |byte: u8| byte.is_ascii_digit() || b".-+e".contains(&byte);
        let word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
        match self.below(8) {
            // Replace a number with an extreme or a small one.
            0..4 => {
                let Some(range) = self.run(bytes, number) else { return };
                let piece = match self.below(3) {
                    0 => self.of(&pieces()[..20]).to_string(),
                    1 => self.below(1000).to_string(),
                    _ => format!("{}e{}", self.below(20), self.below(8)),
                };
                drop(bytes.splice(range, piece.into_bytes()));
            }
            // Replace a word with another word of the file.
            4 => {
                let (Some(range), Some(other)) = (self.run(bytes, word), self.run(bytes, word))
                else {
                    return;
                };
                let piece = bytes[other].to_vec();
                drop(bytes.splice(range, piece));
            }
            // Duplicate, move or remove a line.
            choice => {
                let mut lines: Vec<Vec<u8>> =
                    bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
                if lines.is_empty() {
                    return;
                }
                let from = self.below(lines.len());
                let line = if choice == 5 { lines[from].clone() } else { lines.remove(from) };
                if choice < 7 {
                    let to = self.below(lines.len() + 1);
                    lines.insert(to, line);
                }
                *bytes = lines.concat();
            }
        }
    }

    /// Returns a random maximal range of bytes with the property `is`.
    fn run(&mut self, bytes: &[u8], is: impl Fn(u8) -> bool) -> Option<std::ops::Range<usize>> {
        let begins = |at: &usize| is(bytes[*at]) && (*at == 0 || !is(bytes[*at - 1]));
        let starts: Vec<usize> = (0..bytes.len()).filter(begins).collect();
        if starts.is_empty() {
            return None;
        }
        let start = *self.of(&starts);
        let length = bytes[start..].iter().take_while(|byte| is(**byte)).count();
        Some(start..start + length)
    }
}
