//! Materials of a glTF file, with their textures and images.
//!
//! Read are the metallic-roughness model with its five textures, samplers, KHR_materials_unlit and KHR_texture_transform.
//! All other extensions are left out with a note, and so are textures that use other coordinates than TEXCOORD_0, and images
//! that are neither PNG nor JPEG. Images are copied without decoding.

use super::store::{Store, wrong};
use crate::base::error::{Place, Result};
use crate::io::bytes::malformed;
use crate::mesh::materials::{
    Alpha, Image, Look, Material, Materials, REPEAT, Sampler, Texture, Transform, Use, image_type,
};
use crate::mesh::topology::NONE;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap};

pub(super) const UNLIT: &str = "KHR_materials_unlit";
pub(super) const TRANSFORM: &str = "KHR_texture_transform";

/// Total size of images in buffer views, in bytes, that is allowed even if the file's buffers are smaller: several images
/// may use the same view.
const REPEATED: usize = 1 << 26;
/// Maximum total size of all images, in bytes: the size that a GLB file can hold.
const MOST: usize = u32::MAX as usize;

/// OpenGL constants that a sampler may have.
const MAG_FILTERS: [u64; 2] = [9728, 9729];
const MIN_FILTERS: [u64; 6] = [9728, 9729, 9984, 9985, 9986, 9987];
const WRAPS: [u64; 3] = [33_071, 33_648, 10_497];

/// The JSON lists of a file that describe its materials.
pub(super) struct Lists {
    pub materials: Value,
    pub textures: Value,
    pub samplers: Value,
    pub images: Value,
}

impl Lists {
    /// Number of materials.
    pub fn count(&self) -> usize {
        self.materials.as_array().map_or(0, Vec::len)
    }
}

/// Returns the materials that triangles use, in the order of the file, and notes on what is left out. `of_triangle` has the
/// index in the file of each triangle's material, which must exist, or [`NONE`].
///
/// # Errors
/// `Error::Format` with the material, texture or image that is malformed.
pub(super) fn read(lists: &Lists, store: &Store, of_triangle: &[u32]) -> Result<(Option<Materials>, Vec<String>)> {
    let used: BTreeSet<u32> = of_triangle.iter().copied().filter(|&m| m != NONE).collect();
    if used.is_empty() {
        return Ok((None, Vec::new()));
    }
    let mut reader = Reader {
        lists,
        store,
        images: Vec::new(),
        known: BTreeMap::new(),
        of_address: HashMap::new(),
        bytes: 0,
        notes: BTreeSet::new(),
    };
    let list = used.iter().map(|&m| reader.material(m as usize)).collect::<Result<Vec<Material>>>()?;
    let number: BTreeMap<u32, u32> = used.into_iter().zip(0..).collect();
    let of_triangle = of_triangle.iter().map(|m| number.get(m).copied().unwrap_or(NONE)).collect();
    let materials = Materials { libraries: Vec::new(), list, images: reader.images, of_triangle };
    Ok((Some(materials), reader.notes.into_iter().collect()))
}

struct Reader<'a, 's> {
    lists: &'a Lists,
    store: &'a Store<'s>,
    images: Vec<Image>,
    /// Index of each image of the file in `images`; `None` for an image that is left out.
    known: BTreeMap<usize, Option<u32>>,
    /// The same for images with an address, by that address.
    of_address: HashMap<&'a str, Option<u32>>,
    /// Total size of all images so far, in bytes.
    bytes: usize,
    notes: BTreeSet<String>,
}

