//! Converts the page's form to the library's settings. All members are named, as for the command line.

use serde::{Deserialize, Serialize};
use spectral_remesh::io::Format;
use spectral_remesh::settings::{NormalSettings, RemeshSettings};
use spectral_remesh::{Error, RemeshOptions, words};

/// The fields of the form. Texts are those of the command line; `None` means not set.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Form {
    points: Option<String>,
    edge_length: Option<f64>,
    max_error: Option<String>,
    features: String,
    /// Zero makes edges even.
    adapt: f64,
    smooth: Option<f64>,
    weld: Option<f64>,
    fill_holes: f64,
    seed: u64,
    attributes: bool,
    /// The format of the input.
    pub format: Option<Format>,
}

impl Default for Form {
    /// Returns the page's initial values.
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
    /// Returns the options of the remeshing.
    ///
    /// # Errors
    /// [`Error::Option`] for an invalid value.
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

/// Turns the cause of a parse failure into an error of the option.
fn read<T>(option: spectral_remesh::Setting, word: Result<T, String>) -> Result<T, Error> {
    word.map_err(|cause| Error::Option { option, cause, remedy: "correct it in the form".into() })
}
