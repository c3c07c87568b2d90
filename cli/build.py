"""``robustness build``: graphs of the families with known robustness, and the counterexamples."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import counted

from .exit_codes import ExitCode
from .named import FILE_NAME
from .options import json_option, talk_options
from .output import Console, graph_document, pass_console, set_text
from .query import speaking
from .suggesting import SuggestingGroup

if TYPE_CHECKING:
    import networkx as nx

    from robustness.constructions import Family, KnownRobustness

__all__ = ["SCHEMA", "command", "encode_with_attributes", "write_graph"]

SCHEMA = "robustness/build/1"
LIST_SCHEMA = "robustness/build-list/1"


class FamilyGroup(SuggestingGroup):
    """One subcommand per family, its options made from the family's parameters."""

    noun = "family"
    where = "robustness build --list names all"

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all families."""
        from robustness.constructions import FAMILIES

        return list(FAMILIES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the subcommand of one family."""
        from robustness.constructions import FAMILIES

        return _family_command(FAMILIES[cmd_name]) if cmd_name in FAMILIES else None


@click.group(
    "build",
    cls=FamilyGroup,
    invoke_without_command=True,
    no_args_is_help=True,
    subcommand_metavar="NAME [PARAMETERS]...",
    short_help="Build a graph of known robustness or a counterexample.",
)
@click.option("--list", "wants_list", is_flag=True, help="List all families with parameters and known values.")
@json_option
@speaking
def command(ctx: click.Context, console: Console, wants_list: bool, as_json: bool) -> None:
    """Build a graph of a family with known robustness, or a counterexample.

    Writes node-link JSON to standard output, so that it pipes into "robustness check -", or to a file in the
    format of its suffix. "robustness build NAME --help" shows the parameters and what is known.
    """
    if wants_list:
        _print_list(console, as_json)
        ctx.exit(ExitCode.DONE)
    if ctx.invoked_subcommand is None:
        raise click.UsageError("Give the NAME of a family, or --list.")


def _print_list(console: Console, as_json: bool) -> None:
    from robustness.constructions import FAMILIES

    if as_json:
        families = [
            {
                "name": family.name,
                "summary": family.summary,
                "value": family.value,
                "parameters": [
                    {"name": each.name, "type": each.kind, "default": None if each.required else each.default}
                    for each in family.parameters
                ],
            }
            for family in FAMILIES.values()
        ]
        console.document(LIST_SCHEMA, {"families": families})
        return
    width = max(map(len, FAMILIES))
    for family in FAMILIES.values():
        flags = (f"--{each.name} {_METAVARS[each.kind]}".rstrip() for each in family.parameters)
        shown = " ".join(
            flag if each.required else f"[{flag}]" for flag, each in zip(flags, family.parameters, strict=True)
        )
        console.result(f"{family.name:<{width}}  {shown}".rstrip())
        console.result(f"{'':<{width}}  {_plain(family.summary)} {family.value}.")


#: What --help says of the parameters of all families; a word that several have means the same in each.
_MEANINGS = {
    "a": "Nodes of the first part.",
    "b": "Nodes of the second part.",
    "columns": "Nodes in a row.",
    "dimension": "Of the hypercube.",
    "directed": "Draw arcs, not edges.",
    "f": "The number of malicious nodes.",
    "k": "How many neighbours to a side.",
    "leaders": "How many vehicles at the front everybody hears.",
    "m": "How many parts.",
    "n": "How many nodes.",
    "p": "The probability of a link.",
    "predecessors": "How many vehicles ahead of it a vehicle hears.",
    "r": "The robustness that is wanted.",
    "radius": "Nodes so far apart are joined.",
    "reading": "How the figure is read: wheel, wheel-crossed or digraph.",
    "rows": "Nodes in a column.",
    "seed": "Of every random choice.",
    "sizes": "Nodes of each part.",
    "variant": "paper, the text read literally, or corrected.",
}


#: How --list and --help call values of each type.
_METAVARS = {"int": "N", "float": "X", "str": "NAME", "bool": "", "Sequence[int]": "N,N,..."}


