"""Dask workers sample and mesh clouds, and one of them dies."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest

import spectral_remesh as sr

distributed = pytest.importorskip("distributed")


def torus(path, count: int) -> None:
    rng = np.random.default_rng(3)
    u, v = 2 * np.pi * rng.random((2, count))
    r = 3 + np.cos(v)
    points = np.stack([r * np.cos(u), r * np.sin(u), np.sin(v)], 1).astype("<f4")
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n" + "".join(f"property float {c}\n" for c in "xyz")
    path.write_bytes(head.encode() + b"end_header\n" + points.tobytes())


def two_workers() -> distributed.Client:
    return distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_a_worker_that_dies_changes_nothing(tmp_path):
    from spectral_remesh.distributed import COMMAND, _run, sample

    cloud, work, shares = tmp_path / "cloud.ply", tmp_path / "work", []
    torus(cloud, 150_000)
    options = {"points": 6000, "sweeps": 3}
    with two_workers() as client:
        victim = next(iter(client.run(os.getpid).values()))

        def end() -> None:
            while not shares:
                time.sleep(0.01)
            os.kill(victim, signal.SIGKILL)
            (work / ".remesh-unfinished").touch()

        killer = threading.Thread(target=end)
        killer.start()
        sample(cloud, tmp_path / "a.ply", folder=work, client=client, tiles=8, progress=shares.append, **options)
        killer.join()
    assert shares == sorted(shares) and shares[-1] == 1 and len(shares) >= 8
    assert not list(work.glob(".*"))
    one = tmp_path / "one"
    for words in [("plan", cloud, one, "--points", 6000, "--sweeps", 3), ("sample", one), ("merge", one, tmp_path / "b.ply")]:
        _run(COMMAND, *words)
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    assert len(sr.read(tmp_path / "a.ply").vertices) == 6000


def test_a_mesh_is_the_same_with_workers_and_without(tmp_path):
    from spectral_remesh.distributed import COMMAND, _run, mesh

    cloud, shares = tmp_path / "cloud.ply", []
    torus(cloud, 40_000)
    with two_workers() as client:
        work = tmp_path / "work"
        mesh(cloud, tmp_path / "a.ply", folder=work, client=client, tiles=2, progress=shares.append, points=3000)
    assert shares == sorted(shares) and shares[-1] == 1
    one = tmp_path / "one"
    for words in [("plan", cloud, one, "--points", 3000), ("sample", one), ("mesh", one)]:
        _run(COMMAND, *words)
    _run(COMMAND, "merge", one, tmp_path / "b.ply", "--mesh")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    assert len(sr.read(tmp_path / "a.ply").vertices) == 3000


def test_the_folder_may_be_at_an_address(tmp_path):
    from spectral_remesh.distributed import COMMAND, _run, mesh, sample

    cloud, work = tmp_path / "cloud.ply", tmp_path / "work"
    torus(cloud, 40_000)
    work.mkdir()
    with distributed.Client(n_workers=1, threads_per_worker=2, dashboard_address=None) as client:
        for make, name in [(sample, "points.ply"), (mesh, "mesh.ply")]:
            (work / ".tile-0-unfinished").touch()
            make(cloud, tmp_path / name, folder=work.as_uri(), client=client, tiles=2, points=3000)
            copies = client.run(lambda dask_worker: os.listdir(dask_worker.local_directory))
    # Neither files of the first plan nor incomplete files are left.
    assert (work / "plan.json").exists() and not list(work.glob(".*"))
    assert not any(name.startswith("remesh-") for names in copies.values() for name in names)
    one = tmp_path / "one"
    for words in [("plan", cloud, one, "--points", 3000), ("sample", one), ("merge", one, tmp_path / "b.ply"), ("mesh", one)]:
        _run(COMMAND, *words)
    _run(COMMAND, "merge", one, tmp_path / "c.ply", "--mesh")
    assert (tmp_path / "points.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    assert (tmp_path / "mesh.ply").read_bytes() == (tmp_path / "c.ply").read_bytes()


def test_what_goes_wrong_is_what_the_program_says(tmp_path):
    from spectral_remesh.distributed import sample

    with pytest.raises(RuntimeError, match="there is no such file"):
        sample(tmp_path / "none.ply", tmp_path / "a.ply", folder=tmp_path / "work", points=100)
