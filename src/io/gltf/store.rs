//! Buffers, views and accessors of a glTF file. Every range is checked: an impossible one gives an error that names the
//! part, and no memory is reserved on the word of a count.

use crate::base::error::{Error, Place, Result};
use crate::io::base64;
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, array, malformed};
use crate::io::content::Resolve;
use crate::mesh::attributes::Scalar;
use ::gltf::json::accessor::{Accessor, ComponentType, Type, sparse::Sparse};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Root, buffer::View};
use glam::DVec3;
use std::borrow::Cow;
use std::cell::OnceCell;

/// Maximum number of elements per stored element of an accessor that consists of zeros with exceptions.
const SPARSITY: u64 = 64;
/// Number of elements that such an accessor may have in any case.
const FEW: u64 = 1 << 16;

/// Extensions that compress meshes, and the remedy.
pub(super) const COMPRESSIONS: [&str; 3] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];
pub(super) const DECOMPRESS: &str =
    "decompress it with `gltf-transform copy IN OUT.glb`, or export it without compression";

/// The data of a file. Buffers are fetched when they are first needed, so that those used only by textures may never be.
pub(super) struct Store<'a> {
    root: &'a Root,
    /// Binary chunk of a GLB file.
    bin: Option<&'a [u8]>,
    resolve: Resolve<'a>,
    buffers: Vec<OnceCell<Cow<'a, [u8]>>>,
}

/// The elements of an accessor.
pub(super) struct Vectors {
    /// Numbers per element.
    pub components: usize,
    pub scalar: Scalar,
    pub values: Vec<f64>,
}

/// Returns the error that part number `index` of its kind is wrong because of `cause`.
pub(super) fn wrong(kind: &str, index: usize, cause: impl Into<String>) -> Error {
    malformed(Place::Part(format!("{kind} {index}")), cause, EXPORT_AGAIN)
}

impl<'a> Store<'a> {
    pub fn new(root: &'a Root, bin: Option<&'a [u8]>, resolve: Resolve<'a>) -> Self {
        let buffers = root.buffers.iter().map(|_| OnceCell::new()).collect();
        Store { root, bin, resolve, buffers }
    }

    /// Total size of all buffers fetched so far, in bytes.
    pub fn loaded(&self) -> usize {
        self.buffers.iter().filter_map(OnceCell::get).map(|b| b.len()).sum()
    }

    /// Reads the positions of accessor `index`. Integers are used as they are, or as fractions of their range if the
    /// accessor is normalized.
    pub fn positions(&self, index: usize) -> Result<Vec<DVec3>> {
        let accessor = self.accessor(index)?;
        let read = match (component(accessor), shape(accessor)) {
            (Some(component), Some(Type::Vec3)) => reader(component, accessor.normalized),
            _ => None,
        };
        let Some((size, read)) = read else {
            return Err(wrong("accessor", index, "these are not positions of three floats, bytes or shorts each"));
        };
        let position = |b: &[u8]| DVec3::new(read(b, 0), read(b, size), read(b, 2 * size));
        let positions = self.decode(index, accessor, 3 * size, position)?;
        match positions.iter().position(|p| !p.is_finite()) {
            Some(i) => Err(wrong("accessor", index, format!("position {i} is not finite"))),
            None => Ok(positions),
        }
    }

    /// Reads the elements of accessor `index`. Numbers that are normalized become fractions, unless the attribute is `raw`;
    /// all others are returned as stored.
    pub fn vectors(&self, index: usize, raw: bool) -> Result<Vectors> {
        let accessor = self.accessor(index)?;
        let components = match shape(accessor) {
            Some(Type::Scalar) => Some(1),
            Some(Type::Vec2) => Some(2),
            Some(Type::Vec3) => Some(3),
            Some(Type::Vec4) => Some(4),
            _ => None,
        };
        let normalized = accessor.normalized && !raw;
        let kind = component(accessor).and_then(|c| Some((scalar(c, normalized)?, reader(c, normalized)?)));
        let Some((components, (scalar, (size, read)))) = components.zip(kind) else {
            return Err(wrong("accessor", index, "these are not values of up to four floats, bytes or shorts each"));
        };
        let row = |b: &[u8]| [0, 1, 2, 3].map(|k| if k < components { read(b, k * size) } else { 0.0 });
        let rows = self.decode(index, accessor, components * size, row)?;
        let values = rows.iter().flat_map(|row| &row[..components]).copied().collect();
        Ok(Vectors { components, scalar, values })
    }

