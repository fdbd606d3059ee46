//! Materials as glTF JSON, and their images as views of its buffer.

use super::materials::{TRANSFORM, UNLIT};
use crate::mesh::materials::{Alpha, Image, Look, Material, Materials, Sampler, Texture, Use, image_type};
use serde_json::{Map, Value, json};
use std::collections::{HashMap, HashSet};

/// The JSON lists of a file that describe its materials.
#[derive(Default)]
pub(super) struct Written {
    materials: Vec<Value>,
    textures: Vec<Value>,
    samplers: Vec<Value>,
    images: Vec<Value>,
    extensions: Vec<&'static str>,
    /// Index of the texture for an image and a sampler, and the samplers so far.
    texture_numbers: HashMap<(usize, usize), usize>,
    sampler_numbers: HashMap<Sampler, usize>,
    /// Index of each image of the mesh in `images`, if it is written.
    image_numbers: Vec<Option<usize>>,
}

impl Written {
    /// Converts all materials, with textures if there are `coordinates` for them. `store` puts an image into the buffer and
    /// returns the index of its view. Images in files are left out.
    pub fn new(materials: &Materials, coordinates: bool, mut store: impl FnMut(&[u8]) -> usize) -> Written {
        let mut written = Written { image_numbers: vec![None; materials.images.len()], ..Written::default() };
        if coordinates {
            written.add_images(materials, &mut store);
        }
        for material in &materials.list {
            let material = written.material(material);
            written.materials.push(material);
        }
        written
    }

    /// Puts the lists that are not empty into the JSON of a file.
    pub fn put(self, root: &mut Value) {
        let extensions = self.extensions.into_iter().map(Value::from).collect();
        for (key, list) in [
            ("materials", self.materials),
            ("textures", self.textures),
            ("samplers", self.samplers),
            ("images", self.images),
            ("extensionsUsed", extensions),
        ] {
            if !list.is_empty() {
                root[key] = list.into();
            }
        }
    }

    fn add_images(&mut self, of: &Materials, store: &mut dyn FnMut(&[u8]) -> usize) {
        let looks = of.list.iter().filter_map(|m| m.look.as_ref());
        let used: HashSet<u32> = looks.flat_map(|look| &look.textures).map(|texture| texture.image).collect();
        for (i, image) in of.images.iter().enumerate().filter(|(i, _)| used.contains(&(*i as u32))) {
            let Image::Bytes(bytes) = image else { continue };
            let Some((kind, _)) = image_type(bytes) else { continue };
            self.image_numbers[i] = Some(self.images.len());
            self.images.push(json!({ "bufferView": store(bytes), "mimeType": kind }));
        }
    }

    fn material(&mut self, material: &Material) -> Value {
        // For a material known only by name.
        let usual = Look { metallic: 0.0, ..Look::default() };
        let look = material.look.as_ref().unwrap_or(&usual);
        let mut pbr = json!({
            "baseColorFactor": look.base_color, "metallicFactor": look.metallic, "roughnessFactor": look.roughness,
        });
        let mut value = json!({});
        for texture in &look.textures {
            let Some((key, info)) = self.info(texture) else { continue };
            let place = if key.starts_with("base") || key.starts_with("metallic") { &mut pbr } else { &mut value };
            place[key] = info;
        }
        value["pbrMetallicRoughness"] = pbr;
        if !material.name.is_empty() {
            value["name"] = material.name.clone().into();
        }
        if look.emissive != [0.0; 3] {
            value["emissiveFactor"] = json!(look.emissive);
        }
        match look.alpha {
            Alpha::Opaque => {}
            Alpha::Mask(cutoff) => {
                value["alphaMode"] = "MASK".into();
                value["alphaCutoff"] = cutoff.into();
            }
            Alpha::Blend => value["alphaMode"] = "BLEND".into(),
        }
        if look.double_sided {
            value["doubleSided"] = true.into();
        }
        if look.unlit {
            value["extensions"] = json!({ UNLIT: {} });
            self.uses(UNLIT);
        }
        value
    }

    /// Returns the key of a texture in its material, and the value for that key.
    fn info(&mut self, texture: &Texture) -> Option<(&'static str, Value)> {
        let image = self.image_numbers.get(texture.image as usize).copied().flatten()?;
        let (key, strength) = match texture.of {
            Use::BaseColor => ("baseColorTexture", None),
            Use::MetallicRoughness => ("metallicRoughnessTexture", None),
            Use::Normal => ("normalTexture", Some("scale")),
            Use::Occlusion => ("occlusionTexture", Some("strength")),
            Use::Emissive => ("emissiveTexture", None),
        };
        let mut info = json!({ "index": self.texture(image, texture) });
        if let Some(name) = strength.filter(|_| texture.strength != 1.0) {
            info[name] = texture.strength.into();
        }
        if let Some(t) = texture.transform {
            let change = json!({ "offset": t.offset, "rotation": t.rotation, "scale": t.scale });
            info["extensions"] = json!({ TRANSFORM: change });
            self.uses(TRANSFORM);
        }
        Some((key, info))
    }

    /// Returns the index of the texture for this image, with the sampler of `texture`.
    fn texture(&mut self, image: usize, texture: &Texture) -> usize {
        let sampler = self.sampler(texture.sampler);
        let textures = &mut self.textures;
        *self.texture_numbers.entry((image, sampler)).or_insert_with(|| {
            textures.push(json!({ "source": image, "sampler": sampler }));
            textures.len() - 1
        })
    }

    fn sampler(&mut self, sampler: Sampler) -> usize {
        let samplers = &mut self.samplers;
        *self.sampler_numbers.entry(sampler).or_insert_with(|| {
            let [across, up] = sampler.wrap;
            let mut value = Map::from_iter([("wrapS".into(), across.into()), ("wrapT".into(), up.into())]);
            value.extend(sampler.mag_filter.map(|filter| ("magFilter".into(), filter.into())));
            value.extend(sampler.min_filter.map(|filter| ("minFilter".into(), filter.into())));
            samplers.push(value.into());
            samplers.len() - 1
        })
    }

    fn uses(&mut self, extension: &'static str) {
        if !self.extensions.contains(&extension) {
            self.extensions.push(extension);
        }
    }
}
