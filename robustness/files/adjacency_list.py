"""Lists of neighbours: a node a line, then all its neighbours, ``1: 2 3`` or ``1 2 3``.

Lists that agree (each of two neighbours names the other) are an undirected graph. Of others the user says whether
each link is named once and runs both ways (``--undirected``) or one way (``--directed``; ``--rows`` says which).
"""

from __future__ import annotations

import re

from robustness.errors import UnreadableTopology
from robustness.files.found import Found, Link, Node, ReadingOptions
from robustness.files.rows import Content, Rows, split_lines

__all__ = ["lists_of", "neighbours_of", "refuse_lists_of_neighbours"]


def neighbours_of(content: Content) -> list[list[str]] | None:
    """Return node and neighbours of every line, where all are ``u: v w`` or where ragged ones agree; else None."""
    matches = [re.fullmatch(r"(?P<u>[^:\s]+)\s*:(?:\s+(?P<rest>.*))?", text) for _, text in content.lines]
    if len(matches) > 1 and all(matches):
        return [[match["u"].strip(), *_split(match["rest"] or "")] for match in matches if match is not None]
    cells = split_lines([text for _, text in content.lines])[1]
    is_ragged = len({len(row) for row in cells}) > 1
    return cells if is_ragged and _agree(cells) else None


def _split(text: str) -> list[str]:
    return [part for part in re.split(r"[\s,;]+", text.strip().strip("[]{}()")) if part]


def _agree(cells: list[list[str]]) -> bool:
    """Return whether every node has one row, every cell is a node, and neighbours name one another."""
    if not all(cells):  # a line of separators alone
        return False
    heads = {row[0] for row in cells}
    if len(heads) < len(cells) or len(cells) < 2:
        return False
    pairs = {(row[0], cell) for row in cells for cell in row[1:]}
    return bool(pairs) and all(u != v and (v, u) in pairs for u, v in pairs)


def lists_of(content: Content, options: ReadingOptions) -> Found:
    """Return the links of lists of neighbours.

    Raises
    ------
    UnreadableTopology
        When a node has two lists.
    """
    if not content.lines:
        raise UnreadableTopology("lists of neighbours hold at least one node, and here is none")
    cells = neighbours_of(content) or [_split(text) or [""] for _, text in content.lines]
    seen: dict[str, int] = {}
    for (line, _), row in zip(content.lines, cells, strict=True):
        if row[0] in seen:
            raise UnreadableTopology(f"line {line}: {row[0]!r} has a list on line {seen[row[0]]} already: join the two")
        seen[row[0]] = line
    if not any(len(row) > 1 for row in cells):
        raise UnreadableTopology(
            "no line has a neighbour: lists of neighbours are 'u v w', a node and all that it is linked to"
        )
    labels = dict.fromkeys([row[0] for row in cells] + [cell for row in cells for cell in row[1:]])
    nodes = [Node(label) for label in labels]
    links = [Link(row[0], cell) for row in cells for cell in row[1:]]
    pairs = {(link.source, link.target) for link in links}
    loss = "lists of neighbours make every label text"
    if all((v, u) in pairs for u, v in pairs) and not options.directed:
        once = list({frozenset((link.source, link.target)): link for link in links}.values())
        return Found(nodes, once, False, ["lists of neighbours"], loss=loss)
    directed = content.is_directed if options.directed is None else options.directed
    if directed is None and options.rows is None:
        u, v = next((a.source, a.target) for a in links if (a.target, a.source) not in pairs)
        raise UnreadableTopology(
            f"{u!r} lists {v!r} and {v!r} does not list {u!r}: --undirected if a link is listed once, --directed if it "
            "runs one way"
        )
    if options.rows == "hear":
        links = [Link(link.target, link.source) for link in links]
    way = "whom u hears" if options.rows == "hear" else "who hears u"
    notes = [f"lists of neighbours: node u lists {way}" if directed is not False else "lists of neighbours"]
    is_doubtful = options.rows is None and directed is not False
    return Found(nodes, links, True if directed is None else directed, notes, loss=loss, is_doubtful=is_doubtful)


def refuse_lists_of_neighbours(rows: Rows, *, is_asked: bool) -> None:
    """Refuse rows of equal length that may be links with weights, or a matrix, and may be lists of neighbours."""
    if not is_asked and len(rows.cells[0]) > 2 and _agree(rows.cells):
        raise UnreadableTopology(
            f"{len(rows.cells)} rows of {len(rows.cells[0])} labels may be links with weights and may be lists of "
            "neighbours: say which with --format edge-list or --format adjacency-list"
        )
