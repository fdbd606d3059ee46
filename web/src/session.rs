//! The page's input and result.

use crate::dropped::{Dropped, stem};
use crate::page::Page;
use spectral_remesh::io::{Companions, Format, Loaded, companions, read_named, write_with_attributes};
use spectral_remesh::report::page::{Content, Subject, content, page};
use spectral_remesh::{Attributes, Error, Fault, Input, Mesh, Monitor, Outcome, RemeshOptions, quality, remesh};

/// The file that was read, and its result.
#[derive(Default)]
pub struct Session {
    input: Option<(String, Loaded)>,
    outcome: Option<Outcome>,
}

/// Files to save.
pub struct Saved {
    pub files: Vec<(String, Vec<u8>)>,
    /// The data of the result that they cannot hold.
    pub lost: Vec<String>,
}

impl Session {
    /// Reads the mesh among the files.
    pub fn load(&mut self, files: &Dropped, format: Option<Format>) -> Result<(), Error> {
        Page.stage("read");
        let ((name, bytes), others) = files.mesh().ok_or_else(|| missing("no file"))?;
        let mut loaded = read_named(name, bytes, format, files)?;
        if !others.is_empty() {
            loaded.notes.push(format!("only one mesh is read at a time: {} ignored", others.join(", ")));
        }
        *self = Session { input: Some((name.into(), loaded)), outcome: None };
        Ok(())
    }

    /// Returns the name and the mesh of the input.
    pub fn input(&self) -> Result<(&str, &Mesh), Error> {
        self.read().map(|(name, loaded)| (name, &loaded.mesh))
    }

    fn read(&self) -> Result<(&str, &Loaded), Error> {
        self.input.as_ref().map(|(name, loaded)| (name.as_str(), loaded)).ok_or_else(|| missing("no mesh yet"))
    }

    /// Returns the content of a report on the quality of the input.
    pub fn measured(&self) -> Result<Content, Error> {
        let (name, loaded) = self.read()?;
        Page.stage("measure");
        let mut report = quality(&Input::from(loaded), None).map_err(|e| e.in_file(name))?;
        report.add_files("", name);
        report.run.notes.splice(0..0, loaded.notes.clone());
        Ok(content(None, &[Subject { report: &report, mesh: &loaded.mesh, edges: None }]))
    }

    /// Remeshes the input.
    pub fn remesh(&mut self, options: &RemeshOptions) -> Result<(), Error> {
        let (name, loaded) = self.read()?;
        let mut outcome = remesh(&Input::from(loaded), options, &Page).map_err(|e| e.in_file(name))?;
        let output = self.output_name(self.proposed_format()?)?;
        if let Some(report) = &mut outcome.report {
            report.run.notes.splice(0..0, loaded.notes.clone());
            report.add_files(name, &output);
        }
        self.outcome = Some(outcome);
        Ok(())
    }

    /// Returns the result.
    pub fn outcome(&self) -> Result<&Outcome, Error> {
        self.outcome.as_ref().ok_or_else(|| missing("no result yet"))
    }

    /// Returns the content of the report on the result.
    pub fn content(&self) -> Result<Content, Error> {
        self.about().map(|(reference, subject)| content(Some(reference), &[subject]))
    }

    /// Returns the file name of the report on the result, and the report as a page.
    pub fn page(&self) -> Result<(String, String), Error> {
        let (reference, subject) = self.about()?;
        Ok((self.named("html")?, page(Some(reference), &[subject])))
    }

    /// Returns the file name of the report on the result, and the report as JSON.
    pub fn json(&self) -> Result<(String, String), Error> {
        Ok((self.named("json")?, self.about()?.1.report.to_json()))
    }

    /// Returns the reference mesh and the subject of the report.
    fn about(&self) -> Result<(&Mesh, Subject<'_>), Error> {
        let outcome = self.outcome()?;
        let report = outcome.report.as_ref().ok_or_else(|| missing("no report"))?;
        let reference = outcome.of_points.as_deref().map_or_else(|| self.input().map(|(_, mesh)| mesh), Ok)?;
        Ok((reference, Subject { report, mesh: &outcome.mesh, edges: Some(&outcome.edges) }))
    }

    /// Returns the result as files of a format.
    pub fn save(&self, format: Format) -> Result<Saved, Error> {
        let outcome = self.outcome()?;
        let name = self.output_name(format)?;
        let lost = format.cannot_hold(&outcome.attributes).into_iter().map(|l| format!("{}: {}", l.name, l.cause));
        let (attributes, mut files) = with_companions(&outcome.attributes, format, stem(&name));
        let mut bytes = Vec::new();
        write_with_attributes(&outcome.mesh, &attributes, format, &mut bytes).map_err(|error| Error::File {
            file: name.clone(),
            cause: error.to_string(),
            remedy: "choose another format".into(),
        })?;
        files.insert(0, (name, bytes));
        Ok(Saved { files, lost: lost.collect() })
    }

    /// Returns the format of the input if it can be written, otherwise PLY.
    pub fn proposed_format(&self) -> Result<Format, Error> {
        let format = self.read()?.1.format;
        Ok(if Format::OF_MESHES.contains(&format) { format } else { Format::Ply })
    }

    fn output_name(&self, format: Format) -> Result<String, Error> {
        self.named(format.extension())
    }

    fn named(&self, ending: &str) -> Result<String, Error> {
        Ok(format!("{}-remeshed.{ending}", stem(self.read()?.0)))
    }
}

/// Returns the attributes for a file of `format`, and its companion files.
fn with_companions(attributes: &Attributes, format: Format, stem: &str) -> (Attributes, Vec<(String, Vec<u8>)>) {
    match &attributes.materials {
        Some(materials) if format == Format::Obj => {
            let Companions { materials, files } = companions(stem, materials);
            (Attributes { materials: Some(materials), ..attributes.clone() }, files)
        }
        _ => (attributes.clone(), Vec::new()),
    }
}

fn missing(cause: &str) -> Error {
    Error::Mesh { fault: Fault::Empty, cause: cause.into(), remedy: "drop a mesh on the page first".into() }
}
