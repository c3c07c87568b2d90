"""How the answer to ``mend`` and ``thin`` is waited for, told, and kept in files."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import plural

from .before_and_after import facts_of, line_of
from .exit_codes import ExitCode
from .interruption import Overrun
from .output import Console, ProgressLine, graph_document, set_text

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from robustness.limits import Limits
    from robustness.mending import BudgetResult, MendResult

    from .mending import Kept
    from .query import Query

__all__ = ["Answered", "answer", "tell"]


@dataclass(frozen=True, slots=True)
class Answered:
    """What is known when the work has ended, or was stopped by a limit or Ctrl-C.

    Attributes
    ----------
    mended : MendResult or None
        The links that were found; None where nothing is known.
    bought : BudgetResult or None
        Of what budget they are the best that it buys.
    before, after : dict or None
        The facts of both networks; without an ``after`` no choice of links is known.
    is_interrupted : bool
        Whether Ctrl-C ended it.
    """

    mended: MendResult | None
    bought: BudgetResult | None = None
    before: dict[str, Any] | None = None
    after: dict[str, Any] | None = None
    is_interrupted: bool = False

    @classmethod
    def of(cls, found: MendResult | BudgetResult) -> Answered:
        """Return what was found, without the facts."""
        from robustness.mending import BudgetResult

        return cls(found.best, found) if isinstance(found, BudgetResult) else cls(found)

    def with_facts(self, limits: Limits) -> Answered:
        """Return the answer with the facts of both networks, as far as the limits allow."""
        if self.mended is None:
            return self
        one_way = self._is_one_way
        before = facts_of(self.mended.before, limits, one_way=one_way)
        if self.mended.cost is None:
            return replace(self, before=before)
        is_same = self.mended.graph == self.mended.before
        after = before if is_same else facts_of(self.mended.graph, limits, one_way=one_way)
        return replace(self, before=before, after=after)

    @property
    def _is_one_way(self) -> bool:
        """Whether the network has, or gets, links that run one way only: then arcs are counted."""
        return self.mended is not None and (self.mended.before.directed or self.mended.graph.directed)

    @property
    def exit_code(self) -> ExitCode:
        """What the answer deserves."""
        if self.is_interrupted:
            return ExitCode.INTERRUPTED
        if self.bought is not None:
            reached = ExitCode.REFUTED if self.mended is None else ExitCode.DONE
            return reached if self.bought.is_exact else ExitCode.UNDECIDED
        verdict = "" if self.mended is None else self.mended.verdict.value
        codes = {"optimal": ExitCode.DONE, "impossible": ExitCode.REFUTED}
        return codes.get(verdict, ExitCode.UNDECIDED)

    def document(self) -> dict[str, Any]:
        """Return the answer for JSON."""
        if self.mended is None:
            return {}
        facts: dict[str, Any] = {"before": self.before, "after": self.after}
        if self.bought is not None:
            missed = None if self.bought.missed is None else self.bought.missed.goal
            facts |= {"missed": missed, "is_exact": self.bought.is_exact}
        return {"graph": graph_document(self.mended.before), **self.mended.as_dict(), **facts}

    def lines(self) -> list[str]:
        """Return the answer in words; the first line says it all."""
        if self.mended is None:
            return []
        models = [goal.model for goal in self.mended.goals if goal.survive is not None] or ["malicious"]
        told = [self._headline(), *_links(self.mended)]
        if self.mended.reason:
            told.append(f"stopped: {self.mended.reason}")
        for name, facts in (("before", self.before), ("after", self.after)):
            if facts is not None:
                told.append(line_of(name, facts, dict.fromkeys(models), one_way=self._is_one_way))
        return told

    def _headline(self) -> str:
        if self.bought is not None or self.mended is None:
            return "" if self.bought is None else self.bought.summary()
        color = {"optimal": "green", "impossible": "red"}.get(self.mended.verdict.value, "yellow")
        head, _, rest = self.mended.summary().partition(":")
        return f"{click.style(head + ':', fg=color, bold=True)}{rest}"


def _links(mended: MendResult) -> list[str]:
    """Return a line for each link, and the sets that no candidate breaks where there are such."""
    from robustness.spelled import Spelling

    arrow, spelled = "->" if mended.one_way else "--", Spelling(mended.before.labels)
    shown = mended.dropped if mended.thinned else mended.links
    told = [f"  {'drop' if mended.thinned else 'add'}  {spelled(u)} {arrow} {spelled(v)}" for u, v in shown]
    if mended.witness is not None and mended.witness.S1:
        told.append(f"no candidate breaks these sets, so this is out of reach: {mended.witness.goal}")
        sides = (("M", mended.witness.M), ("S1", mended.witness.S1), ("S2", mended.witness.S2))
        told += [f"  {name:<3} {set_text(labels, mended.before.labels)}" for name, labels in sides if labels]
    return told


def answer(console: Console, query: Query, work: Callable[[ProgressLine, Callable[[Any], None]], Any]) -> Answered:
    """Return what ``work(progress, on_improvement)`` finds, or the best that was known when it was stopped."""
    from robustness.limits import Limits
    from robustness.mending.master import load_solver

    if query.timeout is not None:
        load_solver()
    limits = Limits.of(query.timeout, query.jobs, query.seed)
    latest = [Answered(None)]

    def keep(found: MendResult | BudgetResult) -> None:
        latest.append(Answered.of(found))

    with ProgressLine(console) as line:

        def whole() -> Answered:
            keep(work(line, keep))
            return latest[-1].with_facts(limits)

        try:
            return query.wait_for(whole, line)
        except (KeyboardInterrupt, Overrun) as stop:
            known = replace(latest[-1], is_interrupted=isinstance(stop, KeyboardInterrupt))
            return known.with_facts(limits.within(1e-9))


def tell(ctx: click.Context, console: Console, query: Query, schema: str, answered: Answered, kept: Kept) -> None:
    """Print an answer, write what was asked for, and end with the exit code that it deserves."""
    mended, code = answered.mended, answered.exit_code
    if mended is None:
        message = (
            "interrupted: nothing is claimed" if answered.is_interrupted else "undecided: nothing was found in time"
        )
        if answered.bought is not None and not answered.is_interrupted:
            message = answered.bought.summary()
        console.error(message)
        console.error_document(code, message)
        ctx.exit(code)
    if query.as_json:
        console.document(schema, answered.document())
    else:
        console.answer(answered.lines())
    _keep(console, query, mended, kept)
    if answered.is_interrupted:
        console.error("interrupted: what is printed holds, nothing else is claimed")
    ctx.exit(code)


def _keep(
    console: Console,
    query: Query,
    found: MendResult,
    kept: Kept,
) -> None:
    """Write the mended network, its certificates, and a picture; without one, of the sets that no candidate breaks."""
    from robustness.files import write_topology

    if kept.certificate is not None:
        from robustness.mending.certification import certify_mending, least_claimed

        data = certify_mending(found, **query.effort())
        _write(console, kept.certificate, data)
        if data is not None and found.problem is not None:
            least = least_claimed(data)
            if least is not None and found.problem.least is not None and least < found.problem.least:
                console.talk(
                    f"its violations give a bound of {found.problem.actions.price(least)} only, not {found.lower_bound}"
                )
    if found.cost is None:
        is_drawn = kept.picture is not None and found.witness is not None and bool(found.witness.S1)
        if kept.picture is not None and is_drawn:
            _draw(console, found, kept.picture)
        for path in (kept.output, kept.goal_certificate, None if is_drawn else kept.picture):
            if path is not None:
                console.talk(f"not written: {path}, as no links that reach the goal are known")
        return
    if kept.output is not None:
        write_topology(found.graph, kept.output)
        console.talk(f"wrote {kept.output}")
    if kept.goal_certificate is not None:
        _write(console, kept.goal_certificate, _certificate(found, query))
    if kept.picture is not None:
        _draw(console, found, kept.picture)


def _draw(console: Console, found: MendResult, path: Path) -> None:
    from robustness.figures.network import draw_to_file

    draw_to_file(found.graph, found, path)
    console.talk(f"wrote {path}")


def _write(console: Console, path: Path, data: bytes | None) -> None:
    from robustness.files import write_certificate

    if data is None:
        console.talk("no certificate: a limit was reached, or the kernel has no evidence of this kind")
    else:
        write_certificate(path, data)
        console.talk(f"wrote {path} ({len(data):,} {plural(len(data), 'byte')}, verified)")


def _certificate(found: MendResult, query: Query) -> bytes | None:
    """Return a certificate that the mended network is what the (one) goal asks."""
    from robustness.decision.certification import certify
    from robustness.threat_models import certify_tolerance, tolerance

    goal = found.goals[0]
    effort = query.effort()
    if goal.r is not None:
        return certify(found.graph, goal.r, goal.s, **effort).certificate
    result = tolerance(found.graph, goal.model, **effort)
    return certify_tolerance(result, **effort).guaranteed
