//! What the form of the page says, as the library's settings. From here on every member is named, as on the command line.

use serde::{Deserialize, Serialize};
use spectral_remesh::io::Format;
use spectral_remesh::settings::{NormalSettings, RemeshSettings};
use spectral_remesh::{Error, RemeshOptions, words};

/// The fields of the form. Texts are words of the command line; what is `None` is not set.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Form {
    points: Option<String>,
    edge_length: Option<f64>,
    max_error: Option<String>,
    features: String,
    /// Even edges at zero.
    adapt: f64,
    smooth: Option<f64>,
    weld: Option<f64>,
    fill_holes: f64,
    seed: u64,
    attributes: bool,
    /// What the input is read as.
    pub format: Option<Format>,
}

impl Default for Form {
    /// What the page proposes.
    fn default() -> Form {
        Form {
            points: Some("4000".into()),
            edge_length: None,
            max_error: None,
            features: "auto".into(),
            adapt: 0.0,
            smooth: None,
            weld: None,
            fill_holes: 0.0,
            seed: 0,
            attributes: true,
            format: None,
        }
    }
}

impl Form {
    /// How to remesh.
    ///
    /// # Errors
    /// [`Error::Option`] for what makes no sense.
    pub fn resolve(self) -> Result<RemeshOptions, Error> {
        use spectral_remesh::Setting::{Features, MaxError, Points};
        let Form {
            points,
            edge_length,
            max_error,
            features,
            adapt,
            smooth,
            weld,
            fill_holes,
            seed,
            attributes,
            format: _,
        } = self;
        let settings = RemeshSettings {
            points: points.map(|word| read(Points, words::points(&word))).transpose()?,
            edge_length,
            sigma_p: None,
            seed,
            weld,
            features: Some(read(Features, words::features(&features))?),
            adapt: Some(adapt).filter(|&adapt| adapt != 0.0),
            sigma_n: None,
            signals: Vec::new(),
            sizing: None,
            smooth,
            within: None,
            select: None,
            fill_holes,
            terrain: None,
            normals: NormalSettings::default(),
            max_error: max_error.map(|word| read(MaxError, words::max_error(&word))).transpose()?,
            attributes,
            optimize: true,
        };
        settings.resolve()
    }
}

/// A word that was read, or what is wrong with it.
fn read<T>(option: spectral_remesh::Setting, word: Result<T, String>) -> Result<T, Error> {
    word.map_err(|cause| Error::Option { option, cause, remedy: "correct it in the form".into() })
}
