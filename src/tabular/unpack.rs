//! Decompresses Parquet pages up to a size limit.

use std::io::Read;

use flate2::read::MultiGzDecoder;
use lz4_flex::block::{DecompressError, decompress_into};
use parquet::basic::{Compression, CompressionCodec};
use ruzstd::decoding::StreamingDecoder;

use super::error::Fault;

/// The largest page, compressed or decompressed, bytes.
pub(super) const MAX_PAGE_BYTES: usize = 16 * 1024 * 1024;

/// Decompresses `packed` and appends the result to `unpacked`.
pub(super) fn unpack(
    packed: &[u8],
    compression: Compression,
    unpacked: &mut Vec<u8>,
) -> Result<(), Fault> {
    let whole = match compression {
        Compression::SNAPPY => match snap::raw::decompress_len(packed) {
            Ok(length) if length > MAX_PAGE_BYTES => return Err(too_large(length)),
            Ok(_) => snap::raw::Decoder::new().decompress_vec(packed).is_ok_and(|bytes| {
                unpacked.extend(bytes);
                true
            }),
            Err(_) => false,
        },
        Compression::LZ4_RAW => lz4(packed, unpacked)?,
        Compression::GZIP(_) => fill(MultiGzDecoder::new(packed), unpacked),
        Compression::ZSTD(_) => {
            StreamingDecoder::new(packed).is_ok_and(|decoder| fill(decoder, unpacked))
        }
        other => {
            let allowed =
                "ZSTD, SNAPPY, GZIP, LZ4_RAW (`compression=\"lz4\"` in many programs), or none";
            let problem = "unsupported compression";
            // The codec without its level.
            let found = format!("compression {:?}", CompressionCodec::from(other));
            return Err(Fault::new(problem, found, allowed));
        }
    };
    match whole {
        true if unpacked.len() > MAX_PAGE_BYTES => Err(too_large(unpacked.len())),
        true => Ok(()),
        false => Err(Fault::damaged("a page that cannot be decompressed")),
    }
}

/// Reads to the end, or past the size of the largest page. Returns whether no error occurred.
fn fill(reader: impl Read, unpacked: &mut Vec<u8>) -> bool {
    reader.take(MAX_PAGE_BYTES as u64 + 1).read_to_end(unpacked).is_ok()
}

/// Decompresses a block of LZ4, which does not contain its decompressed size. Each byte expands to at most 255 bytes.
fn lz4(packed: &[u8], unpacked: &mut Vec<u8>) -> Result<bool, Fault> {
    let levels = unpacked.len();
    for times in [4, 32, 256] {
        let room = packed.len().saturating_mul(times).min(MAX_PAGE_BYTES);
        unpacked.resize(levels + room, 0);
        match decompress_into(packed, &mut unpacked[levels..]) {
            Ok(length) => {
                unpacked.truncate(levels + length);
                return Ok(true);
            }
            Err(DecompressError::OutputTooSmall { .. }) if room == MAX_PAGE_BYTES => {
                return Err(too_large(room + 1));
            }
            Err(DecompressError::OutputTooSmall { .. }) => {}
            Err(_) => return Ok(false),
        }
    }
    Ok(false)
}

fn too_large(bytes: usize) -> Fault {
    let found = format!("a page of {bytes} bytes or more");
    let allowed = format!("pages of at most {MAX_PAGE_BYTES} bytes");
    Fault::new("the file is too large when decompressed", found, allowed)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::write::GzEncoder;
    use parquet::basic::{Compression, GzipLevel, ZstdLevel};

    use super::{MAX_PAGE_BYTES, unpack};

    /// Returns a Zstandard frame of one repeated byte: each four bytes expand to 128 kB.
    fn zstd(blocks: usize) -> Vec<u8> {
        let block = |last: usize| {
            let header = (128 << 10) << 3 | 1 << 1 | last;
            [&header.to_le_bytes()[..3], b"x"].concat()
        };
        let head = [0x28, 0xb5, 0x2f, 0xfd, 0, 0x58];
        [head.to_vec(), block(0).repeat(blocks - 1), block(1)].concat()
    }

    fn gzip(bytes: usize) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(&vec![b'x'; bytes]).unwrap();
        encoder.finish().unwrap()
    }

    /// Returns an LZ4 block of one repeated byte: each byte expands to 255, and the last five are literal.
    fn lz4(bytes: usize) -> Vec<u8> {
        let rest = bytes - 1 - 4 - 15 - 5;
        let mut block = vec![0x1f, b'x', 1, 0];
        block.extend(vec![255; rest / 255]);
        block.extend([(rest % 255) as u8, 0x50]);
        block.extend([b'x'; 5]);
        block
    }

    #[test]
    fn pages_above_the_size_limit_are_refused() {
        let snappy =
            |bytes: usize| snap::raw::Encoder::new().compress_vec(&vec![b'x'; bytes]).unwrap();
        let (gz, zst) = (GzipLevel::default(), ZstdLevel::default());
        let (most, block) = (MAX_PAGE_BYTES, 128 << 10);
        for (compression, right, bomb) in [
            (Compression::ZSTD(zst), zstd(most / block), zstd(100_000)),
            (Compression::GZIP(gz), gzip(most), gzip(8 * most)),
            (Compression::LZ4_RAW, lz4(most), lz4(8 * most)),
            (Compression::SNAPPY, snappy(most), snappy(8 * most)),
        ] {
            let mut unpacked = Vec::new();
            unpack(&right, compression, &mut unpacked).unwrap();
            assert!(unpacked.len() == most && unpacked.iter().all(|byte| *byte == b'x'));
            let mut unpacked = Vec::new();
            let fault = unpack(&bomb, compression, &mut unpacked).unwrap_err();
            assert!(
                fault.problem.contains("too large when decompressed"),
                "{compression}: {fault:?}"
            );
            assert!(unpacked.capacity() <= 4 * most, "{compression}: {}", unpacked.capacity());
            for damaged in [&right[..right.len() - 1], b"", b"x"] {
                assert!(unpack(damaged, compression, &mut Vec::new()).is_err(), "{compression}");
            }
        }
    }
}