    /// Reads the indices in accessor `index`, each of which must be less than `vertices`.
    pub fn indices(&self, index: usize, vertices: usize) -> Result<Vec<u32>> {
        let accessor = self.accessor(index)?;
        let read = component(accessor).filter(|_| shape(accessor) == Some(Type::Scalar)).and_then(index_reader);
        let Some((size, read)) = read else {
            return Err(wrong("accessor", index, "the indices are not unsigned integers"));
        };
        let indices = self.decode(index, accessor, size, read)?;
        match indices.iter().position(|&v| v as usize >= vertices) {
            Some(i) => {
                let cause = format!("index {i} refers to vertex {}, but there are only {vertices}", indices[i]);
                Err(wrong("accessor", index, cause))
            }
            None => Ok(indices),
        }
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor> {
        self.root.accessors.get(index).ok_or_else(|| wrong("accessor", index, "does not exist"))
    }

    /// Reads all elements of an accessor, each of `size` bytes.
    fn decode<T: Copy>(
        &self,
        index: usize,
        accessor: &Accessor,
        size: usize,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        let fail = |cause: String| wrong("accessor", index, cause);
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                self.rows(view.value(), offset, accessor.count.0, size, &fail)?.map(&read).collect()
            }
            None => zeros(accessor, read(&[0; 16])).ok_or_else(|| self.without_data(index))?,
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace(sparse, &mut values, size, read, &fail)?;
        }
        Ok(values)
    }

    /// Returns the error that an accessor has no data. In compressed files they are elsewhere.
    fn without_data(&self, index: usize) -> Error {
        match self.root.extensions_used.iter().find(|name| COMPRESSIONS.contains(&name.as_str())) {
            Some(name) => {
                let cause = format!("its data are compressed with {name}, which is not supported");
                malformed(Place::Part(format!("accessor {index}")), cause, DECOMPRESS)
            }
            None => wrong("accessor", index, "has no data"),
        }
    }

    /// Writes the exceptions of a sparse accessor to their places.
    fn replace<T>(
        &self,
        sparse: &Sparse,
        values: &mut [T],
        size: usize,
        read: impl Fn(&[u8]) -> T,
        fail: &dyn Fn(String) -> Error,
    ) -> Result<()> {
        let Checked::Valid(kind) = &sparse.indices.component_type else {
            return Err(fail("the sparse indices are not unsigned integers".into()));
        };
        let Some((width, read_index)) = index_reader(kind.0) else {
            return Err(fail("the sparse indices are not unsigned integers".into()));
        };
        let (at, with) = (&sparse.indices, &sparse.values);
        let places = self.rows(at.buffer_view.value(), at.byte_offset.0, sparse.count.0, width, fail)?;
        let rows = self.rows(with.buffer_view.value(), with.byte_offset.0, sparse.count.0, size, fail)?;
        let count = values.len();
        for (place, row) in places.map(read_index).zip(rows) {
            let cause = || fail(format!("a sparse value is for element {place}, but there are only {count}"));
            *values.get_mut(place as usize).ok_or_else(cause)? = read(row);
        }
        Ok(())
    }

    /// Returns `count` rows of `size` bytes of a view, from `offset` on.
    fn rows(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
        fail: &dyn Fn(String) -> Error,
    ) -> Result<impl Iterator<Item = &[u8]>> {
        let (bytes, stride) = self.view(view)?;
        let stride = stride.filter(|&s| s > 0).unwrap_or(size);
        if stride < size {
            return Err(fail(format!("elements of {size} bytes overlap at a stride of {stride} bytes")));
        }
        let needed = if count == 0 { 0 } else { (u128::from(count) - 1) * stride as u128 + size as u128 };
        let bytes = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..));
        let fits = bytes.filter(|bytes| needed <= bytes.len() as u128);
        let bytes = fits.ok_or_else(|| fail(format!("{count} elements are more than buffer view {view} holds")))?;
        // The last row may lack the gap after it.
        Ok(bytes.chunks(stride).take(count as usize).map(move |row| &row[..size]))
    }

    /// Returns the bytes of a view and its stride.
    pub fn view(&self, index: usize) -> Result<(&[u8], Option<usize>)> {
        let fail = |cause: &str| wrong("buffer view", index, cause);
        let view: &View = self.root.buffer_views.get(index).ok_or_else(|| fail("does not exist"))?;
        let buffer = self.buffer(view.buffer.value())?;
        let begin = view.byte_offset.unwrap_or_default().0;
        let end = begin.checked_add(view.byte_length.0);
        let range = usize::try_from(begin).ok().zip(end.and_then(|end| usize::try_from(end).ok()));
        let bytes = range.and_then(|(begin, end)| buffer.get(begin..end));
        let bytes = bytes.ok_or_else(|| fail(&format!("reaches beyond buffer {}", view.buffer.value())))?;
        Ok((bytes, view.byte_stride.map(|s| s.0)))
    }

    /// Returns the bytes of a buffer, exactly as many as the file declares.
    fn buffer(&self, index: usize) -> Result<&[u8]> {
        let Some((cell, buffer)) = self.buffers.get(index).zip(self.root.buffers.get(index)) else {
            return Err(wrong("buffer", index, "does not exist"));
        };
        let bytes = match cell.get() {
            Some(bytes) => bytes,
            None => {
                let bytes = self.fetch(index, buffer.uri.as_deref())?;
                cell.get_or_init(|| bytes)
            }
        };
        let wanted = buffer.byte_length.0;
        usize::try_from(wanted).ok().and_then(|length| bytes.get(..length)).ok_or_else(|| {
            let cause = format!("{wanted} bytes are declared, but only {} are there", bytes.len());
            malformed(Place::Part(format!("buffer {index}")), cause, CUT_SHORT)
        })
    }

    fn fetch(&self, index: usize, uri: Option<&str>) -> Result<Cow<'a, [u8]>> {
        let Some(uri) = uri else {
            let bin = self.bin.filter(|_| index == 0);
            return bin.map(Cow::Borrowed).ok_or_else(|| wrong("buffer", index, "has no data"));
        };
        self.file(uri).map_err(|cause| {
            let remedy = "keep the buffers of a glTF file beside it, or export it as GLB";
            malformed(Place::Part(format!("buffer {index}")), cause, remedy)
        })
    }

    /// Returns the bytes at an address: embedded in it, or in another file. The error is a sentence that says what went
    /// wrong.
    pub fn file(&self, uri: &str) -> std::result::Result<Cow<'a, [u8]>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let text = data.split_once(',').filter(|(kind, _)| kind.ends_with(";base64")).map(|(_, text)| text);
            let bytes = text.and_then(base64::decode).ok_or("the data in its URI are not base64")?;
            return Ok(Cow::Owned(bytes));
        }
        (self.resolve)(uri).map(Cow::Owned)
    }
}

