//! Random numbers by name: a draw depends only on master seed, kind, name, cell and replicate.
//!
//! Each (seed, kind, name) keys a ChaCha8 generator through SHA-256; the cell selects its stream,
//! and the replicate selects the position in the stream. No draw depends on another draw, so a
//! larger sample, a further sweep value or a further uncertain parameter changes no existing draw.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sha2::{Digest, Sha256};

/// Domain tag of the draws; another tag would give other values for the same seed.
const TAG: &[u8] = b"stickslip draw 1";

/// The key of all draws for one name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DrawKey([u8; 32]);

impl DrawKey {
    /// Creates the key for a kind of draw, such as `monte_carlo`, and a name, such as `beta_1`.
    pub fn new(seed: u64, kind: &str, name: &str) -> DrawKey {
        let mut digest = Sha256::new();
        for part in [TAG, &seed.to_le_bytes(), kind.as_bytes(), name.as_bytes()] {
            digest.update((part.len() as u64).to_le_bytes());
            digest.update(part);
        }
        DrawKey(digest.finalize().into())
    }

    /// Returns 64 random bits.
    pub fn bits(&self, cell: u64, replicate: u64) -> u64 {
        let mut generator = ChaCha8Rng::from_seed(self.0);
        generator.set_stream(cell);
        generator.set_word_pos(2 * u128::from(replicate));
        generator.next_u64()
    }

    /// Returns a uniform number strictly between zero and one: a multiple of 2^-52 plus 2^-53.
    pub fn uniform(&self, cell: u64, replicate: u64) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 52) as f64;
        ((self.bits(cell, replicate) >> 12) as f64 + 0.5) * STEP
    }
}

/// A random permutation of `0..length`, computed entry by entry without a table.
///
/// A Feistel network permutes the next larger power of four. Values outside the range pass through
/// the network again until they fall inside ("cycle walking"; J. Black and P. Rogaway, "Ciphers
/// with arbitrary finite domains", CT-RSA 2002).
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RandomOrder {
    length: u64,
    half_bits: u32,
    round_keys: [u64; 8],
}

impl RandomOrder {
    /// Creates the permutation for a key; `length` is at least one.
    pub fn new(key: &DrawKey, length: u64) -> RandomOrder {
        let bits = u64::BITS - length.saturating_sub(1).leading_zeros();
        let mut round_keys = [0; 8];
        for (round, round_key) in (0..).zip(&mut round_keys) {
            *round_key = key.bits(0, round);
        }
        RandomOrder { length, half_bits: bits.div_ceil(2).max(1), round_keys }
    }

    /// Returns the entry at `index`, which must be below the length.
    pub fn at(&self, index: u64) -> u64 {
        let mut value = index;
        loop {
            value = self.permute(value);
            if value < self.length {
                return value;
            }
        }
    }

    fn permute(&self, value: u64) -> u64 {
        let mask = (1_u64 << self.half_bits) - 1;
        let (mut left, mut right) = (value >> self.half_bits, value & mask);
        for round_key in self.round_keys {
            (left, right) = (right, left ^ (mix(right ^ round_key) & mask));
        }
        (left << self.half_bits) | right
    }
}

/// Returns a pseudo-random number that depends only on `number`.
pub(crate) fn mixed(number: u64) -> u64 {
    mix(number.wrapping_add(0x9e37_79b9_7f4a_7c15))
}

/// The finaliser of SplitMix64 (G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014, doi:10.1145/2660193.2660195).
fn mix(bits: u64) -> u64 {
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
