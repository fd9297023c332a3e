//! Checks the lengths of the texts in a Parquet page before the Parquet library allocates memory for them.
//!
//! In the delta encodings the library (parquet 60.1) allocates memory for as many texts as the page announces: for a file of
//! 189 bytes it fills 4 GiB, and for one of 185 bytes the allocation of 32 GiB fails, which ends the process. It copies a
//! shared prefix into every text that begins with it, and a text of a dictionary for every row that refers to it: 1024 rows
//! with the same text of 16 MB take 4 GiB. `tests/fuzz/hostile.rs` has such files.

use parquet::basic::Encoding;

use super::error::Fault;
use super::thrift::{signed, varint};

/// The longest text, bytes.
pub(super) const MAX_TEXT_BYTES: usize = 16 * 1024;

/// Checks that a page contains at most `most` encoded texts and none longer than [`MAX_TEXT_BYTES`].
pub(super) fn check_texts(encoding: Encoding, bytes: &[u8], most: usize) -> Result<(), Fault> {
    let damaged = || Fault::damaged("a page that ends before its last text");
    let check = |length: i64| match usize::try_from(length) {
        Err(_) => Err(damaged()),
        Ok(length) if length <= MAX_TEXT_BYTES => Ok(()),
        Ok(length) => {
            let allowed = format!("at most {MAX_TEXT_BYTES} bytes");
            Err(Fault::new("the text is too long", format!("{length} bytes"), allowed))
        }
    };
    match encoding {
        Encoding::PLAIN => {
            let mut rest = bytes;
            for _ in 0..most {
                let Some((length, after)) = rest.split_first_chunk() else { break };
                let length = u32::from_le_bytes(*length);
                check(length.into())?;
                rest = after.get(length as usize..).ok_or_else(damaged)?;
            }
            Ok(())
        }
        Encoding::DELTA_LENGTH_BYTE_ARRAY => {
            let (lengths, _) = differences(bytes, most).ok_or_else(damaged)?;
            lengths.into_iter().try_for_each(check)
        }
        Encoding::DELTA_BYTE_ARRAY => {
            let (same, used) = differences(bytes, most).ok_or_else(damaged)?;
            let (suffixes, _) = differences(&bytes[used..], most).ok_or_else(damaged)?;
            let mut lengths = same.iter().zip(&suffixes);
            lengths.try_for_each(|(same, suffix)| check(same.saturating_add(*suffix)))
        }
        // Indices into a dictionary, whose texts have been checked.
        _ => Ok(()),
    }
}

/// Decodes numbers in the encoding DELTA_BINARY_PACKED. Returns them and the length of their encoding in bytes, or `None` if
/// they are damaged or more than `most`.
fn differences(bytes: &[u8], most: usize) -> Option<(Vec<i64>, usize)> {
    let mut used = 0;
    let number = |used: &mut usize| {
        let (value, length) = varint(bytes.get(*used..)?)?;
        *used += length;
        Some(value)
    };
    let small = |value| i32::try_from(signed(value)).ok();
    let size = |used: &mut usize| usize::try_from(number(used)?).ok();
    let (block, parts, count) = (size(&mut used)?, size(&mut used)?, size(&mut used)?);
    let mut last = small(number(&mut used)?)?;
    let part = block.checked_div(parts)?;
    if count > most || part == 0 || !part.is_multiple_of(32) {
        return None;
    }
    let mut numbers = Vec::with_capacity(count);
    numbers.extend((count > 0).then_some(i64::from(last)));
    while numbers.len() < count {
        let least = small(number(&mut used)?)?;
        let widths = bytes.get(used..used.checked_add(parts)?)?;
        used += parts;
        for width in widths.iter().map(|width| usize::from(*width)) {
            if numbers.len() == count {
                break;
            }
            let length = width.checked_mul(part)? / 8;
            let packed = bytes.get(used..used.checked_add(length)?).filter(|_| width <= 32)?;
            used += length;
            for index in 0..part.min(count - numbers.len()) {
                let bit = |bit: usize| u32::from(packed[bit / 8] >> (bit % 8) & 1);
                let step = (0..width).fold(0, |step, k| step | bit(index * width + k) << k);
                last = last.wrapping_add(least).wrapping_add(step as i32);
                numbers.push(i64::from(last));
            }
        }
    }
    Some((numbers, used))
}
