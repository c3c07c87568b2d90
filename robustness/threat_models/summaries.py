"""Results in plain words. No sentence here claims more than the theorem that its result carries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from robustness.threat_models.models import THREAT_MODELS

if TYPE_CHECKING:
    from robustness.threat_models.results import ToleranceResult, ToleranceTable

__all__ = ["number", "sentences_of", "summary", "table_summary"]


def number(f: int | None) -> str:
    """Return an f as people write it: ``none`` for -1 and None."""
    return "none" if f is None or f < 0 else str(f)


def summary(result: ToleranceResult) -> str:
    """Return one model's result in a sentence, and what it rests on."""
    where = result.threat.where
    told = f"{where[0].upper()}{where[1:]}: {_outcome(result)}."
    return " ".join([told, *_scope([result] if result.graph.n >= 2 else [])])


def _outcome(result: ToleranceResult) -> str:
    """Return what is known under one model, without saying which."""
    if result.graph.n < 2:
        return "fewer than two nodes cannot disagree"
    parts = [_promised(result), _refuted(result)]
    standings = {f: result.standing(f).value for f in result.between}
    late = [str(f) for f, standing in standings.items() if standing == "undecided"]
    unsaid = [str(f) for f, standing in standings.items() if standing == "open"]
    if late:
        parts.append(f"f = {', '.join(late)} {'was' if len(late) == 1 else 'were'} not decided within the limit")
    if unsaid:
        why = next(reason.evidence for reason in result.reasons if reason.standing.value == "open")
        parts.append(f"f = {', '.join(unsaid)} {'is' if len(unsaid) == 1 else 'are'} open: {why}")
    return "; ".join(part for part in parts if part)


def table_summary(table: ToleranceTable) -> str:
    """Return the whole table as one paragraph."""
    graph = table.graph
    size = f"A network of {graph.n} {'node' if graph.n == 1 else 'nodes'} and {graph.arc_count} arcs."
    return " ".join([size, *sentences_of(table)])


def sentences_of(table: ToleranceTable) -> list[str]:
    """Return a sentence for each outcome, which models with one and the same share, and what the promises rest on."""
    if table.graph.n < 2:
        return ["Fewer than two nodes cannot disagree, whatever the threat."]
    sentences: dict[str, list[str]] = {}
    for result in table.results:
        sentences.setdefault(_outcome(result), []).append(result.threat.where)
    told = [f"{'; and '.join(where)}: {outcome}." for outcome, where in sentences.items()]
    if len(sentences) == 1 and len(table) == len(THREAT_MODELS):
        told = [f"under every threat model: {next(iter(sentences))}."]
    return [*(sentence[0].upper() + sentence[1:] for sentence in told), *_scope(table.results)]


def _scope(results: Sequence[ToleranceResult]) -> Iterator[str]:
    """Yield what the promises rest on."""
    given = results[0].parameters if results else None
    if given is not None:
        yield f"For {given.told([result.threat for result in results])}."
    elif any(result.guaranteed >= 0 for result in results):
        yield "What is guaranteed holds for the update rules, weights and gains that its theorem names."
    sequence = results[0].sequence if results else None
    if sequence is not None and sequence.period is None:
        yield "A finite trace is taken to go on as it was: no new link, and every window as good as those seen."


def _promised(result: ToleranceResult) -> str:
    f = result.guaranteed
    if f < 0:
        if result.refuted == 0:
            return ""
        is_open = result.standing(0).value == "open"
        return "nothing is guaranteed" if is_open else "nothing is guaranteed within the limit"
    if f == 0:
        return "agreement is guaranteed only while nobody lies (f = 0)"
    return f"agreement is guaranteed for f = {f}" + (" and below" if f > 1 else "")


def _refuted(result: ToleranceResult) -> str:
    f, sets = result.refuted, result.attack_sets
    if f is None or sets is None:
        return "no attack is known within the limit"
    if f == 0:
        return "agreement fails even though nobody lies: two groups hear nothing from outside"
    if not sets.M:
        return f"for f = {f} it stays split for ever without a single liar, since everybody discards too much"
    return f"for f = {f} an attack by {len(sets.M)} {'liar' if len(sets.M) == 1 else 'liars'} keeps it split for ever"
