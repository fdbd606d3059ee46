//! Functions shared by the readers of XML.

use super::bytes::{EXPORT_AGAIN, malformed};
use crate::base::error::{Error, Place};
use quick_xml::events::BytesStart;
use quick_xml::{Reader, XmlVersion};
use std::borrow::Cow;

/// Returns the value of an element's attribute, by its name without a prefix.
pub(super) fn attribute(tag: &BytesStart, name: &str) -> Option<String> {
    let mut all = tag.attributes();
    let found = all.with_checks(false).flatten().find(|a| a.key.local_name().as_ref() == name)?;
    found.normalized_value(XmlVersion::Explicit1_0).ok().map(Cow::into_owned)
}

/// Returns the error that the text is not XML.
pub(super) fn mistake(reader: &Reader<&[u8]>, error: &quick_xml::Error) -> Error {
    let cause = format!("not XML: {error}").replace(['\n', '\r'], " ");
    malformed(Place::Byte(reader.error_position() as usize), cause, EXPORT_AGAIN)
}
