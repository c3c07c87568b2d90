"""Lists of links: two labels a line, by the names of columns or by place, with arrows, or under headings.

A link without a word of its own runs both ways, unless a comment, an arrow ``->`` or a column ``Type`` says so.
Labels are text, and nodes without links cannot be told, but for counts and headings that name them. What is no link,
such as prose or lines with a keyword, is refused.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping

from robustness.errors import UnreadableTopology
from robustness.files.found import COLUMN_NAMES, Found, Link, Node, ReadingOptions
from robustness.files.rows import Content, Rows, bare, is_number, split_lines
from robustness.spelled import counted

__all__ = [
    "NO_ISOLATED",
    "PARALLEL",
    "arrows_of",
    "columns_of",
    "found_links",
    "links_of",
    "sections_of",
    "without_counts",
]

_ARROW = re.compile(r"^(?P<u>\S.*?)\s*(?P<kind>->|--|<->)\s*(?P<v>\S.*?)\s*[;,]?$")

_LOSS = "an edge list reads every label as text"
#: What an edge list loses, and how links that it gives twice are told of.
NO_ISOLATED = f"{_LOSS} and has no isolated nodes"
PARALLEL = "repeated one"


def found_links(links: list[Link], directed: bool | None, *notes: str, nodes: list[str] | None = None) -> Found:
    """Return what a list of links holds; its nodes are the ends of its links and those in ``nodes``."""
    labels: dict[Hashable, None] = dict.fromkeys(nodes or [])
    labels.update(dict.fromkeys(end for link in links for end in (link.source, link.target)))
    loss = NO_ISOLATED if nodes is None else _LOSS
    return Found([Node(label) for label in labels], links, directed, list(notes), loss=loss, parallel=PARALLEL)


def arrows_of(content: Content) -> Found | None:
    """Return the links of lines ``u -> v``, ``u -- v`` or ``u <-> v``; None when there are no such lines.

    Raises
    ------
    UnreadableTopology
        When some lines have no arrow, or the arrows contradict one another or a comment.
    """
    lines = content.lines
    if not any("--" in text or "->" in text for _, text in lines):
        return None
    if any("\t" in text and not re.search(r"\t(->|--|<->)\t", text) for _, text in lines):
        return None  # tabs separate, so an arrow is part of a name
    matches = [(number, None if text.startswith('"') else _ARROW.match(text)) for number, text in lines]
    if not any(match for _, match in matches):
        return None
    links: list[Link] = []
    kinds: set[str] = set()
    for number, match in matches:
        if match is None:
            raise UnreadableTopology(f"line {number}: has no arrow, which other lines have: write 'u -> v' in each")
        kinds.add(match["kind"])
        one_way = {"->": True, "<->": False}.get(match["kind"])
        links.append(Link(bare(match["u"]), bare(match["v"]), one_way))
    if "--" in kinds and len(kinds) > 1:
        raise UnreadableTopology("some lines have '->' and some '--': write one kind")
    directed = "->" in kinds
    if content.is_directed is not None and content.is_directed != directed:
        raise UnreadableTopology("a comment says one direction and the arrows another: mend one of them")
    return found_links(links, directed, "arrows")


_HEADINGS: Mapping[str, str] = {
    **dict.fromkeys(("router", "routers", "node", "nodes", "vertices", "vertex"), "nodes"),
    **dict.fromkeys(("link", "links", "edge", "edges", "arcs"), "links"),
}


def sections_of(content: Content) -> Found | None:
    """Return the links of a text with headings such as ``router`` and ``link`` on lines of their own, or None.

    The first column of a row under a heading for nodes names a node. A row under a heading for links holds the names of
    two nodes in its first two columns, or, where the first numbers the links, in the next two.
    """
    parts: dict[str, list[list[str]]] = {}
    current: list[list[str]] | None = None
    for number, text in content.lines:
        match = re.fullmatch(r"([A-Za-z]+)\s*:?\s*(\(?\s*\d+\s*\)?)?", text)
        kind = None if match is None else _HEADINGS.get(match[1].lower())
        if kind is not None and (current is not None or not parts):
            if kind in parts:
                raise UnreadableTopology(f"line {number}: a second heading for {kind}: keep one")
            current = parts.setdefault(kind, [])
        elif current is None:
            return None
        else:
            current.append(split_lines([text])[1][0])
    if set(parts) != {"nodes", "links"}:
        return None
    names = [row[0] for row in parts["nodes"]]
    rows, known = parts["links"], set(names)
    if len(known) < len(names):
        raise UnreadableTopology("a node is named twice under the heading for nodes: keep one")
    places = [k for k in (0, 1) if all(len(row) > k + 1 and {row[k], row[k + 1]} <= known for row in rows)]
    if len(places) != 1:
        raise UnreadableTopology("a row under the heading for links does not begin with the names of two nodes")
    links = [Link(row[places[0]], row[places[0] + 1]) for row in rows]
    return found_links(links, content.is_directed, "headings for nodes and links", nodes=names)


def without_counts(content: Content) -> tuple[Content, list[str] | None, list[str]]:
    """Return the content without a first line of counts, the names of all nodes where it tells them, and notes.

    ``n m`` before m links is counts where it cannot be a link: n nodes are there, and m is none of them. ``n`` alone is
    the number of nodes, where they are numbered from 0 or from 1.

    Raises
    ------
    UnreadableTopology
        When the line may be a link and may be counts, or does not fit what follows.
    """
    lines = content.lines
    if content.skipped >= 0 or len(lines) < 3 or not re.fullmatch(r"\d{1,9}(\s+\d{1,9}){0,2}", lines[0][1]):
        return content, None, []
    number, text = lines[0]
    counts = [int(cell) for cell in text.split()]
    _, cells = split_lines([text for _, text in lines[1:]])
    labels = {cell for row in cells for cell in row[:2]}
    is_table = all(len(row) >= 2 for row in cells)
    numbers = {int(label) for label in labels if label.isascii() and label.isdigit() and len(label) < 10}
    is_numbered = is_table and len(numbers) == len(labels)
    rest = Content(lines[1:], content.is_directed, content.comment, content.skipped)
    if len(counts) == 1:
        if not is_numbered:
            raise UnreadableTopology(f"line {number}: {text} alone is no link: remove it, or --skip-lines 1")
        first = _numbered_from(numbers, counts[0])
        if first is None or (counts[0] == len(lines) - 1 and len(numbers) != counts[0]):
            raise UnreadableTopology(
                f"line {number}: {text} may be the number of nodes or of links, and links join "
                f"{counted(len(numbers), 'node')}: --skip-lines 1 leaves it out"
            )
        nodes = [str(k) for k in range(first, first + counts[0])]
        return rest, nodes, [f"line {number} says {counted(counts[0], 'node')}"]
    if counts[1] != len(lines) - 1 or counts[0] < len(labels) or not is_table:
        return content, None, []
    first = _numbered_from(numbers, counts[0]) if is_numbered else None
    is_link_too = len(counts) == len(cells[0]) and str(counts[1]) in labels
    if is_link_too or first is None:
        raise UnreadableTopology(
            f"line {number}: {text} may be a link, or the numbers of nodes and links: --skip-lines 1 if it is counts, "
            "--skip-lines 0 if it is a link"
        )
    nodes = [str(k) for k in range(first, first + counts[0])]
    return rest, nodes, [f"line {number} says {counted(counts[0], 'node')} and {counted(counts[1], 'link')}"]


def _numbered_from(numbers: set[int], count: int) -> int | None:
    """Return whether ``count`` nodes are numbered from 0 or from 1, or None when that is in doubt."""
    if not numbers or max(numbers) > count or (0 in numbers and count in numbers):
        return None
    if 0 in numbers:
        return 0 if count - 1 in numbers else None
    return 1 if count in numbers else None


def links_of(
    rows: Rows, options: ReadingOptions, nodes: list[str] | None = None, notes: list[str] | None = None
) -> Found:
    """Return the links in rows: by the columns asked for, by the names of the columns, or in the first two.

    Raises
    ------
    UnreadableTopology
        When a row is no link, or a line may be a link or something else.
    """
    told = list(notes or [])
    head, body, lines = _head(rows, options)
    numbered = [row[0] for row in body]
    if (
        head is not None
        and not head[0]
        and any(numbered == [str(k) for k in range(first, first + len(body))] for first in (0, 1))
    ):
        head, body = head[1:], [row[1:] for row in body]
        told.append("column 1 numbers the rows")
    if len(head or rows.cells[0]) < 2:
        raise UnreadableTopology(
            f"line {rows.lines[0]}: an edge is two labels with a space between, not {rows.cells[0][0]!r}"
        )
    source, target = columns_of(options, head, ("source", "target"), len(rows.cells[0]), {"source": 0, "target": 1})
    if not body:
        raise UnreadableTopology("an edge list holds at least one edge, and here is none")
    if head is None and not options.columns:
        _require_links(body, lines)
    for row, line in zip(body, lines, strict=True):
        if not row[source] or not row[target]:
            raise UnreadableTopology(f"line {line}: one end of the link is empty")
    own = _types(head, body, lines)
    loops = sum(row[source] == row[target] for row in body)
    if 2 * loops > len(body) > 1:
        raise UnreadableTopology(
            f"{loops} of {len(body)} rows join a node with itself, as in a table of nodes: say where the ends of links "
            "stand with --columns source=1,target=2"
        )
    names = head or [str(k) for k in range(1, len(rows.cells[0]) + 1)]
    others = [(k, name) for k, name in enumerate(names) if k not in (source, target)]
    links = [
        Link(row[source], row[target], one_way, {name: row[k] for k, name in others if k < len(row) and row[k]})
        for row, one_way in zip(body, own, strict=True)
    ]
    told.append(f"links between columns {source + 1} and {target + 1}")
    if head is not None and rows.may_have_head:
        told.append(f"header on line {rows.lines[0]} skipped")
    found = found_links(links, rows.is_directed, *told, nodes=nodes)
    found.is_doubtful = head is None and not options.columns and len(rows.cells[0]) > 2
    return found


def _head(rows: Rows, options: ReadingOptions) -> tuple[list[str] | None, list[list[str]], list[int]]:
    """Return the names of the columns, if the first line has them, and what follows."""
    first, rest = [cell.lower() for cell in rows.cells[0]], rows.cells[1:]
    follows = first, rest, rows.lines[1:]
    if not rows.may_have_head:
        return None, rows.cells, rows.lines
    wanted = [str(place).lower() for place in (options.columns or {}).values() if isinstance(place, str)]
    if wanted:
        return follows
    labels = {cell.lower() for row in rest for cell in row}
    if not first[0] and rest:
        return follows
    names = [{name for name in COLUMN_NAMES[end] if name in first} for end in ("source", "target")]
    is_text = not any(map(is_number, first[:2])) and bool(rest) and all(all(map(is_number, row[:2])) for row in rest)
    if is_text:
        return follows
    if (
        set(first[:2]) & {"id", "node", "node_id", "nodes", "name", "label"}
        and not any(names)
        and labels.isdisjoint(first)
    ):
        raise UnreadableTopology(
            f"line {rows.lines[0]}: {', '.join(first[:3])} are the columns of a table of nodes: read the table of links"
        )
    if not all(names) or not labels.isdisjoint(first):  # then they name nodes
        _refuse_unknown_names(rows)
        return None, rows.cells, rows.lines
    words = [name for end in names for name in end]
    stems = {re.sub(r"\d+$", "", label) for label in labels}
    looks_like_nodes = any(re.sub(r"\d+$", "", name) in stems for name in words if name[-1].isdigit())
    if looks_like_nodes or ({"u", "v"} <= set(first[:2]) and rest):
        raise UnreadableTopology(
            f"line {rows.lines[0]}: {' '.join(first[:2])} may be a link or the names of the columns: --skip-lines 1 "
            "if it "
            "is names, --skip-lines 0 if it is a link"
        )
    return follows if any(len(name) > 2 for name in words) else (None, rows.cells, rows.lines)


def _refuse_unknown_names(rows: Rows) -> None:
    """Refuse a first line of words that are no ends of any other link, where links meet: it may name the columns."""
    first, rest = rows.cells[0][:2], rows.cells[1:]
    ends = [cell for row in rest for cell in row[:2]]
    if len(set(first)) < 2 or any(map(is_number, first)) or len(set(ends)) == len(ends):
        return
    if not set(first).isdisjoint(ends):
        return
    raise UnreadableTopology(
        f"line {rows.lines[0]}: {first[0]!r} and {first[1]!r} are ends of no other link, so they may be names of "
        "columns: --skip-lines 1 if they are, --skip-lines 0 if they are a link"
    )


def columns_of(
    options: ReadingOptions,
    head: list[str] | None,
    wanted: tuple[str, ...],
    width: int,
    otherwise: Mapping[str, int],
) -> list[int]:
    """Return where each of ``wanted`` stands, from 0: as asked, by the names of the columns, or as ``otherwise`` says.

    Raises
    ------
    UnreadableTopology
        When a column that was asked for is not there.
    """
    asked = options.columns or {}
    places = []
    for name in wanted:
        place = asked.get(name)
        if isinstance(place, str):
            if head is None or place.lower() not in head:
                raise UnreadableTopology(f"no column is named {place!r}; the first line has: {', '.join(head or [])}")
            places.append(head.index(place.lower()))
        elif place is not None:
            if place > width:
                raise UnreadableTopology(f"column {place} was asked for, and there are {width}")
            places.append(place - 1)
        else:
            named = [head.index(known) for known in COLUMN_NAMES[name] if head is not None and known in head]
            places.append(named[0] if named else otherwise[name])
    if len(set(places)) < len(places):
        raise UnreadableTopology(f"one column is taken for two things: name {', '.join(wanted)} with --columns")
    return places


def _types(head: list[str] | None, body: list[list[str]], lines: list[int]) -> list[bool | None]:
    """Return what a column ``Type`` says of each link: directed, undirected, or nothing."""
    if head is None or "type" not in head:
        return [None] * len(body)
    place = head.index("type")
    kinds = [row[place].lower() for row in body]
    if not {"directed", "undirected"} & set(kinds):
        return [None] * len(body)
    for kind, line in zip(kinds, lines, strict=True):
        if kind not in ("directed", "undirected", "mutual"):
            raise UnreadableTopology(f"line {line}: Type is Directed or Undirected, not {kind!r}")
    return [kind == "directed" for kind in kinds]


def _require_links(rows: list[list[str]], lines: list[int]) -> None:
    """Guarantees that rows without a header can hardly be anything but links."""
    width = len(rows[0])
    for row, line in zip(rows, lines, strict=True):
        odd = next((cell for cell in row[2:] if cell and not is_number(cell)), None)
        if odd is not None:
            raise UnreadableTopology(
                f"line {line}: {odd!r} in column {row.index(odd, 2) + 1} is neither a label nor a weight: an edge is "
                "two labels and then numbers; say where they stand with --columns source=1,target=2"
            )
    if width > 2 and len(rows) > 1 and len({row[0] for row in rows}) == 1 and not is_number(rows[0][0]):
        raise UnreadableTopology(
            f"line {lines[0]}: every line begins with {rows[0][0]!r}, which may be a keyword or a node: "
            "--columns source=2,target=3 if it is a keyword, source=1,target=2 if it is a node"
        )
