//! Material libraries (MTL). Statements are kept verbatim, and some are interpreted for other formats.
//!
//! Interpreted are `Kd d Tr Ke Ns Pm Pr` and the images `map_Kd map_Ke norm`. A material with an image of colours gets a
//! white base colour.

use super::write::plain;
use crate::io::text::number;
use crate::mesh::materials::{Alpha, Image, Look, Material, Materials, Sampler, Statement, Texture, Use};
use std::collections::{HashMap, HashSet};
use std::io::{self, Write};

/// Statements that end with the name of an image, besides those that begin with `map_`.
const MAPS: [&str; 5] = ["bump", "disp", "decal", "refl", "norm"];

/// Options of such a statement that may have several values, and how many at most; numbers only.
const LONG_OPTIONS: [(&str, usize); 4] = [("-mm", 2), ("-o", 3), ("-s", 3), ("-t", 3)];

/// Content of a library.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Library {
    /// Looks by material name. Images in them are indices of `images`.
    pub looks: Vec<(String, Look)>,
    /// Names of images, as the library has them.
    pub images: Vec<String>,
    /// Index of each name.
    numbers: HashMap<String, u32>,
}

/// Reads a library. Comments and everything before the first material are left out.
pub(crate) fn parse(bytes: &[u8]) -> Library {
    let text = String::from_utf8_lossy(bytes);
    let mut library = Library::default();
    for line in text.lines().map(|line| line.split('#').next().unwrap_or_default().trim()) {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if keyword == "newmtl" {
            let look = Look { metallic: 0.0, ..Look::default() };
            library.looks.push((rest.split_whitespace().collect::<Vec<_>>().join(" "), look));
        } else if !keyword.is_empty() {
            library.statement(keyword, rest, line);
        }
    }
    library
}

impl Library {
    fn statement(&mut self, keyword: &str, rest: &str, line: &str) {
        let Some((_, look)) = self.looks.last_mut() else { return };
        let lower = keyword.to_ascii_lowercase();
        let is_map = lower.starts_with("map_") && lower != "map_aat" || MAPS.contains(&lower.as_str());
        let (options, name) = if is_map { options(rest) } else { ("", "") };
        if name.is_empty() {
            understand(look, &lower, rest);
            look.statements.push(Statement { words: line.into(), image: None });
            return;
        }
        let images = &mut self.images;
        let image = *self.numbers.entry(name.into()).or_insert_with(|| {
            images.push(name.into());
            images.len() as u32 - 1
        });
        let words = if options.is_empty() { keyword.into() } else { format!("{keyword} {options}") };
        look.statements.push(Statement { words, image: Some(image) });
        let of = match lower.as_str() {
            "map_kd" => Use::BaseColor,
            "map_ke" => Use::Emissive,
            "norm" => Use::Normal,
            _ => return,
        };
        look.textures.retain(|texture| texture.of != of);
        look.textures.push(Texture { of, image, strength: 1.0, sampler: Sampler::default(), transform: None });
        match of {
            Use::BaseColor => look.base_color[..3].fill(1.0),
            Use::Emissive => look.emissive = [1.0; 3],
            _ => {}
        }
    }
}

/// Applies a statement without an image to a look, if it is one of those that are interpreted.
fn understand(look: &mut Look, keyword: &str, rest: &str) {
    let numbers: Vec<f64> =
        rest.split_whitespace().map_while(|word| number(word.as_bytes())).filter(|x| x.is_finite()).collect();
    let Some(&first) = numbers.first() else { return };
    // A single number stands for all three.
    let three = [0, 1, 2].map(|k| numbers.get(k).unwrap_or(&first).clamp(0.0, 1.0));
    let has = |of: Use| look.textures.iter().any(|texture| texture.of == of);
    match keyword {
        "kd" if !has(Use::BaseColor) => look.base_color[..3].copy_from_slice(&three),
        "ke" if !has(Use::Emissive) => look.emissive = three,
        "d" | "tr" => {
            let opacity = if keyword == "d" { first } else { 1.0 - first }.clamp(0.0, 1.0);
            look.base_color[3] = opacity;
            look.alpha = if opacity < 1.0 { Alpha::Blend } else { Alpha::Opaque };
        }
        "pm" => look.metallic = first.clamp(0.0, 1.0),
        "pr" => look.roughness = first.clamp(0.0, 1.0),
        // The roughness whose highlight is about as wide as that of this exponent.
        "ns" => look.roughness = (2.0 / (first.max(0.0) + 2.0)).sqrt(),
        _ => {}
    }
}

/// Splits a statement that ends with the name of an image into its options and that name, which may have spaces.
fn options(text: &str) -> (&str, &str) {
    let mut rest = text;
    while rest.starts_with('-') {
        let (option, after) = word(rest);
        rest = after;
        let long = LONG_OPTIONS.iter().find(|(name, _)| *name == option);
        for given in 0..long.map_or(1, |(_, most)| *most) {
            let (value, after) = word(rest);
            if long.is_some() && given > 0 && number(value.as_bytes()).is_none() {
                break;
            }
            rest = after;
        }
    }
    (text[..text.len() - rest.len()].trim_end(), rest)
}

