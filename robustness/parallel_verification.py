"""Verifying a long refutation by several processes, each of which runs the kernel on some of its trees.

Which trees can be verified apart is a hint that the kernel does not trust (:mod:`certificates.shares`). certify has it
from the search, of the parts that were handed on; verify from a file beside the certificate, ``FILE.cubes``, which
certify writes when it has verified the whole. When anything but a verified claim comes of the shares, the whole is
verified by one process, whose verdict is the one that counts.
"""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import Any

from certificates import CertificateError, MalformedCertificate, VerifiedClaim, VerifiedToleranceClaim, verify
from certificates.file_bytes import certificate_blocks
from certificates.shares import Share, together
from certificates.stream import Stream
from robustness.errors import Undecided
from robustness.files.writing import replace_file, write_certificate
from robustness.limits import Limits, Progress
from robustness.transcripts import Transcript
from robustness.whole_file import read_text

__all__ = ["cubes_beside", "verify_in_parallel", "verify_listing", "write_with_cubes"]

_FORMAT = "robustness/cubes-index/1"

#: A body of fewer bytes is verified in a second or two; the others are cut into trees of one part in so many at most.
_WORTH_IT, _PARTS = 2**17, 16

#: Seconds between two looks at how far the processes are.
_LOOK = 0.2

#: Bytes that a process is told at a time.
_BLOCK = 2**16

Cubes = tuple[tuple[int, int], ...]

#: Gives the bytes of a certificate, from the beginning, and tells how much of how much has been taken.
_Source = Callable[[Callable[[int, int], object]], Iterator[bytes]]


def verify_listing(
    graph_bytes: bytes, header: bytes, body: bytes | Transcript, limits: Limits
) -> tuple[VerifiedClaim, Cubes]:
    """Return what the kernel proves from a certificate, and the trees in it that can be verified apart.

    A transcript is shared out to as many processes as ``limits`` has threads, by the trees that the search handed on.
    What is returned does not depend on that.

    Raises
    ------
    Undecided
        When the time limit passes over a long transcript.
    """
    size = len(header) + len(body)
    parts = _chosen(body.trees, len(body)) if isinstance(body, Transcript) else ()
    if limits.jobs > 1 and parts:

        def blocks(told: Callable[[int, int], object]) -> Iterator[bytes]:
            return _telling(chain((header,), _blocks(body)), size, told)

        def tell(words: str) -> None:
            _keep_the_limit(limits)
            if limits.progress is not None:
                limits.progress(Progress(0, words))

        shares = _verified_shares(graph_bytes, blocks, parts, limits.jobs, tell)
        claim = _together(shares)
        if isinstance(claim, VerifiedClaim):
            return claim, _chosen({tree for share in shares for tree in share.trees}, len(body))

    def look(done: int, size: int) -> None:
        if done > _WORTH_IT:
            _keep_the_limit(limits)
        if limits.progress is not None:
            limits.progress(Progress(0, f"{100 * done // size} % of the certificate verified"))

    stream = Stream(_telling(chain((header,), _blocks(body)), size, look))
    stream.trees = []
    return verify(graph_bytes, stream), _chosen(stream.trees, len(body))


def write_with_cubes(output: Path, header: bytes, body: bytes | Transcript, cubes: Cubes) -> dict[str, Any]:
    """Write a certificate and, if there are any, the trees that can be verified apart; say what was written."""
    size = len(header) + len(body)
    write_certificate(output, chain((header,), _blocks(body)))
    written: dict[str, Any] = {"certificate": str(output), "bytes": size}
    if cubes:
        index = _index_of(output)
        replace_file(index, json.dumps({"format": _FORMAT, "bytes": size, "cubes": cubes}).encode("ascii"))
        written["cubes"] = str(index)
    return written


