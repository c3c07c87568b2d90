"""Cubes on a real Dask cluster, whose processes are killed in the middle of a search."""

from __future__ import annotations

import json
import logging
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import robustness as rb
from cli.main import robustness as program
from robustness.cubes import opened_cluster, software, spreading
from robustness.evidence import Refutation
from tests.cubes.instances import ENDLESS, LONG, MIDDLE, SMALL

distributed = pytest.importorskip("distributed")

#: Its sockets and loops are collected when they are; what it logs about the dead is not ours.
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning"),
]


@pytest.fixture(autouse=True)
def quiet() -> None:
    for name in ("distributed", "tornado", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)


@contextmanager
def process(*arguments: str, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a process of Dask, and end it."""
    started = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | environment,
        start_new_session=True,
    )
    try:
        yield started
    finally:
        with suppress(ProcessLookupError):
            os.killpg(started.pid, signal.SIGKILL)
        started.wait()


def scheduler(port: int) -> Any:
    return process("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")


def worker(port: int, *arguments: str, **environment: str) -> Any:
    return process(
        "dask_worker", f"tcp://127.0.0.1:{port}", "--nthreads", "1", "--no-dashboard", *arguments, **environment
    )


def free_port() -> int:
    import socket

    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def wait_for_workers(client: Any, number: int) -> None:
    client.wait_for_workers(number, timeout=60)


def test_an_address_is_looked_at() -> None:
    for address in ("local:0", "local:two", "here", "tcp:", "http://host:1"):
        with pytest.raises(rb.InvalidParameter, match="a cluster is tcp://HOST:PORT"), opened_cluster(address):
            pass


def test_workers_killed_at_random_times_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spreading, "_FIRST_SLICE", 0.05)
    graph, r = MIDDLE
    alone = rb.check_rs_robustness(graph, r, transcript=True).basis
    draws, over, killed = random.Random(5), threading.Event(), []
    with opened_cluster("local:2") as client:
        same = rb.check_rs_robustness(graph, r, executor=client)
        assert same.verdict is rb.Verdict.ROBUST

        def kill_now_and_then() -> None:
            while len(killed) < 2 and not over.wait(draws.uniform(0.02, 0.4)):
                pids = [int(pid) for pid in client.run(os.getpid).values()]
                if pids:
                    os.kill(draws.choice(pids), signal.SIGKILL)
                    killed.append(1)

        killer = threading.Thread(target=kill_now_and_then)
        killer.start()
        for _ in range(20):  # a search may end before anybody is killed
            found = rb.check_rs_robustness(graph, r, transcript=True, executor=client, time_limit=120)
            if killed:
                break
        over.set()
        killer.join()
    assert killed
    assert found.verdict is rb.Verdict.ROBUST
    assert isinstance(found.basis, Refutation)
    assert found.basis == alone  # byte for byte the transcript of one thread


def test_a_worker_of_another_version_is_refused_and_the_others_go_on(tmp_path: Path) -> None:
    old = tmp_path / "old.py"
    old.write_text(
        "def dask_setup(worker):\n"
        "    from robustness.cubes import solving\n"
        "    solving.software = lambda: '0.0.1/1/old'\n"
    )
    port = free_port()
    with ExitStack() as stack:
        stack.enter_context(scheduler(port))
        stack.enter_context(worker(port, "--no-nanny", "--preload", str(old)))
        client = stack.enter_context(opened_cluster(f"tcp://127.0.0.1:{port}"))
        wait_for_workers(client, 1)
        with pytest.warns(rb.GraphWarning, match=r"refused: worker tcp://.* has version 0.0.1/1/old, not"):
            alone = rb.check_rs_robustness(*LONG, executor=client, time_limit=8)
        assert alone.verdict is rb.Verdict.UNDECIDED
        stack.enter_context(worker(port, "--no-nanny"))
        wait_for_workers(client, 2)
        with pytest.warns(rb.GraphWarning, match="install the same"):
            found = rb.check_rs_robustness(*LONG, executor=client, time_limit=120)
    assert found.verdict is rb.Verdict.ROBUST
    assert found.stats["lost"] == 0
    assert software() != "0.0.1/1/old"


def test_workers_out_of_memory_leave_it_undecided(tmp_path: Path) -> None:
    """Every worker that gets a cube asks for more memory than it may have, and its nanny ends it."""
    greedy = tmp_path / "greedy.py"
    greedy.write_text(
        "def dask_setup(worker):\n"
        "    from robustness.cubes import executors\n"
        "    def solve(task):\n"
        "        import resource\n"
        "        resource.setrlimit(resource.RLIMIT_AS, (1 << 32, 1 << 32))\n"
        "        return {'much': bytearray(1 << 36)}\n"
        "    executors.solve = solve\n"
    )
    port = free_port()
    with ExitStack() as stack:
        stack.enter_context(scheduler(port))
        stack.enter_context(worker(port, "--no-nanny", "--preload", str(greedy)))
        client = stack.enter_context(opened_cluster(f"tcp://127.0.0.1:{port}"))
        wait_for_workers(client, 1)
        found = rb.check_rs_robustness(*LONG, executor=client, time_limit=120)
    assert found.verdict is rb.Verdict.UNDECIDED
    assert found.stats["reason"].startswith("a cube was lost 5 times: MemoryError")


def test_a_scheduler_that_is_killed_and_the_journal(tmp_path: Path) -> None:
    """The search ends right or UNDECIDED, and goes on from its journal on a new cluster."""
    port, state = free_port(), tmp_path / "state"
    with ExitStack() as stack:
        first = stack.enter_context(scheduler(port))
        stack.enter_context(worker(port, "--no-nanny"))
        client = stack.enter_context(opened_cluster(f"tcp://127.0.0.1:{port}"))
        wait_for_workers(client, 1)
        threading.Timer(1.5, os.killpg, [first.pid, signal.SIGKILL]).start()
        found = rb.check_rs_robustness(*LONG, executor=client, state=state, time_limit=10)
        assert found.verdict in (rb.Verdict.ROBUST, rb.Verdict.UNDECIDED)
    known = state.read_bytes().count(b"\n")
    assert known > 1
    with opened_cluster("local:1") as client:
        found = rb.check_rs_robustness(*LONG, executor=client, state=state)
    assert found.verdict is rb.Verdict.ROBUST


def test_the_command(tmp_path: Path) -> None:
    small, endless = tmp_path / "small.json", tmp_path / "endless.json"
    small.write_bytes(SMALL[0].canonical_bytes())
    endless.write_bytes(ENDLESS[0].canonical_bytes())
    base = [sys.executable, "-m", "robustness"]
    certify = [*base, "certify", str(small), "-r", str(SMALL[1]), "-o", str(tmp_path / "proof"), "--cluster", "local:1"]
    done = subprocess.run(certify, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    limited = ["--cluster", "local:2", "--timeout", "6", "--json", "--state", str(tmp_path / "state")]
    done = subprocess.run(
        [*base, "check", str(endless), "-r", str(ENDLESS[1]), *limited],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 30, done.stderr
    document = json.loads(done.stdout)
    assert document["estimate"]["workers"] == 2
    assert document["estimate"]["closed"] < 0.2
    assert "by workers" in document["trusted"]
    bad = subprocess.run([*base, "check", str(small), "--cluster", "x"], capture_output=True, text=True, check=False)
    assert bad.returncode == 2
    assert "a cluster is tcp://HOST:PORT" in bad.stderr


def test_a_cluster_whose_workers_are_killed_while_it_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is started again, and given up with a word: no worker that is killed at whatever moment ends in an error."""
    begin, failures = distributed.LocalCluster, [RuntimeError("Nanny failed to start."), OSError("no more processes")]

    def start(**options: Any) -> Any:
        if failures:
            raise failures.pop()
        return begin(**options)

    monkeypatch.setattr(distributed, "LocalCluster", start)
    with opened_cluster("local:1") as client:
        assert len(client.scheduler_info()["workers"]) == 1
    failures += [RuntimeError("Nanny failed to start.")] * 3
    with pytest.raises(rb.Undecided, match=r"local:1 did not start \(Nanny"), opened_cluster("local:1"):
        pass
    failures += [RuntimeError("Nanny failed to start.")] * 3
    done = CliRunner().invoke(program, ["check", "topohub:sndlib/abilene", "-r", "1", "--cluster", "local:1"])
    assert (done.exit_code, "Traceback" in done.output) == (30, False)


def test_two_local_clusters_at_a_time_say_nothing_of_ports(recwarn: pytest.WarningsRecorder) -> None:
    with opened_cluster("local:1"), opened_cluster("local:1"):
        pass
    assert not [each for each in recwarn if "already in use" in str(each.message)]


def is_there(group: int) -> bool:
    """Return whether any process of a group is left."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.parametrize(
    ("command", "lines"),
    [
        (["check", "-r", str(ENDLESS[1]), "--state", "state"], 6),
        (["certify", "-r", str(ENDLESS[1]), "-o", "proof", "--state", "state"], 0),
        (["survey"], 0),
    ],
    ids=["check, at work", "certify, that starts", "survey"],
)
def test_ctrl_c_at_a_terminal_goes_to_all_processes_and_ends_in_a_word(
    command: list[str], lines: int, tmp_path: Path
) -> None:
    """No worker cries out, none is left, and nobody waits for them."""
    (tmp_path / "net.json").write_bytes(ENDLESS[0].canonical_bytes())
    process = subprocess.Popen(
        [sys.executable, "-m", "robustness", command[0], "net.json", *command[1:], "--cluster", "local:2"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    with process:
        state, ends = tmp_path / "state", time.monotonic() + 120
        while lines and time.monotonic() < ends and not (state.exists() and state.read_bytes().count(b"\n") > lines):
            time.sleep(0.05)
        if not lines:
            time.sleep(2)
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60)
    ends = time.monotonic() + 30
    while is_there(process.pid) and time.monotonic() < ends:
        time.sleep(0.1)
    assert process.returncode == 130
    assert "Traceback" not in said
    assert "warn" not in said
    assert "interrupted: " in said
    assert not is_there(process.pid)
