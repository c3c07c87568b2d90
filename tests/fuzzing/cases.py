"""Command lines to try: on mutated files and certificates, and made of the options that the commands declare."""

from __future__ import annotations

import itertools
import json
import random
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import click

from cli.main import COMMANDS, robustness
from tests.fuzzing.mutation import HOSTILE_WORDS, mutated

__all__ = ["Case", "cases"]

ROOT = Path(__file__).resolve().parents[2]

#: What is done with a file that may be anything; FILE is the file.
_READING = (
    "check FILE", "check FILE -r 2", "certify FILE -r 1 -o OUT", "tolerance FILE", "attack FILE",
    "simulate FILE --steps 9",
    "joint FILE -r 1", "survey FILE", "mend FILE -r 1", "verify FILE CERT", "simulate FILE --over-time --steps 9",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One command line, and the files that it is about: they are written where it runs."""

    arguments: tuple[str, ...]
    files: dict[str, bytes] = field(default_factory=dict)


def cases(seed: int) -> Iterator[Case]:
    """Yield cases without end, the same ones for the same seed."""
    draw = random.Random(seed)
    material = _Material()
    for kind in itertools.cycle((_reading, _certificate, _recorded, _arguments)):
        yield kind(material, draw)


class _Material:
    """Good files of every kind."""

    def __init__(self) -> None:
        self.topologies = {path.name: path.read_bytes() for path in sorted((ROOT / "tests" / "data").glob("*.*"))}
        self.topologies["round-robin.json"] = (ROOT / "examples" / "round-robin.json").read_bytes()
        folder = ROOT / "tests" / "certificates"
        self.proofs = [
            (path.with_suffix(".graph").read_bytes(), path.read_bytes()) for path in sorted(folder.rglob("*.cert"))
        ]
        self.bytes = [*self.topologies.values(), *(certificate for _, certificate in self.proofs)]
        self.recorded = _recorded_documents()
        self.bytes += self.recorded.values()


def _recorded_documents() -> dict[str, bytes]:
    """Return a run and an attack on the square, as the toolkit writes them."""
    import networkx as nx

    from robustness.simulation import Scenario, as_topology, random_start
    from robustness.simulation.finding import find_attack
    from robustness.simulation.replay import encode_run

    square = nx.cycle_graph(4)
    attack = find_attack(square, 1).attack
    assert attack is not None
    network = as_topology(square, steps=1)
    run = encode_run(Scenario(network, f=1, steps=9), random_start(network.union, [1], seed=0))
    return {"run": json.dumps(run).encode(), "attack": json.dumps(attack.as_dict()).encode()}


def _reading(material: _Material, draw: random.Random) -> Case:
    name = draw.choice(sorted(material.topologies))
    data = mutated(material.topologies[name], material.bytes, draw)
    suffix = Path(name).suffix if draw.random() < 0.9 else Path(draw.choice(sorted(material.topologies))).suffix
    file = f"file{suffix}"
    line = draw.choice(_READING).replace("FILE", file).split()
    return Case((*line, *_limit(line[0])), {file: data, "CERT": material.proofs[0][1]})


def _certificate(material: _Material, draw: random.Random) -> Case:
    graph, certificate = draw.choice(material.proofs)
    if draw.random() < 0.9:
        certificate = mutated(certificate, material.bytes, draw)
    if draw.random() < 0.2:
        graph = mutated(graph, material.bytes, draw)
    question = draw.choice(("", "", "--expect robust -r 1", "-r 2 -s 1", "--expect together -f 1 --model byzantine"))
    return Case(("verify", "graph.json", "CERT", *question.split()), {"graph.json": graph, "CERT": certificate})


def _recorded(material: _Material, draw: random.Random) -> Case:
    square = {"square.json": material.topologies["square.json"]}
    kind = draw.choice(("run", "attack", "draw"))
    data = mutated(material.recorded["run" if kind == "run" else "attack"], material.bytes, draw)
    lines = {
        "run": "simulate --replay FILE",
        "attack": "simulate square.json --attack FILE --steps 9",
        "draw": "draw square.json --attack FILE -o picture.svg",
    }
    return Case(tuple(lines[kind].replace("FILE", "file.json").split()), {**square, "file.json": data})


def _arguments(material: _Material, draw: random.Random) -> Case:
    """Return a line made of a command's own parameters, each with a value of its type, or with a hostile one."""
    name = draw.choice(list(COMMANDS))
    command = robustness.get_command(click.Context(robustness), name)
    assert command is not None
    line = [name]
    if isinstance(command, click.Group) and draw.random() < 0.9:
        family = draw.choice(command.list_commands(click.Context(command)))
        command = command.get_command(click.Context(command), family) or command
        line.append(family)
    for parameter in command.params:
        if isinstance(parameter, click.Argument):
            line += [_value(parameter, draw) for _ in range(draw.choice((1, 1, 1, 1, 0, 2)))]
        elif parameter.name not in ("timeout", "jobs", "help") and draw.random() < (
            0.9 if parameter.required else 0.15
        ):
            line.append(draw.choice(parameter.opts))
            if not getattr(parameter, "is_flag", False):
                line.append(_value(parameter, draw))
    files = {"square.json": material.topologies["square.json"], "CERT": material.proofs[0][1]}
    files["round-robin.json"] = material.topologies["round-robin.json"]
    return Case((*line, *(_limit(name) if isinstance(command, click.Command) else ())), files)


def _value(parameter: click.Parameter, draw: random.Random) -> str:
    if draw.random() < 0.15:
        return draw.choice(HOSTILE_WORDS).replace("\x00", "")  # which no command line can hold
    if isinstance(parameter, click.Argument):
        return draw.choice(("square.json", "square.json", "square.json", "round-robin.json", "CERT", "gone.json", "-"))
    if isinstance(parameter.type, click.Choice):
        return str(draw.choice(list(parameter.type.choices)))
    if "output" in parameter.opts[-1] or parameter.name in ("save", "canonical", "plot", "animate", "picture"):
        return draw.choice(("out", "out.json", "out.svg", ".", "square.json", "gone/out.json", "out.gif"))
    if isinstance(parameter.type, click.Path):
        return draw.choice(("square.json", "CERT", "gone.json", "."))
    return draw.choice(("0", "1", "2", "3", "5", "1.5", "1,2", "4..5", "2-robust"))


def _limit(name: str) -> tuple[str, ...]:
    """Return what keeps a command short."""
    return () if name in ("build", "draw", "verify") else ("--timeout", "1")
