"""Several hosts sample a cloud, and one of them drops off the network. The hosts are Linux network namespaces, which only root
can create."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from test_distributed import torus

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")

#: Prefix of the addresses in the network, whose first host is this machine.
NETWORK = "10.213.77."


def ip(*words: str) -> bool:
    return subprocess.run(["ip", *words], capture_output=True, check=False).returncode == 0


class Host:
    """A host with a worker."""

    def __init__(self, switch: str, number: int) -> None:
        self.name, self.cable = f"{switch}h{number}", f"{switch}c{number}"
        self.address = f"{NETWORK}{number + 2}"
        self.worker: subprocess.Popen[bytes] | None = None
        self.is_up = (
            ip("netns", "add", self.name)
            and ip("link", "add", self.cable, "type", "veth", "peer", "name", "eth0", "netns", self.name)
            and ip("link", "set", self.cable, "master", switch, "up")
            and ip("-n", self.name, "address", "add", f"{self.address}/24", "dev", "eth0")
            and ip("-n", self.name, "link", "set", "eth0", "up")
            and ip("-n", self.name, "link", "set", "lo", "up")
        )

    def work_for(self, scheduler: str, folder: Path) -> None:
        program = [sys.executable, "-m", "distributed.cli.dask_worker", scheduler]
        program += ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
        with (folder / f"{self.name}.log").open("wb") as log:
            self.worker = subprocess.Popen(["ip", "netns", "exec", self.name, *program], cwd=folder, stdout=log, stderr=log)

    def pull_cable(self) -> None:
        assert ip("link", "set", self.cable, "down")

    def shut_down(self) -> None:
        if self.worker is not None:
            self.worker.kill()
            self.worker.wait()
        ip("link", "delete", self.cable)
        ip("netns", "delete", self.name)


@pytest.fixture
def hosts() -> Iterator[list[Host]]:
    """Two hosts, connected to each other and to this machine."""
    if sys.platform != "linux" or os.geteuid() != 0 or shutil.which("ip") is None:
        pytest.skip("only root of Linux makes network namespaces, with ip")
    switch = f"sr{os.getpid()}"
    made: list[Host] = []
    try:
        is_up = (
            ip("link", "add", switch, "type", "bridge")
            and ip("address", "add", f"{NETWORK}1/24", "dev", switch)
            and ip("link", "set", switch, "up")
        )
        made += [Host(switch, number) for number in range(2)] if is_up else []
        if not made or not all(host.is_up for host in made):
            pytest.skip("network namespaces cannot be made here")
        yield made
    finally:
        for host in made:
            host.shut_down()
        ip("link", "delete", switch)


def test_a_host_that_drops_off_the_network_changes_nothing(tmp_path, hosts):
    from spectral_remesh.distributed import COMMAND, _run, sample

    cloud, work = tmp_path / "cloud.ply", tmp_path / "work"
    torus(cloud, 150_000)
    shares: list[float] = []

    def progress(share: float) -> None:
        if not shares:
            hosts[0].pull_cable()
        shares.append(share)

    def network() -> str:
        return os.readlink("/proc/self/ns/net")

    quickly = dask.config.set({"distributed.scheduler.worker-ttl": "5s"})
    with (
        quickly,
        distributed.LocalCluster(n_workers=0, host=f"{NETWORK}1", dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        for host in hosts:
            host.work_for(cluster.scheduler_address, tmp_path)
        client.wait_for_workers(2, timeout=60)
        assert len({network(), *client.run(network).values()}) == 3
        sample(cloud, tmp_path / "a.ply", folder=work, client=client, tiles=8, progress=progress, points=6000, sweeps=3)
        assert len(client.scheduler_info()["workers"]) == 1
    assert shares == sorted(shares) and shares[-1] == 1
    one = tmp_path / "one"
    for words in [("plan", cloud, one, "--points", 6000, "--sweeps", 3), ("sample", one), ("merge", one, tmp_path / "b.ply")]:
        _run(COMMAND, *words)
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
