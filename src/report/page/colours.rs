//! The colours of quality figures, and their legends.
//!
//! The ramp is uniform in the OKLab colour space (B. Ottosson, *A perceptual color space for image processing*, 2020): its
//! colours are equally spaced and get darker from good to bad, so that it can be read without distinguishing hues, and in
//! greyscale.

use glam::DVec3;

/// Colours from good to bad.
pub(super) const RAMP: [&str; 11] = [
    "#c6e4f0", "#d4d5b4", "#dcbd7c", "#dd9f4a", "#d88024", "#cf5f15", "#bc421b", "#a12b28", "#831b2e", "#63142e",
    "#440e2c",
];

/// Valences and their colours: blue for too few edges, brown for too many.
pub(super) const VALENCES: [(&str, &str); 6] = [
    ("boundary", "#b7b7b7"),
    ("4 or less", "#234993"),
    ("5", "#4b99d7"),
    ("6", "#c6e4f0"),
    ("7", "#e28e3a"),
    ("8 or more", "#92361f"),
];

/// Colours of sharp edges that were kept, of those that were left out, of faces at fault, and of anything without a figure.
pub(super) const KEPT: &str = "#053370";
pub(super) const LEFT_OUT: &str = "#bf0080";
pub(super) const MARKED: &str = "#db008c";
pub(super) const UNKNOWN: &str = "#cdd1d6";

/// Returns the index of a valence in [`VALENCES`]; `None` stands for a boundary vertex.
pub(super) fn valence_class(valence: Option<u32>) -> u8 {
    match valence {
        None => 0,
        Some(n) => (n.clamp(4, 8) - 3) as u8,
    }
}

/// Returns the colour at a position on the ramp, 0 for good and 1 for bad, as sRGB red, green and blue in 0..=1.
pub(super) fn on_ramp(badness: f64) -> DVec3 {
    let at = badness.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let k = (at as usize).min(RAMP.len() - 2);
    rgb(RAMP[k]).lerp(rgb(RAMP[k + 1]), at - k as f64)
}

/// Parses a colour given as `#rrggbb`.
pub(super) fn rgb(hex: &str) -> DVec3 {
    let part = |i: usize| u8::from_str_radix(&hex[i..i + 2], 16).map_or(0.0, |byte| f64::from(byte) / 255.0);
    DVec3::new(part(1), part(3), part(5))
}

/// The figures by which a mesh can be coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Colouring {
    Angle,
    Quality,
    Valence,
    Distance,
}

impl Colouring {
    pub(super) const ALL: [Colouring; 4] =
        [Colouring::Angle, Colouring::Quality, Colouring::Valence, Colouring::Distance];

    /// Its name in the page's markup.
    pub(super) fn key(self) -> &'static str {
        match self {
            Colouring::Angle => "angle",
            Colouring::Quality => "quality",
            Colouring::Valence => "valence",
            Colouring::Distance => "distance",
        }
    }

    /// Its label for the user.
    pub(super) fn title(self) -> &'static str {
        match self {
            Colouring::Angle => "Angle",
            Colouring::Quality => "Quality",
            Colouring::Valence => "Valence",
            Colouring::Distance => "Distance",
        }
    }

    /// Returns the legend of the colours as HTML. `farthest` is the distance at the end of the ramp, in words.
    pub(super) fn legend(self, farthest: &str) -> String {
        let ramp = |from: &str, to: &str, what: &str| {
            let colours = RAMP.join(",");
            format!(
                "<span class=\"what\">{what}</span> <span class=\"end\">{from}</span>\
                 <span class=\"ramp\" style=\"background:linear-gradient(90deg,{colours})\"></span>\
                 <span class=\"end\">{to}</span>"
            )
        };
        match self {
            Colouring::Angle => ramp("60°", "0°", "smallest angle of each triangle"),
            Colouring::Quality => ramp("1", "0", "Q of each triangle"),
            Colouring::Distance => ramp("0", farthest, "distance of each vertex, % of the diagonal"),
            Colouring::Valence => {
                let swatch = |(name, colour): &(&str, &str)| {
                    format!("<span class=\"swatch\"><i style=\"background:{colour}\"></i>{name}</span>")
                };
                let swatches: String = VALENCES.iter().map(swatch).collect();
                format!("<span class=\"what\">edges at each vertex</span> {swatches}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_gets_darker_all_the_way() {
        let light = |k: usize| on_ramp(k as f64 / 100.0).dot(DVec3::new(0.2126, 0.7152, 0.0722));
        assert!((0..100).all(|k| light(k) > light(k + 1)));
        assert_eq!((on_ramp(-1.0), on_ramp(2.0)), (rgb(RAMP[0]), rgb(RAMP[10])));
    }

    #[test]
    fn each_valence_has_its_colour() {
        let classes = [None, Some(3), Some(4), Some(5), Some(6), Some(7), Some(8), Some(40)].map(valence_class);
        assert_eq!(classes, [0, 1, 1, 2, 3, 4, 5, 5]);
    }
}
