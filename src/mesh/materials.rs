//! The appearance of triangles as plain data: materials modelled on those of glTF, the images that they use, and the
//! unchanged statements of an OBJ material library.

use std::sync::Arc;

/// The materials of a mesh and their assignment to triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Materials {
    /// The files that define materials but were not read, as named in the file that was read.
    pub libraries: Vec<String>,
    /// All materials.
    pub list: Vec<Material>,
    /// The images that the materials use.
    pub images: Vec<Image>,
    /// The material number of each triangle; [`NONE`](super::topology::NONE) for a triangle without material.
    pub of_triangle: Vec<u32>,
}

/// A material.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Material {
    /// Its name, which may be empty.
    pub name: String,
    /// Its appearance; `None` if this is defined in a file that was not read.
    pub look: Option<Look>,
}

impl Material {
    /// A material of which only the name is known.
    pub fn named(name: &str) -> Material {
        Material { name: name.into(), look: None }
    }
}

/// The appearance of a material, in the quantities of glTF.
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
    /// The meaning of the opacity.
    pub alpha: Alpha,
    /// Whether its back is visible.
    pub double_sided: bool,
    /// Whether its colour is shown as is, without any lighting.
    pub unlit: bool,
    /// Textures, at most one for each use.
    pub textures: Vec<Texture>,
    /// The equivalent statements of an OBJ material library; empty for a material from elsewhere.
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

/// The meaning of a material's opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Alpha {
    /// The opacity is ignored.
    Opaque,
    /// The material is visible where the opacity is at least this value.
    Mask(f64),
    /// The opacity is the degree of coverage.
    Blend,
}

/// The purpose of an image.
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
    /// Its purpose.
    pub of: Use,
    /// The number of its image.
    pub image: u32,
    /// Scale of normals or strength of occlusion; 1 for all other uses.
    pub strength: f64,
    /// How it is sampled.
    pub sampler: Sampler,
    /// A transform that is applied to the texture coordinates first.
    pub transform: Option<Transform>,
}

/// How an image is sampled, by the OpenGL constants that glTF uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// The magnification filter.
    pub mag_filter: Option<u32>,
    /// The minification filter.
    pub min_filter: Option<u32>,
    /// The wrap mode beyond the sides of the image, horizontally and vertically.
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
    /// The translation, which is applied last.
    pub offset: [f64; 2],
    /// The rotation in radians.
    pub rotation: f64,
    /// The scale, which is applied first.
    pub scale: [f64; 2],
}

/// A statement of an OBJ material library.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// Its words, without the name of an image.
    pub words: String,
    /// The number of the image whose name ends the statement.
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

/// Returns the media type and file extension of an image according to its content: PNG or JPEG, since glTF has no others.
pub fn image_type(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some(("image/png", "png")),
        [0xff, 0xd8, 0xff, ..] => Some(("image/jpeg", "jpg")),
        _ => None,
    }
}