impl Reader<'_, '_> {
    fn material(&mut self, index: usize) -> Result<Material> {
        let value = &self.lists.materials[index];
        let fail = |cause: String| wrong("material", index, cause);
        if !value.is_object() {
            return Err(fail("is not an object".into()));
        }
        let pbr = &value["pbrMetallicRoughness"];
        let alpha = match value["alphaMode"].as_str() {
            None | Some("OPAQUE") => Alpha::Opaque,
            Some("MASK") => Alpha::Mask(number(&value["alphaCutoff"], 0.5).map_err(fail)?.max(0.0)),
            Some("BLEND") => Alpha::Blend,
            Some(other) => return Err(fail(format!("has the unknown alpha mode '{}'", other.escape_debug()))),
        };
        let mut look = Look {
            base_color: numbers(&pbr["baseColorFactor"], [1.0; 4]).map_err(fail)?.map(share),
            metallic: share(number(&pbr["metallicFactor"], 1.0).map_err(fail)?),
            roughness: share(number(&pbr["roughnessFactor"], 1.0).map_err(fail)?),
            emissive: numbers(&value["emissiveFactor"], [0.0; 3]).map_err(fail)?.map(share),
            alpha,
            double_sided: value["doubleSided"].as_bool().unwrap_or(false),
            unlit: value["extensions"][UNLIT].is_object(),
            ..Look::default()
        };
        for (of, info, strength) in [
            (Use::BaseColor, &pbr["baseColorTexture"], ""),
            (Use::MetallicRoughness, &pbr["metallicRoughnessTexture"], ""),
            (Use::Normal, &value["normalTexture"], "scale"),
            (Use::Occlusion, &value["occlusionTexture"], "strength"),
            (Use::Emissive, &value["emissiveTexture"], ""),
        ] {
            if !info.is_null() {
                let strength = number(&info[strength], 1.0).map_err(fail)?;
                look.textures.extend(self.texture(index, of, info, strength)?);
            }
        }
        self.note_extensions(&value["extensions"], UNLIT, "materials");
        let name = value["name"].as_str().unwrap_or_default().into();
        Ok(Material { name, look: Some(look) })
    }

    /// Returns the texture that `info` of material `material` refers to; `None` if it is left out.
    fn texture(&mut self, material: usize, of: Use, info: &Value, strength: f64) -> Result<Option<Texture>> {
        let fail = |cause: String| wrong("material", material, cause);
        let index = entry(&info["index"], &self.lists.textures, "texture").map_err(fail)?;
        let extension = &info["extensions"][TRANSFORM];
        let transform = extension.is_object().then(|| transform(extension)).transpose().map_err(fail)?;
        let coordinates = extension["texCoord"].as_u64().or(info["texCoord"].as_u64()).unwrap_or(0);
        self.note_extensions(&info["extensions"], TRANSFORM, "textures");
        if coordinates != 0 {
            self.notes.insert(format!("textures that use TEXCOORD_{coordinates} are left out"));
            return Ok(None);
        }
        let texture = &self.lists.textures[index];
        if texture["source"].is_null() {
            self.notes.insert("textures without a PNG or JPEG image are left out".into());
            return Ok(None);
        }
        let fail = |cause: String| wrong("texture", index, cause);
        let source = entry(&texture["source"], &self.lists.images, "image").map_err(fail)?;
        let sampler = match &texture["sampler"] {
            Value::Null => Sampler::default(),
            number => sampler(&self.lists.samplers[entry(number, &self.lists.samplers, "sampler").map_err(fail)?]),
        };
        let image = self.image(source)?;
        Ok(image.map(|image| Texture { of, image, strength, sampler, transform }))
    }

    fn image(&mut self, index: usize) -> Result<Option<u32>> {
        let address = self.lists.images[index]["uri"].as_str();
        let known = self.known.get(&index).or_else(|| self.of_address.get(address?));
        if let Some(known) = known {
            return Ok(*known);
        }
        let bytes = self.image_bytes(index)?.filter(|bytes| {
            let is_known = image_type(bytes).is_some();
            if !is_known {
                self.notes.insert(format!("image {index} is left out: it is neither PNG nor JPEG"));
            }
            is_known
        });
        let number = bytes.map(|bytes| {
            self.images.push(Image::Bytes(bytes.into()));
            self.images.len() as u32 - 1
        });
        self.known.insert(index, number);
        self.of_address.extend(address.map(|address| (address, number)));
        Ok(number)
    }

