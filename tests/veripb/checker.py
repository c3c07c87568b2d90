"""A small checker of pseudo-Boolean proofs: of the rules that the exporter uses, in both spellings, and of no others.

Written from the public description of the format; it knows nothing of graphs and imports nothing of ours. A constraint
is ``sum coefficient * literal >= degree`` with positive coefficients on literals of different variables; a literal is
``2 * variable``, or ``2 * variable + 1`` for its negation.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

__all__ = ["Checker", "Constraint", "Rejected", "check", "normalised"]


class Rejected(Exception):
    """The proof is not one, or not one of the subset that is read here."""


@dataclass(frozen=True, slots=True)
class Constraint:
    """``sum of coefficient * literal >= degree``, normalised; terms in descending order of coefficients."""

    terms: tuple[tuple[int, int], ...]  # (coefficient, literal)
    degree: int

    def slack(self) -> int:
        return sum(coefficient for coefficient, _ in self.terms) - self.degree


def normalised(terms: Sequence[tuple[int, int]], degree: int) -> Constraint:
    """Return the constraint with opposite literals cancelled, and no negative coefficients and degree."""
    weight: dict[int, int] = {}
    for coefficient, literal in terms:
        if coefficient < 0:
            coefficient, literal, degree = -coefficient, literal ^ 1, degree - coefficient
        taken = min(coefficient, weight.get(literal ^ 1, 0))
        if taken:
            weight[literal ^ 1] -= taken
            degree -= taken
        weight[literal] = weight.get(literal, 0) + coefficient - taken
    kept = sorted(((c, lit) for lit, c in weight.items() if c), key=lambda term: (-term[0], term[1]))
    return Constraint(tuple(kept), max(0, degree))


def negation(constraint: Constraint) -> Constraint:
    """Return ``sum of coefficient * literal <= degree - 1``."""
    total = sum(coefficient for coefficient, _ in constraint.terms)
    return normalised([(c, lit ^ 1) for c, lit in constraint.terms], total - constraint.degree + 1)


def weakens(strong: Constraint, weak: Constraint, false: set[int]) -> bool:
    """Return whether ``strong`` yields ``weak`` by adding ``literal >= 0``, when the literals in ``false`` are."""
    true = {lit ^ 1 for lit in false}
    goal = {lit: c for c, lit in weak.terms}
    lost = sum(max(0, c - goal.get(lit, 0)) for c, lit in strong.terms if lit not in false and lit not in true)
    reached = strong.degree - sum(c for c, lit in strong.terms if lit in true)
    return reached - lost >= weak.degree - sum(c for c, lit in weak.terms if lit in true)


class Checker:
    """The constraints by number, where each literal occurs, and propagation over them."""

    def __init__(self, model: str) -> None:
        self.variables: dict[str, int] = {}
        self.constraints: dict[int, Constraint] = {}
        self.slacks: dict[int, int] = {}
        self.occurrences: dict[int, dict[int, int]] = {}
        self.copies: dict[Constraint, int] = {}
        self.eager: set[int] = set()
        self.last = 0
        for line in model.splitlines():
            if line.strip() and not line.startswith("*"):
                text = line.strip()
                if not text.endswith(";"):
                    raise Rejected(f"no semicolon: {line!r}")
                self.add(self.inequality(text[:-1].split()))
        self.size = self.last

    # Reading

    def literal(self, word: str) -> int:
        if not re.fullmatch(r"~?[A-Za-z][A-Za-z0-9]+", word):
            raise Rejected(f"no literal: {word!r}")
        return 2 * self.variables.setdefault(word.lstrip("~"), len(self.variables)) + word.startswith("~")

    def inequality(self, words: Sequence[str]) -> Constraint:
        if len(words) % 2 or words[-2] != ">=":
            raise Rejected(f"no inequality: {words}")
        pairs = zip(words[:-2:2], words[1:-2:2], strict=True)
        return normalised([(number(c), self.literal(word)) for c, word in pairs], number(words[-1]))

    # The database

    def add(self, constraint: Constraint) -> int:
        self.last += 1
        self._put(self.last, constraint)
        return self.last

    def _put(self, key: int, constraint: Constraint) -> None:
        self.constraints[key] = constraint
        self.copies[constraint] = self.copies.get(constraint, 0) + 1
        self.slacks[key] = constraint.slack()
        for coefficient, literal in constraint.terms:
            self.occurrences.setdefault(literal, {})[key] = coefficient
        if self.slacks[key] < max((c for c, _ in constraint.terms[:1]), default=0):
            self.eager.add(key)

    def remove(self, key: int) -> None:
        if key not in self.constraints:
            raise Rejected(f"there is no constraint {key}")
        constraint = self.constraints.pop(key)
        self.copies[constraint] -= 1
        self.eager.discard(key)
        for _, literal in constraint.terms:
            del self.occurrences[literal][key]

    def propagates(self, *assumed: Constraint) -> tuple[bool, set[int]]:
        """Return whether propagation over everything and ``assumed`` meets a conflict, and what it made false."""
        for k, constraint in enumerate(assumed):
            self._put(-1 - k, constraint)
        try:
            return self._propagate()
        finally:
            for k in range(len(assumed)):
                self.remove(-1 - k)

    def _propagate(self) -> tuple[bool, set[int]]:
        false: set[int] = set()
        slacks: dict[int, int] = {}
        touched = set(self.eager)
        while touched:
            key = touched.pop()
            slack = slacks.get(key, self.slacks[key])
            if slack < 0:
                return True, false
            for coefficient, literal in self.constraints[key].terms:
                if coefficient <= slack:
                    break
                if literal not in false and literal ^ 1 not in false:
                    false.add(literal ^ 1)
                    for other, weight in self.occurrences.get(literal ^ 1, {}).items():
                        slacks[other] = slacks.get(other, self.slacks[other]) - weight
                        touched.add(other)
        return False, false

    # The rules

    def pol(self, words: Sequence[str]) -> None:
        stack: list[tuple[list[tuple[int, int]], int] | int] = []
        for word in words:
            if word in ("+", "*"):
                if len(stack) < 2:
                    raise Rejected("an operator without two operands")
                right, left = stack.pop(), stack.pop()
                if word == "*":
                    left = self._operand(left)
                    if not isinstance(right, int) or right < 1:
                        raise Rejected("a factor is a positive number")
                    stack.append(([(c * right, lit) for c, lit in left[0]], left[1] * right))
                else:
                    one, two = self._operand(left), self._operand(right)
                    stack.append((one[0] + two[0], one[1] + two[1]))
            else:
                stack.append(number(word))
        if len(stack) != 1:
            raise Rejected("a sum leaves one constraint")
        self.add(normalised(*self._operand(stack[0])))

    def _operand(self, value: tuple[list[tuple[int, int]], int] | int) -> tuple[list[tuple[int, int]], int]:
        if not isinstance(value, int):
            return value
        if value not in self.constraints:
            raise Rejected(f"there is no constraint {value}")
        return list(self.constraints[value].terms), self.constraints[value].degree

    def rup(self, words: Sequence[str]) -> None:
        constraint = self.inequality(words)
        if not self.propagates(negation(constraint))[0]:
            raise Rejected(f"propagation does not derive {' '.join(words)}")
        self.add(constraint)

    def red(self, words: Sequence[str], witness: Sequence[str]) -> None:
        """``F and not C`` imply ``F and C`` with the witness put in; each of these for a simple reason."""
        constraint = self.inequality(words)
        replaced: dict[int, int] = {}
        values: dict[int, int] = {}
        if len(witness) % 3 or any(arrow != "->" for arrow in witness[1::3]):
            raise Rejected("a witness is a list of: variable -> value")
        for variable, value in zip(witness[::3], witness[2::3], strict=True):
            literal = self.literal(variable)
            if literal & 1 or literal in replaced or literal in values:
                raise Rejected(f"a witness names a variable once: {variable}")
            if value in ("0", "1"):
                values[literal], values[literal ^ 1] = int(value), 1 - int(value)
            else:
                replaced[literal], replaced[literal ^ 1] = self.literal(value), self.literal(value) ^ 1
        against = negation(constraint)
        moved = set(values) | set(replaced)
        affected = {key for literal in moved for key in self.occurrences.get(literal, ())}
        for goal in [constraint, *(self.constraints[key] for key in sorted(affected))]:
            image = substituted(goal, replaced, values)
            if self.copies.get(image) or not image.degree or self.propagates(against, negation(image))[0]:
                continue
            if not weakens(against, image, self.propagates(against)[1]):
                raise Rejected(f"the witness does not keep {goal}")
        self.add(constraint)

    def delete(self, words: Sequence[str]) -> None:
        if not words or words[0] != "id":
            raise Rejected("only del id is read here")
        for word in words[1:]:
            self.remove(number(word, 1))

    def contradiction(self, word: str) -> None:
        key = number(word, 1)
        if key not in self.constraints or self.constraints[key].slack() >= 0:
            raise Rejected(f"constraint {key} is no contradiction")

    def formula(self, words: Sequence[str]) -> None:
        if list(words) != [str(self.size)]:
            raise Rejected(f"the model has {self.size} constraints, not {words}")

    def rule(self, name: str, words: Sequence[str], witness: Sequence[str] | None) -> None:
        """Carry out one rule; only ``red`` has a witness."""
        if (name == "red") != (witness is not None):
            raise Rejected(f"a witness too many or too few: {name}")
        if name == "red":
            self.red(words, witness or ())
            return
        rules: Mapping[str, object] = {"f": self.formula, "pol": self.pol, "rup": self.rup, "del": self.delete}
        handler = rules.get(name)
        if not callable(handler):
            raise Rejected(f"no rule of the subset: {name!r}")
        handler(words)


def substituted(constraint: Constraint, replaced: Mapping[int, int], values: Mapping[int, int]) -> Constraint:
    """Return the constraint with the witness put in."""
    terms, degree = [], constraint.degree
    for coefficient, literal in constraint.terms:
        if literal in values:
            degree -= coefficient * values[literal]
        else:
            terms.append((coefficient, replaced.get(literal, literal)))
    return normalised(terms, degree)


def number(word: str, least: int = 0) -> int:
    """Return the number that a word spells, at least ``least``."""
    if not re.fullmatch(r"\d{1,12}", word) or int(word) < least:
        raise Rejected(f"no number of at least {least}: {word!r}")
    return int(word)


def check(model: bytes, proof: bytes) -> None:
    """Return when the proof shows that the model has no solution; raise :class:`Rejected` otherwise."""
    text = proof.decode("ascii")
    head, _, body = text.partition("\n")
    rules = {
        "pseudo-Boolean proof version 3.0": _modern_rules,
        "pseudo-Boolean proof version 1.1": _old_rules,
    }
    if head not in rules:
        raise Rejected(f"no proof begins with {head[:60]!r}")
    checker = Checker(model.decode("ascii"))
    read = list(rules[head](body))
    if not read or read[0][0] != "f":
        raise Rejected("the proof does not begin with the formula")
    for name, words, witness in read[: -1 if head.endswith("1.1") else -3]:
        checker.rule(name, words, witness)
    closing = [(name, list(words)) for name, words, _ in read[-1 if head.endswith("1.1") else -3 :]]
    match closing:
        case [("output", ["NONE"]), ("conclusion", ["UNSAT", ":", key]), ("end", ["pseudo-Boolean", "proof"])]:
            checker.contradiction(key)
        case [("c", [key])]:
            checker.contradiction(key)
        case _:
            raise Rejected(f"no conclusion that the model is unsatisfiable: {closing}")


def _modern_rules(body: str) -> Iterator[tuple[str, list[str], list[str] | None]]:
    """Yield the rules of version 3: each ends with a semicolon, a colon stands before a witness."""
    *rules, rest = re.sub(r"%.*", "", body).split(";")
    if rest.strip():
        raise Rejected(f"the last rule has no semicolon: {rest[:60]!r}")
    for rule in rules:
        words = rule.split()
        if not words:
            raise Rejected("a semicolon without a rule")
        colon = words.index(":") if words[0] == "red" and ":" in words else len(words)
        yield words[0], words[1:colon], words[colon + 1 :] if colon < len(words) else None


def _old_rules(body: str) -> Iterator[tuple[str, list[str], list[str] | None]]:
    """Yield the rules of version 1.1: one a line, a semicolon ends an inequality, what follows it is the witness."""
    if not body.endswith("\n"):
        raise Rejected("the last line does not end")
    for line in body.splitlines():
        words = line.split()
        if not words or words[0].startswith("*"):
            continue
        if words[0] in ("rup", "red"):
            if ";" not in words:
                raise Rejected(f"an inequality without a semicolon: {line[:60]!r}")
            end = words.index(";")
            yield words[0], words[1:end], words[end + 1 :] if words[0] == "red" or end + 1 < len(words) else None
        else:
            yield words[0], words[1:], None
