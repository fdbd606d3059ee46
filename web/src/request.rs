//! The page's requests, and the answers to them.

use crate::dropped::Dropped;
use crate::envelope::{open, seal};
use crate::form::Form;
use crate::session::Session;
use crate::words::{label, worded};
use serde::{Deserialize, Serialize};
use spectral_remesh::SMOOTHING_SUPPORT;
use spectral_remesh::io::Format;
use spectral_remesh::report::page::{Content, MOST_IN_VIEWER};
use spectral_remesh::{Error, Setting};

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Request {
    /// Returns the defaults of the form, and the formats.
    Describe,
    /// Reads the files that follow, which have these names.
    Load { names: Vec<String>, form: Form },
    /// Measures the quality of the input.
    Measure,
    /// Remeshes the input.
    Remesh { form: Form },
    /// Returns the result as a file, with its companion files.
    Save { format: Format },
    /// Returns the report on the result as a page.
    Page,
    /// Returns the report on the result as JSON.
    Json,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Answer {
    Described {
        version: &'static str,
        form: Form,
        smoothing: f64,
        labels: Vec<&'static str>,
        read: Vec<Kind>,
        written: Vec<Kind>,
    },
    Loaded {
        name: String,
        vertices: usize,
        triangles: usize,
        /// Whether to show the input before it is remeshed. Drawing a large mesh takes as long as remeshing it.
        is_shown: bool,
    },
    Measured(Shown),
    Remeshed {
        verified: bool,
        vertices: usize,
        /// The proposed format to save it in.
        format: Format,
        #[serde(flatten)]
        shown: Shown,
    },
    /// The names of the files that follow, and the data of the mesh that they cannot hold.
    Files {
        names: Vec<String>,
        lost: Vec<String>,
    },
    Error(String),
}

/// A format in a list of choices.
#[derive(Serialize)]
struct Kind {
    ending: &'static str,
    name: &'static str,
}

impl From<Format> for Kind {
    fn from(format: Format) -> Kind {
        Kind { ending: format.extension(), name: format.name() }
    }
}

/// A report to show.
#[derive(Serialize)]
struct Shown {
    title: String,
    main: String,
    scene: String,
}

impl From<Content> for Shown {
    fn from(Content { title, main, scene }: Content) -> Shown {
        Shown { title, main, scene }
    }
}

/// Executes a request, and returns the answer.
pub fn answer(session: &mut Session, request: &[u8]) -> Vec<u8> {
    let (request, files) = match open::<Request>(request) {
        Ok(opened) => opened,
        Err(cause) => return seal(Answer::Error(cause), &[]),
    };
    let (answer, files) = done(session, request, files).unwrap_or_else(|e| (Answer::Error(worded(&e)), Vec::new()));
    seal(answer, &files)
}

fn done(session: &mut Session, request: Request, files: Vec<&[u8]>) -> Result<(Answer, Vec<Vec<u8>>), Error> {
    let answer = match request {
        Request::Describe => described(),
        Request::Load { names, form } => {
            let dropped = Dropped(names.iter().map(String::as_str).zip(files).collect());
            session.load(&dropped, form.format)?;
            let (name, mesh) = session.input()?;
            let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
            let is_shown = (1..=MOST_IN_VIEWER).contains(&triangles);
            Answer::Loaded { name: name.into(), vertices, triangles, is_shown }
        }
        Request::Measure => Answer::Measured(session.measured()?.into()),
        Request::Remesh { form } => {
            session.remesh(&form.resolve()?)?;
            let outcome = session.outcome()?;
            let (verified, vertices) = (outcome.verified(), outcome.mesh.positions.len());
            let (format, shown) = (session.proposed_format()?, session.content()?.into());
            Answer::Remeshed { verified, vertices, format, shown }
        }
        Request::Save { format } => {
            let saved = session.save(format)?;
            let (names, contents) = saved.files.into_iter().unzip();
            return Ok((Answer::Files { names, lost: saved.lost }, contents));
        }
        Request::Page => return session.page().map(one_file),
        Request::Json => return session.json().map(one_file),
    };
    Ok((answer, Vec::new()))
}

fn one_file((name, text): (String, String)) -> (Answer, Vec<Vec<u8>>) {
    (Answer::Files { names: vec![name], lost: Vec::new() }, vec![text.into_bytes()])
}

fn described() -> Answer {
    Answer::Described {
        version: env!("CARGO_PKG_VERSION"),
        form: Form::default(),
        smoothing: SMOOTHING_SUPPORT,
        labels: Setting::ALL.into_iter().filter_map(label).collect(),
        read: Format::ALL.map(Kind::from).into(),
        written: Format::OF_MESHES.map(Kind::from).into(),
    }
}