/// Returns the first word, and the text after it.
fn word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// Gives each material a unique name that is valid in a library.
pub(crate) fn name_apart(list: &mut [Material]) {
    let mut taken = HashSet::new();
    for (material, number) in list.iter_mut().zip(1..) {
        let name = plain(&material.name);
        let name = if name.is_empty() { format!("material-{number}") } else { name };
        material.name = if taken.contains(&name) { format!("{name}-{number}") } else { name };
        taken.insert(material.name.clone());
    }
}

/// Writes a library of all materials that have a look. Only images that are files are written.
pub(crate) fn write(materials: &Materials, out: &mut dyn Write) -> io::Result<()> {
    let file = |image: u32| match materials.images.get(image as usize) {
        Some(Image::File(name)) => Some(name),
        _ => None,
    };
    for Material { name, look } in &materials.list {
        let Some(look) = look else { continue };
        writeln!(out, "newmtl {}", plain(name))?;
        let own = if look.statements.is_empty() { statements(look) } else { look.statements.clone() };
        for Statement { words, image } in &own {
            match image {
                None => writeln!(out, "{words}")?,
                Some(image) => file(*image).map_or(Ok(()), |name| writeln!(out, "{words} {name}"))?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Returns the library statements for a look of another origin.
fn statements(look: &Look) -> Vec<Statement> {
    let ([r, g, b, opacity], [er, eg, eb]) = (look.base_color, look.emissive);
    let mut all = vec![format!("Kd {r} {g} {b}"), format!("Pr {}", look.roughness), format!("Pm {}", look.metallic)];
    if look.alpha == Alpha::Blend {
        all.push(format!("d {opacity}"));
    }
    if look.emissive != [0.0; 3] {
        all.push(format!("Ke {er} {eg} {eb}"));
    }
    let image = |texture: &Texture| {
        let words = match texture.of {
            Use::BaseColor => "map_Kd",
            Use::Emissive => "map_Ke",
            Use::Normal => "norm",
            Use::MetallicRoughness | Use::Occlusion => return None,
        };
        Some(Statement { words: words.into(), image: Some(texture.image) })
    };
    let plain = all.into_iter().map(|words| Statement { words, image: None });
    plain.chain(look.textures.iter().filter_map(image)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIBRARY: &str = "# a library\nKd 9 9 9\nnewmtl a  red\nKd 0.5 0.25 0\r\nd 0.5\nillum 2\n\n\
                           newmtl wood\nKd 0 0 0\nmap_Kd -s 2 2 -clamp on my wood.png\nmap_Bump -bm 0.3 bump.png\n";

    #[test]
    fn libraries_are_understood_as_far_as_other_formats_need() {
        let Library { looks, images, .. } = parse(LIBRARY.as_bytes());
        assert_eq!(images, ["my wood.png", "bump.png"]);
        let [(red_name, red), (wood_name, wood)] = &looks[..] else { panic!("{looks:?}") };
        assert_eq!((red_name.as_str(), wood_name.as_str()), ("a red", "wood"));
        assert_eq!((red.base_color, red.alpha), ([0.5, 0.25, 0.0, 0.5], Alpha::Blend));
        assert_eq!((wood.base_color, wood.textures.len(), wood.textures[0].of), ([1.0; 4], 1, Use::BaseColor));
        assert_eq!(parse(b"\xff\nmap_Kd\n"), Library::default());
    }

    #[test]
    fn statements_come_back_as_they_were() {
        let Library { looks, images, .. } = parse(LIBRARY.as_bytes());
        let list = looks.into_iter().map(|(name, look)| Material { name, look: Some(look) }).collect();
        let images = images.into_iter().map(|name| Image::File(format!("../{name}"))).collect();
        let mut text = Vec::new();
        write(&Materials { list, images, ..Materials::default() }, &mut text).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "newmtl a red\nKd 0.5 0.25 0\nd 0.5\nillum 2\n\nnewmtl wood\nKd 0 0 0\n\
             map_Kd -s 2 2 -clamp on ../my wood.png\nmap_Bump -bm 0.3 ../bump.png\n\n"
        );
    }

    #[test]
    fn names_of_images_follow_options() {
        for (text, expected) in [
            ("a b.png", ("", "a b.png")),
            ("-o 1 2 3 4.png", ("-o 1 2 3", "4.png")),
            ("-o 1 a.png", ("-o 1", "a.png")),
            ("-bm 2 -imfchan r a.png", ("-bm 2 -imfchan r", "a.png")),
            ("-s", ("-s", "")),
            ("", ("", "")),
        ] {
            assert_eq!(options(text), expected);
        }
    }
}
