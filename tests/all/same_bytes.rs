//! Checks that the program writes the same bytes on every processor and with any number of threads.
//!
//! The system's C library chooses its elementary functions by the abilities of the processor. glibc can be told not to use
//! fused multiply-add, which simulates another processor for any elementary function that the program might call.

use spectral_remesh::io::file::read_file;
use std::path::Path;
use std::process::{Command, Stdio};

/// The glibc setting that hides the processor features that its faster functions need, by their names in new and old versions.
const WITHOUT_FMA: &str = "glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4,-AVX2_Usable,-FMA_Usable,-FMA4_Usable";

/// Command and input file of each run; its output file and further arguments.
const RUNS: [(&str, &str); 6] = [
    ("blob.obj", "out.obj --points 600"),
    ("bracket.stl", "out.obj --points 800"),
    ("blob.obj", "out.obj --points 600 --adapt 1 --optimize 0"),
    ("bracket.stl", "out.ply --points 600 --max-error 1%"),
    ("sample blob.obj", "out.ply --points 400"),
    ("cloud.xyz", "out.obj --points 600 --smooth"),
];

/// Runs the program in `folder` with `words`, and returns the bytes that it writes to `out`.
fn written(folder: &Path, words: &str, out: &str, tunables: &str) -> Vec<u8> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_remesh"));
    command.current_dir(folder).args(words.split_whitespace()).stdin(Stdio::null()).env("GLIBC_TUNABLES", tunables);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    let file = folder.join(out);
    let bytes = std::fs::read(&file).unwrap();
    std::fs::remove_file(file).unwrap();
    bytes
}

/// Returns the working folder of the runs, with models of `data/` and the vertices of one of them as a cloud.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    for name in ["blob.obj", "bracket.stl"] {
        std::fs::copy(data.join(name), folder.path().join(name)).unwrap();
    }
    let cloud = read_file(&data.join("noisy.ply"), None).unwrap().mesh.positions;
    let lines: String = cloud.iter().step_by(3).map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
    std::fs::write(folder.path().join("cloud.xyz"), lines).unwrap();
    folder
}

#[test]
#[ignore = "slow"]
fn neither_processors_nor_threads_change_a_byte() {
    let folder = folder();
    for (input, rest) in RUNS {
        let out = rest.split(' ').next().unwrap();
        let with = |threads: usize, tunables| {
            written(folder.path(), &format!("{input} {rest} --quiet --threads {threads}"), out, tunables)
        };
        let bytes = with(1, "");
        assert!(bytes.len() > 1000, "{input}");
        assert!(bytes == with(2, "") && bytes == with(8, ""), "{input} {rest} differs between numbers of threads");
        if cfg!(all(target_os = "linux", target_env = "gnu")) {
            assert!(bytes == with(2, WITHOUT_FMA), "{input} {rest} differs between processors");
        }
    }
}

#[test]
fn nor_a_byte_of_a_page() {
    let folder = folder();
    let page = |threads: usize, tunables| {
        let words = format!("bracket.stl out.obj --points 800 --quiet --report out.html --threads {threads}");
        written(folder.path(), &words, "out.html", tunables)
    };
    let bytes = page(1, "");
    assert!(bytes == page(2, ""), "it differs between numbers of threads");
    if cfg!(all(target_os = "linux", target_env = "gnu")) {
        assert!(bytes == page(2, WITHOUT_FMA), "it differs between processors");
    }
}