/// Returns the base values of a sparse accessor without a view of its own.
fn zeros<T: Copy>(accessor: &Accessor, zero: T) -> Option<Vec<T>> {
    let sparse = accessor.sparse.as_ref()?;
    let count = accessor.count.0;
    // More exceptions than elements do not make more elements plausible.
    let stored = sparse.count.0.min(count);
    (count <= FEW || count / SPARSITY <= stored && stored <= u64::from(u32::MAX) / SPARSITY)
        .then(|| vec![zero; count as usize])
}

fn component(accessor: &Accessor) -> Option<ComponentType> {
    match &accessor.component_type {
        Checked::Valid(kind) => Some(kind.0),
        Checked::Invalid => None,
    }
}

fn shape(accessor: &Accessor) -> Option<Type> {
    match accessor.type_ {
        Checked::Valid(shape) => Some(shape),
        Checked::Invalid => None,
    }
}

/// Returns the scalar type of numbers as they are read; `None` for a type that attributes must not have.
fn scalar(component: ComponentType, normalized: bool) -> Option<Scalar> {
    Some(match component {
        _ if normalized => Scalar::F32,
        ComponentType::I8 => Scalar::I8,
        ComponentType::U8 => Scalar::U8,
        ComponentType::I16 => Scalar::I16,
        ComponentType::U16 => Scalar::U16,
        ComponentType::F32 => Scalar::F32,
        ComponentType::U32 => return None,
    })
}

type ReadCoordinate = fn(&[u8], usize) -> f64;
type ReadIndex = fn(&[u8]) -> u32;

/// Returns the size of a coordinate in bytes, and a function that reads one. Rows must have been checked to be long enough.
fn reader(component: ComponentType, normalized: bool) -> Option<(usize, ReadCoordinate)> {
    let read: ReadCoordinate = match (component, normalized) {
        (ComponentType::F32, _) => |b, at| array(b, at).map_or(f32::NAN, f32::from_le_bytes).into(),
        (ComponentType::I8, false) => |b, at| (b[at] as i8).into(),
        (ComponentType::U8, false) => |b, at| b[at].into(),
        (ComponentType::I16, false) => |b, at| array(b, at).map_or(0, i16::from_le_bytes).into(),
        (ComponentType::U16, false) => |b, at| array(b, at).map_or(0, u16::from_le_bytes).into(),
        (ComponentType::I8, true) => |b, at| (f64::from(b[at] as i8) / 127.0).max(-1.0),
        (ComponentType::U8, true) => |b, at| f64::from(b[at]) / 255.0,
        (ComponentType::I16, true) => {
            |b, at| (f64::from(array(b, at).map_or(0, i16::from_le_bytes)) / 32767.0).max(-1.0)
        }
        (ComponentType::U16, true) => |b, at| f64::from(array(b, at).map_or(0, u16::from_le_bytes)) / 65535.0,
        (ComponentType::U32, _) => return None,
    };
    Some((component.size(), read))
}

/// Returns the size of an index in bytes, and a function that reads one.
fn index_reader(component: ComponentType) -> Option<(usize, ReadIndex)> {
    let read: ReadIndex = match component {
        ComponentType::U8 => |b| b[0].into(),
        ComponentType::U16 => |b| array(b, 0).map_or(0, u16::from_le_bytes).into(),
        ComponentType::U32 => |b| array(b, 0).map_or(0, u32::from_le_bytes),
        _ => return None,
    };
    Some((component.size(), read))
}
