"""What a worker does: search one cube for a slice of time.

Task and result are plain values, so that a worker of another version can read them far enough to refuse.
"""

from __future__ import annotations

import time
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np

from robustness.cubes.cube import Cube, CubeQuestion, ids_of, software
from robustness.errors import InternalError
from robustness.kernels.layout import CLOSED, FAILED, FLUSH, FOUND, GROW, NODES, PAUSED, PROBES

__all__ = ["CLOSED_CUBE", "OPEN_CUBE", "PAIR_FOUND", "REFUSED", "kernel_search", "left_over", "solve"]

CLOSED_CUBE, OPEN_CUBE, PAIR_FOUND, REFUSED = "closed", "open", "found", "refused"

#: The search looks at the clock and the stop flag after so many seconds.
_LOOK = 0.02

#: A slice ends when its transcript has so many bytes, so that neither side runs out of memory.
_MOST_TRANSCRIPT = 1 << 26


def solve(task: dict[str, Any], stopped: Callable[[], bool] | None = None) -> dict[str, Any]:
    """Search one cube until it is closed, a pair is found, its slice is over or ``stopped()``.

    Parameters
    ----------
    task : dict
        As :meth:`CubeQuestion.as_task` makes it.
    stopped : callable, optional
        The stop flag, where the worker can see it.

    Returns
    -------
    dict
        ``status``: "closed"; "open" with ``rest``, the cube that is left; "found" with ``pair``; or "refused", by a
        worker of another version. ``question`` and ``cube``: digests of what was searched. ``transcript``: compressed,
        of what was refuted. ``nodes``, ``probes``, ``failed`` and ``seconds``.
    """
    if task["software"] != software():
        return {"status": REFUSED, "software": software(), "cube": task["cube"]}
    question = CubeQuestion.of_task(task)
    cube = Cube.from_wire((task["states"], task["symmetric"]), question.hears.shape[1])
    search, rules = kernel_search(question, cube)
    packer, parts, written = zlib.compressobj(1), [], 0
    started = time.monotonic()
    ends, quota, status = started + task["seconds"], 1, PAUSED
    while status not in (CLOSED, FOUND):
        begun = time.monotonic()
        status = search.run(quota)
        if question.transcript and status in (CLOSED, FLUSH, PAUSED):
            parts.append(packer.compress(np.asarray(rules.buffer)[: rules.place].tobytes()))
            written += rules.place
            rules.place = 0
        if status == GROW:
            search.stack = np.concatenate([np.asarray(search.stack), np.zeros_like(search.stack)])
            search.table = np.concatenate([np.asarray(search.table), np.zeros_like(search.table)])
        elif status == PAUSED:
            now = time.monotonic()
            if now >= ends or written > _MOST_TRANSCRIPT or (stopped is not None and stopped()):
                break
            quota = int(min(max(quota * min(4.0, _LOOK / max(now - begun, 1e-6)), 1), 1 << 30))
        elif status not in (CLOSED, FOUND, FLUSH):
            raise InternalError(f"the search kernel stopped with status {status}: please report")
    counters = np.asarray(search.counters)
    result: dict[str, Any] = {
        "status": {CLOSED: CLOSED_CUBE, FOUND: PAIR_FOUND}.get(status, OPEN_CUBE),
        "software": software(),
        "question": question.key,
        "cube": cube.key,
        "nodes": int(counters[NODES]),
        "failed": int(counters[FAILED]),
        "probes": int(counters[PROBES]),
        "seconds": time.monotonic() - started,
        "transcript": b"".join([*parts, packer.flush()]) if question.transcript and status != FOUND else b"",
    }
    if status == FOUND:
        result["pair"] = [sorted(ids_of(side)) for side in np.asarray(search.pair)]
    elif status == PAUSED:
        result["rest"] = left_over(search).to_wire()
    return result


def kernel_search(question: CubeQuestion, cube: Cube) -> tuple[Any, Any]:
    """Return the kernel's search, set upon a cube, and its rules."""
    from robustness.kernels.search_loop import Search
    from robustness.kernels.search_rules import Rules

    n, words = question.hears.shape
    rules = Rules(question.hears, question.need, question.spare, question.blockers, question.sharing)
    if question.transcript:
        rules.buffer, rules.place = np.empty(32 * n * n + 4096 + 2**16, np.uint8), 0
    search = Search(rules, question.look_ahead)
    k = len(cube.symmetric)
    if k > len(np.asarray(search.stack)):
        search.stack, search.table = np.zeros((2 * k, 8, words), np.uint64), np.zeros((2 * k, 3), np.int64)
    np.asarray(search.stack)[:k] = cube.states
    np.asarray(search.table)[:k] = [(1, flag, 0) for flag in cube.symmetric]
    search.level = k - 1
    return search, rules


def left_over(search: Any) -> Cube:
    """Return the cube that a paused search has still to do: every level of its stack is pending."""
    k = search.level + 1
    table = np.asarray(search.table)[:k]
    if not table[:, 0].all():
        raise InternalError("a paused search has a level that is not pending: please report")
    return Cube(np.asarray(search.stack)[:k].copy(), tuple(bool(flag) for flag in table[:, 1]))
