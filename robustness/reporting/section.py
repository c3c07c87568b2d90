"""What a page shows of one network: a picture, the models' sentences, and an attack to play."""

from __future__ import annotations

import io
import warnings
from base64 import b64encode
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import Any, Self

from robustness.digraph import Digraph
from robustness.figures.network import draw
from robustness.figures.saving import new_figure
from robustness.natural_order import in_natural_order
from robustness.reporting.proposal import in_sentences
from robustness.simulation.attacks import Attack
from robustness.spelled import counted
from robustness.surveying.row import Findings
from robustness.threat_models import ToleranceTable
from robustness.threat_models.results import largest_survived, number, sentences_of

__all__ = ["Film", "Section", "section_of"]

#: Larger networks are not drawn: a picture of them says little and takes long.
_LARGEST = 80

#: How many steps of an attack are played. What is held apart does not move at all, so a short film says it.
_STEPS = 40


@dataclass(frozen=True, slots=True)
class Film:
    """An attack, step by step.

    Attributes
    ----------
    story : str
        The attack in words.
    claim : str
        What is shown, for the heading.
    lines : tuple of dict
        For each node its name, the ``group`` it belongs to (``"S1"``, ``"S2"``, ``"M"`` or ``"rest"``) and its
        ``values``, one for each step.
    """

    story: str
    claim: str
    lines: tuple[dict[str, Any], ...]


@dataclass(frozen=True, slots=True)
class Section:
    """What is shown of one network beside its row.

    Attributes
    ----------
    picture : bytes
        An SVG document, or nothing.
    models : tuple of (str, str, str, str)
        Each threat model, what it is in words, the largest f that is survived and the smallest that is not.
    told : tuple of str
        What is known under the models, in sentences.
    film : Film or None
    mending : tuple of str
        What links would mend it, a sentence and the links; empty when nothing is proposed.
    certificate_digest : str
        SHA-256 of the certificate's file, empty when none was written.
    with_pictures : bool
        Whether a picture and an attack were asked for.
    """

    picture: bytes = b""
    models: tuple[tuple[str, str, str, str], ...] = ()
    told: tuple[str, ...] = ()
    film: Film | None = None
    certificate_digest: str = field(default="")
    mending: tuple[str, ...] = ()
    with_pictures: bool = False

    def as_dict(self) -> dict[str, Any]:
        """Return everything as JSON-ready values."""
        return asdict(self) | {"picture": self.picture.decode()}

    @classmethod
    def of_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the section that :meth:`as_dict` wrote."""
        film = content["film"]
        return cls(
            content["picture"].encode(),
            tuple((name, where, survived, refuted) for name, where, survived, refuted in content["models"]),
            tuple(content["told"]),
            None if film is None else Film(film["story"], film["claim"], tuple(film["lines"])),
            content["certificate_digest"],
            tuple(content["mending"]),
            content["with_pictures"],
        )

    def without_pictures(self) -> Section:
        """Return the section as it is where neither pictures nor attacks are asked for."""
        return replace(self, picture=b"", film=None, with_pictures=False)


def section_of(findings: Findings, *, with_pictures: bool) -> Section:
    """Return what is shown of a network.

    Parameters
    ----------
    findings : Findings
        What its row was made from.
    with_pictures : bool
        Whether it is drawn, and an attack played, when it has at most 80 nodes.
    """
    row, graph = findings.row, findings.graph
    digest = sha256(Path(row.certificate).read_bytes()).hexdigest() if row.certificate else ""
    mending = () if findings.mended is None else tuple(in_sentences(findings.mended))
    models = tuple(
        (result.model, result.threat.where, largest_survived(result), number(result.refuted))
        for result in findings.table.results
    )
    told = tuple(sentences_of(findings.table)) if models else ()
    section = Section(b"", models, told, None, digest, mending, with_pictures)
    if not with_pictures or not 1 <= graph.n <= _LARGEST:
        return section
    return replace(section, picture=_picture(graph, row.weakest), film=_film(findings.table))


def _size(nodes: int) -> tuple[float, float]:
    """Return the size of a picture in inches: a page is about ten wide, and few nodes need less."""
    return (7.2, 4.8) if nodes <= 30 else (9.6, 6.4)


def _picture(graph: Digraph, weakest: Mapping[str, Any] | None) -> bytes:
    """Return the network as SVG, the weakest pair marked, where the file places its nodes if it does."""
    from matplotlib import rc_context

    pair = None if weakest is None else (weakest["S1"], weakest["S2"])
    figure = new_figure(*_size(graph.n))
    axes = figure.subplots()
    draw(graph, pair, ax=axes)
    if axes.get_aspect() == 1:  # a layout of ours, that often is flat: no empty ground below it
        low, high = axes.dataLim.min, axes.dataLim.max
        share = (high[1] - low[1]) / ((high[0] - low[0]) or 1.0)
        figure.set_figheight(min(figure.get_figheight(), max(2.2, 0.9 + share * 0.75 * figure.get_figwidth())))
    stream = io.BytesIO()
    with (
        warnings.catch_warnings(),
        rc_context({"svg.hashsalt": "robustness", "svg.fonttype": "none", "font.family": "sans-serif"}),
    ):
        # The letters stay text that the reader's own fonts show.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font", category=UserWarning)
        figure.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()


def _film(table: ToleranceTable) -> Film | None:
    """Return the attack with the fewest liars, played; None when none is known."""
    attacks = [(result.attack, result.model) for result in table.results]
    known = [(attack.f, k) for k, (attack, _) in enumerate(attacks) if attack is not None]
    if not known:
        return None
    attack, model = attacks[min(known)[1]]
    return None if attack is None else _played(attack, model)


def _played(attack: Attack, model: str) -> Film:
    outcome = attack.run(_STEPS, record=True)
    trajectory = outcome.trajectory
    values = [] if trajectory is None else trajectory.p.T.tolist()
    groups = {"M": attack.malicious, "S1": attack.S1, "S2": attack.S2}
    by_label = dict(zip(attack.graph.labels, values, strict=True))
    lines = tuple(
        {
            "name": str(label),
            "group": next((name for name, members in groups.items() if label in members), "rest"),
            "values": [round(value, 3) for value in by_label[label]],
        }
        for label in in_natural_order(by_label)
    )
    count = len(attack.malicious)
    liars = f"with {counted(count, 'malicious node')}" if count else "without a single malicious node"
    return Film(attack.story(), f"f = {attack.f} under the model {model}, {liars}", lines)


def as_data_address(picture: bytes) -> str:
    """Return an SVG document as an address that an ``img`` takes; scripts in an image never run."""
    return "data:image/svg+xml;base64," + b64encode(picture).decode("ascii")
