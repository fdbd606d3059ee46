//! What triangles look like, as plain data: materials modelled on those of glTF, the images that they use, and the
//! statements of an OBJ material library as they were.

use std::sync::Arc;

/// Which material each triangle has.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Materials {
    /// The files that define materials and were not read, as the file that was read names them.
    pub libraries: Vec<String>,
    /// All materials.
    pub list: Vec<Material>,
    /// The images that they use.
    pub images: Vec<Image>,
    /// The number of each triangle's material; [`NONE`](super::topology::NONE) for a triangle without one.
    pub of_triangle: Vec<u32>,
}

/// A material.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Material {
    /// Its name, which may be empty.
    pub name: String,
    /// What it looks like; `None` if that is defined in a file that was not read.
    pub look: Option<Look>,
}

impl Material {
    /// A material of which only the name is known.
    pub fn named(name: &str) -> Material {
        Material { name: name.into(), look: None }
    }
}

/// What a material looks like, in the quantities of glTF.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// Red, green, blue, opacity, each from 0 to 1 and linear.
    pub base_color: [f64; 4],
    /// From 0 to 1.
    pub metallic: f64,
    /// From 0 to 1.
    pub roughness: f64,
    /// Red, green, blue of the light that it emits, each from 0 to 1 and linear.
    pub emissive: [f64; 3],
    /// What the opacity means.
    pub alpha: Alpha,
    /// Whether its back is visible.
    pub double_sided: bool,
    /// Whether its colour is seen as it is, without any light.
    pub unlit: bool,
    /// At most one for each use.
    pub textures: Vec<Texture>,
    /// The statements of an OBJ material library that say all this; empty for a material from elsewhere.
    pub statements: Vec<Statement>,
}

impl Default for Look {
    /// The default values of glTF.
    fn default() -> Look {
        Look {
            base_color: [1.0; 4],
            metallic: 1.0,
            roughness: 1.0,
            emissive: [0.0; 3],
            alpha: Alpha::Opaque,
            double_sided: false,
            unlit: false,
            textures: Vec::new(),
            statements: Vec::new(),
        }
    }
}

/// What the opacity of a material means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Alpha {
    /// Nothing.
    Opaque,
    /// Visible where the opacity is at least this.
    Mask(f64),
    /// How much it covers.
    Blend,
}

/// What an image is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Use {
    BaseColor,
    MetallicRoughness,
    Normal,
    Occlusion,
    Emissive,
}

/// An image on a surface, placed by its texture coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// What it is for.
    pub of: Use,
    /// The number of its image.
    pub image: u32,
    /// Scale of normals or strength of occlusion; 1 for all others.
    pub strength: f64,
    /// How it is sampled.
    pub sampler: Sampler,
    /// How texture coordinates are transformed first.
    pub transform: Option<Transform>,
}

/// How an image is sampled, by the OpenGL constants that glTF uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// The filter where it is enlarged.
    pub mag_filter: Option<u32>,
    /// The filter where it is reduced.
    pub min_filter: Option<u32>,
    /// What follows beyond its sides, horizontally and vertically.
    pub wrap: [u32; 2],
}

/// The constant for images that repeat.
pub const REPEAT: u32 = 10_497;

impl Default for Sampler {
    fn default() -> Sampler {
        Sampler { mag_filter: None, min_filter: None, wrap: [REPEAT; 2] }
    }
}

/// An affine transform of texture coordinates, as in KHR_texture_transform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Added last.
    pub offset: [f64; 2],
    /// In radians.
    pub rotation: f64,
    /// Multiplied first.
    pub scale: [f64; 2],
}

/// A statement of an OBJ material library.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// Its words, without the name of an image.
    pub words: String,
    /// The number of the image whose name ends it.
    pub image: Option<u32>,
}

/// An image.
#[derive(Debug, Clone, PartialEq)]
pub enum Image {
    /// The content of a PNG or JPEG file.
    Bytes(Arc<[u8]>),
    /// The path of a file, relative to the file that names it until that file's folder is known.
    File(String),
}

/// The media type and the file extension of an image, by its content: PNG or JPEG, since glTF has no others.
pub fn image_type(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some(("image/png", "png")),
        [0xff, 0xd8, 0xff, ..] => Some(("image/jpeg", "jpg")),
        _ => None,
    }
}
