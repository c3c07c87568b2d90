"""Writing a proof: numbered constraints, the levels they live on, and the two spellings of the format.

A checker gives every constraint the next number: first those of the model, then one for every line ``pol``, ``rup`` or
``red``. Each derived constraint here belongs to a *level*, the number of branches that were open when it was written;
when the last of these closes, the level is deleted, so that the checker propagates only over what is still of use.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from robustness.decision.veripb.inequalities import Model, inequality, negated

__all__ = ["SYNTAXES", "Proof", "Syntax"]


@dataclass(frozen=True, slots=True)
class Syntax:
    """One spelling of the format: what ends a rule, what precedes a witness, how the proof begins and ends."""

    version: str
    #: Ends a line that does not end with an inequality.
    end: str
    #: Stands between an inequality and a witness.
    witness: str
    #: Ends a line with a witness.
    witnessed: str
    #: The last lines; ``{}`` is the number of the contradiction.
    conclusion: str


SYNTAXES = {
    "3.0": Syntax("3.0", " ;", ":", " ;", "output NONE ;\nconclusion UNSAT : {} ;\nend pseudo-Boolean proof ;\n"),
    "1.1": Syntax("1.1", "", ";", "", "c {}\n"),
}


class Proof:
    """The lines so far, the number of the last constraint, and the constraints of every level that are alive."""

    def __init__(self, model: Model, syntax: Syntax) -> None:
        self.syntax = syntax
        self.last = len(model.lines)
        self.lines = [f"pseudo-Boolean proof version {syntax.version}", f"f {self.last}{syntax.end}"]
        self.levels: list[list[int]] = [[]]
        #: For every level: sums written there, so that none is alive twice.
        self.sums: list[set[tuple[tuple[int, int], ...]]] = [set()]

    def open_level(self) -> None:
        """Begin the level of one more open branch."""
        self.levels.append([])
        self.sums.append(set())

    def close_level(self) -> None:
        """Delete the constraints of the last level, and the level."""
        self.delete(self.levels.pop())
        self.sums.pop()

    def add_up(self, summands: Iterable[tuple[int, int]]) -> None:
        """Derive the sum of ``(constraint, factor)``, unless it is alive already or is a single constraint."""
        key = tuple(sorted(summands))
        if len(key) > 1 and not any(key in level for level in self.sums):
            self.sums[-1].add(key)
            self._derive(self._sum(key))

    def add_for_good(self, summands: Sequence[tuple[int, int]]) -> int:
        """Derive the sum of ``(constraint, factor)``, never to be deleted, and return its number."""
        return self._derive(self._sum(summands), lasting=True)

    def _sum(self, summands: Sequence[tuple[int, int]]) -> str:
        words = ["pol"]
        for k, (number, factor) in enumerate(summands):
            words += [str(number)] + ([str(factor), "*"] if factor > 1 else []) + (["+"] if k else [])
        return " ".join(words) + self.syntax.end

    def clause(self, literals: Sequence[str]) -> int:
        """Derive ``sum of literals >= 1`` by reverse unit propagation and return its number."""
        return self._derive("rup " + inequality([(1, literal) for literal in literals], 1) + " ;")

    def without_loss(self, terms: Sequence[tuple[int, str]], degree: int, witness: Iterable[tuple[str, str]]) -> int:
        """Derive an inequality by redundance, never to be deleted, and return its number.

        ``witness`` has ``(variable, what replaces it)``: a violating pair that breaks the inequality becomes one that
        does not.
        """
        replaced = " ".join(f"{variable} -> {value}" for variable, value in witness)
        rule = f"red {inequality(terms, degree)} {self.syntax.witness} {replaced}"
        return self._derive(rule + self.syntax.witnessed, lasting=True)

    def _derive(self, line: str, lasting: bool = False) -> int:
        self.lines.append(line)
        self.last += 1
        self.levels[0 if lasting else -1].append(self.last)
        return self.last

    def delete(self, numbers: Sequence[int]) -> None:
        """Delete constraints that are not needed any more."""
        if numbers:
            self.lines.append("del id " + " ".join(map(str, numbers)) + self.syntax.end)

    def refuted(self, decisions: Sequence[str]) -> None:
        """Close the last level: derive that its decisions do not all hold, and keep that on the level above."""
        clause = self.clause([negated(literal) for literal in decisions])
        self.levels[-1].remove(clause)
        self.close_level()
        self.levels[-1].append(clause)

    def text(self) -> str:
        """Return the complete proof; its last constraint is the contradiction."""
        return "\n".join(self.lines) + "\n" + self.syntax.conclusion.format(self.last)
