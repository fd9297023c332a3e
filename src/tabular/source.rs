//! Gives the Parquet library bounded access to the footer and the pages of a file.

use std::fs::File;
use std::io::Cursor;
use std::sync::{Mutex, MutexGuard, PoisonError};

use bytes::Bytes;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::reader::{ChunkReader, Length};

use super::error::{Fault, guarded};
use super::thrift;
use super::unpack::MAX_PAGE_BYTES;

/// The largest footer, bytes: room for the largest allowed study.
const MAX_FOOTER_BYTES: usize = 96 * 1024 * 1024;
/// The largest header of a page, bytes.
const MAX_HEADER_BYTES: u64 = 16 * 1024;

/// The bytes at the beginning and at the end of a Parquet file.
const MAGIC: &[u8; 4] = b"PAR1";

/// The location of a file's bytes.
pub(super) enum ByteLocation {
    Memory(Bytes),
    Disk(File),
}

impl ByteLocation {
    fn length(&self) -> u64 {
        match self {
            ByteLocation::Memory(bytes) => bytes.len() as u64,
            ByteLocation::Disk(file) => file.len(),
        }
    }

    /// Reads `length` bytes from the position `start`.
    fn read(&self, start: u64, length: usize) -> Result<Bytes, Fault> {
        let end = start.checked_add(length as u64);
        if end.is_none_or(|end| end > self.length()) {
            return Err(Fault::damaged("a part outside the file"));
        }
        let read = match self {
            ByteLocation::Memory(bytes) => bytes.get_bytes(start, length),
            ByteLocation::Disk(file) => file.get_bytes(start, length),
        };
        read.map_err(|error| Fault::damaged(&error.to_string()))
    }

    /// Reads and checks the footer.
    fn footer(&self) -> Result<ParquetMetaData, Fault> {
        let foreign = || Fault::damaged("a file that does not begin and end with PAR1");
        let end = self.length().checked_sub(8).filter(|end| *end >= 4).ok_or_else(foreign)?;
        let (head, tail) = (self.read(0, 4)?, self.read(end, 8)?);
        let Some((length, magic)) = tail.split_first_chunk() else { return Err(foreign()) };
        if head != MAGIC[..] || magic != MAGIC {
            return Err(foreign());
        }
        let length = u32::from_le_bytes(*length) as usize;
        if length > MAX_FOOTER_BYTES {
            let allowed = format!("a footer of at most {MAX_FOOTER_BYTES} bytes");
            let found = format!("a footer of {length} bytes");
            return Err(Fault::new("the footer is too large", found, allowed));
        }
        let start = end.checked_sub(length as u64);
        let start = start.ok_or_else(|| Fault::damaged("a footer that is longer than the file"))?;
        let bytes = self.read(start, length)?;
        thrift::check_footer(&bytes)?;
        let metadata = guarded(|| ParquetMetaDataReader::decode_metadata(&bytes))?;
        metadata.map_err(|error| Fault::damaged(&error.to_string()))
    }
}

/// A Parquet file with its decoded footer.
pub(super) struct ParquetSource {
    place: ByteLocation,
    /// The decoded footer.
    pub metadata: ParquetMetaData,
    /// The decompressed size that further pages may have, bytes.
    budget: Mutex<u64>,
    /// The first fault; the library reports errors only as text.
    fault: Mutex<Option<Fault>>,
}

/// Locks a mutex; no code here panics while it holds a lock.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ParquetSource {
    /// Reads the footer of a file.
    pub fn new(place: ByteLocation) -> Result<ParquetSource, Fault> {
        let metadata = place.footer()?;
        Ok(ParquetSource { place, metadata, budget: Mutex::new(0), fault: Mutex::new(None) })
    }

    /// Sets the decompressed size that the pages may have in total from now on, bytes.
    pub fn set_budget(&self, bytes: u64) {
        *locked(&self.budget) = bytes;
    }

    /// Subtracts the size of a page from the budget.
    pub fn charge(&self, bytes: u64) -> Result<(), Fault> {
        let mut budget = locked(&self.budget);
        let allowed = "the size that this number of rows and columns needs";
        let too_large =
            || Fault::new("the file is too large when decompressed", "larger pages", allowed);
        *budget = budget.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }

    /// Stores a fault and returns the library's error with its text.
    pub fn store(&self, fault: Fault) -> ParquetError {
        let text = ParquetError::General(fault.problem.clone());
        *locked(&self.fault) = Some(fault);
        text
    }

    /// Returns the stored fault, or one with the library's message if none is stored.
    pub fn fault(&self, message: &str) -> Fault {
        locked(&self.fault).take().unwrap_or_else(|| Fault::damaged(message))
    }
}

impl Length for ParquetSource {
    fn len(&self) -> u64 {
        self.place.length()
    }
}

impl ChunkReader for ParquetSource {
    type T = Cursor<Bytes>;

    /// Returns the header of a page; the library reads only page headers with this function.
    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        let rest = self.len().saturating_sub(start).min(MAX_HEADER_BYTES);
        let bytes = self.get_bytes(start, usize::try_from(rest).unwrap_or(0))?;
        let length = thrift::page_header(&bytes).map_err(|fault| self.store(fault))?;
        Ok(Cursor::new(bytes.slice(..length)))
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        if length > MAX_PAGE_BYTES {
            let found = format!("a page of {length} bytes");
            let allowed = format!("pages of at most {MAX_PAGE_BYTES} bytes");
            return Err(self.store(Fault::new("the file is too large", found, allowed)));
        }
        self.place.read(start, length).map_err(|fault| self.store(fault))
    }
}
