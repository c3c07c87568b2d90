"""The sentences of a page: what somebody reads who will not look at a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from robustness.surveying import Gate, Row, Survey

__all__ = ["headline", "in_words"]


def headline(survey: Survey, gate: Gate) -> str:
    """Return the verdict about all networks in a sentence or two."""
    total = len(survey.rows) + len(survey.missing)
    if not total:
        return "No network was asked about."
    if gate.r is None and gate.survive is None:
        return _without_gate(survey, total)
    wanted = " and ".join(_wishes(gate, survey.models))
    counted = Counter(row.gate for row in survey.rows)
    counted["undecided"] += len(survey.missing)
    if counted["passed"] == total:
        return f"All {total} networks {wanted}." if total > 1 else f"The network does: it {_third_person(wanted)}."
    tails = {
        "refuted": "do not, each with a counterexample",
        "undecided": "were not decided within the limit: nothing is claimed about them",
        "error": "could not be read",
    }
    rest = "; ".join(f"{counted[name]} {tail}" for name, tail in tails.items() if counted[name])
    return f"{counted['passed']} of {total} networks {wanted}; {rest}."


def _third_person(wanted: str) -> str:
    return wanted.replace("survive ", "survives ").replace("are ", "is ")


def _wishes(gate: Gate, models: Sequence[str]) -> list[str]:
    wishes = []
    if gate.r is not None:
        wishes.append(f"are ({gate.r},{gate.s})-robust")
    if gate.survive is not None:
        under = "every threat model" if len(models) > 1 else f"the threat model {', '.join(models)}"
        wishes.append(f"survive {_nodes(gate.survive)} under {under}")
    return wishes


def _without_gate(survey: Survey, total: int) -> str:
    read = [row for row in survey.rows if not row.error]
    rest = "" if len(read) == total else f" {total - len(read)} could not be read or were not reached."
    if not survey.models:
        return f"{len(read)} networks were decided; nothing was required of them.{rest}"
    least = [min(row.guaranteed.values()) for row in read]
    survivors = sum(f >= 1 for f in least)
    return (
        f"{survivors} of {len(read)} networks survive one malicious node under every threat model that was looked at. "
        f"Nothing was required of them.{rest}"
    )


def in_words(row: Row, models: Sequence[str]) -> str:
    """Return what is known about one network in a few sentences."""
    if row.error:
        return f"It could not be read: {row.error}"
    kind = "directed " if row.directed else ""
    links = f"{row.arcs} arcs" if row.directed else f"{(row.arcs or 0) // 2} links"
    sentences = [f"A {kind}network of {row.nodes} nodes and {links}.", _robustness(row)]
    guaranteed = [f for f in (row.guaranteed.get(model) for model in models) if f is not None]
    if guaranteed:
        low, high = min(guaranteed), max(guaranteed)
        promised = _nodes(low) if low == high else f"{max(low, 0)} to {high} malicious nodes, depending on the model"
        sentences.append("It does not even agree when nobody lies." if high < 0 else f"It survives {promised}.")
    if row.gate:
        sentences.append(
            {
                "passed": "It has what is required.",
                "refuted": "It does not have what is required.",
                "undecided": "Whether it has what is required was not decided within the limit.",
            }.get(row.gate, "")
        )
    return " ".join(filter(None, sentences))


def _robustness(row: Row) -> str:
    if row.r != row.r_at_most:
        return f"Its greatest r is between {row.r} and {row.r_at_most}: a limit came before the rest."
    s = f"{row.s}" if row.s == row.s_at_most else f"between {row.s} and {row.s_at_most}"
    return f"The greatest r for which it is r-robust is {row.r}; the greatest s with it is {s}."


def _nodes(f: int) -> str:
    return f"{f} malicious node" + "s" * (f != 1)
