"""The command of the package works, and Python gives the same bytes with the same options."""

from __future__ import annotations

import inspect
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import command, torus

import spectral_remesh as sr

# Flags without an argument of the same name, with their equivalents in Python.
COMMAND_ONLY = {
    "format": "the argument of read()",
    "output-format": "the argument of write()",
    "no-attributes": "attributes=False",
    "report": "a member of the result",
    "json": "the result is a dictionary",
    "quiet": "nothing is printed",
    "verbose": "progress",
    "out-of-core": "the command; for samples spectral_remesh.distributed",
    "memory": "the command; for samples spectral_remesh.distributed",
    "temp": "the command; for samples spectral_remesh.distributed",
    "resume": "spectral_remesh.distributed",
    "help": "help()",
    "version": "__version__",
}

# Flags of a job that are a separate function in Python.
OTHER_FUNCTION = {"remesh": {"levels"}}

# Arguments without a flag of the same name.
PYTHON_ONLY = {"vertices", "faces", "attributes", "progress", "report", "strict"}

# For each job, command lines and their equivalents in Python. Together they use all options.
SAME = {
    "remesh": [
        ("data/blob.obj --points 500 --seed 3 --threads 1", {"points": 500, "seed": 3, "threads": 1}),
        ("data/blob.obj --edge-length 0.2 --adapt 0.5", {"edge_length": 0.2, "adapt": 0.5}),
        ("data/blob.obj --sigma-p 0.2 --sigma-n 0.75", {"sigma_p": 0.2, "sigma_n": 0.75}),
        ("data/blob.obj --points auto --max-error 2%", {"points": "auto", "max_error": "2%"}),
        ("data/blob.obj --points 900 --max-error 0.05", {"points": 900, "max_error": np.float64(0.05)}),
        ("data/blob.obj --points 400 --optimize 0", {"points": 400, "optimize": False}),
        ("data/blob.obj --points 400 --within 0,-2,-2,2,2,2", {"points": 400, "within": [[0, -2, -2], [2, 2, 2]]}),
        ("data/bracket.stl --points 600 --features 30", {"points": 600, "features": 30}),
        ("data/bracket.stl --points 600 --features none", {"points": 600, "features": "none"}),
        ("data/terrain.ply --points 500 --weld 0.001", {"points": 500, "weld": 0.001}),
        ("data/noisy.ply --points 500 --smooth", {"points": 500, "smooth": True}),
        ("data/noisy.ply --points 500 --smooth 3.5", {"points": 500, "smooth": 3.5}),
        ("marked.ply --sizing h", {"sizing": "h"}),
        ("marked.ply --points 400 --sigma half=0.5", {"points": 400, "sigma": {"half": 0.5}}),
        ("marked.ply --points 200 --select half", {"points": 200, "select": "half"}),
        ("marked.ply --points 400 --no-attributes", {"points": 400, "attributes": False}),
        ("cloud.ply --points 400 --normal-neighbors 12", {"points": 400, "normal_neighbors": 12}),
        (
            "bare.xyz --points 400 --normal-fit sphere --normal-radius 0.5 --fill-holes 0.1",
            {"points": 400, "normal_fit": "sphere", "normal_radius": 0.5, "fill_holes": 0.1},
        ),
        ("bare.xyz --points 300 --terrain", {"points": 300, "terrain": True}),
    ],
    "sample": [
        ("data/blob.obj --points 500 --seed 3 --sweeps 4 --threads 2", {"points": 500, "seed": 3, "sweeps": 4, "threads": 2}),
        ("data/blob.obj --edge-length 0.2 --sigma-n 0.75", {"edge_length": 0.2, "sigma_n": 0.75}),
        ("marked.ply --sigma-p 0.2 --sigma half=0.5", {"sigma_p": 0.2, "sigma": {"half": 0.5}}),
        ("data/blob.obj --points 500 --scan-only", {"points": 500, "scan_only": True}),
        ("data/blob.obj --points 500 --levels 3", {"points": 500, "levels": 3}),
        ("bare.xyz --points 300 --smooth 3 --normal-fit plane", {"points": 300, "smooth": 3, "normal_fit": "plane"}),
        ("bare.xyz --points 300 --within -9,-9,-9,9,9,0", {"points": 300, "within": [[-9, -9, -9], [9, 9, 0]]}),
        ("bare.xyz --points 300 --normal-neighbors 9", {"points": 300, "normal_neighbors": 9}),
        ("bare.xyz --points 300 --normal-radius 0.5", {"points": 300, "normal_radius": 0.5}),
    ],
    "reconstruct": [
        ("bare.xyz --resolution 0.2 --smooth 3 --threads 1", {"resolution": 0.2, "smooth": 3, "threads": 1}),
        ("bare.xyz --normal-fit sphere --normal-neighbors 9", {"normal_fit": "sphere", "normal_neighbors": 9}),
        ("bare.xyz --normal-radius 0.5 --smooth 0", {"normal_radius": 0.5, "smooth": 0}),
    ],
}


@pytest.fixture
def folder(tmp_path, data, marked):
    """A folder with ``data/``, ``marked.ply``, and clouds with and without normals."""
    os.symlink(data, tmp_path / "data")
    cloud = sr.sample(*torus(), points=1500)
    sr.write(tmp_path / "cloud.ply", cloud)
    sr.write(tmp_path / "bare.xyz", sr.Mesh(cloud.vertices))
    return tmp_path


