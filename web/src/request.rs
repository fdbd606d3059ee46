//! What the page can ask for, and the answers.

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
    /// What there is to choose from.
    Describe,
    /// Reads the files that follow, of which these are the names.
    Load { names: Vec<String>, form: Form },
    /// How good what was read is.
    Measure,
    /// Remeshes what was read.
    Remesh { form: Form },
    /// The result as a file, and those that belong to it.
    Save { format: Format },
    /// The report on the result as a page.
    Page,
    /// The report on the result as JSON.
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
        /// Whether to look at it before it is remeshed: drawing pictures of a large mesh takes as long as remeshing.
        is_shown: bool,
    },
    Measured(Shown),
    Remeshed {
        verified: bool,
        vertices: usize,
        /// The proposed name to save it by.
        format: Format,
        #[serde(flatten)]
        shown: Shown,
    },
    /// The files that follow, and what of the mesh they have no place for.
    Files {
        names: Vec<String>,
        lost: Vec<String>,
    },
    Error(String),
}

/// A format, for lists to choose from.
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

/// A report to be looked at.
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

/// Does what a request says.
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
