"""Fault models and their enforcement: an adversary that does more than its model allows is an error, not an attack."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.spelled import counted

__all__ = ["FAULT_MODELS", "FaultModel", "fault_model_named", "require_fault_model"]


@dataclass(frozen=True, slots=True)
class FaultModel:
    """How many nodes may misbehave, and whether one may tell different neighbours different things.

    Attributes
    ----------
    name : str
        As users type it.
    local : bool
        True: at most f malicious in-neighbours of each normal node (f-local). False: at most f in all (f-total).
    byzantine : bool
        Whether a malicious node may send different values to different neighbours at one step.
    """

    name: str
    local: bool
    byzantine: bool


#: Every fault model by its name.
FAULT_MODELS: Mapping[str, FaultModel] = MappingProxyType(
    {
        model.name: model
        for model in (
            FaultModel("malicious", local=False, byzantine=False),
            FaultModel("malicious-local", local=True, byzantine=False),
            FaultModel("byzantine", local=False, byzantine=True),
            FaultModel("byzantine-local", local=True, byzantine=True),
        )
    }
)


def fault_model_named(name: object) -> FaultModel:
    """Return the fault model of this name, or raise :class:`InvalidParameter` naming those there are."""
    if not (isinstance(name, str) and name in FAULT_MODELS):
        raise InvalidParameter(f"a fault model is one of {', '.join(FAULT_MODELS)}, not {name!r}")
    return FAULT_MODELS[name]


def require_fault_model(graph: Digraph, malicious: npt.NDArray[np.bool_], f: int, model: FaultModel) -> None:
    """Guarantees that every run's malicious set obeys the model, or raises :class:`InvalidParameter`.

    Parameters
    ----------
    graph : Digraph
        All links that ever exist, added ones included.
    malicious : boolean array, shape ``(B, n)``
    f : int
    model : FaultModel
    """
    if not model.local:
        counts = malicious.sum(axis=1)
        if counts.size and counts.max() > f:
            raise InvalidParameter(
                f"f-total: at most f = {counted(f, 'node is', 'nodes are')} malicious, not {counts.max()}: name fewer"
            )
        return
    for i in range(graph.n):
        heard = malicious[:, graph.in_neighbours(i)].sum(axis=1)
        worst = int(np.where(malicious[:, i], 0, heard).max(initial=0))
        if worst > f:
            raise InvalidParameter(
                f"f-local: a normal node hears at most f = {f} malicious ones, but {graph.labels[i]!r} hears {worst}"
            )
