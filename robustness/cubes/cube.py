"""Cubes: what is left to refute of a question, small enough to send to another process, and the answer that comes back.

A cube is a stack of states that have not been propagated (docs/adr/0003). It stands for all violating pairs that any of
them stands for, and the search takes its last state first. So a cube can be cut between any two states: the parts are
cubes, and their transcripts, the last part's first, make the transcript of the whole.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness import kernels
from robustness.kernels import sources

__all__ = ["Cube", "CubeQuestion", "Words", "ids_of", "software", "whole_state"]

Words = npt.NDArray[np.uint64]

#: Counts the ways in which coordinator and workers have talked to each other.
_PROTOCOL = 2


@cache
def software() -> str:
    """Return what tells this version of the search from every other: coordinator and worker must have the same."""
    try:
        released = version_of("graph-robustness")
    except PackageNotFoundError:  # a checkout that is not installed
        released = "checkout"
    folder = Path(str(kernels.__file__)).parent
    return f"{released}/{_PROTOCOL}/{sources.digest(folder)[:16]}"


def whole_state(n: int) -> Words:
    """Return the state in which every node may be a satisfied member of either set."""
    state = np.zeros((8, max(1, -(-n // 64))), np.uint64)
    for node in range(n):
        state[:4, node // 64] |= np.uint64(1) << np.uint64(node % 64)
    return state


def ids_of(words: Words) -> frozenset[int]:
    """Return the ids in a row of a state."""
    return frozenset(np.flatnonzero(np.unpackbits(words.view(np.uint8), bitorder="little")).tolist())


@dataclass(frozen=True, eq=False)
class Cube:
    """A stack of pending states.

    Attributes
    ----------
    states : array of uint64, shape (k, 8, words)
        Rows as in :mod:`robustness.kernels.search_rules`; k >= 1.
    symmetric : tuple of bool, length k
        Which of them are still symmetric in the two sides.
    """

    states: Words
    symmetric: tuple[bool, ...]

    @classmethod
    def whole(cls, n: int) -> Cube:
        """Return the cube that stands for every violating pair on n nodes."""
        return cls(whole_state(n)[np.newaxis], (True,))

    @classmethod
    def from_wire(cls, wire: Any, words: int) -> Cube:
        """Return the cube that :meth:`to_wire` has written; raise ValueError for what is none."""
        data, flags = wire
        if not isinstance(data, bytes) or not isinstance(flags, str) or not flags or set(flags) - {"0", "1"}:
            raise ValueError("a cube is its states as bytes and a flag 0 or 1 for each")
        states = np.frombuffer(data, "<u8").astype(np.uint64).reshape(len(flags), 8, words)
        return cls(states, tuple(flag == "1" for flag in flags))

    def to_wire(self) -> tuple[bytes, str]:
        """Return the cube as bytes and a text of flags, the same on every machine."""
        return self.states.astype("<u8").tobytes(), "".join("1" if flag else "0" for flag in self.symmetric)

    @cached_property
    def key(self) -> str:
        """A digest of what the cube is: two cubes with the same key are the same subproblem."""
        data, flags = self.to_wire()
        return hashlib.sha256(flags.encode() + b" " + data).hexdigest()[:32]

    def cut(self, parts: int) -> list[Cube]:
        """Return at most ``parts`` cubes that make this one, in the order of the proof: the last states first.

        The first states stand nearest to the root and have most of the work, so each becomes a cube of its own.
        """
        k = len(self.symmetric)
        at = min(parts, k) - 1
        rest = [] if at >= k else [Cube(self.states[at:].copy(), self.symmetric[at:])]
        return rest + [Cube(self.states[i : i + 1].copy(), self.symmetric[i : i + 1]) for i in reversed(range(at))]


@dataclass(frozen=True, eq=False)
class CubeQuestion:
    """What all cubes of a search are about, and how they are searched.

    Attributes
    ----------
    hears : array of uint64, shape (n, words)
        Bit j of row i: i hears j.
    need : array of int64, shape (n,)
        ``max(0, d_i - r + 1)``.
    spare : int
        ``s - 1``.
    transcript : bool
        Whether refutations are recorded.
    blockers, look_ahead, sharing
        Switches of the search.
    """

    hears: Words
    need: npt.NDArray[np.int64]
    spare: int
    transcript: bool
    blockers: int
    look_ahead: bool
    sharing: bool = True

    @cached_property
    def key(self) -> str:
        """A digest of what is asked: cubes of several questions can be the same, and what is true of them is not."""
        switches = self.spare, self.transcript, self.blockers, self.look_ahead, self.sharing
        numbers = json.dumps([*self.hears.shape, *map(int, switches)]).encode()
        data = self.hears.astype("<u8").tobytes() + self.need.astype("<i8").tobytes()
        return hashlib.sha256(numbers + b" " + data).hexdigest()[:32]

    def as_task(self, cube: Cube, seconds: float) -> dict[str, Any]:
        """Return a cube, its question and its slice of time as plain values, for a worker."""
        states, flags = cube.to_wire()
        return {
            "software": software(),
            "question": self.key,
            "cube": cube.key,
            "states": states,
            "symmetric": flags,
            "hears": self.hears.astype("<u8").tobytes(),
            "need": self.need.astype("<i8").tobytes(),
            "spare": self.spare,
            "transcript": self.transcript,
            "blockers": self.blockers,
            "look_ahead": self.look_ahead,
            "sharing": self.sharing,
            "seconds": seconds,
        }

    @classmethod
    def of_task(cls, task: dict[str, Any]) -> CubeQuestion:
        """Return the question of a task."""
        need = np.frombuffer(task["need"], "<i8").astype(np.int64)
        hears = np.frombuffer(task["hears"], "<u8").astype(np.uint64).reshape(len(need), -1)
        switches = task["blockers"], task["look_ahead"], task["sharing"]
        return cls(hears, need, task["spare"], task["transcript"], *switches)
