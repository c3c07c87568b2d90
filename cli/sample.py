"""``robustness sample``: what random samples of a large network say, which is never a proof."""

from __future__ import annotations

import secrets
import time
from typing import TYPE_CHECKING

import click

from .exit_codes import ExitCode
from .interruption import Overrun, interruptibly
from .options import ReadingCommand, Seed, graph_argument, jobs_option, json_option, load_graph, timeout_option
from .output import Console, ProgressLine, graph_document
from .query import speaking

if TYPE_CHECKING:
    from robustness.sampling import SampleResult

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/sample/1"


@click.command("sample", cls=ReadingCommand, short_help="Test by random samples whether GRAPH is R-robust; no proof.")
@graph_argument
@click.option("-r", type=click.IntRange(min=1), metavar="R", help="Is GRAPH R-robust? The greatest R unless given.")
@click.option(
    "--error",
    type=click.FloatRange(0, 0.5, min_open=True),
    default=0.001,
    show_default=True,
    metavar="P",
    help="The chance of error that is allowed.",
)
@click.option("--nodes", type=click.IntRange(min=2), metavar="N", default=40, show_default=True, help="Of each sample.")
@click.option(
    "--repeats", type=click.IntRange(min=1), metavar="N", default=10, show_default=True, help="How many samples."
)
@click.option(
    "--seed",
    type=Seed(),
    metavar="N",
    help="Draw the samples of another run again; drawn from the system unless given.",
)
@timeout_option
@jobs_option
@json_option
@speaking
def command(
    ctx: click.Context,
    console: Console,
    source: str,
    r: int | None,
    error: float,
    nodes: int,
    repeats: int,
    seed: int | None,
    timeout: float | None,
    jobs: int,
    as_json: bool,
) -> None:
    """Test by random samples whether GRAPH is R-robust, for networks that are too large to decide. No proof.

    Each sample is a random set of nodes whose own network is decided exactly. "Likely R-robust" means: of a network
    that is not R-robust, samples like these are drawn with probability P at most. It is no probability that GRAPH
    is R-robust, and samples that say nothing are no sign that it is not. The exit code is 30 in any case, as
    nothing is proven; 'robustness check' proves.
    """
    from robustness.sampling import SampleResult, SampleVerdict, sample_robustness

    graph = load_graph(source)
    seed = secrets.randbits(63) if seed is None else seed  # here, so that one that a limit stops tells it, too
    started = time.monotonic()
    with ProgressLine(console) as line:

        def work() -> SampleResult:
            return sample_robustness(
                graph, r, error=error, nodes=nodes, repeats=repeats, seed=seed, time_limit=timeout, jobs=jobs,
                progress=line,
            )  # fmt: skip

        try:
            found = interruptibly(work, timeout, line.tick)
        except Overrun as limit:
            found = SampleResult(
                SampleVerdict.UNDECIDED, r or 0, 1.0, min(nodes, graph.n), repeats, 0, seed, str(limit),
                seconds=time.monotonic() - started,
            )  # fmt: skip
    if as_json:
        console.document(SCHEMA, {"graph": graph_document(graph)} | found.as_dict())
    else:
        console.result(found.summary())
        console.talk(f"drawn with --seed {found.seed}")
    ctx.exit(ExitCode.UNDECIDED)
