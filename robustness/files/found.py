"""How a file is to be read, what a reader finds in it, and the one place that makes a graph of it.

A reader takes bytes and :class:`ReadingOptions` and returns :class:`Found`: nodes and links in the words of the file.
What is common to all formats is done here: which way links run, which label names a node, parallel links, and the
line that says what was taken for granted (``graph.read_as``).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph, plain_label
from robustness.errors import InvalidParameter, UnreadableTopology
from robustness.files.text import warn_lossy
from robustness.spelled import counted, plural

__all__ = ["Found", "Link", "Node", "ReadingOptions", "graph_of", "parsed_columns"]

Rows = Literal["speak", "hear"]


@dataclass(frozen=True, slots=True)
class ReadingOptions:
    """What the user says about a file; None leaves it to the file.

    Attributes
    ----------
    format : str or None
        A name of :data:`robustness.files.FORMAT_NAMES`, which goes before the suffix.
    directed : bool or None
        True: a link without a word of its own runs from its first end to its second. False: all run both ways.
    label_attribute : str or None
        The attribute that names the nodes; ``id`` for what the file itself tells them apart by.
    rows : "speak" or "hear" or None
        Of a matrix or of adjacency lists, which are then what the file is: row u says who hears u, or whom u hears.
    columns : mapping or None
        Of a table of links: which column (a number from 1, or a name of the first line) is ``source``, ``target``,
        and for contacts ``time``, or ``start`` and ``end``.
    skip_lines : int or None
        So many lines at the beginning of a text are no links.
    """

    format: str | None = None
    directed: bool | None = None
    label_attribute: str | None = None
    rows: Rows | None = None
    columns: Mapping[str, int | str] | None = None
    skip_lines: int | None = None

    def __post_init__(self) -> None:
        if self.rows not in (None, "speak", "hear"):
            raise InvalidParameter(f"rows is 'speak' (row u says who hears u) or 'hear', not {self.rows!r}")
        if self.skip_lines is not None and (type(self.skip_lines) is not int or self.skip_lines < 0):
            raise InvalidParameter(f"skip_lines is a number of lines, not {self.skip_lines!r}")


#: What a column may be, by the names that people write above it.
COLUMN_NAMES: Mapping[str, tuple[str, ...]] = {
    "source": ("source", "from", "src", "u", "tail", "node1", "node_1", "node 1", "user_a", "sender", "fromnodeid",
               "start_node", "i", "node_i", "user1", "id1", "a", "s", "id_1", "from_node", "source_id", "sourceid"),
    "target": ("target", "to", "dst", "v", "head", "node2", "node_2", "node 2", "user_b", "receiver", "tonodeid",
               "end_node", "j", "node_j", "user2", "id2", "b", "d", "id_2", "to_node", "target_id", "targetid", "dest",
               "destination"),
    "time": ("time", "timestamp", "t", "unixtime", "unix_time", "datetime", "date", "ts", "time_stamp", "epoch"),
    "start": ("start", "start_time", "begin", "starttime", "t_start", "tstart", "from_time"),
    "end": ("end", "end_time", "endtime", "stop", "t_end", "tend", "to_time"),
}  # fmt: skip


def parsed_columns(text: str) -> dict[str, int | str]:
    """Return the columns that ``time=3,source=1,target=2`` names, by what they hold.

    Raises
    ------
    InvalidParameter
        For text of another shape, an unknown name, or a column that is given twice.
    """
    found: dict[str, int | str] = {}
    for part in text.split(","):
        name, equals, place = (piece.strip() for piece in part.partition("="))
        if name not in COLUMN_NAMES or not equals or not place or name in found:
            raise InvalidParameter(
                f"columns are given as source=1,target=2 (and time=3, or start=3,end=4, for contacts), not {text!r}"
            )
        found[name] = int(place) if place.isascii() and place.isdigit() else place
        if found[name] == 0:
            raise InvalidParameter(f"columns count from 1, not 0: {part!r}")
    if len(set(found.values())) < len(found):
        raise InvalidParameter(f"one column holds one thing, but {text!r} names one twice")
    return found


@dataclass(slots=True)
class Node:
    """A node of a file: what tells it apart, and what else the file says of it."""

    id: Hashable
    #: What a person sees in the drawing, in the order in which it is looked for.
    seen: Sequence[str] = ()
    attributes: Mapping[str, Any] = field(default_factory=dict)
    pos: tuple[float, float] | None = None


@dataclass(slots=True)
class Link:
    """A link of a file: its ends by id, whether it says that it runs one way (None: nothing), and what else is said."""

    source: Hashable
    target: Hashable
    one_way: bool | None = None
    attributes: Mapping[str, Any] | None = None


@dataclass(slots=True)
class Found:
    """What a reader found.

    Attributes
    ----------
    nodes : list of Node
    links : list of Link
    ends : array of shape (links, 2) or None
        Instead of ``links``, where there may be millions: the places of both ends among the nodes.
    directed : bool or None
        Whether links run one way where they say nothing themselves; None when the file does not say, which is then
        undirected and told.
    notes : list of str
        How the file was read, where a word is due; each is told.
    asked : list of str
        What was done as the user asked; it is told as well.
    loss : str
        What the format loses, told with every warning; empty: nothing.
    is_doubtful : bool
        The file can be read in another way than it was, so the line that says how is a warning. (A direction that
        nobody says makes one too.)
    parallel : str
        What a link that is given twice is called; empty: the format says that there may be some, so no word is due.
    """

    nodes: list[Node]
    links: list[Link]
    directed: bool | None = None
    notes: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)
    loss: str = ""
    is_doubtful: bool = False
    parallel: str = "parallel one"
    ends: npt.NDArray[np.int64] | None = None


def graph_of(found: Found, options: ReadingOptions) -> Digraph:
    """Return the graph that a reader found, and warn where the file can be read in another way than it was.

    Raises
    ------
    UnreadableTopology
        When a link ends at no node, the direction is in doubt, or the label that was asked for does not name the nodes.
    """
    notes = list(found.notes)
    names = _names(found, options, notes)
    ends = _ends(found)
    own = np.full(len(ends), -1, np.int8)
    if found.ends is None:
        own[:] = [_CODES[link.one_way] for link in found.links]
    asked = list(found.asked)
    said = _direction_said(found, options, ends[own < 0], asked)
    default = bool(said)
    one_way = np.zeros(len(own), bool) if options.directed is False else np.where(own < 0, default, own == 1)
    directed = bool(one_way.any()) if len(own) else default
    kept = ends[ends[:, 0] != ends[:, 1]]
    is_single = one_way[ends[:, 0] != ends[:, 1]]
    loops = len(ends) - len(kept)
    distinct = _count(_codes(np.where(is_single[:, None], kept, np.sort(kept, axis=1)), len(names), is_single))
    both = int((~is_single).sum())
    if directed and both:
        notes.insert(0, f"{both} of the links {plural(both, 'runs', 'run')} both ways")
    if distinct < len(kept) and found.parallel:
        again = len(kept) - distinct
        notes.append(f"{counted(again, found.parallel)} {plural(again, 'counts', 'count')} once")
    if loops:
        notes.append(f"{counted(loops, 'self-loop')} dropped: no robustness definition depends on them")
    line = "; ".join([f"{_word(directed)}, {counted(len(names), 'node')}, {counted(distinct, 'link')}", *notes, *asked])
    if said is None or found.is_doubtful:
        hints = [found.loss, "--directed if links run one way" if said is None else ""]
        warn_lossy("; ".join([f"read as: {line}", *filter(None, hints)]))
    graph = Digraph.from_ends(
        list(names.values()),
        np.concatenate([kept, kept[~is_single][:, ::-1]]),
        directed=directed,
        read_as=line,
        node_attributes=_attributes(found, names),
    )
    graph.link_attributes = {
        (plain_label(names[link.source]), plain_label(names[link.target])): link.attributes
        for link in found.links
        if link.attributes
    }
    return graph


#: What a link says of its direction, as a number; negative: nothing.
_CODES = {None: -1, False: 0, True: 1}

_Ends = npt.NDArray[np.int64]


def _ends(found: Found) -> _Ends:
    """Return the places of both ends of every link among the nodes, shape ``(links, 2)``."""
    if found.ends is not None:
        return found.ends
    place = {node.id: k for k, node in enumerate(found.nodes)}
    try:
        flat = np.fromiter((place[end] for link in found.links for end in (link.source, link.target)), np.int64)
    except KeyError as unknown:
        raise UnreadableTopology(f"a link joins {unknown.args[0]!r}, which is no node: add the node") from None
    return flat.reshape(-1, 2)


def _codes(ends: _Ends, n: int, mark: npt.NDArray[np.bool_] | int = 0) -> npt.NDArray[np.int64]:
    """Return one number for every pair of ends."""
    return (ends[:, 0] * n + ends[:, 1]) * 2 + mark


def _count(codes: npt.NDArray[np.int64]) -> int:
    """Return how many different codes there are, by sorting, which is faster than a table of so many."""
    return int((np.diff(np.sort(codes)) > 0).sum()) + (len(codes) > 0)


def _direction_said(found: Found, options: ReadingOptions, silent: _Ends, asked: list[str]) -> bool | None:
    """Return whether links that say nothing themselves (``silent``) run one way; None: nobody says, so they do not."""
    if options.directed is not None:
        if found.directed is not None and found.directed != options.directed:
            asked.append(f"{_word(options.directed)} as asked, where the file says {_word(found.directed)}")
        return options.directed
    if found.directed is not None:
        return found.directed
    pairs = silent[silent[:, 0] != silent[:, 1]]
    n = len(found.nodes)
    if _count(_codes(pairs, n)) == _count(_codes(np.sort(pairs, axis=1), n)):
        return None if len(pairs) else False  # no link is given in both directions
    has_reverse = np.isin(_codes(pairs[:, ::-1], len(found.nodes)), _codes(pairs, len(found.nodes)))
    if has_reverse.any() and not has_reverse.all():
        twice, once = (
            " ".join(repr(found.nodes[end].id) for end in pairs[is_one][0].tolist())
            for is_one in (has_reverse, ~has_reverse)
        )
        raise UnreadableTopology(
            f"the links may run one way or both: {twice} is given in both directions and {once} in one: say which with "
            "--directed or --undirected"
        )
    return False


def _word(directed: bool) -> str:
    return "directed" if directed else "undirected"


def _names(found: Found, options: ReadingOptions, notes: list[str]) -> dict[Hashable, Hashable]:
    """Return what names each node, by its id."""
    ids = [node.id for node in found.nodes]
    if len(set(ids)) < len(ids):
        twice = next(node for node, count in Counter(ids).items() if count > 1)
        raise UnreadableTopology(f"the node {twice!r} is given twice: keep one")
    wanted = options.label_attribute
    if wanted == "id":
        return dict(zip(ids, ids, strict=True))
    if wanted is not None:
        return _names_asked_for(found, wanted)
    keys = dict.fromkeys(key for node in found.nodes for key in node.seen)
    for key in keys:
        labels = [node.attributes.get(key) for node in found.nodes]
        if labels == ids:
            break
        if all(map(_is_name, labels)) and len(set(labels)) == len(labels):
            notes.append(f"nodes are named by their {_KEY_WORDS.get(key, key)}")
            return dict(zip(ids, labels, strict=True))
    else:
        if any(_is_name(node.attributes.get(key)) for node in found.nodes for key in keys):
            notes.append("labels repeat or lack, so nodes are named by id")
    return dict(zip(ids, ids, strict=True))


#: What a key is called that no author of a file ever sees.
_KEY_WORDS = {"nodelabel": "label"}


def _names_asked_for(found: Found, wanted: str) -> dict[Hashable, Hashable]:
    names: dict[Hashable, Hashable] = {}
    taken: dict[Hashable, Hashable] = {}
    for node in found.nodes:
        label = node.attributes.get(wanted)
        if not _is_name(label):
            have = sorted({key for other in found.nodes for key, value in other.attributes.items() if _is_name(value)})
            raise UnreadableTopology(
                f"node {node.id!r} has no attribute {wanted!r} that names it; nodes here have: "
                f"{', '.join(['id', *have][:12])}"
            )
        if label in taken:
            raise UnreadableTopology(
                f"the attribute {wanted!r} does not tell nodes apart: {taken[label]!r} and {node.id!r} both have "
                f"{label!r}"
            )
        taken[label] = node.id
        names[node.id] = label
    return names


def _is_name(label: object) -> bool:
    return type(label) is int or (isinstance(label, str) and bool(label.strip()))


def _attributes(found: Found, names: Mapping[Hashable, Hashable]) -> dict[Hashable, dict[str, object]]:
    """Return what a picture may want of the nodes: their places, and their ids where labels name them."""
    result: dict[Hashable, dict[str, object]] = {}
    placed = [node for node in found.nodes if node.pos is not None and all(map(math.isfinite, node.pos))]
    keep_places = len(placed) == len(found.nodes) and (len(placed) < 2 or len({node.pos for node in placed}) > 1)
    for node in found.nodes:
        name = names[node.id]
        data: dict[str, object] = {} if name == node.id else {"id": node.id}
        if keep_places:
            data["pos"] = node.pos
        for key in node.seen:
            if _is_name(node.attributes.get(key)) and node.attributes[key] != name:
                data[key] = node.attributes[key]
        if data:
            result[name] = data
    return result
