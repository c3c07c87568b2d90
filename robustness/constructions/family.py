"""What a family is: a function from parameters to a graph, the value known for it, and why it is known."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robustness.errors import InvalidParameter

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["Family", "KnownRobustness", "Parameter", "require"]

#: No family is built with a greater number: a graph of more nodes fits no memory as a networkx graph.
_MOST = 10_000_000


@dataclass(frozen=True, slots=True)
class KnownRobustness:
    """What is known about one graph of a family without any search.

    Attributes
    ----------
    r : int
        r*, or a lower bound on it when ``exact`` is False.
    s : int or None
        s_max(r), where it is known.
    exact : bool
        Whether r is r* itself.
    source : str
        A proof in a few words, a theorem, or "verified exhaustively up to n = ...".
    """

    r: int
    s: int | None
    source: str
    exact: bool = True


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a family: its name, its type in words, and its default (None when it must be given)."""

    name: str
    kind: str
    default: Any

    def accepts(self, value: object) -> bool:
        """Return whether ``value`` is of the type of this parameter."""
        match self.kind:
            case "int":
                return type(value) is int
            case "float":
                return type(value) in (int, float)
            case "bool":
                return type(value) is bool
            case "Sequence[int]":
                return isinstance(value, list | tuple) and all(type(part) is int for part in value)
            case _:
                return type(value) is str

    @property
    def required(self) -> bool:
        """Whether a value must be given."""
        return self.default is inspect.Parameter.empty

    def parse(self, text: str) -> Any:
        """Return the value that ``text`` spells, or raise :class:`InvalidParameter`."""
        try:
            match self.kind:
                case "int":
                    return int(text)
                case "float":
                    return float(text)
                case "Sequence[int]":
                    return tuple(int(part) for part in text.split(","))
                case "bool":
                    return {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}[text.lower()]
                case _:
                    return text
        except (ValueError, KeyError):
            raise InvalidParameter(f"{self.name} is of type {self.kind}, not {text!r}") from None


@dataclass(frozen=True, slots=True)
class Family:
    """A named family of graphs.

    Attributes
    ----------
    name : str
        As typed on the command line.
    build : callable
        Parameters to a networkx graph. It raises :class:`InvalidParameter` out of its hypotheses.
    known : callable
        The same parameters to a :class:`KnownRobustness`, or None where nothing is known for them.
    value : str
        The closed form in one line, for people.
    """

    name: str
    build: Callable[..., nx.Graph]
    known: Callable[..., KnownRobustness | None]
    value: str

    @property
    def summary(self) -> str:
        """The first line of the docstring."""
        return (inspect.getdoc(self.build) or "").partition("\n")[0]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters of ``build``, in order."""
        return tuple(
            Parameter(name, str(parameter.annotation), parameter.default)
            for name, parameter in inspect.signature(self.build).parameters.items()
        )

    def bind(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Return all parameters by name, defaults filled in, or raise :class:`InvalidParameter`."""
        known = {parameter.name: parameter for parameter in self.parameters}
        if unknown := sorted(set(given) - set(known)):
            raise InvalidParameter(f"{self.name} takes {', '.join(known) or 'no parameters'}, not {', '.join(unknown)}")
        if missing := [name for name, parameter in known.items() if parameter.required and name not in given]:
            raise InvalidParameter(
                f"{self.name} needs {', '.join(missing)}: give {'it' if len(missing) == 1 else 'them'}"
            )
        for name, value in given.items():
            require(known[name].accepts(value), f"{name} is of type {known[name].kind}", **{name: value})
            numbers = value if isinstance(value, tuple | list) else (value,)
            most = max((abs(number) for number in numbers if type(number) is int), default=0)
            require(most <= _MOST or name == "seed", f"{name} is at most {_MOST}", **{name: value})
        return {name: given.get(name, parameter.default) for name, parameter in known.items()}


def require(holds: bool, rule: str, **values: object) -> None:
    """Raise :class:`InvalidParameter` with ``rule`` and the values unless ``holds``."""
    if not holds:
        raise InvalidParameter(f"{rule}, not " + ", ".join(f"{name} = {value!r}" for name, value in values.items()))
