"""The front: ``report``, one self-contained page about many networks."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from robustness.digraph import GraphLike
from robustness.errors import InvalidParameter
from robustness.figures.saving import new_figure
from robustness.files import ReadingOptions
from robustness.files.writing import replace_file
from robustness.reporting import page
from robustness.reporting.section import Section, section_of
from robustness.spelled import counted
from robustness.surveying import Gate, Row, Survey, survey
from robustness.surveying.row import Findings
from robustness.told import Told

__all__ = ["Kept", "Report", "report", "report_of", "require_drawing"]


@dataclass(frozen=True, slots=True, repr=False)
class Report(Told):
    """A page about many networks.

    Attributes
    ----------
    survey : Survey
        The rows that the page shows.
    html : str
        The page: everything is in it, and it asks the network for nothing.
    """

    survey: Survey
    html: str

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the page to a file, whole or not at all."""
        replace_file(path, self.html.encode("utf-8"))

    def as_dict(self) -> dict[str, Any]:
        """Return what the page shows as rows, as JSON-ready values."""
        return self.survey.as_dict()

    def summary(self) -> str:
        """Return the rows of the page as a table in text."""
        return self.survey.summary()

    def __repr__(self) -> str:
        networks = counted(len(self.survey), "network")
        return f"<Report: {networks}, {self.survey.worst}, {len(self.html):,} characters>"

    def _repr_html_(self) -> str:
        return self.survey._repr_html_()


def report(
    graphs: Iterable[Any] | Mapping[str, GraphLike],
    *,
    title: str = "Robustness report",
    models: Iterable[str] | None = None,
    gate: Gate | None = None,
    pictures: bool = True,
    mending: float = 5.0,
    time_limit: float | None = None,
    total_time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    state: str | os.PathLike[str] | None = None,
    certificates: str | os.PathLike[str] | None = None,
    on_row: Callable[[Row, int, int], None] | None = None,
    reading: ReadingOptions | None = None,
) -> Report:
    """Return one self-contained HTML page about many networks: verdicts in words, a table to sort, and one part each.

    The part of a network has its picture with the weakest pair, what it survives under each threat model, the attack
    on the smallest f that is refuted as a film, and the digests to verify certificates by.

    Parameters
    ----------
    graphs, models, gate, time_limit, total_time_limit, jobs, seed, certificates, on_row, reading
        As for :func:`robustness.survey`.
    state : path, optional
        A journal, as for :func:`robustness.survey`, which keeps pictures, attacks and links as well as rows.
    title : str
        The heading of the page.
    pictures : bool
        Whether networks are drawn (those of up to 80 nodes) and attacks are played.
    mending : float
        Seconds for each network to find links that give it what ``gate`` asks and it lacks (without a gate, one more
        r); 0 proposes nothing.

    Returns
    -------
    Report

    Raises
    ------
    MissingExtra
        When pictures are asked for and matplotlib is not installed.
    InvalidParameter, UnreadableTopology
        As :func:`robustness.survey` does.

    See Also
    --------
    robustness.survey : the rows as data

    >>> import networkx as nx
    >>> made = report({"wheel": nx.wheel_graph(5)}, models=["malicious"], pictures=False)
    >>> made.survey.rows[0].r, "survives 1 malicious node" in made.html
    (2, True)
    """
    require_drawing(pictures)
    kept = Kept(pictures)
    found = survey(
        graphs,
        models=models,
        gate=gate,
        time_limit=time_limit,
        total_time_limit=total_time_limit,
        jobs=jobs,
        seed=seed,
        mending=mending,
        state=state,
        certificates=certificates,
        on_row=on_row,
        on_findings=kept.add,
        on_kept=kept.take,
        reading=reading,
    )
    return report_of(found, kept.sections, title=title, gate=gate)


def report_of(
    found: Survey, sections: Mapping[str, Section], *, title: str = "Robustness report", gate: Gate | None = None
) -> Report:
    """Return the page about a survey that is there already.

    Parameters
    ----------
    found : Survey
        Its rows are shown.
    sections : mapping from name to Section
        What is shown beside them. A row without a section is shown by its facts alone.
    title, gate
        As for :func:`report`.
    """
    if not isinstance(title, str):
        raise InvalidParameter(f"title is text, not {title!r}")
    return Report(found, page.html(title, found, gate or Gate(), sections))


class Kept:
    """What a page shows of each network beside its row, collected while the survey runs.

    Parameters
    ----------
    pictures : bool
        Whether networks are drawn and attacks are played.
    """

    def __init__(self, pictures: bool) -> None:
        self.sections: dict[str, Section] = {}
        self._pictures = pictures
        self._drawing = threading.Lock()  # matplotlib draws one picture at a time

    def add(self, findings: Findings) -> dict[str, Any]:
        """Keep what is shown of one network, and return it for a journal."""
        with self._drawing:
            section = section_of(findings, with_pictures=self._pictures)
        self.sections[findings.row.network] = section
        return section.as_dict()

    def take(self, row: Row, shown: Any) -> bool:
        """Keep what a journal holds of one network; False where that is no part of a page, or one without pictures."""
        if shown is None or (self._pictures and not shown["with_pictures"]):
            return False
        section = Section.of_dict(shown)
        self.sections[row.network] = section if self._pictures else section.without_pictures()
        return True


def require_drawing(pictures: bool) -> None:
    """Say what is missing before the work is done."""
    if pictures:
        new_figure(1, 1)
