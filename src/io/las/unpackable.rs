//! Stand-in for compressed points, for builds that cannot decompress them.

use super::header::Header;
use crate::base::error::{Place, Result};
use crate::io::bytes::malformed;
use crate::prepare::thin::{Levels, Wanted};
use std::io::{Read, Seek};

#[cfg(feature = "fs")]
pub(super) const CAN_UNPACK: bool = false;

pub(super) fn unpack<R: Read + Seek + Send + Sync>(
    _: R,
    _: &Header,
    _: &Wanted,
    _: &mut dyn FnMut(usize, &[u8]) -> Result<()>,
) -> Result<Option<Levels>> {
    let cause = "the points are compressed (LAZ), and this program was built without the feature laz";
    Err(malformed(Place::Whole, cause, "decompress it to LAS, or build with that feature"))
}
