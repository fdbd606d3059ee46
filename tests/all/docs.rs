//! The documentation: its commands run, its links lead somewhere, and its Rust code is compiled.

use std::fs::read_to_string;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the Markdown pages of the root, python/, blender/ and docs/, relative to the root and sorted.
fn pages() -> Vec<String> {
    let names = root().join("docs").read_dir().unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut pages: Vec<String> =
        names.filter(|name| name.ends_with(".md")).map(|name| format!("docs/{name}")).collect();
    let others =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "python/README.md", "blender/README.md"];
    pages.extend(others.map(String::from));
    pages.sort();
    pages
}

fn text(page: &str) -> String {
    read_to_string(root().join(page)).unwrap_or_else(|e| panic!("{page}: {e}"))
}

/// Returns the code blocks of a page in one language.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    let fences: Vec<&str> = text.split("\n```").collect();
    let inside = fences.iter().skip(1).step_by(2);
    inside.filter_map(|block| block.strip_prefix(language)?.strip_prefix('\n')).collect()
}

/// Returns the shell blocks of a page that call the program.
fn scripts(text: &str) -> Vec<&str> {
    let calls = |block: &&str| block.lines().any(|line| line.starts_with("remesh "));
    blocks(text, "sh").into_iter().filter(calls).collect()
}

#[test]
fn links_lead_to_files() {
    for page in pages() {
        let folder = root().join(&page).parent().map(PathBuf::from).unwrap();
        let text = text(&page);
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for target in targets.filter(|target| !target.contains("://")) {
            let file = target.split('#').next().unwrap();
            assert!(folder.join(file).exists(), "{page}: no {file}");
        }
    }
}

#[test]
fn blocks_are_found_by_language() {
    let page = "a\n```sh\nremesh a b\n```\nb\n```text\nno\n```\n\n```sh\nls\n```\n";
    assert_eq!(blocks(page, "sh"), ["remesh a b", "ls"]);
    assert_eq!(scripts(page), ["remesh a b"]);
}

/// Each page with commands is a separate test, so that they run in parallel.
#[cfg(all(unix, feature = "cli"))]
mod commands {
    use super::{pages, root, scripts, text};
    use std::path::Path;
    use std::process::{Command, Stdio};

    const PAGES: [&str; 13] = [
        "README.md",
        "docs/choosing.md",
        "docs/clouds.md",
        "docs/comparison.md",
        "docs/exit-status.md",
        "docs/formats.md",
        "docs/gallery.md",
        "docs/grading.md",
        "docs/large.md",
        "docs/levels.md",
        "docs/options.md",
        "docs/report.md",
        "docs/scan.md",
    ];

    /// Runs the commands of a page unchanged and in order, in a folder that also contains `data/`.
    #[track_caller]
    fn run(page: &str) {
        let folder = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(root().join("data"), folder.path().join("data")).unwrap();
        let program = Path::new(env!("CARGO_BIN_EXE_remesh")).parent().unwrap().display();
        let path = format!("{program}:{}", std::env::var("PATH").unwrap());
        let text = text(page);
        for script in scripts(&text) {
            let mut shell = Command::new("sh");
            shell.args(["-eu", "-c", script]).current_dir(folder.path()).env("PATH", &path).stdin(Stdio::null());
            let ran = shell.output().unwrap();
            assert!(ran.status.success(), "{page}:\n{script}\n{}", String::from_utf8_lossy(&ran.stderr));
        }
    }

    #[test]
    fn every_page_with_commands_is_run() {
        let found: Vec<String> = pages().into_iter().filter(|page| !scripts(&text(page)).is_empty()).collect();
        assert_eq!(found, PAGES);
    }

    #[test]
    fn of_the_readme() {
        run("README.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_choosing_options() {
        run("docs/choosing.md");
    }

    #[test]
    fn on_other_remeshers() {
        run("docs/comparison.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_the_gallery() {
        run("docs/gallery.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_scans() {
        run("docs/scan.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_clouds() {
        run("docs/clouds.md");
    }

    #[test]
    fn on_exit_statuses() {
        run("docs/exit-status.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_formats() {
        run("docs/formats.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_grading() {
        run("docs/grading.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_levels_of_detail() {
        run("docs/levels.md");
    }

    #[test]
    #[ignore = "slow"]
    fn on_options() {
        run("docs/options.md");
    }

    #[test]
    fn on_reports() {
        run("docs/report.md");
    }
}
