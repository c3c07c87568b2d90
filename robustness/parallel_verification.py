"""Verifying a long refutation by several processes, each of which runs the kernel on some of its trees.

The trees that can be verified apart stand in a file of their own beside the certificate, ``FILE.cubes``, which
certify writes when it has verified the whole: a hint that the kernel does not trust (:mod:`certificates.shares`).
When anything but a verified claim comes of the shares, the whole is verified by one process, whose verdict is the one
that counts.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from itertools import chain
from pathlib import Path
from typing import Any

from certificates import RejectedCertificate, VerifiedClaim, VerifiedToleranceClaim, verify
from certificates.file_bytes import certificate_blocks
from certificates.shares import Share, together, verify_share
from certificates.stream import Stream
from robustness.files.writing import replace_file, write_certificate
from robustness.limits import Limits, Progress
from robustness.transcripts import Transcript
from robustness.whole_file import read_text

__all__ = ["cubes_beside", "verify_in_parallel", "verify_listing", "write_with_cubes"]

_FORMAT = "robustness/cubes-index/1"

#: A body of fewer bytes is verified in a second or two; the others are cut into trees of one part in so many at most.
_WORTH_IT, _PARTS = 2**17, 16

Cubes = tuple[tuple[int, int], ...]


def verify_listing(
    graph_bytes: bytes, header: bytes, body: bytes | Transcript, limits: Limits
) -> tuple[VerifiedClaim, Cubes]:
    """Return what the kernel proves from a certificate, and the trees in it that can be verified apart."""
    size = len(header) + len(body)
    stream = Stream(_telling(chain((header,), _blocks(body)), size, limits.progress))
    stream.trees = []
    claim = verify(graph_bytes, stream)
    return claim, _chosen(stream.trees, len(body))


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
        Each process reads the file for itself.
    cubes : tuple of (int, int)
        As :func:`cubes_beside` finds them.
    jobs : int
        Processes.
    tell : callable
        Gets a few words on how far the work is.
    """
    count = min(jobs, max(1, len(cubes)))
    running: list[subprocess.Popen[bytes]] = []
    is_over = threading.Event()

    def share(number: int) -> Share | None:
        asked = pickle.dumps((sys.path, os.getpid(), graph_bytes, str(certificate), cubes, number, count))
        if is_over.is_set():
            return None
        with subprocess.Popen(  # noqa: S603  # our own interpreter and program
            [sys.executable, "-c", _CHILD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        ) as process:
            running.append(process)
            said, _ = process.communicate(asked)
        found = pickle.loads(said) if process.returncode == 0 else None  # noqa: S301  # said by our own process
        return found if isinstance(found, Share) else None

    shares: list[Share] = []
    try:
        with ThreadPoolExecutor(jobs) as pool:
            try:
                for future in as_completed([pool.submit(share, number) for number in range(count)]):
                    found = future.result()
                    if found is None:
                        return None
                    shares.append(found)
                    tell(f"{100 * len(shares) // count} % of the certificate verified, by {jobs} processes")
            finally:
                is_over.set()
                for process in running:
                    process.kill()
        return together(shares)
    except (OSError, RejectedCertificate):
        return None


#: What a process does: it finds our packages where its parent does.
_CHILD = """
import pickle, sys
asked = pickle.load(sys.stdin.buffer)
sys.path[:] = asked[0]
from robustness.parallel_verification import answer_parent
answer_parent(*asked[1:])
"""


def answer_parent(parent: int, graph_bytes: bytes, path: str, cubes: Cubes, number: int, count: int) -> None:
    """Verify one share and write it to the standard output; end when the parent is gone."""

    def look(done: int, size: int) -> None:
        if os.name == "posix" and os.getppid() != parent:
            os._exit(1)

    try:
        share = verify_share(graph_bytes, certificate_blocks(path, look), cubes, number, count)
    except Exception:  # noqa: BLE001  # whatever it is: one process verifies the whole, and says it
        sys.exit(1)
    sys.stdout.buffer.write(pickle.dumps(share))


def _index_of(certificate: Path) -> Path:
    return certificate.with_name(certificate.name + ".cubes")


def _blocks(body: bytes | Transcript) -> Iterable[bytes]:
    return (body,) if isinstance(body, bytes) else body


def _telling(blocks: Iterable[bytes], size: int, progress: Callable[[Progress], None] | None) -> Iterator[bytes]:
    done = 0
    for block in blocks:
        if progress is not None:
            progress(Progress(0, f"{100 * done // size} % of the certificate verified"))
        done += len(block)
        yield block


def _chosen(trees: list[tuple[int, int]], size: int) -> Cubes:
    """Return trees to verify apart: the largest of those that are no more than a part; none of a short transcript."""
    chosen: list[tuple[int, int]] = []
    end = 0
    for start, length in sorted(trees, key=lambda tree: (tree[0], -tree[1])) if size > _WORTH_IT else ():
        if start >= end and length <= size // _PARTS:
            chosen.append((start, length))
            end = start + length
    return tuple(chosen)
