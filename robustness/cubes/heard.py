"""What a worker said, read with suspicion: either all of it is in order, or none of it counts."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass
from typing import Any

from robustness.cubes.cube import Cube, CubeQuestion, software
from robustness.cubes.solving import CLOSED_CUBE, OPEN_CUBE, PAIR_FOUND, REFUSED

__all__ = ["MOST", "Heard", "WrongResult", "heard"]

#: No count of a slice is as great, so that sums of them stay numbers that can be divided.
MOST = 1 << 62


class WrongResult(Exception):
    """A result that counts as lost, and why."""


@dataclass(frozen=True, slots=True)
class Heard:
    """A result that is in order.

    Attributes
    ----------
    status : str
        As :func:`robustness.cubes.solving.solve` returns it.
    worker : str
        Who it was, where that is known.
    version : str or None
        Of a worker that has another than this process; then nothing else is known.
    pair : two tuples of int
        As it was said: not checked against anything.
    rest : Cube or None
        What is left.
    packed, size
        The transcript, compressed, and its length before.
    nodes, probes, failed, seconds
        What it took.
    """

    status: str
    worker: str = ""
    version: str | None = None
    pair: tuple[tuple[int, ...], tuple[int, ...]] = (), ()
    rest: Cube | None = None
    packed: bytes = b""
    size: int = 0
    nodes: int = 0
    probes: int = 0
    failed: int = 0
    seconds: float = 0.0


def heard(result: Any, question: CubeQuestion, cube: Cube) -> Heard:
    """Return what a worker said about a cube of a question; raise WrongResult when any of it is not in order."""
    try:
        return _read(result, question, cube)
    except WrongResult:
        raise
    except Exception as broken:  # noqa: BLE001 - whatever it takes to read what somebody made up
        raise WrongResult(f"a result that cannot be read ({type(broken).__name__}: {broken})"[:200]) from None


def _read(result: Any, question: CubeQuestion, cube: Cube) -> Heard:
    status, worker = result["status"], str(result.get("worker", ""))
    if status == REFUSED or result["software"] != software():
        return Heard(REFUSED, worker, str(result["software"])[:100])
    if result["question"] != question.key:
        raise WrongResult("a result about another question")
    if result["cube"] != cube.key:
        raise WrongResult("a result about another cube")
    if status == PAIR_FOUND:
        first, second = (tuple(int(i) for i in side) for side in result["pair"])
        return Heard(status, worker, pair=(first, second))
    if status not in (CLOSED_CUBE, OPEN_CUBE):
        raise WrongResult(f"a result with the status {status!r}"[:200])
    rest = None
    if status == OPEN_CUBE:
        rest = Cube.from_wire(result["rest"], question.hears.shape[1])
        if rest.key == cube.key:
            raise WrongResult("a result that leaves the cube as it was")
    packed = result["transcript"]
    if not isinstance(packed, bytes):
        raise WrongResult("a result whose transcript is not bytes")
    size = len(zlib.decompress(packed)) if question.transcript else 0
    nodes, probes, failed = (_count(result[name]) for name in ("nodes", "probes", "failed"))
    seconds = float(result["seconds"])
    if not (math.isfinite(seconds) and seconds >= 0):
        raise WrongResult(f"a result that took {seconds} seconds")
    return Heard(status, worker, None, ((), ()), rest, packed, size, nodes, probes, failed, seconds)


def _count(number: Any) -> int:
    if type(number) is not int or not 0 <= number < MOST:
        raise WrongResult(f"a result that counts {number!r}"[:200])
    return number