@pytest.mark.parametrize(("job", "line", "options"), [(job, *case) for job, cases in SAME.items() for case in cases])
def test_python_writes_the_same_bytes_as_the_command(folder, job, line, options):
    source, *flags = line.split()
    before = [] if job == "remesh" else [job]
    ran = command(*before, source, "command.ply", *flags, "--report", "r.json", folder=folder)
    assert ran.returncode in (0, 3), ran.stderr
    made = getattr(sr, job)(sr.read(folder / source), **options)
    sr.write(folder / "python.ply", made)
    assert (folder / "python.ply").read_bytes() == (folder / "command.ply").read_bytes()
    report = json.loads((folder / "r.json").read_text())
    own = {"input", "output", "stages", "peak_memory_bytes", "notes", "threads"}
    assert {k: v for k, v in made.report.items() if k not in own} == {k: v for k, v in report.items() if k not in own}
    if job == "remesh":
        assert made.verified == (ran.returncode == 0)


def test_levels_have_the_same_bytes(folder):
    ran = command("data/bracket.stl", "out.ply", "--levels", "900,300", "--features", "30", "--report", "r.json", folder=folder)
    assert ran.returncode == 0, ran.stderr
    levels = sr.levels(sr.read(folder / "data/bracket.stl"), points=[900, 300], features=30)
    reports = json.loads((folder / "r.json").read_text())
    for number, (level, report) in enumerate(zip(levels, reports, strict=True), 1):
        sr.write(folder / "python.ply", level)
        assert (folder / "python.ply").read_bytes() == (folder / f"out-{number}.ply").read_bytes()
        assert level.report["output"]["shape"] == report["output"]["shape"] and level.verified


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "off", "gltf", "glb", "3mf", "vtp", "ply.gz"])
def test_every_format_is_written_with_the_same_bytes(folder, ending):
    # Colours, texture, material, names of objects, and normals with more digits than their type has.
    (folder / "skin.mtl").write_text("newmtl red\nKd 1 0 0\n")
    mesh = sr.read(folder / "data/blob.obj")
    vertices = "".join(f"v {x} {y} {z} {abs(x) / 2} 0.5 0\n" for x, y, z in mesh.vertices)
    seams = "".join(f"vt {x / 4} {y / 4}\n" for x, y, z in mesh.vertices)
    faces = "".join(f"f {a}/{a} {b}/{b} {c}/{c}\n" for a, b, c in mesh.faces + 1)
    (folder / "skin.obj").write_text(f"mtllib skin.mtl\no body\nusemtl red\n{vertices}{seams}{faces}")
    assert command("skin.obj", "command.glb", "--points", 400, folder=folder).returncode == 0
    for source in ("skin.obj", "command.glb", "marked.ply"):
        for folder_name in ("command", "python"):
            (folder / folder_name).mkdir(exist_ok=True)
        target = f"out.{ending}"
        assert command(source, f"command/{target}", "--points", 300, folder=folder).returncode == 0
        sr.write(folder / "python" / target, sr.remesh(sr.read(folder / source), points=300))
        assert (folder / "python" / target).read_bytes() == (folder / "command" / target).read_bytes()
        assert len(sr.read(folder / "python" / target).faces) > 500


def test_what_is_read_is_written_again_unless_it_is_changed(tmp_path, marked):
    mesh = sr.read(marked)
    assert {name: array.dtype.name for name, array in mesh.attributes.items()} == {"h": "float32", "half": "uint8"}
    mesh.attributes["h"][:] = 0.5
    mesh.attributes["new"] = np.arange(len(mesh.vertices))
    del mesh.attributes["half"]
    sr.write(tmp_path / "again.ply", mesh)
    again = sr.read(tmp_path / "again.ply")
    assert list(again.attributes) == ["h", "new"]
    assert (again.attributes["h"] == 0.5).all() and again.attributes["new"][7] == 7


def flags(job: str, folder) -> set[str]:
    text = command(*([] if job == "remesh" else [job]), "--help", folder=folder).stdout
    return set(re.findall(r"^ +(?:-\w, )?--([a-z-]+)", text, re.MULTILINE))


@pytest.mark.parametrize("job", ["remesh", "sample", "reconstruct", "quality"])
def test_the_command_and_python_have_the_same_options(tmp_path, job):
    of_command = {flag.replace("-", "_") for flag in flags(job, tmp_path) - COMMAND_ONLY.keys() - OTHER_FUNCTION.get(job, set())}
    of_python = set(inspect.signature(getattr(sr, job)).parameters)
    assert of_command == of_python - PYTHON_ONLY
    assert of_python >= {"vertices", "faces"}
    if job in SAME:
        tried = {name for _, options in SAME[job] for name in options}
        assert of_python - PYTHON_ONLY == tried - PYTHON_ONLY


def test_the_command_has_its_exit_statuses(tmp_path, data):
    for words, status in [
        (["--version"], 0),
        (["none.ply", "out.ply", "--points", 9], 1),
        (["--points", "many"], 2),
        ([data / "blob.obj", "out.ply", "--points", 500, "--max-error", "0.01%"], 3),
    ]:
        assert command(*words, folder=tmp_path).returncode == status
    assert f"remesh {sr.__version__}\n" == command("--version", folder=tmp_path).stdout
    as_module = [sys.executable, "-m", "spectral_remesh", "--version"]
    assert subprocess.run(as_module, capture_output=True, text=True, check=True).stdout == f"remesh {sr.__version__}\n"


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_an_interrupt_ends_the_command(tmp_path, data):
    program = shutil.which("remesh", path=os.path.dirname(sys.executable)) or "remesh"
    words = [program, data / "blob.obj", "out.ply", "--points", "2000000", "-v"]
    with subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        while "sample" not in running.stderr.readline():
            time.sleep(0.01)
        running.send_signal(signal.SIGINT)
        rest = running.stderr.read()
    assert running.returncode == 130 and "interrupted" in rest
    assert not (tmp_path / "out.ply").exists()
