"""One network of a survey: what is asked of it, and the row of facts that answers."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robustness.decision.front import check_rs_robustness, determine_robustness
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter, RobustnessError
from robustness.limits import Limits
from robustness.mending import MendResult
from robustness.results import Bounds, RobustnessResult, Verdict
from robustness.threat_models import THREAT_MODELS, ToleranceTable, tolerance

__all__ = ["Findings", "Gate", "Question", "Row", "measure", "unreadable"]

#: What a gate says of a network, from best to worst. An error is worst: the network was not even asked about.
STANDINGS = ("passed", "undecided", "refuted", "error")

#: What stands in a table for a network that nothing was asked about.
NOT_REACHED = "not reached before the survey ended: nothing is claimed"


@dataclass(frozen=True, slots=True)
class Gate:
    """What every network of a survey has to fulfil; a part that is None asks nothing.

    Attributes
    ----------
    r, s : int or None, int
        The network is (r,s)-robust.
    survive : int or None
        Agreement is guaranteed with this many malicious nodes, under each of the models that the survey looks at.
    """

    r: int | None = None
    s: int = 1
    survive: int | None = None

    def __post_init__(self) -> None:
        for name, value, least in (("r", self.r, 0), ("s", self.s, 1), ("survive", self.survive, 0)):
            if value is not None and (type(value) is not int or value < least):
                raise InvalidParameter(f"{name} of a gate is an integer of at least {least}, not {value!r}")


@dataclass(frozen=True, slots=True)
class Question:
    """What a survey asks of each network.

    Attributes
    ----------
    models : tuple of str
        Threat models, names in ``THREAT_MODELS``; none: only r* and s.
    gate : Gate
    time_limit : float or None
        Seconds for one network.
    seed : int
    mending : float
        Seconds for one network to find the fewest links that mend it; 0: not asked.
    """

    models: tuple[str, ...] = tuple(THREAT_MODELS)
    gate: Gate = field(default_factory=Gate)
    time_limit: float | None = None
    seed: int = 0
    mending: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Return the question as JSON-ready values: two surveys with equal ones give equal rows, seconds aside."""
        gate = {"r": self.gate.r, "s": self.gate.s, "survive": self.gate.survive}
        asked = {"models": list(self.models), "gate": gate, "time_limit": self.time_limit, "seed": self.seed}
        return asked | ({"mending": self.mending} if self.mending else {})


@dataclass(frozen=True, slots=True)
class Row:
    """What is known about one network.

    Attributes
    ----------
    network : str
        The name it was asked for by: a path, ``topohub:GROUP/NAME``, or the caller's own.
    nodes, arcs : int or None
        None when it could not be read. An undirected link is two arcs.
    directed : bool or None
    r, r_at_most : int or None
        ``r <= r* <= r_at_most``, equal when r* is known.
    s, s_at_most : int or None
        ``s <= s_max(r*) <= s_at_most``; None while r* is not known.
    guaranteed : mapping from model to int
        The largest f promised; -1 when not even agreement without liars.
    refuted : mapping from model to int or None
        The smallest f with an attack; None when none is known.
    gate : str
        ``"passed"``, ``"undecided"``, ``"refuted"``, ``"error"``, or ``""`` when nothing was required.
    links, links_at_least : int or None
        How many further links give the network what the gate asks and it lacks (without a gate, one more r): so many
        were found, and so many are needed at least; 0 where nothing is lacking. None when not asked, and not known.
    weakest : dict or None
        The violating pair of (r* + 1)-robustness, ``{"S1": [...], "S2": [...]}``, where one was found.
    sha256 : str
        Of the canonical graph, which certificates are bound to.
    certificate : str
        Path of the certificate of r*, when certificates were asked for.
    seconds : float
    error : str
        Why there are no facts, in one line; empty when all went well.
    """

    network: str
    nodes: int | None = None
    arcs: int | None = None
    directed: bool | None = None
    r: int | None = None
    r_at_most: int | None = None
    s: int | None = None
    s_at_most: int | None = None
    guaranteed: Mapping[str, int] = field(default_factory=dict)
    refuted: Mapping[str, int | None] = field(default_factory=dict)
    gate: str = ""
    weakest: Mapping[str, list[Any]] | None = None
    sha256: str = ""
    certificate: str = ""
    seconds: float = field(default=0.0, compare=False)
    error: str = ""
    links: int | None = None
    links_at_least: int | None = None

    @property
    def is_decided(self) -> bool:
        """Whether r*, s and every model are known exactly."""
        if self.error or self.r is None or self.r != self.r_at_most or self.s != self.s_at_most:
            return False
        return all(f is not None and f == self.guaranteed[model] + 1 for model, f in self.refuted.items())

    def as_dict(self) -> dict[str, Any]:
        """Return the row as JSON-ready values."""
        return {
            "network": self.network,
            "nodes": self.nodes,
            "arcs": self.arcs,
            "directed": self.directed,
            "r": self.r,
            "r_at_most": self.r_at_most,
            "s": self.s,
            "s_at_most": self.s_at_most,
            "guaranteed": dict(self.guaranteed),
            "refuted": dict(self.refuted),
            "gate": self.gate,
            "links": self.links,
            "links_at_least": self.links_at_least,
            "weakest": None if self.weakest is None else {name: list(side) for name, side in self.weakest.items()},
            "sha256": self.sha256,
            "certificate": self.certificate,
            "seconds": round(self.seconds, 6),
            "error": self.error,
        }

    @classmethod
    def of_dict(cls, content: Mapping[str, Any]) -> Row:
        """Return the row that :meth:`as_dict` wrote."""
        return cls(**content)