def cubes_beside(certificate: Path) -> Cubes:
    """Return the cubes that the file beside a certificate names; none when there is no such file, or another one."""
    try:
        document = json.loads(read_text(_index_of(certificate)))
        if document["format"] != _FORMAT:
            return ()
        return tuple((start, length) for start, length in document["cubes"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ()


def verify_in_parallel(
    graph_bytes: bytes, certificate: Path, cubes: Cubes, jobs: int, tell: Callable[[str], object]
) -> VerifiedClaim | VerifiedToleranceClaim | None:
    """Return what all shares of a certificate prove together; None when that is nothing, for whatever reason.

    Parameters
    ----------
    graph_bytes : bytes
    certificate : Path
        It is read once for each process.
    cubes : tuple of (int, int)
        As :func:`cubes_beside` finds them.
    jobs : int
        Processes.
    tell : callable
        Gets a few words on how far the work is.
    """

    def blocks(told: Callable[[int, int], object]) -> Iterator[bytes]:
        return certificate_blocks(certificate, told)

    return _together(_verified_shares(graph_bytes, blocks, cubes, jobs, tell))


def _together(shares: list[Share]) -> VerifiedClaim | VerifiedToleranceClaim | None:
    try:
        return together(shares)
    except CertificateError:
        return None


def _verified_shares(
    graph_bytes: bytes, blocks: _Source, cubes: Cubes, jobs: int, tell: Callable[[str], object]
) -> list[Share]:
    """Return the shares of a certificate, each accepted by a process of its own; fewer when one was not."""
    count = min(jobs, max(1, len(cubes)))
    part_done = [0.0] * count

    def share(number: int) -> Share | None:
        def told(done: int, size: int) -> None:
            part_done[number] = done / size if size else 0.0

        asked = pickle.dumps((sys.path, (graph_bytes, cubes, number, count)))
        return children.answer(chain((asked,), blocks(told)))

    children = _Children()
    shares: list[Share] = []
    with ThreadPoolExecutor(count) as pool:
        try:
            waiting = {pool.submit(share, number) for number in range(count)}
            while waiting:
                done, waiting = wait(waiting, _LOOK, FIRST_COMPLETED)
                for future in done:
                    found = future.result()
                    if found is None:
                        return []
                    shares.append(found)
                part = sum(part_done) / count if waiting else 1.0
                tell(f"{int(100 * part)} % of the certificate verified, by {jobs} processes")
        except (OSError, MalformedCertificate, RuntimeError):  # what is read, or too few threads: the whole says it
            return []
        finally:
            children.end()
    return shares


#: What a process does: it finds our packages where its parent does. When the parent is gone its input ends.
_CHILD = """
import pickle, sys
path, asked = pickle.load(sys.stdin.buffer)
sys.path[:] = path
from certificates.shares import verify_share
graph, *which = asked
share = verify_share(graph, iter(lambda: sys.stdin.buffer.read(65536), b""), *which)
sys.stdout.buffer.write(pickle.dumps(share))
"""


class _Children:
    """The processes of one verification, which end together."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._running: list[subprocess.Popen[bytes]] = []
        self._is_over = False

    def end(self) -> None:
        """End all, and whatever is started from now on."""
        with self._lock:
            self._is_over = True
            for process in self._running:
                process.kill()

    def answer(self, told: Iterable[bytes]) -> Share | None:
        """Return the share that a process accepts which is told this; None when it accepts none."""
        if not sys.executable or getattr(sys, "frozen", False):  # no Python that could be started
            return None
        with subprocess.Popen(  # noqa: S603  # our own interpreter and program
            [sys.executable, "-I", "-c", _CHILD],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=_BLOCK,
        ) as process:
            with self._lock:
                self._running.append(process)
                if self._is_over:
                    process.kill()
            try:
                said = _conversation(process, told)
            except BaseException:
                process.kill()
                raise
        try:
            found = pickle.loads(said) if process.returncode == 0 else None  # noqa: S301  # said by our own process
        except Exception:  # noqa: BLE001  # something else that Python starts with has written there
            return None
        return found if isinstance(found, Share) else None


def _conversation(process: subprocess.Popen[bytes], told: Iterable[bytes]) -> bytes:
    """Tell a process something, and return what it says when it has heard all; one that has ended hears nothing."""
    if process.stdin is None or process.stdout is None:
        return b""
    with suppress(BrokenPipeError):
        for block in told:
            process.stdin.write(block)
    with suppress(BrokenPipeError):
        process.stdin.close()
    return process.stdout.read()


def _index_of(certificate: Path) -> Path:
    return certificate.with_name(certificate.name + ".cubes")


def _blocks(body: bytes | Transcript) -> Iterable[bytes]:
    return (body,) if isinstance(body, bytes) else body


def _telling(blocks: Iterable[bytes], size: int, told: Callable[[int, int], object]) -> Iterator[bytes]:
    done = 0
    for block in blocks:
        told(done, size)
        done += len(block)
        yield block


def _keep_the_limit(limits: Limits) -> None:
    if limits.expired():
        raise Undecided("the time limit was reached before the proof was verified")


def _chosen(trees: Iterable[tuple[int, int]], size: int) -> Cubes:
    """Return trees to verify apart: the largest of those that are no more than a part; none of a short transcript."""
    chosen: list[tuple[int, int]] = []
    end = 0
    for start, length in sorted(trees, key=lambda tree: (tree[0], -tree[1])) if size > _WORTH_IT else ():
        if start >= end and 0 < length <= size // _PARTS:
            chosen.append((start, length))
            end = start + length
    return tuple(chosen)
