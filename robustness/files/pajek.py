"""Pajek (.net): read here, since the reader of networkx passes over lists of arcs and mixed directions in silence.

``*Vertices n`` and lines ``number "label" x y``; then ``*Arcs`` (one way) and ``*Edges`` (both ways) as ``u v weight``,
``*Arcslist`` and ``*Edgeslist`` as ``u v w ...``, or ``*Matrix``. Nodes are named by their labels, where each has its
own.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable

from robustness.digraph import Digraph
from robustness.errors import InvalidGraph, UnreadableTopology
from robustness.files.found import Found, Link, Node, ReadingOptions, graph_of
from robustness.files.rows import is_number
from robustness.files.text import decode_utf8, texts_of, warn_lossy
from robustness.places import place_of
from robustness.spelled import counted

__all__ = ["decode", "encode"]

#: The most vertices that a header may announce.
NODE_LIMIT = 1_000_000

_CELL = re.compile(r'"(?P<quoted>[^"]*)"|(?P<plain>\S+)')

#: Headings whose lines are not the graph.
_OTHERS = ("*network", "*partition", "*vector", "*permutation", "*cluster", "*hierarchy", "*title", "*events")


def decode(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of a Pajek file: the union of its relations, should it have several."""
    reader = _Reader()
    for number, line in enumerate(re.split(r"\r\n|\r|\n", decode_utf8(data)), 1):
        text = line.strip()
        if text and not text.startswith("%"):
            reader.take(number, text)
    if reader.count is None:
        raise UnreadableTopology("a Pajek file has a line *Vertices with their number, and here is none")
    nodes = [
        Node(k, ("label",), reader.vertices.get(k, {}), place_of(reader.vertices.get(k, {})))
        for k in range(1, reader.count + 1)
    ]
    reader.links += reader.matrix_links()
    both_ways = all(link.one_way is False for link in reader.links)
    notes = reader.notes + [f"{name} is not the graph and left out" for name in reader.left_out]
    if reader.relations > 1:
        notes.append(f"{reader.relations} relations joined")
    found = Found(
        nodes, reader.links, not both_ways, notes, loss="Pajek reads every label as text", is_doubtful=bool(notes)
    )
    return graph_of(found, options)


