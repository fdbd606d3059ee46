//! `remesh sample`: what it does.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, Stopwatch, check};
use crate::cli::args::{PropertyWidth, Sampling};
use crate::cli::run::{hand_out, load, name, peak_memory_bytes};
use crate::cli::terminal::Terminal;
use crate::io::{Loaded, file};
use crate::mesh::attributes::{Attribute, Attributes, Scalar};
use crate::mesh::points::Points;
use crate::pipeline::{SampleOptions, Sampled, Signal, sample, sample_points};
use crate::report::samples::SamplesReport;

/// The signals that properties of an input are.
pub(super) fn signals(properties: &[PropertyWidth], input: &Loaded) -> Result<Vec<Signal>> {
    let signal = |p: &PropertyWidth| Ok(Signal { values: input.attributes.numbers(&p.name)?, sigma: p.sigma });
    properties.iter().map(signal).collect()
}

/// Reads, samples, writes, reports.
pub(super) fn sample_file(job: &Sampling) -> Result<()> {
    job.options.validate()?;
    file::points_format(&job.output, None)?;
    file::check_target(&job.output)?;
    job.run.report.iter().try_for_each(|path| file::check_target(path))?;
    let report = {
        let terminal = Terminal::new(job.run.voice);
        let monitor = Stopwatch::new(&terminal);
        let input = load(&job.input, &monitor)?;
        let mut sampled = sample_loaded(&input, job, &monitor).map_err(|e| e.in_file(&name(&job.input)))?;
        sampled.notes.splice(0..0, input.notes.iter().cloned());
        check(&monitor)?;
        monitor.stage("write");
        file::write_points_file(&job.output, &sampled.points, &numbers(&sampled), None)?;
        let report = SamplesReport::new(&sampled, &job.options, name(&job.input), job.output.display().to_string());
        report.with_run(&monitor.laps(), peak_memory_bytes(), rayon::current_num_threads())
    };
    hand_out(&report.to_json(), &report.to_text(), &job.run)
}

fn sample_loaded(input: &Loaded, job: &Sampling, monitor: &Stopwatch) -> Result<Sampled> {
    let options = SampleOptions { signals: signals(&job.properties, input)?, ..job.options.clone() };
    if input.mesh.triangles.is_empty() {
        let points = Points { positions: input.mesh.positions.clone(), normals: input.attributes.normals() };
        return sample_points(&points, &options, monitor);
    }
    sample(&input.mesh, &options, monitor)
}

/// The numbers of samples in the input, if they are points of it, as the property `index`.
fn numbers(sampled: &Sampled) -> Attributes {
    let attribute = |indices: &Vec<u32>| Attribute {
        name: "index".into(),
        components: 1,
        values: indices.iter().map(|&i| f64::from(i)).collect(),
        scalar: Scalar::U32,
    };
    Attributes { vertex: sampled.indices.iter().map(attribute).collect(), ..Attributes::default() }
}