    /// Returns the content of an image; `None` if it cannot be read.
    fn image_bytes(&mut self, index: usize) -> Result<Option<Vec<u8>>> {
        let image = &self.lists.images[index];
        let fail = |cause: &str| wrong("image", index, cause);
        match (image["uri"].as_str(), &image["bufferView"]) {
            (Some(uri), _) => match self.store.file(uri) {
                Ok(bytes) => self.within(MOST, index, &bytes).map(Some),
                Err(cause) => {
                    self.notes.insert(format!("image {index} is left out: {cause}"));
                    Ok(None)
                }
            },
            (None, Value::Null) => Err(fail("has no data")),
            (None, view) => {
                let view = view.as_u64().and_then(|view| usize::try_from(view).ok());
                let (bytes, _) = self.store.view(view.ok_or_else(|| fail("its buffer view is not a number"))?)?;
                self.within(REPEATED.max(self.store.loaded()), index, bytes).map(Some)
            }
        }
    }

    /// Returns a copy of the `bytes` of image `index`, unless the images so far exceed `most` bytes with it.
    fn within(&mut self, most: usize, index: usize, bytes: &[u8]) -> Result<Vec<u8>> {
        self.bytes = self.bytes.saturating_add(bytes.len());
        if self.bytes > most {
            let cause = "the images are too large together: they share their data, or there are too many";
            return Err(malformed(Place::Part(format!("image {index}")), cause, "export every image once"));
        }
        Ok(bytes.to_vec())
    }

    /// Adds a note for each of the `extensions` of materials or textures except the one that is read.
    fn note_extensions(&mut self, extensions: &Value, read: &str, of: &str) {
        let others = extensions.as_object().into_iter().flat_map(|e| e.keys()).filter(|name| *name != read);
        self.notes.extend(others.map(|name| format!("the extension {name} of {of} is left out")));
    }
}

/// Returns `index` as a number, if `list` has an entry with this index.
fn entry(index: &Value, list: &Value, kind: &str) -> std::result::Result<usize, String> {
    let count = list.as_array().map_or(0, Vec::len);
    let number = index.as_u64().and_then(|i| usize::try_from(i).ok());
    number.filter(|&i| i < count).ok_or_else(|| format!("uses {kind} {index}, but there are only {count}"))
}

fn number(value: &Value, default: f64) -> std::result::Result<f64, String> {
    if value.is_null() { Ok(default) } else { value.as_f64().ok_or_else(|| format!("{value} is not a number")) }
}

fn numbers<const N: usize>(value: &Value, default: [f64; N]) -> std::result::Result<[f64; N], String> {
    if value.is_null() {
        return Ok(default);
    }
    let numbers: Option<Vec<f64>> = value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| format!("has a factor that is not {N} numbers"))
}

/// Clamps a factor to the range 0 to 1, which applies to all factors except the strengths of textures.
fn share(factor: f64) -> f64 {
    factor.clamp(0.0, 1.0)
}

fn transform(value: &Value) -> std::result::Result<Transform, String> {
    Ok(Transform {
        offset: numbers(&value["offset"], [0.0; 2])?,
        rotation: number(&value["rotation"], 0.0)?,
        scale: numbers(&value["scale"], [1.0; 2])?,
    })
}

/// Returns a sampler. Values that glTF does not define are ignored.
fn sampler(value: &Value) -> Sampler {
    let one_of = |key: &str, known: &[u64]| value[key].as_u64().filter(|n| known.contains(n)).map(|n| n as u32);
    Sampler {
        mag_filter: one_of("magFilter", &MAG_FILTERS),
        min_filter: one_of("minFilter", &MIN_FILTERS),
        wrap: ["wrapS", "wrapT"].map(|key| one_of(key, &WRAPS).unwrap_or(REPEAT)),
    }
}
