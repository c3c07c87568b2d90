"""The sentences of a page: what somebody reads who will not look at a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from robustness.spelled import counted, counted_links, plural, robust
from robustness.surveying import Gate, Row, Survey
from robustness.threat_models import THREAT_MODELS

__all__ = ["headline", "in_models", "in_words", "reason"]


def headline(survey: Survey, gate: Gate) -> str:
    """Return the verdict about all networks in a sentence or two."""
    total = len(survey.rows) + len(survey.missing)
    if not total:
        return "No network was asked about."
    if gate.r is None and gate.survive is None:
        return _without_gate(survey, total)
    standing = Counter(row.gate for row in survey.rows)
    standing["missing"] = len(survey.missing)
    if total == 1:
        return _about_one(next(name for name, count in standing.items() if count), gate, survey.models)
    passed = standing["passed"]
    wanted = _wish(gate, survey.models, "is" if passed == 1 else "are")
    if passed == total:
        return f"{'Both' if total == 2 else f'All {total}'} networks {wanted}."
    tails = {
        "refuted": ("fails, with a counterexample", "fail, each with a counterexample"),
        "undecided": (
            "was not decided within the limit: nothing is claimed about it",
            "were not decided within the limit: nothing is claimed about them",
        ),
        "missing": ("was not reached: nothing is claimed about it", "were not reached: nothing is claimed about them"),
        "error": ("could not be read", "could not be read"),
    }
    rest = "; ".join(f"{standing[name]} {tail[standing[name] != 1]}" for name, tail in tails.items() if standing[name])
    if not passed and standing["refuted"] < total:  # "none of them is" would claim something of the others, too
        return f"Of {counted(total, 'network')} none was shown to {_wish(gate, survey.models, 'be')}; {rest}."
    return f"{passed or 'None'} of {counted(total, 'network')} {wanted}; {rest}."


def _about_one(standing: str, gate: Gate, models: Sequence[str]) -> str:
    if standing == "passed":
        return f"The network {_wish(gate, models, 'is')}."
    told = {
        "refuted": "it fails, with a counterexample",
        "undecided": "that was not decided within the limit: nothing is claimed",
        "missing": "it was not reached: nothing is claimed",
        "error": "it could not be read",
    }
    return f"The network must {_wish(gate, models, 'be')}; {told[standing]}."


def _wish(gate: Gate, models: Sequence[str], be: str) -> str:
    """Return what a gate asks, with the form of "to be" that tells the number: is, are, or be after an auxiliary."""
    wishes = []
    if gate.r is not None:
        wishes.append(f"{be} {robust(gate.r, gate.s)}")
    if gate.survive is not None:
        wishes.append(
            f"survive{'s' if be == 'is' else ''} {counted(gate.survive, 'malicious node')} under {in_models(models)}"
        )
    return " and ".join(wishes)


def in_models(models: Sequence[str]) -> str:
    """Return threat models in words; all of them are not listed.

    >>> in_models(["malicious"]), in_models(["malicious", "delayed"]), in_models(list(THREAT_MODELS))
    ('the threat model malicious', 'the threat models malicious and delayed', 'every threat model')
    """
    if set(models) >= set(THREAT_MODELS):
        return "every threat model"
    *first, last = models
    return f"the threat models {', '.join(first)} and {last}" if first else f"the threat model {last}"


def _without_gate(survey: Survey, total: int) -> str:
    read = [row for row in survey.rows if not row.error]
    if not read:
        return f"Nothing is known about {counted(total, 'network')}: none was reached, or could be read."
    unread, missing = len(survey.rows) - len(read), len(survey.missing)
    rest = f" {unread} could not be read." if unread else ""
    rest += f" {counted(missing, 'was', 'were')} not reached." if missing else ""
    if not survey.models:
        told = counted(len(read), "network was", "networks were")
        return f"{told} looked at; nothing was required of {'it' if len(read) == 1 else 'them'}.{rest}"
    standing = Counter(map(_survives_one, read))
    under = in_models(survey.models)
    if len(read) == 1:
        which = "the network" if total == 1 else "the one network that was read"
        verdicts = {
            True: f"{which.capitalize()} survives 1 malicious node under {under}.",
            False: f"{which.capitalize()} does not survive 1 malicious node under {under}.",
            None: f"Whether {which} survives 1 malicious node under {under} was not decided within the limit.",
        }
        return f"{verdicts[_survives_one(read[0])]} Nothing was required of it.{rest}"
    survivors, unknown = standing[True], standing[None]
    survive = plural(survivors, "survives", "survive")
    open_ = f"; {counted(unknown, 'was', 'were')} not decided within the limit" if unknown else ""
    if unknown and not survivors:
        shown = f"Of {counted(len(read), 'network')} none was shown to survive 1 malicious node under {under}{open_}."
        return f"{shown} Nothing was required of them.{rest}"
    return (
        f"{survivors or 'None'} of {counted(len(read), 'network')} {survive} 1 malicious node under {under}{open_}. "
        f"Nothing was required of them.{rest}"
    )


def _survives_one(row: Row) -> bool | None:
    """Return whether a network survives one malicious node under every model; None where that was not decided."""
    if (row.nodes or 0) < 2 or min(row.guaranteed.values()) >= 1:
        return True
    return False if any(f is not None and f <= 1 for f in row.refuted.values()) else None


def in_words(row: Row, models: Sequence[str]) -> str:
    """Return what is known about one network in a few sentences."""
    if row.error:
        return f"It could not be read: {reason(row)}"
    kind = "directed " if row.directed else ""
    links = counted_links(row.arcs or 0, bool(row.directed))
    sentences = [f"A {kind}network of {counted(row.nodes or 0, 'node')} and {links}.", _robustness(row)]
    sentences.append(_tolerance(row, models))
    if row.gate:
        sentences.append(
            {
                "passed": "It has what is required.",
                "refuted": "It does not have what is required.",
                "undecided": "Whether it has what is required was not decided within the limit.",
            }.get(row.gate, "")
        )
    return " ".join(filter(None, sentences))


def reason(row: Row) -> str:
    """Return why a row has no facts, without its own name before it."""
    return row.error.removeprefix(f"{row.network}: ")


def _tolerance(row: Row, models: Sequence[str]) -> str:
    guaranteed = {model: row.guaranteed[model] for model in models if model in row.guaranteed}
    if not guaranteed:
        return ""
    if (row.nodes or 0) < 2:
        return "Fewer than two nodes cannot disagree."
    low, high = min(guaranteed.values()), max(guaranteed.values())
    is_decided = all(row.refuted.get(model) == f + 1 for model, f in guaranteed.items())
    if high < 0:
        return "It does not even agree when nobody lies." if is_decided else "That it agrees at all was not proven."
    promised = (
        counted(low, "malicious node")
        if low == high
        else f"{max(low, 0)} to {counted(high, 'malicious node')}, depending on the model"
    )
    if is_decided:
        return f"It survives {promised}." if high else "It survives no malicious node."
    return f"It survives at least {promised}; how many more is not known."


def _robustness(row: Row) -> str:
    if row.r != row.r_at_most:
        return f"Its greatest r is between {row.r} and {row.r_at_most}: a limit came before the rest."
    s = f"{row.s}" if row.s == row.s_at_most else f"between {row.s} and {row.s_at_most}"
    return f"The greatest r for which it is r-robust is {row.r}; the greatest s with it is {s}."
