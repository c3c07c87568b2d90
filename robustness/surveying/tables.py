"""The rows of a survey as text, CSV, JSON Lines, JUnit XML and Markdown. Names are data: escaped in each."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any
from xml.etree import ElementTree as ET

from robustness.printable import printable, width_of
from robustness.spelled import Spelling, counted, listed_in_words
from robustness.surveying.row import NOT_REACHED, Row

__all__ = ["TABLES", "aligned", "cells", "flat", "text"]

#: How many nodes of a set a failure names.
_MOST_NODES = 20


def flat(row: Row, models: Sequence[str]) -> dict[str, Any]:
    """Return a row as one value for each column, the same columns for every row of a survey."""
    content = row.as_dict()
    guaranteed, refuted = content.pop("guaranteed"), content.pop("refuted")
    content.pop("weakest")
    tail = {
        name: content.pop(name)
        for name in ("gate", "links", "links_at_least", "sha256", "certificate", "seconds", "error")
    }
    for model in models:
        content[f"{model} guaranteed"] = guaranteed.get(model)
        content[f"{model} refuted"] = refuted.get(model)
    return content | tail


def cells(rows: Sequence[Row], models: Sequence[str]) -> list[list[str]]:
    """Return the table that a person reads: a head, then a line for each row.

    An interval stands where a limit left one: ``2..4``. Under a model stands the largest f that is guaranteed, and
    ``0..2`` when f = 3 is the smallest that is refuted and nothing is known in between; ``any`` of a single node,
    ``none`` where not even f = 0 is. Under "links" stands how many further links mend it, where asked.
    """
    has_gate = any(row.gate for row in rows)
    has_links = any(row.links_at_least is not None for row in rows)
    asked = [name for name, is_there in (("gate", has_gate), ("links", has_links)) if is_there]
    head = ["network", "nodes", "arcs", "r*", "s", *models, *asked, "seconds", "note"]
    return [head, *(_line(row, models, has_gate, has_links) for row in rows)]


def _line(row: Row, models: Sequence[str], has_gate: bool, has_links: bool = False) -> list[str]:
    gate = [row.gate] if has_gate else []
    gate += [_interval(row.links_at_least, row.links)] if has_links else []
    if row.error:
        return [row.network, *[""] * (4 + len(models)), *gate[:has_gate], *[""] * has_links, "", row.error]
    known = [_interval(row.r, row.r_at_most), _interval(row.s, row.s_at_most)]
    promised = [_survived(row.guaranteed.get(each), _before(row.refuted.get(each))) for each in models]
    if row.nodes is not None and row.nodes < 2:  # nobody can disagree
        promised = ["any"] * len(models)
    note = "directed" if row.directed else ""
    return [row.network, str(row.nodes), str(row.arcs), *known, *promised, *gate, f"{row.seconds:.2f}", note]


def _before(refuted: int | None) -> int | None:
    return None if refuted is None else refuted - 1


def _survived(low: int | None, high: int | None) -> str:
    """Return an interval of numbers of liars, which begins with ``none`` where agreement is not promised at all."""
    if low is None or low >= 0:
        return _interval(low, high)
    if high is None:
        return "?"
    return "none" if high < 0 else f"none..{high}"


def _interval(low: int | None, high: int | None) -> str:
    if low is None:
        return "?"
    if high is None:
        return f">={low}"
    return str(low) if low == high else f"{low}..{high}"


def text(rows: Sequence[Row], models: Sequence[str]) -> str:
    """Return a table for a terminal: names to the left, numbers to the right."""
    table = [[printable(cell) for cell in line] for line in cells(rows, models)]
    return "\n".join(aligned(table))


def aligned(table: Sequence[Sequence[str]], gap: int = 2) -> Iterator[str]:
    """Yield a line for each row, in columns ``gap`` spaces apart; the first row is the head."""
    widths = [max(map(width_of, column)) for column in zip(*table, strict=True)]
    is_word = [name in ("network", "gate", "note") for name in table[0]]
    for line in table:
        rooms = (" " * (width - width_of(cell)) for cell, width in zip(line, widths, strict=True))
        padded = (cell + room if word else room + cell for cell, room, word in zip(line, rooms, is_word, strict=True))
        yield (" " * gap).join(padded).rstrip()


def _csv(rows: Sequence[Row], models: Sequence[str]) -> str:
    target = io.StringIO()
    columns = list(flat(Row(""), models))
    writer = csv.DictWriter(target, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(flat(row, models) for row in rows)
    return target.getvalue()


def _json_lines(rows: Sequence[Row], _: Sequence[str]) -> str:
    schema = {"schema": "robustness/survey-row/1"}
    return "".join(json.dumps(schema | row.as_dict(), allow_nan=False) + "\n" for row in rows)


def _junit(rows: Sequence[Row], models: Sequence[str]) -> str:
    """Return one test case for each network: a refuted gate is a failure, an unreadable file an error.

    A gate that is undecided is a failure too, since nobody may deploy on it; its type tells it apart.
    """
    suite = ET.Element(
        "testsuite",
        name="robustness survey",
        tests=str(len(rows)),
        failures=str(sum(not row.error and row.gate in ("refuted", "undecided") for row in rows)),
        errors=str(sum(bool(row.error) for row in rows)),
        skipped="0",
        time=f"{sum(row.seconds for row in rows):.6f}",
    )
    head = cells([], models)[0]
    for row in rows:
        case = ET.SubElement(
            suite, "testcase", classname="robustness", name=_xml(row.network), time=f"{row.seconds:.6f}"
        )
        if row.error:
            kind = "not reached" if row.error == NOT_REACHED else "unreadable"
            ET.SubElement(case, "error", type=kind, message=_xml(row.error))
            continue
        facts = ", ".join(
            f"{name} {cell}" for name, cell in zip(head[1:], _line(row, models, False)[1:], strict=True) if cell
        )
        if row.gate in ("refuted", "undecided"):
            failure = ET.SubElement(case, "failure", type=row.gate, message=_xml(f"{row.gate}: {facts}"))
            failure.text = _xml(_weakest_pair(row)) or None
        ET.SubElement(case, "system-out").text = _xml(facts)
    ET.indent(suite)
    return ET.tostring(suite, encoding="unicode", xml_declaration=False) + "\n"


def _weakest_pair(row: Row) -> str:
    """Return the two sets that do not listen in words; empty where none is known."""
    if row.weakest is None or row.r_at_most is None:
        return ""
    spelled = Spelling(label for side in row.weakest.values() for label in side)
    low, high = (listed_in_words(row.weakest[side], _MOST_NODES, spelled) for side in ("S1", "S2"))
    return (
        f"weakest pair: no node of S1 = {low} or S2 = {high} hears {counted(row.r_at_most + 1, 'node')} outside its set"
    )


def _xml(words: str) -> str:
    """Return ``words`` without the letters that XML 1.0 cannot hold; each stands as ``?``."""
    return re.sub("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", words)


def _markdown(rows: Sequence[Row], models: Sequence[str]) -> str:
    head, *body = cells(rows, models)
    lines = [head, ["---"] * len(head), *body]
    return "".join("| " + " | ".join(map(_markdown_cell, line)) + " |\n" for line in lines)


def _markdown_cell(cell: str) -> str:
    if cell == "---":
        return cell
    return re.sub(r"([\\`*_{}\[\]<>()#+!|~$&-])", r"\\\1", printable(cell))


def _text_lines(rows: Sequence[Row], models: Sequence[str]) -> str:
    return text(rows, models) + "\n"


#: How rows are written, by name; each takes the rows and the models and returns the whole text.
TABLES: Mapping[str, Callable[[Sequence[Row], Sequence[str]], str]] = MappingProxyType(
    {"table": _text_lines, "csv": _csv, "jsonl": _json_lines, "junit": _junit, "markdown": _markdown}
)
