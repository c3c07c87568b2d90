"""What an operation promises: a pair (r, s), the rule that gives it, and the premises it was derived from.

A :class:`Guarantee` is bound to one graph by the SHA-256 of its canonical form. Its premises are guarantees too, so
a chain of operations is a derivation: a tree whose leaves were decided by an exact algorithm. It turns into JSON
and back, and :func:`robustness.constructions.operations.replay` carries it out again and compares.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from robustness.errors import InvalidParameter

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["RULES", "Guarantee", "Guaranteed"]

#: Every rule by name, and the lemma it stands for: from what, to what.
RULES: Mapping[str, str] = MappingProxyType(
    {
        "checked": "an exact algorithm found G to be (r,s)-robust",
        "weaken": "(r,s)-robust graphs are (r',s')-robust for r' <= r and s' <= s + r - r' (Lemma 1 (i), (ii))",
        "add-arcs": "more arcs keep (r,s): X_S^r never loses a node",
        "union": "a union of arc sets keeps (r,s) of either: it adds arcs to both",
        "remove-in-arcs": "losing at most w in-arcs per node turns (r,s) into (r-w,s) (Lemma 1 (vi))",
        "remove-nodes": "removing nodes of which each other node hears at most w turns (r,s) into (r-w,s)",
        "add-node": "a new node of in-degree at least r+s-1 keeps (r,s) (Lemma 1 (vii), strengthened)",
        "grow": "add-node, again and again",
        "join-clique": "joining m nodes to all turns r into min(r+m, ceil(N/2), max(m, floor((m+d)/2)+1))",
        "blow-up": "t copies of each node turn r into min(t r, ceil(t d/2)); d+1 for d when copies are cliques",
    }
)


@dataclass(frozen=True, slots=True)
class Guarantee:
    """The graph with this digest is (r,s)-robust, by this rule, from these premises.

    Attributes
    ----------
    r, s : int
        The pair promised. Smaller pairs follow by Lemma 1 (i) and (ii).
    rule : str
        A key of :data:`RULES`.
    parameters : mapping
        What the operation was given, JSON-ready.
    premises : tuple of Guarantee
        What it started from; empty for ``"checked"``.
    sha256 : str
        Of the canonical bytes of the graph it speaks about (``Digraph.sha256``).
    """

    r: int
    s: int
    rule: str
    parameters: Mapping[str, Any] = field(hash=False)
    premises: tuple[Guarantee, ...]
    sha256: str

    def implies(self, r: int, s: int = 1) -> bool:
        """Return whether (r,s)-robustness follows by Lemma 1 (i) and (ii).

        >>> Guarantee(3, 1, "checked", {}, (), "").implies(2, 2)
        True
        """
        return r <= 0 or (r <= self.r and s <= self.s + self.r - r)

    def as_dict(self) -> dict[str, Any]:
        """Return the derivation as JSON-ready values."""
        return {
            "r": self.r,
            "s": self.s,
            "rule": self.rule,
            "parameters": dict(self.parameters),
            "premises": [premise.as_dict() for premise in self.premises],
            "sha256": self.sha256,
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Guarantee:
        """Return the derivation that :meth:`as_dict` wrote. It is read, not believed: see ``replay``.

        Raises
        ------
        InvalidParameter
            When the document is not of the form.
        """
        try:
            r, s, rule, sha256 = (document[key] for key in ("r", "s", "rule", "sha256"))
            if type(r) is not int or type(s) is not int or type(sha256) is not str or rule not in RULES:
                raise TypeError
            premises = tuple(cls.from_dict(premise) for premise in document["premises"])
            return cls(r, s, rule, dict(document["parameters"]), premises, sha256)
        except (KeyError, TypeError, ValueError):
            raise InvalidParameter(
                "a derivation has r, s, rule, parameters, premises and sha256 as Guarantee.as_dict writes them"
            ) from None

    def explain(self) -> str:
        """Return the derivation in words, one step per line, premises indented below their conclusion."""
        lines = [f"({self.r},{self.s})-robust by {self.rule}: {RULES[self.rule]}"]
        for premise in self.premises:
            lines += ["  " + line for line in premise.explain().splitlines()]
        return "\n".join(lines)

    def __str__(self) -> str:
        return f"({self.r},{self.s})-robust by {self.rule}"


class Guaranteed(NamedTuple):
    """A graph and what is promised about it."""

    graph: nx.Graph
    guarantee: Guarantee
