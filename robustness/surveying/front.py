"""The front: ``survey``, one row for each of many networks."""

from __future__ import annotations

import html
import importlib
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from robustness.cubes.executors import require_executor
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter, MissingExtra, RobustnessError
from robustness.files import ReadingOptions
from robustness.files.front import read_with
from robustness.spelled import counted
from robustness.surveying import tables
from robustness.surveying.mended import seconds_for_mending, with_links
from robustness.surveying.networks import expand, note_of_twice
from robustness.surveying.row import NOT_REACHED, STANDINGS, Findings, Gate, Question, Row, measure, unreadable
from robustness.surveying.state import Journal, key_of
from robustness.threat_models import THREAT_MODELS
from robustness.threat_models.models import threat_model_named
from robustness.told import Told
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["Survey", "survey"]


@dataclass(frozen=True, slots=True, repr=False)
class Survey(Told):
    """The rows of a survey, in the order of its networks.

    Attributes
    ----------
    rows : tuple of Row
    models : tuple of str
        The threat models that were looked at.
    notes : tuple of str
        What was passed over on the way, one line each.
    missing : tuple of str
        Networks that the time limit for the whole, or Ctrl-C, left unasked. Nothing is claimed about them.
    """

    rows: tuple[Row, ...]
    models: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    missing: tuple[str, ...] = field(default=())

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def worst(self) -> str:
        """The worst of all gates: ``"passed"``, ``"undecided"``, ``"refuted"`` or ``"error"``.

        A network that could not be read counts as an error, and one that was not reached as undecided, gates or none.
        """
        standings = [row.gate or ("error" if row.error else "passed") for row in self.rows]
        standings += ["undecided"] * len(self.missing)
        return max(standings, key=STANDINGS.index, default="passed")

    @property
    def listed(self) -> tuple[Row, ...]:
        """The rows, and after them one for each network that was not reached, which says so: what tables show."""
        standing = "undecided" if any(row.gate for row in self.rows) else ""
        return self.rows + tuple(Row(name, gate=standing, error=NOT_REACHED) for name in self.missing)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as JSON-ready values."""
        return {
            "rows": [row.as_dict() for row in self.rows],
            "models": list(self.models),
            "notes": list(self.notes),
            "missing": list(self.missing),
            "worst": self.worst,
        }

    def to_frame(self) -> Any:
        """Return the rows as a pandas DataFrame, one column for each fact, with a row for each network in ``missing``.

        Raises
        ------
        MissingExtra
            When pandas is not installed.
        """
        try:
            pandas = importlib.import_module("pandas")
        except ImportError:
            raise MissingExtra("to_frame needs the package pandas: install it with: pip install pandas") from None
        columns = list(tables.flat(Row(""), self.models))
        return pandas.DataFrame([tables.flat(row, self.models) for row in self.listed], columns=columns)

    def summary(self) -> str:
        """Return the rows as a table in text."""
        return tables.text(self.listed, self.models)

    def __repr__(self) -> str:
        nothing_asked = self.worst == "passed" and not any(row.gate for row in self.rows)
        return f"<Survey: {counted(len(self.rows), 'network')}{'' if nothing_asked else f', {self.worst}'}>"

    def _repr_html_(self) -> str:
        head, *body = tables.cells(self.listed, self.models)
        rows = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in body)
        names = "".join(f"<th>{html.escape(cell)}</th>" for cell in head)
        return f"<table><thead><tr>{names}</tr></thead><tbody>{rows}</tbody></table>"


@taking_numpy_integers
def survey(
    graphs: Iterable[Any] | Mapping[str, GraphLike],
    *,
    models: Iterable[str] | None = None,
    gate: Gate | None = None,
    time_limit: float | None = None,
    total_time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    mending: float = 0.0,
    state: str | os.PathLike[str] | None = None,
    certificates: str | os.PathLike[str] | None = None,
    on_row: Callable[[Row, int, int], None] | None = None,
    on_findings: Callable[[Findings], Any] | None = None,
    on_kept: Callable[[Row, Any], bool] | None = None,
    reading: ReadingOptions | None = None,
    executor: Any = None,
) -> Survey:
    """Return one row of facts for each of many networks: its size, r*, s, what f it survives, and what a gate says.

    Parameters
    ----------
    graphs : iterable or mapping
        Graphs as everywhere; paths, folders, patterns and ``topohub:GROUP/*`` as text, which
        :func:`robustness.surveying.networks.expand` explains; ``(name, graph)`` pairs; or a mapping from name to graph.
        A graph with a name may be a path too. A source that is named twice is surveyed once.
    models : iterable of str, optional
        Threat models to look at, names in ``THREAT_MODELS``; all unless given.
    gate : Gate, optional
        What every network has to fulfil.
    time_limit, total_time_limit : float, optional
        Wall-clock seconds for one network and for all. What they leave undecided says so.
    jobs : int
        Networks at once, one thread each.
    seed : int
        Of the heuristics; it never changes a verdict.
    mending : float
        Seconds for each network of up to 80 nodes to find the fewest further links that give it what the gate asks and
        it lacks (without a gate, one more r): ``links`` and ``links_at_least`` of its row. 0: not asked.
    state : path, optional
        A journal. Rows that it holds are not computed again, so a survey that was killed goes on where it was.
    certificates : path, optional
        A folder for a certificate of r* of every network and the canonical graph that it is bound to.
    on_row : callable, optional
        Called with each finished row, how many are finished, and how many there are.
    on_findings : callable, optional
        Called with each row and the answers it was made from, in the thread that found them; not for rows of errors,
        nor for those that a journal holds. What it returns, JSON-ready, is kept beside the row in the journal.
    on_kept : callable, optional
        Called with each row that the journal holds and what ``on_findings`` returned for it (None when it did not run).
        Whether that will do; otherwise the network is asked about anew.
    reading : ReadingOptions, optional
        How files are to be read, as for :func:`robustness.read_topology`.
    executor : concurrent.futures.Executor, distributed.Client or robustness.cubes.CubeExecutor, optional
        Who solves the cubes of the exact searches for r* and s, as for :func:`robustness.check_rs_robustness`.

    Returns
    -------
    Survey
        A network that cannot be read has a row that says why; the others are not held up.

    Raises
    ------
    InvalidParameter
        For an unknown model, numbers out of range, one graph in place of many, and two graphs of one name.
    UnreadableTopology
        For a folder or pattern that holds no network, and a damaged journal.

    See Also
    --------
    robustness.report : the same as a page
    robustness.determine_robustness : one network

    >>> import networkx as nx
    >>> rows = survey({"wheel": nx.wheel_graph(5), "complete": nx.complete_graph(7)}, models=["delayed"])
    >>> [(row.network, row.r, row.guaranteed["delayed"]) for row in rows]
    [('wheel', 2, 0), ('complete', 4, 2)]
    """
    if type(jobs) is not int or jobs < 1:
        raise InvalidParameter(f"jobs is an integer of at least 1, not {jobs!r}")
    require_executor(executor)
    names = tuple(THREAT_MODELS) if models is None else tuple(threat_model_named(name).name for name in models)
    question = Question(names, gate or Gate(), time_limit, seed, seconds_for_mending(mending))
    networks, notes = _named(graphs)
    folder = None if certificates is None else Path(certificates)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    with Journal(None if state is None else Path(state)) as journal:

        def row_of(name: str, graph: Any, left: float | None) -> tuple[str | None, Row, Any]:
            asked = _within(question, left)
            return _row(name, graph, asked, question, journal, folder, on_findings, on_kept, reading, executor)

        rows = _run(networks, row_of, journal, jobs, total_time_limit, on_row)
    missing = tuple(name for (name, _), row in zip(networks, rows, strict=True) if row is None)
    return Survey(tuple(row for row in rows if row is not None), names, notes, missing)


def _named(graphs: Iterable[Any] | Mapping[str, GraphLike]) -> tuple[list[tuple[str, Any]], tuple[str, ...]]:
    """Return the name and the graph of each network, its source where that is yet to be read, and notes."""
    if isinstance(graphs, str | os.PathLike):
        graphs = [graphs]
    if isinstance(graphs, Mapping):
        graphs = [(str(name), graph) for name, graph in graphs.items()]
    elif hasattr(graphs, "is_multigraph") or not hasattr(graphs, "__iter__"):
        raise InvalidParameter(
            f"a survey is about many networks, not {type(graphs).__name__}: give a list of graphs, or a dict from "
            "their names to them"
        )
    networks: dict[str, Any] = {}
    notes: list[str] = []
    for number, each in enumerate(graphs):
        if isinstance(each, str | os.PathLike):
            found = expand([each])
            notes += found.notes
            notes += [note_of_twice(name) for name in found.names if name in networks]
            networks |= {name: name for name in found.names}
            continue
        is_pair = isinstance(each, tuple) and len(each) == 2 and isinstance(each[0], str)
        name, graph = each if is_pair else (str(number), each)
        if name in networks:
            raise InvalidParameter(f"two networks are named {name!r}: give each a name of its own")
        networks[name] = graph
    return list(networks.items()), tuple(notes)


def _run(
    networks: list[tuple[str, Any]],
    row_of: Callable[[str, Any, float | None], tuple[str | None, Row, Any]],
    journal: Journal,
    jobs: int,
    total: float | None,
    on_row: Callable[[Row, int, int], None] | None,
) -> list[Row | None]:
    rows: list[Row | None] = [None] * len(networks)
    ends = None if total is None else time.monotonic() + total
    finished = 0
    pool = ThreadPoolExecutor(jobs, thread_name_prefix="survey")
    try:
        waiting: dict[Future[tuple[str | None, Row, Any]], int] = {}
        pending = iter(enumerate(networks))
        while True:
            while len(waiting) < jobs and (item := next(pending, None)) is not None:
                k, (name, graph) = item
                left = None if ends is None else ends - time.monotonic()
                if left is not None and left <= 0:
                    break
                waiting[pool.submit(row_of, name, graph, left)] = k
            if not waiting:
                return rows
            for future in wait(waiting, return_when=FIRST_COMPLETED).done:
                key, row, shown = future.result()
                rows[waiting.pop(future)] = row
                finished += 1
                # In this order: whoever finds a row in the journal can rely on its having been told.
                if on_row is not None:
                    on_row(row, finished, len(networks))
                if key is not None:
                    journal.add(key, row, shown)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _within(question: Question, left: float | None) -> Question:
    """Return the question with the time limit that the whole survey leaves for one network."""
    if left is None:
        return question
    seconds = left if question.time_limit is None else min(left, question.time_limit)
    return replace(question, time_limit=seconds, mending=min(left, question.mending))


def _row(
    name: str,
    graph: Any,
    question: Question,
    asked: Question,
    journal: Journal,
    folder: Path | None,
    on_findings: Callable[[Findings], Any] | None,
    on_kept: Callable[[Row, Any], bool] | None,
    reading: ReadingOptions | None,
    executor: Any,
) -> tuple[str | None, Row, Any]:
    """Return the row of one network, its key in the journal when it is to be remembered, and what goes with it."""
    try:
        is_source = isinstance(graph, str | os.PathLike)
        read: Digraph = read_with(graph, reading or ReadingOptions()) if is_source else as_digraph(graph)
    except (RobustnessError, OSError) as problem:
        return None, unreadable(name, problem, question.gate), None
    key = key_of(name, read, asked)
    known, kept = journal.get(key)
    has_files = known is None or folder is None or not known.certificate or Path(known.certificate).is_file()
    if known is not None and has_files and (on_kept is None or on_kept(known, kept)):
        return None, known, None
    found = measure(name, read, question, folder, executor)
    if isinstance(found, Findings) and question.mending:
        found = with_links(found, question.gate, question.mending, question.seed)
    row = found.row if isinstance(found, Findings) else found
    shown = on_findings(found) if isinstance(found, Findings) and on_findings is not None else None
    # A row that the limit for the whole cut short is not what a run with more time would say.
    is_mended = not asked.mending or (row.links is not None and row.links == row.links_at_least)
    was_cut = question != asked and not (row.is_decided and is_mended)
    return None if row.error or was_cut else key, row, shown
