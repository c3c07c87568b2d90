"""Edge lists in text: ``u v`` a line, with tabs, commas, semicolons or spaces between, or an arrow.

The format does not say whether links have a direction. They have none, unless a comment, an arrow ``->`` or a column
``Type`` says so. Labels are text, and nodes without links cannot be told. A square block of numbers is a matrix
(:mod:`robustness.files.matrix`). What is neither, such as prose or lines with a keyword, is refused.
"""

from __future__ import annotations

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.rows import Rows, is_number
from robustness.files.text import warn_lossy

__all__ = ["graph_of_links", "links_of"]

_SOURCES = ("source", "from", "src", "u", "tail", "node1", "node_1", "user_a", "sender", "fromnodeid", "start")
_TARGETS = ("target", "to", "dst", "v", "head", "node2", "node_2", "user_b", "receiver", "tonodeid", "end")


def links_of(rows: Rows) -> Digraph:
    """Return the graph whose links are the rows: by the names of the columns where there are names, else the first two.

    Raises
    ------
    UnreadableTopology
        When a row is no link, or a line may be a link or something else.
    """
    width = len(rows.cells[0])
    if width < 2:
        raise UnreadableTopology(
            f"line {rows.lines[0]}: an edge is two labels with a space between, not {rows.cells[0][0]!r}"
        )
    head, body, lines = _head(rows)
    source, target, directed = _columns(head, body, rows.is_directed)
    if not body:
        raise UnreadableTopology("an edge list holds at least one edge, and here is none")
    if head is None:
        _require_links(body, lines)
    for row, line in zip(body, lines, strict=True):
        if not row[source] or not row[target]:
            raise UnreadableTopology(f"line {line}: one end of the link is empty")
    links = [(row[source], row[target]) for row in body]
    said = "" if head is None else f", header on line {rows.lines[0]} skipped"
    return graph_of_links(links, directed, f"links between columns {source + 1} and {target + 1}{said}")


def _head(rows: Rows) -> tuple[list[str] | None, list[list[str]], list[int]]:
    """Return the names of the columns, if the first line has them, and what follows."""
    first, rest = [cell.lower() for cell in rows.cells[0]], rows.cells[1:]
    labels = {cell.lower() for row in rest for cell in row}
    is_named = any(cell in _SOURCES for cell in first) and any(cell in _TARGETS for cell in first)
    is_named = is_named and labels.isdisjoint(first)  # else they name nodes
    is_text = not any(map(is_number, first[:2])) and bool(rest) and all(all(map(is_number, row[:2])) for row in rest)
    if is_named or is_text:
        return first, rest, rows.lines[1:]
    return None, rows.cells, rows.lines


def _columns(head: list[str] | None, body: list[list[str]], said: bool | None) -> tuple[int, int, bool]:
    """Return where the two ends of a link stand, and whether links have a direction."""
    if head is None:
        return 0, 1, bool(said)
    source = next((k for k, name in enumerate(head) if name in _SOURCES), 0)
    target = next((k for k, name in enumerate(head) if name in _TARGETS), 1)
    if "type" not in head:
        return source, target, bool(said)
    kinds = {row[head.index("type")].lower() for row in body}
    if kinds <= {"directed", "undirected"} and len(kinds) == 1:
        return source, target, kinds == {"directed"}
    if kinds & {"directed", "undirected"}:
        raise UnreadableTopology("column 'Type' says directed of some links and undirected of others: write two arcs")
    return source, target, bool(said)


def _require_links(rows: list[list[str]], lines: list[int]) -> None:
    """Guarantees that rows without a header can hardly be anything but links."""
    width = len(rows[0])
    for row, line in zip(rows, lines, strict=True):
        odd = next((cell for cell in row[2:] if cell and not is_number(cell)), None)
        if odd is not None:
            raise UnreadableTopology(
                f"line {line}: {odd!r} in column {row.index(odd, 2) + 1} is neither a label nor a weight: an edge is "
                "two labels and then numbers; name the columns source and target in a first line"
            )
    if width > 2 and len(rows) > 1 and len({row[0] for row in rows}) == 1 and not is_number(rows[0][0]):
        raise UnreadableTopology(
            f"line {lines[0]}: every line begins with {rows[0][0]!r}, which may be a keyword or a node: remove it, or "
            "name the columns source and target in a first line"
        )
    if _may_be_counts(rows):
        raise UnreadableTopology(
            f"line {lines[0]}: {' '.join(rows[0])} may be a link, or the numbers of nodes and links: remove it if it "
            "is counts, move it to the end if it is a link"
        )


def _may_be_counts(rows: list[list[str]]) -> bool:
    """Return whether the first row reads as "so many nodes, so many links" of the rows that follow."""
    first, rest = rows[0], rows[1:]
    if len(rest) < 2 or not all(cell.isascii() and cell.isdigit() for cell in first):
        return False
    labels = {cell for row in rest for cell in row[:2]}
    numbers = [int(cell) for cell in first if len(cell) < 10]
    return len(rest) in numbers[1:] and bool(numbers) and numbers[0] >= len(labels)


def graph_of_links(links: list[tuple[str, str]], directed: bool, how: str) -> Digraph:
    """Return the graph with these links, and say what was taken for granted."""
    arcs = links if directed else links + [(v, u) for u, v in links if u != v]
    graph = Digraph(dict.fromkeys(label for link in links for label in link), arcs, directed=directed)
    kind = "directed" if directed else "undirected"
    distinct = len(set(links) if directed else {frozenset(link) for link in links})
    twice = f"; {len(links) - distinct} given more than once count once" if distinct < len(links) else ""
    warn_lossy(
        f"read as: {kind}, {graph.n} nodes, {distinct} links; {how}{twice}; an edge list reads every label as text and "
        "has no isolated nodes"
    )
    return graph