def _family_command(family: Family) -> click.Command:
    """Return the subcommand that builds graphs of one family."""
    import inspect

    options: list[click.Parameter] = []
    for each in family.parameters:
        settings: dict[str, Any] = {"required": each.required, "help": _MEANINGS[each.name]}
        if not each.required:
            settings |= {"default": each.default, "show_default": True}
        if each.kind == "bool":
            settings |= {"is_flag": True}
        else:
            settings |= {"metavar": _METAVARS[each.kind], "type": str}
        options.append(click.Option([f"--{each.name}", each.name], **settings))
    output = click.Option(["-o", "--output"], type=FILE_NAME, metavar="FILE", help="Write there, by the suffix.")

    @pass_console
    @click.pass_context
    def build_one(ctx: click.Context, console: Console, /, output: str | None, as_json: bool, **given: Any) -> None:
        parameters = {
            each.name: each.parse(given[each.name]) if isinstance(given[each.name], str) else given[each.name]
            for each in family.parameters
        }
        _build(
            console, family.name, parameters, output, as_json or bool(ctx.parent and ctx.parent.params.get("as_json"))
        )
        ctx.exit(ExitCode.DONE)

    made = click.Command(
        family.name,
        params=[*options, output],
        callback=build_one,
        help=_help(inspect.getdoc(family.build) or ""),
        short_help=_plain(family.summary),
    )
    own = len(made.params)
    decorated: click.Command = json_option(talk_options(made))
    decorated.params[own:] = reversed(decorated.params[own:])  # decorators put the last one first
    return decorated


def _help(docstring: str) -> str:
    """Return what a family's docstring says, without its sections for Python, its examples and its markup."""
    told, *sections = re.split(r"^(\w[\w ]*)\n-{3,}\n", docstring, flags=re.MULTILINE)
    told += "".join(body for name, body in zip(sections[::2], sections[1::2], strict=True) if name == "Notes")
    paragraphs = [each for each in told.split("\n\n") if not each.startswith(">>>")]
    return re.sub(r"\*(\S[^*]*\S)\*", r"\1", _plain("\n\n".join(paragraphs)))


def _build(console: Console, name: str, parameters: Mapping[str, Any], output: str | None, as_json: bool) -> None:
    from robustness.constructions import build, known_robustness
    from robustness.digraph import as_digraph

    graph = build(name, **parameters)
    known = known_robustness(name, **parameters)
    if output is not None:
        write_graph(graph, output)
    if as_json:
        document = {
            "family": graph.graph["family"],
            "graph": graph_document(as_digraph(graph)),
            "known": None if known is None else {"r": known.r, "s": known.s, "source": known.source},
            "topology": json.loads(encode_with_attributes(graph)),
        }
        console.document(SCHEMA, document)
    elif output is None:
        console.content(encode_with_attributes(graph).decode("ascii").rstrip("\n"))
    said = [f"{name}: {counted(len(graph), 'node')}, {counted(graph.size(), 'arc' if graph.is_directed() else 'edge')}"]
    said.append(_known_text(known))
    if "trap" in graph.graph:
        sets = graph.graph["trap"].items()
        said.append("trap: " + ", ".join(f"{key} = {set_text(nodes, graph)}" for key, nodes in sets))
    if as_json or output is None:
        console.talk("\n".join(said))
    else:  # what is said is the result when the graph itself goes to a file
        console.answer(said)
    if output is not None:
        console.talk(f"wrote {output}")


def _known_text(known: KnownRobustness | None) -> str:
    if known is None:
        return "known: nothing; compute it with: robustness check"
    s = "" if known.s is None else f", greatest s for it {known.s}"
    return f"known: r* {'=' if known.exact else '>='} {known.r}{s} ({known.source})"


def encode_with_attributes(graph: nx.Graph) -> bytes:
    """Return node-link JSON that keeps the attributes of the graph itself, a trap for instance, under ``graph``."""
    from robustness.files import encode_topology

    attributes = json.dumps(graph.graph, ensure_ascii=True)
    return encode_topology(graph).replace(b'"graph": {}', b'"graph": ' + attributes.encode("ascii"), 1)


def write_graph(graph: nx.Graph, output: str) -> None:
    """Write ``graph`` to a file in the format of its suffix; node-link JSON keeps the graph's attributes."""
    from robustness.files import replace_file, write_topology

    if graph.graph and Path(output).suffix.lower() == ".json":
        replace_file(output, encode_with_attributes(graph))
    else:
        write_topology(graph, output)


def _plain(words: str) -> str:
    """Return a docstring's words without its markup; a function is named as the family that it builds."""
    words = re.sub(r" \(:\w+:`[^`]*`\)|``", "", words)
    return re.sub(r":\w+:`([^`]*)`", lambda role: role[1].replace("_", "-"), words)
