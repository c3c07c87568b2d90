"""The page itself: words, table and parts as HTML. Every name is data and escaped; nothing is loaded from elsewhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from importlib.resources import files
from shlex import quote

from robustness.reporting.film import film_html
from robustness.reporting.section import Section, as_data_address
from robustness.reporting.wording import headline, in_words, reason
from robustness.surveying import Gate, Row, Survey
from robustness.surveying.row import STANDINGS
from robustness.surveying.tables import cells

__all__ = ["html"]

#: What a browser may do with the page: run its own script and style, show its own pictures, and ask for nothing.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"


def html(title: str, survey: Survey, gate: Gate, sections: Mapping[str, Section]) -> str:
    """Return the page.

    Parameters
    ----------
    title : str
    survey : Survey
        Its rows become the table.
    gate : Gate
        What was asked of every network.
    sections : mapping from name to Section
        What is shown beside the rows; a row without one is shown by its facts alone.
    """
    parts = "".join(
        _part(k, row, sections.get(row.network, Section()), survey.models) for k, row in enumerate(survey.rows)
    )
    notes = [*survey.notes, *(f"{name}: the time limit came first; nothing is claimed" for name in survey.missing)]
    listed = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return (
        "<!DOCTYPE html>\n<html lang='en'>\n<head>\n<meta charset='utf-8'>\n"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>\n"
        f"<meta http-equiv='Content-Security-Policy' content=\"{_POLICY}\">\n"
        f"<title>{escape(title)}</title>\n<link rel='icon' href='data:,'>\n"
        f"<style>\n{_resource('page.css')}</style>\n</head>\n<body>\n<main>\n"
        f"<h1>{escape(title)}</h1>\n"
        f"<p class='verdict {_standing_of(survey, gate)}'>{escape(headline(survey, gate))}</p>\n"
        f"{_table(survey, sections)}\n{parts}"
        + (f"<h2>Notes</h2>\n<ul>{listed}</ul>\n" if notes else "")
        + f"{_FOOT}</main>\n<script>\n{_resource('page.js')}</script>\n</body>\n</html>\n"
    )


_FOOT = (
    "<p class='faint'>Every answer is exact or says that a limit came first. <i>(r,s)-robust</i>: of any two disjoint "
    "sets of nodes, one has enough nodes that each hear r nodes outside their set. A network survives f when resilient "
    "consensus reaches agreement whatever f malicious nodes do; the models say how many may lie where, and "
    "whether they may tell each neighbour another lie.</p>\n"
)


def _key(head: Sequence[str], models: Sequence[str]) -> str:
    """Return what the columns mean that do not say it themselves."""
    told = []
    if models:
        told.append(
            "Under each threat model stands the largest f that is survived: 0 when agreement needs everybody to be "
            "honest, none when that does not suffice, 0..2 when 0 is proven, 3 refuted, and the rest was not decided."
        )
    if "links" in head:
        wish = "what is required of it" if "gate" in head else "one more r"
        told.append(
            f"Under links stands how many further links give a network {wish}: 3..5 when 5 were found, and fewer than "
            "3 are proven not to do."
        )
    return f"<p class='faint'>{' '.join(told)}</p>" if told else ""


def _standing_of(survey: Survey, gate: Gate) -> str:
    """Return what colours the verdict; nothing where nothing was required, since nothing has passed then."""
    return "" if gate == Gate() and survey.worst == "passed" else survey.worst


def _resource(name: str) -> str:
    return files("robustness.reporting").joinpath(name).read_text(encoding="utf-8")


def _table(survey: Survey, sections: Mapping[str, Section]) -> str:
    """Return the table, with what sorts and filters it."""
    head, *body = _kept(cells(survey.rows, survey.models), survey)
    has_gate = "gate" in head
    has_pictures = any(section.picture for section in sections.values())
    names = "".join(_head(name) for name in head) + ("<th class='thumbs'>picture</th>" if has_pictures else "")
    lines = "".join(
        _line(k, row, line, head, sections.get(row.network, Section()), has_pictures)
        for k, (row, line) in enumerate(zip(survey.rows, body, strict=True))
    )
    failing = "<label><input type='checkbox' id='failing'> only what does not pass</label>" if has_gate else ""
    return (
        "<div class='tools'><label>find <input type='search' id='words'></label>"
        f"{failing}<span id='count' class='faint' role='status'>{len(body)} of {len(body)} shown</span></div>\n"
        f"{_filters(head, [row.network for row in survey.rows])}"
        "<div class='scroll' tabindex='0' role='region' aria-label='networks'>"
        f"<table class='networks'><thead><tr>{names}</tr></thead><tbody>{lines}</tbody></table></div>"
        + _key(head, survey.models)
    )


def _kept(table: list[list[str]], survey: Survey) -> list[list[str]]:
    """Return the table with the gate beside the name, and without the seconds where no row has kept them."""
    order = list(range(len(table[0])))
    if "gate" in table[0]:
        order.insert(1, order.pop(table[0].index("gate")))
    if not any(row.seconds for row in survey.rows):
        order.remove(table[0].index("seconds"))
    return [[line[k] for k in order] for line in table]


def _group(name: str) -> str:
    """Return the collection or folder that a name begins with; empty where there is none."""
    return name.rpartition("/")[0] and name.partition("/")[0]


def _filters(head: Sequence[str], networks: Sequence[str]) -> str:
    """Return the bounds by which rows can be chosen, folded: a collection, and a least and a greatest value each."""
    groups = sorted(set(map(_group, networks)))
    chosen = ""
    if 1 < len(groups) < len(networks) and "" not in groups:
        options = "".join(f"<option>{escape(each)}</option>" for each in groups)
        chosen = f"<label>collection <select id='group'><option value=''>all</option>{options}</select></label>"
    bounds = "".join(
        f"<fieldset data-column='{k}'><legend>{escape(name)}</legend>"
        + "".join(
            f"<input type='number' step='any' class='{end}' aria-label='{escape(name, quote=True)}: {words}' "
            f"placeholder='{words}'>"
            for end, words in (("least", "at least"), ("most", "at most"))
        )
        + "</fieldset>"
        for k, name in enumerate(head)
        if "number" in _class(name)
    )
    return (
        f"<details class='filters'><summary>Filter by value</summary><div class='bounds'>{chosen}{bounds}"
        "<button type='button' id='clear'>Clear</button></div><p class='faint'>An interval such as 2..4 is shown when "
        "all of it lies within the bounds, and what is not known never is.</p></details>\n"
    )


def _head(name: str) -> str:
    shown = "comment" if name == "note" else name
    return f"<th{_class(name)} scope='col'><button type='button'>{escape(shown)}</button></th>"


def _class(name: str) -> str:
    return {"network": "", "gate": "", "note": " class='note'"}.get(name, " class='number'")


def _line(k: int, row: Row, line: Sequence[str], head: Sequence[str], section: Section, has_pictures: bool) -> str:
    shown = []
    for name, cell in zip(head, line, strict=True):
        if name == "network":
            shown.append(
                f"<td class='name' data-value='{escape(cell, quote=True)}'><a href='#n{k}'>{escape(cell)}</a></td>"
            )
        elif name == "gate":
            shown.append(f"<td class='{escape(cell, quote=True)}'{_values(cell)}>{escape(cell)}</td>")
        else:
            told = reason(row) if name == "note" and row.error else cell
            shown.append(f"<td{_class(name)}{_values(cell)}>{escape(told)}</td>")
    if has_pictures:
        image = f"<img class='thumb' alt='' src='{as_data_address(section.picture)}'>" if section.picture else ""
        shown.append(f"<td class='thumbs'>{image}</td>")
    group = f" data-group='{escape(_group(row.network), quote=True)}'"
    return f"<tr data-gate='{escape(row.gate, quote=True)}'{group} data-part='n{k}'>{''.join(shown)}</tr>"


def _values(cell: str) -> str:
    """Return what a cell sorts by, and the upper end of an interval (empty where none is known) to filter by."""
    low, dots, high = {"?": ("", "", ""), "any": ("0", "", "")}.get(cell) or cell.lstrip(">=").partition("..")
    low = "-1" if low == "none" else low  # less than 0, agreement while nobody lies
    is_open = dots or cell.startswith((">=", "any"))
    upper = f" data-upper='{escape(high, quote=True)}'" if is_open else ""
    return f"{upper} data-value='{escape(low, quote=True)}'"


def _part(k: int, row: Row, section: Section, models: Sequence[str]) -> str:
    """Return what is known about one network, to unfold."""
    picture = (
        f"<figure><img alt='The network{', its weakest pair marked' if row.weakest else ''}' "
        f"src='{as_data_address(section.picture)}'></figure>"
        if section.picture
        else ""
    )
    table, sentences = _tolerance(section)
    film = ""
    if section.film is not None:
        played = film_html(section.film).replace("{clip}", f"clip{k}")
        told = f"{escape(section.film.claim)}. {escape(section.film.story)}."
        film = f"<h3>The attack that splits it</h3><p>{told}</p>{played}"
    proposed = "".join(f"<p>{escape(each)}</p>" for each in section.mending)
    mending = f"<h3>What would mend it</h3>{proposed}" if proposed else ""
    return (
        f"<details class='network' id='n{k}'><summary><h2>{escape(row.network)}</h2>{_standing(row)}</summary>"
        f"<p>{escape(in_words(row, models))}</p><div class='two'>{picture}{table}</div>{sentences}{film}{mending}"
        f"{_evidence(row, section)}</details>\n"
    )


def _standing(row: Row) -> str:
    return f" <span class='standing {row.gate}'>{row.gate}</span>" if row.gate in STANDINGS else ""


def _tolerance(section: Section) -> tuple[str, str]:
    """Return what is survived under each threat model, in numbers and in sentences."""
    if not section.models:
        return "", ""
    lines = "".join(
        f"<tr><th scope='row'>{escape(name)}<span class='faint'>{escape(where)}</span></th>"
        f"<td class='number'>{escape(survived)}</td><td class='number'>{escape(refuted)}</td></tr>"
        for name, where, survived, refuted in section.models
    )
    told = "".join(f"<li>{escape(sentence)}</li>" for sentence in section.told)
    return (
        "<div><h3>What it survives</h3><table class='models'><thead><tr><th scope='col'>threat model</th>"
        "<th scope='col' class='number'>largest f survived</th>"
        "<th scope='col' class='number'>smallest f that splits it</th></tr></thead>"
        f"<tbody>{lines}</tbody></table></div>",
        f"<ul>{told}</ul>",
    )


def _evidence(row: Row, section: Section) -> str:
    if not row.sha256:
        return ""
    rows = [("SHA-256 of the canonical graph", row.sha256)]
    command = ""
    if row.certificate:
        rows += [("certificate", row.certificate), ("SHA-256 of the certificate", section.certificate_digest)]
        graph = row.certificate.removesuffix(f"-{row.r}-robust.cert") + ".graph"
        words = f"python -I -m certificates verify {quote(graph)} {quote(row.certificate)} --expect robust -r {row.r}"
        command = f"<p>To verify it without the solver: <code>{escape(words)}</code></p>"
    listed = "".join(f"<dt>{escape(name)}</dt><dd><code>{escape(text)}</code></dd>" for name, text in rows)
    return f"<h3>Evidence</h3><dl>{listed}</dl>{command}"
