"""Jobs run alongside Python: progress, interrupts, other threads, forks."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time

import numpy as np
import pytest
from conftest import torus

import spectral_remesh as sr

# A job that would take many seconds. It is ended long before that.
LONG = {"points": 200_000}


def test_progress_is_told_from_the_calling_thread_and_never_falls():
    told = []
    sr.remesh(*torus(), points=4000, progress=lambda stage, done: told.append((stage, done, threading.get_ident())))
    stages, shares, threads = zip(*told, strict=True)
    assert list(shares) == sorted(shares) and shares[-1] == 1
    assert {"sample", "relax", "measure"} & set(stages)
    assert set(threads) == {threading.get_ident()}


@pytest.mark.parametrize("has_tqdm", [True, False])
def test_a_bar_is_shown(capfd, monkeypatch, has_tqdm):
    if has_tqdm:
        pytest.importorskip("tqdm")
    else:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    sr.remesh(*torus(), points=3000, progress=True)
    out, err = capfd.readouterr()
    assert out == "" and "measure" in err and "100 %" in err


def test_what_progress_raises_ends_the_job():
    shares = []

    def stop(stage: str, done: float) -> None:
        shares.append(done)
        if stage == "sample":
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        sr.remesh(*torus(), **LONG, progress=stop)
    assert shares[-1] < 0.5


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("job", [sr.remesh, sr.sample])
def test_ctrl_c_ends_the_job(job):
    # Interrupts are disabled when tests run in the background of a shell.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    shares = []

    def interrupt(stage: str, done: float) -> None:
        shares.append(done)
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        job(*torus(), **LONG, progress=interrupt)
    assert shares[-1] < 0.5
    # The next job is not affected.
    assert len(job(*torus(), points=200).vertices) == 200


def test_other_threads_run_meanwhile():
    made = []
    worker = threading.Thread(target=lambda: made.append(sr.remesh(*torus(), points=4000)))
    worker.start()
    steps = 0
    while worker.is_alive():
        time.sleep(0.001)
        steps += 1
    assert len(made[0].vertices) == 4000
    # With the lock held there would be one or two steps.
    assert steps > 20


def test_several_jobs_run_beside_each_other():
    made = {}

    def job(seed: int) -> None:
        made[seed] = sr.remesh(*torus(), points=400, seed=seed).vertices

    workers = [threading.Thread(target=job, args=(seed,)) for seed in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for seed in range(4):
        assert np.array_equal(made[seed], sr.remesh(*torus(), points=400, seed=seed).vertices)


def count(seed: int) -> int:
    remeshed = sr.remesh(*torus(), points=200, seed=seed)
    assert remeshed._repr_html_()
    return len(remeshed.vertices)


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="there is no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_processes_that_are_forked_off_have_jobs_too():
    # Drawing a picture uses threads, too.
    assert count(0) == 200 and sr.remesh(*torus(), points=200, threads=1)._repr_html_()
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(count, range(4)).get(timeout=60) == [200] * 4
