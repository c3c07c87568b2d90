"""The front: ``report``, one self-contained page about many networks."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from robustness.digraph import GraphLike
from robustness.errors import InvalidParameter
from robustness.figures.saving import new_figure
from robustness.files.writing import replace_file
from robustness.mending import MendResult
from robustness.reporting import page
from robustness.reporting.section import section_of
from robustness.spelled import counted
from robustness.surveying import Gate, Row, Survey, survey
from robustness.surveying.mended import mended_for, seconds_for_mending
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
    certificates: str | os.PathLike[str] | None = None,
    on_row: Callable[[Row, int, int], None] | None = None,
) -> Report:
    """Return one self-contained HTML page about many networks: verdicts in words, a table to sort, and one part each.

    The part of a network has its picture with the weakest pair, what it survives under each threat model, the attack
    on the smallest f that is refuted as a film, and the digests to verify certificates by.

    Parameters
    ----------
    graphs, models, gate, time_limit, total_time_limit, jobs, seed, certificates, on_row
        As for :func:`robustness.survey`.
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
    kept = Kept(gate or Gate(), mending)
    require_drawing(pictures)
    found = survey(
        graphs,
        models=models,
        gate=gate,
        time_limit=time_limit,
        total_time_limit=total_time_limit,
        jobs=jobs,
        seed=seed,
        certificates=certificates,
        on_row=on_row,
        on_findings=kept.add,
    )
    return report_of(found, kept.findings, kept.proposals, title=title, gate=gate, pictures=pictures)


def report_of(
    found: Survey,
    findings: Iterable[Findings],
    proposals: Mapping[str, MendResult] = MappingProxyType({}),
    *,
    title: str = "Robustness report",
    gate: Gate | None = None,
    pictures: bool = True,
) -> Report:
    """Return the page about a survey that is there already.

    Parameters
    ----------
    found : Survey
        Its rows are shown.
    findings : iterable of Findings
        What ``survey(..., on_findings=...)`` handed out. A row without findings is shown without a picture.
    proposals : mapping from name to MendResult
        The links to propose.
    title, gate, pictures
        As for :func:`report`.
    """
    if not isinstance(title, str):
        raise InvalidParameter(f"title is text, not {title!r}")
    require_drawing(pictures)
    sections = {
        each.row.network: section_of(each, with_pictures=pictures, mended=proposals.get(each.row.network))
        for each in findings
    }
    return Report(found, page.html(title, found, gate or Gate(), sections))


class Kept:
    """What a page needs of each network beside its row, collected while the survey runs.

    Parameters
    ----------
    gate : Gate
    seconds : float
        For the links to propose for one network; 0: none.
    """

    def __init__(self, gate: Gate, seconds: float) -> None:
        self.findings: list[Findings] = []
        self.proposals: dict[str, MendResult] = {}
        self._gate, self._seconds = gate, seconds_for_mending(seconds)

    def add(self, findings: Findings) -> None:
        """Keep what was found out about one network, and look for links that mend it."""
        if self._seconds:
            found = mended_for(findings.graph, findings.row, self._gate, self._seconds)
            if found is not None:
                self.proposals[findings.row.network] = found
        self.findings.append(findings)


def require_drawing(pictures: bool) -> None:
    """Say what is missing before the work is done."""
    if pictures:
        new_figure(1, 1)
