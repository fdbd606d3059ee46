//! What the readers of XML share.

use super::bytes::{EXPORT_AGAIN, malformed};
use crate::base::error::{Error, Place};
use quick_xml::events::BytesStart;
use quick_xml::{Reader, XmlVersion};
use std::borrow::Cow;

/// The value of an attribute of an element, by its name without a prefix.
pub(super) fn attribute(tag: &BytesStart, name: &str) -> Option<String> {
    let mut all = tag.attributes();
    let found = all.with_checks(false).flatten().find(|a| a.key.local_name().as_ref() == name)?;
    found.normalized_value(XmlVersion::Explicit1_0).ok().map(Cow::into_owned)
}

/// The error that the text is no XML.
pub(super) fn mistake(reader: &Reader<&[u8]>, error: &quick_xml::Error) -> Error {
    let cause = format!("not XML: {error}").replace(['\n', '\r'], " ");
    malformed(Place::Byte(reader.error_position() as usize), cause, EXPORT_AGAIN)
}