class _Reader:
    """Takes the lines of a file one by one."""

    def __init__(self) -> None:
        self.count: int | None = None
        self.vertices: dict[Hashable, dict[str, str]] = {}
        self.links: list[Link] = []
        self.left_out: dict[str, None] = {}
        self.relations = 0
        self.row = 0
        self.matrix: dict[tuple[int, int], None] = {}
        self.notes: list[str] = []
        self.read: Callable[[int, list[str]], None] | None = None

    def take(self, number: int, text: str) -> None:
        if text.startswith("*"):
            self.open(number, text)
            return
        if self.read is None:
            if not self.left_out:
                raise UnreadableTopology(f"line {number}: {text[:30]!r} stands before *Vertices")
            return
        self.read(number, [match["plain"] or match["quoted"] or "" for match in _CELL.finditer(text)])

    def open(self, number: int, text: str) -> None:
        """Turn to the part that a heading begins."""
        heading, *rest = text.lower().split()
        if heading.startswith("*vertices"):
            if self.count is not None:
                raise UnreadableTopology(f"line {number}: a second *Vertices: keep one network a file")
            if not 1 <= len(rest) <= 2 or not all(cell.isascii() and cell.isdigit() for cell in rest):
                raise UnreadableTopology(
                    f"line {number}: *Vertices is followed by their number, not {' '.join(rest)!r}"
                )
            if len(rest) == 2:
                self.notes.append(f"two modes, of which the first is vertices 1..{rest[1]}")
            self.count = int(rest[0][:18])
            if self.count > NODE_LIMIT:
                raise UnreadableTopology(
                    f"line {number}: at most {NODE_LIMIT} nodes are read, and it announces {rest[0]}"
                )
            self.read = self.vertex
            return
        parts: dict[str, Callable[[int, list[str]], None]] = {
            "*arcs": lambda line, cells: self.pair(line, cells, one_way=True),
            "*edges": lambda line, cells: self.pair(line, cells, one_way=False),
            "*arcslist": lambda line, cells: self.list_of_ends(line, cells, one_way=True),
            "*edgeslist": lambda line, cells: self.list_of_ends(line, cells, one_way=False),
            "*matrix": self.matrix_row,
        }
        name = heading.partition(":")[0]
        self.read = parts.get(name)
        if name in parts and ":" in text:
            self.relations += 1
        if name not in parts and name not in _OTHERS:
            raise UnreadableTopology(f"line {number}: {heading!r} is no heading of a Pajek network")
        if name not in parts and name != "*network":
            self.left_out[heading] = None
        if name == "*network":
            self.left_out.setdefault("", None)
            del self.left_out[""]

    def vertex(self, number: int, cells: list[str]) -> None:
        k = self.number(number, cells[0])
        if k in self.vertices:
            raise UnreadableTopology(f"line {number}: vertex {k} is given twice: keep one")
        values = {"label": cells[1]} if len(cells) > 1 else {}
        if len(cells) > 3 and is_number(cells[2]) and is_number(cells[3]):
            values |= {"x": cells[2], "y": cells[3]}
        self.vertices[k] = values

    def pair(self, number: int, cells: list[str], *, one_way: bool) -> None:
        if len(cells) < 2:
            raise UnreadableTopology(f"line {number}: a link is two numbers of vertices, not {' '.join(cells)!r}")
        self.links.append(Link(self.number(number, cells[0]), self.number(number, cells[1]), one_way))

    def list_of_ends(self, number: int, cells: list[str], *, one_way: bool) -> None:
        first = self.number(number, cells[0])
        self.links += [Link(first, self.number(number, cell), one_way) for cell in cells[1:]]

    def matrix_row(self, number: int, cells: list[str]) -> None:
        self.row += 1
        if len(cells) != self.count or not all(map(is_number, cells)) or self.row > self.count:
            size = counted(self.count or 0, "vertex", "vertices")
            raise UnreadableTopology(f"line {number}: a matrix of {size} has as many rows of as many numbers")
        self.matrix.update(dict.fromkeys((self.row, k) for k, cell in enumerate(cells, 1) if float(cell) != 0))

    def matrix_links(self) -> list[Link]:
        """Return the links of *Matrix: both ways where it is symmetric."""
        if all((v, u) in self.matrix for u, v in self.matrix):
            return [Link(u, v, False) for u, v in self.matrix if u <= v]
        return [Link(u, v, True) for u, v in self.matrix]

    def number(self, line: int, cell: str) -> int:
        k = int(cell) if cell.isascii() and cell.isdigit() and len(cell) < 19 else 0
        if self.count is None or not 1 <= k <= self.count:
            raise UnreadableTopology(f"line {line}: {cell!r} is no number of a vertex: they are 1..{self.count}")
        return k


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` in Pajek's format."""
    texts = texts_of(
        graph.labels, "Pajek", is_allowed=lambda text: text.isprintable() and '"' not in text and _is_seen(text)
    )
    if len(texts) > NODE_LIMIT:
        raise InvalidGraph(f"Pajek files hold at most {NODE_LIMIT} nodes: write .json instead")
    if any(type(label) is not str for label in graph.labels):
        warn_lossy("Pajek makes every label text")
    directed = graph.directed or not graph.is_symmetric
    lines = [f"*Vertices {graph.n}", *(f'{k} "{text}"' for k, text in enumerate(texts, 1))]
    lines.append("*Arcs" if directed else "*Edges")
    lines += [f"{u + 1} {v + 1}" for u, v in graph.arcs() if directed or u < v]
    return ("\n".join(lines) + "\n").encode()


def _is_seen(text: str) -> bool:
    return bool(text.strip()) and text == text.strip()
