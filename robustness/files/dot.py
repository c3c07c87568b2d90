"""DOT, the language of Graphviz: parsed by pydot, which comes with the extra ``formats``.

``graph`` has links both ways, ``digraph`` arcs; ``dir`` of an edge (``both``, ``none``, ``back``) is honoured. A
subgraph is its nodes. Nodes are named by their ``label`` where each has one of its own, else by what stands in the
text.
"""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from collections.abc import Iterator, Mapping
from typing import Any

from robustness.digraph import Digraph
from robustness.errors import MissingExtra, UnreadableTopology
from robustness.files.found import Found, Link, Node, ReadingOptions, graph_of
from robustness.files.text import decode_utf8, texts_of, warn_lossy
from robustness.places import place_of
from robustness.spelled import counted

__all__ = ["decode", "encode"]

#: pydot's parser goes down into brackets by recursion, and its time grows with them.
_DEPTH_LIMIT = 30

#: The most letters that are read: pydot takes about a minute for them.
_SIZE_LIMIT = 1_000_000


def decode(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of a DOT file."""
    text = decode_utf8(data)
    if len(text) > _SIZE_LIMIT:
        raise UnreadableTopology(
            f"is longer than {_SIZE_LIMIT} letters, the most that is read of DOT: write .json instead"
        )
    depth = 0
    for number, line in enumerate(text.split("\n"), 1):
        depth += line.count("{") - line.count("}")
        if depth > _DEPTH_LIMIT:
            raise UnreadableTopology(f"line {number}: brackets are nested more than {_DEPTH_LIMIT} deep")
    complaint = io.StringIO()
    try:
        with _quietly(complaint):
            import pydot

            graphs = pydot.graph_from_dot_data(text)
    except ImportError:
        raise MissingExtra("DOT files need pydot: pip install 'graph-robustness[formats]'") from None
    except RecursionError:
        raise
    except Exception as problem:  # noqa: BLE001 - pydot raises whatever its parser runs into
        raise UnreadableTopology(f"the DOT file cannot be read: {problem}") from None
    if not graphs:
        match = re.search(r"\(at char \d+\), \(line:(\d+), col:(\d+)\)", complaint.getvalue())
        place = f"line {match[1]}, column {match[2]}: " if match else ""
        raise UnreadableTopology(f"{place}this is not the DOT language")
    if len(graphs) > 1:
        raise UnreadableTopology(f"holds {counted(len(graphs), 'graph')}: keep one graph a file")
    reader = _Reader(graphs[0].get_type() == "digraph")
    reader.take(graphs[0], {}, {})
    nodes = [
        Node(name, ("label",) if "label" in values else (), values, place_of(values))
        for name, values in reader.nodes.items()
    ]
    found = Found(nodes, reader.links, reader.directed, loss="DOT reads every label as text")
    return graph_of(found, options)


@contextlib.contextmanager
def _quietly(complaint: io.StringIO) -> Iterator[None]:
    """Put into ``complaint`` what pydot prints about a bad file, and silence the warnings of its parser."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(complaint), contextlib.redirect_stderr(complaint):
        warnings.simplefilter("ignore")
        yield


class _Reader:
    """Collects nodes and edges of a graph and its subgraphs, with the defaults that hold where they stand."""

    def __init__(self, directed: bool) -> None:
        self.directed = directed
        self.nodes: dict[str, dict[str, str]] = {}
        self.links: list[Link] = []

    def take(self, graph: Any, node_defaults: Mapping[str, str], edge_defaults: Mapping[str, str]) -> list[str]:
        """Take everything of a graph and return the names of its nodes."""
        node_defaults, edge_defaults = dict(node_defaults), dict(edge_defaults)
        for defaults, found in ((node_defaults, graph.get_node_defaults()), (edge_defaults, graph.get_edge_defaults())):
            for values in found or []:
                defaults.update(values)
        before = dict.fromkeys(self.nodes)
        inside: dict[str, None] = {}
        for node in graph.get_nodes():
            name = _bare(node.get_name())
            if name in ("node", "edge", "graph") and not node.get_name().startswith('"'):
                continue  # defaults, not nodes
            inside[name] = None
            values = self.nodes.setdefault(name, {})
            values.update({key: _bare(str(value)) for key, value in node.get_attributes().items()})
            if values.get("label") in ("\\N", ""):
                del values["label"]
        for subgraph in graph.get_subgraphs():
            inside.update(dict.fromkeys(self.take(subgraph, node_defaults, edge_defaults)))
        for edge in graph.get_edges():
            ends = [self.ends(edge.get_source()), self.ends(edge.get_destination())]
            direction = _bare(str(edge.get_attributes().get("dir", edge_defaults.get("dir", ""))))
            inside.update(dict.fromkeys([*ends[0], *ends[1]]))
            for u in ends[0]:
                for v in ends[1]:
                    self.link(u, v, direction)
        del before
        return list(inside)

    def link(self, u: str, v: str, direction: str) -> None:
        for end in (u, v):
            self.nodes.setdefault(end, {})
        if not self.directed:
            self.links.append(Link(u, v, False))
        elif direction == "back":
            self.links.append(Link(v, u, True))
        else:
            self.links.append(Link(u, v, direction not in ("both", "none")))

    def ends(self, end: Any) -> list[str]:
        """Return the nodes at one end of an edge: one, without its port, or those of a subgraph."""
        if isinstance(end, str):
            return [_without_port(end)]
        import pydot

        subgraph = end if hasattr(end, "get_nodes") else pydot.Subgraph(obj_dict=end)
        return self.take(subgraph, {}, {})


def _without_port(text: str) -> str:
    match = re.match(r'^("(?:[^"\\]|\\.)*"|[^":]+)(:.*)?$', text, re.DOTALL)
    return _bare(match[1] if match else text)


def _bare(text: str) -> str:
    """Return a name without quotes and with its escaped quotes and line ends as they are shown."""
    if len(text) > 1 and text[0] == text[-1] == '"':
        text = text[1:-1].replace('\\"', '"')
    return text


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` in the DOT language, every name in quotes."""
    texts = texts_of(
        graph.labels,
        "DOT",
        is_allowed=lambda text: text.isprintable() and "\\" not in text and text.strip() == text != "",
    )
    if any(type(label) is not str for label in graph.labels):
        warn_lossy("DOT makes every label text")
    directed = graph.directed or not graph.is_symmetric
    kind, arrow = ("digraph", "->") if directed else ("graph", "--")
    quoted = ['"' + text.replace('"', '\\"') + '"' for text in texts]
    places = [f' [pos="{x!r},{y!r}"]' for x, y in graph.places or ()] or [""] * graph.n
    lines = [f"{kind} {{", *(f"  {name}{place};" for name, place in zip(quoted, places, strict=True))]
    lines += [f"  {quoted[u]} {arrow} {quoted[v]};" for u, v in graph.arcs() if directed or u < v]
    return ("\n".join([*lines, "}"]) + "\n").encode()