def unreadable(name: str, problem: Exception, gate: Gate) -> Row:
    """Return the row of a network that could not be read."""
    return Row(name, gate="error" if _asks(gate) else "", error=" ".join(str(problem).split()))


@dataclass(frozen=True, slots=True)
class Findings:
    """A row and the answers it was made from; the links that mend the network where they were asked for."""

    row: Row
    graph: Digraph
    robustness: RobustnessResult
    table: ToleranceTable
    mended: MendResult | None = None


def measure(
    name: str, graph: Digraph, question: Question, certificates: Path | None = None, executor: Any = None
) -> Row | Findings:
    """Return what was found out about one network, or the row of an error.

    r* and s first, then the threat models, then the gates, all within one time limit; what it leaves undecided says so
    in the row. With ``certificates``, a folder, the certificate that the network is r*-robust is written there;
    ``executor`` solves the cubes of searches for r* and s.
    """
    started = time.monotonic()
    limits = Limits.of(question.time_limit, seed=question.seed)
    spread = limits.spread_over(executor)
    try:
        # Half of the time: what r* and s leave goes to the models, and what they prove is asked of every one of them.
        found = determine_robustness(graph, **spread.share(0.5 if question.models else 1.0).keywords())
        models = {model: tolerance(graph, model, **limits.keywords()) for model in question.models}
        table = ToleranceTable(graph, tuple(models.values()))
        standing = _standing(graph, question, found, table, spread)
        certificate = "" if certificates is None else _certify(name, graph, found, certificates, spread)
    except RobustnessError as problem:
        return unreadable(name, problem, question.gate)
    bounds = found.bounds
    is_known = found.verdict is Verdict.DETERMINED
    row = Row(
        name,
        graph.n,
        graph.arc_count,
        graph.directed,
        found.r,
        found.r if bounds is None else bounds.upper.value,
        found.s if is_known else None,
        _greatest(found) if is_known else None,
        {each: result.guaranteed for each, result in models.items()},
        {each: result.refuted for each, result in models.items()},
        standing,
        _weakest(found),
        graph.sha256,
        certificate,
        time.monotonic() - started,
    )
    return Findings(row, graph, found, table)


def _greatest(found: RobustnessResult) -> int:
    return found.s if found.s_bounds is None else found.s_bounds.upper.value


def _weakest(found: RobustnessResult) -> dict[str, list[Any]] | None:
    if found.witness is None:
        return None
    from robustness.natural_order import in_natural_order

    return {"S1": in_natural_order(found.witness.S1), "S2": in_natural_order(found.witness.S2)}


def _asks(gate: Gate) -> bool:
    return gate.r is not None or gate.survive is not None


def _standing(
    graph: Digraph, question: Question, found: RobustnessResult, table: ToleranceTable, limits: Limits
) -> str:
    gate = question.gate
    if not _asks(gate):
        return ""
    standings = ["passed"]
    if gate.r is not None:
        standings.append(_robust_enough(graph, gate.r, gate.s, found, limits))
    if gate.survive is not None:
        words = {"guaranteed": "passed", "refuted": "refuted"}
        standings += [words.get(result.standing(gate.survive).value, "undecided") for result in table.results]
    return max(standings, key=STANDINGS.index)


def _robust_enough(graph: Digraph, r: int, s: int, found: RobustnessResult, limits: Limits) -> str:
    """Say whether the network is (r,s)-robust: by what is known already, else by one more decision."""
    bounds: Bounds | None = found.bounds
    if s == 1 and bounds is not None and r <= bounds.lower.value:
        return "passed"
    if bounds is not None and r > bounds.upper.value:
        return "refuted"
    if s > max(graph.n, 1):
        return "refuted"
    verdict = check_rs_robustness(graph, r, s, **limits.keywords()).verdict
    return {Verdict.ROBUST: "passed", Verdict.NOT_ROBUST: "refuted"}.get(verdict, "undecided")


def _certify(name: str, graph: Digraph, found: RobustnessResult, folder: Path, limits: Limits) -> str:
    """Write the certificate of r*-robustness and the canonical graph it is bound to; return the certificate's path."""
    from robustness.decision.certification import certify
    from robustness.files import replace_file

    if found.verdict is not Verdict.DETERMINED or found.r < 1:
        return ""
    result = certify(graph, found.r, **limits.keywords())
    if result.certificate is None:
        return ""
    place = folder / f"{_file_name(name)}-{graph.sha256[:12]}"
    certificate = place.with_name(f"{place.name}-{found.r}-robust.cert")
    replace_file(place.with_name(f"{place.name}.graph"), graph.canonical_bytes())
    replace_file(certificate, result.certificate)
    return str(certificate)


def _file_name(name: str) -> str:
    """Return the last part of a network's name with letters that every file system takes."""
    last = name.rpartition("/")[2].rpartition(":")[2]
    return "".join(letter if letter.isascii() and (letter.isalnum() or letter in "-_.") else "_" for letter in last)
