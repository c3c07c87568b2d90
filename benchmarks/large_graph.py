"""``robustness check -r 2`` on a graph of 10^5 nodes and 5 * 10^5 arcs: the whole command, seconds and peak memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.suite import Instance, build
from benchmarks.tables import Target, seconds_text
from benchmarks.workers import Worker

__all__ = ["LARGE_GRAPHS", "check_large_graph"]

#: Graphs of 10^5 nodes and 5 * 10^5 arcs, and what is to settle them; None: nothing known to us does.
LARGE_GRAPHS: tuple[tuple[str, dict[str, int], str | None], ...] = (
    ("hearing_earlier", {"n": 100_000, "k": 5}, "growth"),
    ("gnm", {"n": 100_000, "m": 250_000}, "degree"),
    ("regular_with_clumps", {"n": 100_000, "k": 5}, "a small local violation"),
    ("regular", {"n": 100_000, "k": 5}, None),
)

_WITHIN = 5.0
_MEGABYTES = 1000.0
_PATIENCE = 60.0


def check_large_graph(instance: Instance, settled_by: str | None) -> Target:
    """Write the graph to a file and run the command on it as a user would, in a process of its own."""
    thousandth = {key: value // 1000 if key in "nm" else value for key, value in instance.arguments.items()}
    small = Instance(instance.family, instance.builder, thousandth)
    with tempfile.TemporaryDirectory() as folder, Worker() as worker:
        path, little = Path(folder) / "large.edgelist", Path(folder) / "small.edgelist"
        worker.call(_write, instance, path, seconds=600)
        worker.call(_write, small, little, seconds=60)
        # Memory is counted as the greatest of all children of a process, so a process with no other child counts it.
        worker.discard()
        worker.call(_run, little, seconds=600)
        worker.discard()
        document, seconds, cpu, megabytes = worker.call(_run, path, seconds=2 * _PATIENCE)
    nodes, arcs = document["graph"]["nodes"], document["graph"]["arcs"]
    reached = document["verdict"] != "undecided" and seconds < _WITHIN and megabytes < _MEGABYTES
    return Target(
        f"check -r 2 on {instance.name}",
        f"< {_WITHIN:g} s, < 1 GB",
        f"{document['verdict']} in {seconds_text(seconds)} s, {megabytes:.0f} MB",
        None if settled_by is None else reached,
        seconds,
        cpu,
        f"{nodes} nodes, {arcs} arcs, to be settled by {settled_by or 'no bound we know'}; "
        f"{document['seconds']:.2f} s in {document['algorithm']}, the rest start-up and reading the edge list",
    )


def _write(instance: Instance, path: Path) -> None:
    import warnings

    from robustness import GraphWarning
    from robustness.files import write_topology

    with warnings.catch_warnings():
        # An edge list turns labels into text and drops isolated nodes: what becomes of them is counted after reading.
        warnings.simplefilter("ignore", GraphWarning)
        write_topology(build(instance), path)


def _run(path: Path) -> tuple[dict[str, object], float, float, float]:
    """Return the command's document, wall-clock and CPU seconds, and its peak memory in megabytes."""
    import resource

    command = [sys.executable, "-m", "cli", "check", str(path), "-r", "2", "--json", "--timeout", str(_PATIENCE)]
    began = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=1.5 * _PATIENCE)
    seconds = time.perf_counter() - began
    if done.returncode not in (0, 10, 30):
        raise RuntimeError(f"exit code {done.returncode}: {done.stderr}")
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return json.loads(done.stdout), seconds, used.ru_utime + used.ru_stime, used.ru_maxrss / unit
