//! The layout of a chunk of finished runs.

use std::fs;

use stickslip::engine::{Chunk, ChunkFault};

use crate::cli::support::{AT_ONCE, Scratch, study_text};

/// Length of a chunk's header, and of the header of each run.
const HEAD: usize = 16 + 4 + 4 + 64;
const RUN_HEAD: usize = 8 + 16 + 4;

/// Returns a chunk with three runs, as the program writes it.
fn three_runs() -> Vec<u8> {
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, ""));
    fs::read(scratch.chunks("out").join("000000.chunk")).expect("a chunk")
}

/// Returns the offsets at which the header and each run end.
fn ends(bytes: &[u8]) -> Vec<usize> {
    let mut ends = vec![HEAD];
    while let Some(length) = bytes.get(ends[ends.len() - 1] + RUN_HEAD - 4..) {
        let Some(length) = length.first_chunk() else { break };
        ends.push(ends[ends.len() - 1] + RUN_HEAD + u32::from_le_bytes(*length) as usize);
    }
    ends
}

#[test]
fn no_beginning_of_a_chunk_is_another_chunk() {
    let bytes = three_runs();
    let chunk = Chunk::parse(bytes.clone()).unwrap();
    assert_eq!(chunk.run_ids().collect::<Vec<_>>(), [0, 1, 2]);
    assert_eq!(chunk.study_hash.len(), 64);
    let ends = ends(&bytes);
    assert_eq!((ends.len(), ends[3]), (4, bytes.len()));
    for length in 0..bytes.len() {
        let parsed = Chunk::parse(bytes[..length].to_vec());
        assert_eq!(parsed.is_ok(), ends.contains(&length), "{length}: {parsed:?}");
    }
    assert!(Chunk::parse(bytes[..HEAD].to_vec()).expect("a sound head").run_ids().next().is_none());
}

#[test]
fn faults_are_named() {
    let bytes = three_runs();
    let parsed = |offset: usize, value: u8| {
        let mut bytes = bytes.clone();
        bytes[offset] = value;
        Chunk::parse(bytes).unwrap_err()
    };
    assert_eq!(parsed(0, 0), ChunkFault::Foreign);
    assert!(matches!(parsed(16, 9), ChunkFault::Version { format: 9, .. }));
    // The first run gets the number of the second one.
    assert_eq!(parsed(HEAD, 1), ChunkFault::Order { run_id: 1 });
    // The first outcome gets a length beyond the end of the chunk.
    assert_eq!(parsed(HEAD + RUN_HEAD - 1, 255), ChunkFault::Torn { at: HEAD });
}
