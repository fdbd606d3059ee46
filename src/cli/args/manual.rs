//! Manual pages in the format of man: one for the program and one for each command.

use clap::Command;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};

/// The commands that have their own page.
pub(super) const COMMANDS: [&str; 6] = ["completions", "man", "quality", "reconstruct", "sample", "tiles"];

/// Returns the page of `program`, or of one of its [`COMMANDS`].
pub(super) fn page(program: Command, command: Option<&str>) -> String {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let of_command = command.and_then(|name| program.find_subcommand(name)).cloned();
    let mut described = of_command.unwrap_or(program);
    let usage = described.render_usage().to_string();
    // This text is set verbatim: lines of examples and tables must not be joined.
    let below = described.get_after_help().map(ToString::to_string);
    let version = described.get_version().unwrap_or(env!("CARGO_PKG_VERSION")).to_string();
    let page = Man::new(described).manual("remesh").source(format!("remesh {version}"));
    let mut roff = Vec::new();
    // Writing to memory cannot fail.
    let _ = page.render_title(&mut roff);
    let _ = page.render_name_section(&mut roff);
    roff.extend(verbatim("SYNOPSIS", usage.trim_start_matches("Usage:").trim()));
    let _ = page.render_description_section(&mut roff);
    let _ = page.render_options_section(&mut roff);
    if command.is_none() {
        let _ = page.render_subcommands_section(&mut roff);
    }
    roff.extend(below.into_iter().flat_map(|text| verbatim("NOTES", &text)));
    in_ascii(&String::from_utf8_lossy(&roff))
}

/// Escapes non-ASCII characters by their code points, for man readers that do not support UTF-8.
fn in_ascii(roff: &str) -> String {
    let letter = |c: char| if c.is_ascii() { c.to_string() } else { format!("\\[u{:04X}]", u32::from(c)) };
    roff.chars().map(letter).collect()
}

/// Returns a section with unchanged line breaks.
fn verbatim(heading: &str, text: &str) -> Vec<u8> {
    let mut section = Roff::default();
    section.control("SH", [heading]).control("nf", []);
    for line in text.lines() {
        section.text([roman(line.trim_start_matches("       "))]);
    }
    section.control("fi", []);
    section.to_roff().into_bytes()
}
