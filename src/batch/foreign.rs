//! Inputs that are no text of records, told by their first bytes.

use crate::{Error, Reason};

const UTF_16: &str = "save it as UTF-8, or turn it by iconv -f UTF-16 -t UTF-8";

/// First bytes, what they mean and the remedy.
const FOREIGN: [(&[u8], &str, &str); 8] = [
    (b"\xFF\xFE", "the text is UTF-16", UTF_16),
    (b"\xFE\xFF", "the text is UTF-16", UTF_16),
    (b"\x1F\x8B", "the input is packed by gzip", "unpack it: gunzip -c FILE | heelstrike batch ROBOT.urdf - ..."),
    (b"\x28\xB5\x2F\xFD", "the input is packed by zstd", "unpack it: zstdcat FILE | heelstrike batch ROBOT.urdf - ..."),
    (b"\xFD7zXZ\0", "the input is packed by xz", "unpack it: xzcat FILE | heelstrike batch ROBOT.urdf - ..."),
    (b"BZh", "the input is packed by bzip2", "unpack it: bzcat FILE | heelstrike batch ROBOT.urdf - ..."),
    (b"PK\x03\x04", "the input is a zip archive, as spreadsheets are", "unpack it, or save the sheet as CSV"),
    (b"PAR1", "the input is a Parquet file", "write it as CSV or NDJSON"),
];

/// Why an input that begins so is refused as a whole.
pub(super) fn foreign(beginning: &[u8]) -> Option<Error> {
    let (_, what, remedy) = FOREIGN.iter().find(|(magic, ..)| beginning.starts_with(magic))?;
    Some(Error::new(Reason::Unsupported((*what).into())).hint(*remedy))
}
