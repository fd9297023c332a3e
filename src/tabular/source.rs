//! A Parquet file as the Parquet library reads it: its footer, and its bytes in bounds.

use std::fs::File;
use std::io::Cursor;
use std::sync::{Mutex, MutexGuard, PoisonError};

use bytes::Bytes;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::reader::{ChunkReader, Length};

use super::error::Fault;
use super::guard::guarded;
use super::thrift;
use super::unpack::MAX_PAGE_BYTES;

/// The largest footer, bytes: one with a study in it that is as large as studies may be.
const MAX_FOOTER_BYTES: usize = 96 * 1024 * 1024;
/// The largest header of a page, bytes.
const MAX_HEADER_BYTES: u64 = 16 * 1024;

/// At the beginning and at the end of a file.
const MAGIC: &[u8; 4] = b"PAR1";

/// Where the bytes of a file are.
pub(super) enum Place {
    Memory(Bytes),
    Disk(File),
}

impl Place {
    fn length(&self) -> u64 {
        match self {
            Place::Memory(bytes) => bytes.len() as u64,
            Place::Disk(file) => file.len(),
        }
    }

    /// So many bytes from a place on.
    fn read(&self, start: u64, length: usize) -> Result<Bytes, Fault> {
        let end = start.checked_add(length as u64);
        if end.is_none_or(|end| end > self.length()) {
            return Err(Fault::damaged("a part that lies outside of the file"));
        }
        let read = match self {
            Place::Memory(bytes) => bytes.get_bytes(start, length),
            Place::Disk(file) => file.get_bytes(start, length),
        };
        read.map_err(|error| Fault::damaged(&error.to_string()))
    }

    /// What the footer says.
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
            let allowed = format!("at most {MAX_FOOTER_BYTES} bytes about the file");
            let found = format!("a footer of {length} bytes");
            return Err(Fault::new("too large a footer", found, allowed));
        }
        let start = end.checked_sub(length as u64);
        let start = start.ok_or_else(|| Fault::damaged("a footer that is longer than the file"))?;
        let bytes = self.read(start, length)?;
        thrift::check_footer(&bytes)?;
        let metadata = guarded(|| ParquetMetaDataReader::decode_metadata(&bytes))?;
        metadata.map_err(|error| Fault::damaged(&error.to_string()))
    }
}

/// A Parquet file, and what is known of it.
pub(super) struct Source {
    place: Place,
    /// What its footer says.
    pub metadata: ParquetMetaData,
    /// To how many bytes its pages may still unpack.
    left: Mutex<u64>,
    /// What was wrong, as the library passes on texts only.
    fault: Mutex<Option<Fault>>,
}

/// Nothing panics while something is locked here.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Source {
    /// Reads the footer of a file.
    ///
    /// # Errors
    /// Where there is none, where it is too large or damaged, or columns are too deep.
    pub fn new(place: Place) -> Result<Source, Fault> {
        let metadata = place.footer()?;
        Ok(Source { place, metadata, left: Mutex::new(0), fault: Mutex::new(None) })
    }

    /// Allows its pages to unpack to so many bytes from now on.
    pub fn allow(&self, bytes: u64) {
        *locked(&self.left) = bytes;
    }

    /// Counts a page of so many bytes.
    ///
    /// # Errors
    /// Where there have been more than are allowed.
    pub fn pay(&self, bytes: u64) -> Result<(), Fault> {
        let mut left = locked(&self.left);
        let allowed = "what so many rows and columns need";
        let too_large =
            || Fault::new("the file is too large when unpacked", "pages of more bytes", allowed);
        *left = left.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }

    /// Keeps what is wrong while the library passes on a text.
    pub fn refuse(&self, fault: Fault) -> ParquetError {
        let text = ParquetError::General(fault.problem.clone());
        *locked(&self.fault) = Some(fault);
        text
    }

    /// What was wrong: in our words where we have refused something, the library's otherwise.
    pub fn fault(&self, said: &str) -> Fault {
        locked(&self.fault).take().unwrap_or_else(|| Fault::damaged(said))
    }
}

impl Length for Source {
    fn len(&self) -> u64 {
        self.place.length()
    }
}

impl ChunkReader for Source {
    type T = Cursor<Bytes>;

    /// The header of a page: nothing else is read in this way.
    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        let rest = self.len().saturating_sub(start).min(MAX_HEADER_BYTES);
        let bytes = self.get_bytes(start, usize::try_from(rest).unwrap_or(0))?;
        let length = thrift::page_header(&bytes).map_err(|fault| self.refuse(fault))?;
        Ok(Cursor::new(bytes.slice(..length)))
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        if length > MAX_PAGE_BYTES {
            let found = format!("a page of {length} bytes");
            let allowed = format!("pages of at most {MAX_PAGE_BYTES} bytes");
            return Err(self.refuse(Fault::new("the file is too large", found, allowed)));
        }
        self.place.read(start, length).map_err(|fault| self.refuse(fault))
    }
}
