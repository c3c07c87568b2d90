"""Mending: a certificate of links that make a network reach a goal, and of violations that every choice has to break.

The graph is the network before mending. A *part* of the goal is (r,s)-robustness, or that no sets hold the network
apart (:mod:`certificates.tolerance`). An *action* is a link that can be added: one arc, or an arc each way, of which
those that are there already bring nothing.

Two things are proven here, by the certificates of other kinds alone. That the chosen actions keep their constraints,
cost what is claimed, and make the network reach every part: by one certificate for each part about the mended graph.
And that every pair is a violation of a part in the graph as it is. By the lemma on choices in
docs/certificate-format.md it is then one after every choice that has none of the actions which bring it an arc.

A *cover* is a family of sets of nodes such that every arc of the graph lies inside one; its *starts* lie inside one
each. What they demand of a choice that reaches (r,s)-robustness is the lemma on spreading there; only that it is a
cover with its starts is checked.

That no cheaper choice breaks all of these violations, and does what the covers demand, is a problem in integers that
the certificate holds whole. A tree over choices (:mod:`certificates.least_cost`) proves it where a few thousand nodes
are enough; else it is for any solver.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from certificates.direct import check_violation
from certificates.envelope import id_set, open_certificate, require_about, require_keys
from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import CanonicalGraph, decode_graph, digest, encode_graph
from certificates.least_cost import no_choice_is_cheaper
from certificates.stream import Blocks, Stream
from certificates.tolerance import check_sets, verify_tolerance
from certificates.verification import verify

__all__ = ["FORMAT", "MAX_LOOKS", "VerifiedMendingClaim", "verify_mending"]

FORMAT = "robustness/mending-certificate/2"

#: Pairs times nodes and arcs of the graph, and covers times nodes: at most so many are looked at.
MAX_LOOKS = 2**32

#: No number of a certificate is larger.
_MOST = 2**53

Part = dict[str, Any]


@dataclass(frozen=True, slots=True)
class VerifiedMendingClaim:
    """What was proven about which graph, and what is left to a solver."""

    #: The parts of the goal, in words.
    goal: str
    #: What the chosen links cost, in units of the certificate; None when none were chosen.
    cost: int | None
    #: No choice that breaks all violations, and does what the covers demand, costs less. None: there is none. A solver
    #: has to confirm it unless ``is_least`` is true.
    least: int | None
    links: int
    violations: int
    sha256: str
    nodes: int
    arcs: int
    #: The digest of the graph with the chosen links; empty when none were chosen.
    mended_sha256: str = ""
    #: Nodes of search trees that were replayed.
    tree_nodes: int = 0
    covers: int = 0
    #: Whether a tree over choices has proven ``least``.
    is_least: bool = False

    def __str__(self) -> str:
        graph = f"the graph with {self.nodes} nodes, {self.arcs} arcs and SHA-256 {self.sha256}"
        reached = ""
        if self.cost is not None:
            reached = f"reaches the goal, {self.goal}, with {self.links} links of cost {self.cost}, and "
        covers = f", and {self.covers} covers whose demands it has to meet" if self.covers else ""
        rest = "no choice does" if self.least is None else f"this costs at least {self.least}"
        proven = "proven by a tree over choices" if self.is_least else "left to a solver"
        return (
            f"{graph} {reached}has {self.violations} violations that every choice of links that reaches the goal, "
            f"{self.goal}, has to break{covers}; that {rest} is {proven}"
        )


def verify_mending(
    graph_bytes: bytes, certificate_bytes: Blocks | Stream, may_go_on: Callable[[int], bool] | None = None
) -> VerifiedMendingClaim:
    """Return the claim that ``certificate_bytes`` proves about the graph in ``graph_bytes``, before mending.

    Parameters
    ----------
    graph_bytes : bytes
        The canonical graph, or a node-link JSON document of it.
    certificate_bytes : bytes
        A mending certificate as docs/certificate-format.md defines it.
    may_go_on : callable, optional
        Whether to go on with the tree that proves the least cost, given how many nodes of it were looked at; without it
        there is none.

    Raises
    ------
    Misuse
        When an argument is not bytes.
    MalformedCertificate
        When the bytes are not of the formats (``MalformedGraph`` for the graph).
    RejectedCertificate
        When the certificate does not prove its claim about this graph.
    """
    keys = "claim actions pairs covers lengths"
    document, stream = open_certificate(graph_bytes, certificate_bytes, "graph", [FORMAT], keys)
    claim = require_keys(document["claim"], "the claim", "parts cost least")
    graph = decode_graph(graph_bytes)
    require_about(document, "graph", graph.sha256)
    parts, pairs = _list(claim["parts"], "parts"), _list(document["pairs"], "pairs")
    words = [_words(part, graph.n) for part in parts]
    if len(pairs) * (graph.n + graph.arc_count) > MAX_LOOKS:
        raise MalformedCertificate(f"{len(pairs)} pairs take more than {MAX_LOOKS} looks at nodes and arcs")
    for name in ("cost", "least"):
        if claim[name] is not None:
            _number(claim[name], name)
    if claim["cost"] is not None and (claim["least"] is None or claim["least"] > claim["cost"]):
        raise RejectedCertificate("the chosen links cost less than the least cost that is claimed")
    mended, links = _check_choice(graph, document["actions"], claim["cost"])
    for pair in pairs:
        _check_pair(graph, parts, pair)
    _check_covers(graph, parts, _list(document["covers"], "covers"))
    tree_nodes = _check_parts(mended, parts, document["lengths"], stream.rest())
    return VerifiedMendingClaim(
        " and ".join(words) or "anything", claim["cost"], claim["least"], links, len(pairs),
        graph.sha256, graph.n, graph.arc_count, "" if mended is None else digest(mended), tree_nodes,
        len(document["covers"]),
        may_go_on is not None and no_choice_is_cheaper(graph.hears, document, may_go_on),
    )  # fmt: skip


def _check_choice(graph: CanonicalGraph, actions: Any, cost: int | None) -> tuple[bytes | None, int]:
    """Return the mended graph, and how many links were chosen, after the constraints on actions were checked."""
    actions = require_keys(actions, "the actions", "one_way links required most chosen")
    if type(actions["one_way"]) is not bool:
        raise MalformedCertificate("one_way is true or false")
    arcs = {(j, i) for i, heard in enumerate(graph.hears) for j in heard}
    links, brought = _links(actions, graph.n, arcs)
    required = id_set(actions["required"], len(links), "required")
    most = actions["most"]
    if most is not None and (not isinstance(most, list) or len(most) != graph.n):
        raise MalformedCertificate(f"most is null or a list of {graph.n} numbers")
    for each in most or ():
        _number(each, "a number of most")
    if (actions["chosen"] is None) != (cost is None):
        raise MalformedCertificate("chosen is null exactly when cost is")
    if cost is None:
        return None, 0
    chosen = id_set(actions["chosen"], len(links), "chosen")
    if not set(required) <= set(chosen):
        raise RejectedCertificate("a required link is not chosen")
    if sum(links[a][2] for a in chosen) != cost:
        raise RejectedCertificate(f"the chosen links do not cost {cost}")
    added = {arc for a in chosen for arc in brought[a]}
    gains = Counter(head for _, head in added)
    for i, cap in enumerate(most or ()):
        if gains[i] > cap:
            raise RejectedCertificate(f"node {i} gains more than the {cap} in-neighbours that it may")
    return encode_graph(graph.labels, sorted(arcs | added)), len(chosen)


def _links(
    actions: dict[str, Any], n: int, arcs: set[tuple[int, int]]
) -> tuple[list[tuple[int, int, int]], list[set[tuple[int, int]]]]:
    """Return the links that can be added, and the arcs that each brings: those that are not there yet."""
    links = [_link(link, n) for link in _list(actions["links"], "links")]
    if any(not a[:2] < b[:2] for a, b in pairwise(links)):
        raise MalformedCertificate("links stand in strictly ascending order")
    brought = []
    for u, v, _ in links:
        if not actions["one_way"] and u > v:
            raise MalformedCertificate("the first end of a link both ways is the smaller id")
        both = {(u, v)} if actions["one_way"] else {(u, v), (v, u)}
        if both <= arcs:
            raise RejectedCertificate(f"the link {u} - {v} is there already")
        brought.append(both - arcs)
    return links, brought


def _check_pair(graph: CanonicalGraph, parts: list[Part], pair: Any) -> None:
    """The sets violate their part in the graph as it is."""
    if not isinstance(pair, list) or len(pair) != 4 or type(pair[0]) is not int or not 0 <= pair[0] < len(parts):
        raise MalformedCertificate("a pair is [part, M, S1, S2]")
    part = parts[pair[0]]
    sets = dict(zip(("M", "S1", "S2"), pair[1:], strict=True))
    if "r" in part:
        if sets["M"] != []:
            raise MalformedCertificate("M is empty in a pair about (r,s)-robustness")
        check_violation(graph, part["r"], part["s"], sets)
    else:
        check_sets(graph, part["f"], part["faces"], part["bound"], sets)


def _check_covers(graph: CanonicalGraph, parts: list[Part], covers: list[Any]) -> None:
    """Each is about (r,s)-robustness, and its starts and every arc of the graph as it is lie inside one of its sets."""
    masks: list[int] = []
    looks = graph.arc_count * (1 + graph.n // 1024)
    for cover in covers:
        if not isinstance(cover, list) or len(cover) < 2 or type(cover[0]) is not int or not 0 <= cover[0] < len(parts):
            raise MalformedCertificate("a cover is [part, [start, ...], V, ...]")
        if "r" not in parts[cover[0]]:
            raise MalformedCertificate("a cover belongs to a part that is (r,s)-robust")
        starts = [id_set(ids, graph.n, "a start of a cover") for ids in _list(cover[1], "the starts of a cover")]
        sets = [id_set(ids, graph.n, "a set of a cover") for ids in cover[2:]]
        looks += (graph.n + sum(map(len, sets)) + len(starts) * (1 + len(sets))) * (1 + graph.n // 1024)
        if looks > MAX_LOOKS:
            raise MalformedCertificate(f"the covers take more than {MAX_LOOKS} looks at nodes")
        masks = masks or [sum(1 << j for j in heard) for heard in graph.hears]
        inside, wholes = [0] * graph.n, []
        for V in sets:
            if len(V) < 2:
                raise MalformedCertificate("a set of a cover has two nodes or more")
            mask = sum(1 << i for i in V)
            wholes.append(mask)
            for i in V:
                inside[i] |= mask
        for start in starts:
            if not start or not any(all(mask >> i & 1 for i in start) for mask in wholes):
                raise RejectedCertificate("a start of a cover has nodes, and lies inside one of its sets")
        if any(heard & ~near for heard, near in zip(masks, inside, strict=True)):
            raise RejectedCertificate("an arc lies inside no set of a cover")


def _check_parts(mended: bytes | None, parts: list[Part], lengths: Any, body: bytes) -> int:
    """Every part holds of the mended graph, by the certificates in the body; return the tree nodes replayed."""
    if not isinstance(lengths, list) or not all(type(each) is int and each > 0 for each in lengths):
        raise MalformedCertificate("lengths is a list of positive integers")
    if sum(lengths) != len(body):
        raise MalformedCertificate(f"the lengths add up to {sum(lengths)} bytes, but {len(body)} follow the header")
    if len(lengths) != (0 if mended is None else len(parts)):
        raise RejectedCertificate(f"{len(lengths)} certificates are not one for every part that is reached")
    if mended is None:
        return 0
    place = tree_nodes = 0
    for part, length in zip(parts, lengths, strict=True):
        data, place = body[place : place + length], place + length
        if "r" in part:
            robust = verify(mended, data)
            proven = {"r": robust.r, "s": robust.s, "verdict": robust.verdict}
            tree_nodes += robust.tree_nodes
            wanted = {**part, "verdict": "robust"}
        else:
            safe = verify_tolerance(mended, data)
            proven = {"f": safe.f, "faces": safe.faces, "bound": safe.bound, "verdict": safe.verdict}
            tree_nodes += safe.tree_nodes
            wanted = {**part, "verdict": "together"}
        if proven != wanted:
            raise RejectedCertificate(f"a certificate in the body does not prove that the goal is reached: {proven}")
    return tree_nodes


def _words(part: Any, n: int) -> str:
    """Return a part in words, after its form was checked."""
    if isinstance(part, dict) and "r" in part:
        part = require_keys(part, "a part", "r s")
        for name in ("r", "s"):
            if _number(part[name], name) < 1:
                raise MalformedCertificate(f"{name} of a part is at least 1")
        if part["s"] > n:
            raise MalformedCertificate(f"s of a part lies in 1..n = 1..{n}, not {part['s']}")
        return f"({part['r']},{part['s']})-robust"
    part = require_keys(part, "a part", "f faces bound")
    _number(part["f"], "f")
    if type(part["faces"]) is not int or part["faces"] not in (1, 2) or part["bound"] not in ("total", "local"):
        raise MalformedCertificate("faces is 1 or 2, and bound is 'total' or 'local'")
    where = "in total" if part["bound"] == "total" else "locally"
    return f"no {'trap' if part['faces'] == 2 else 'violation'} for f = {part['f']} {where}"


def _link(link: Any, n: int) -> tuple[int, int, int]:
    if not isinstance(link, list) or len(link) != 3:
        raise MalformedCertificate("a link is [u, v, cost]")
    u, v, cost = (_number(each, "a number of a link") for each in link)
    if u >= n or v >= n or u == v:
        raise MalformedCertificate(f"a link joins two different ids in 0..{n - 1}")
    return u, v, cost


def _number(value: Any, what: str) -> int:
    if type(value) is not int or not 0 <= value <= _MOST:
        raise MalformedCertificate(f"{what} is an integer in 0..{_MOST}")
    return value


def _list(value: Any, what: str) -> list[Any]:
    if not isinstance(value, list):
        raise MalformedCertificate(f"{what} is a list")
    return value
