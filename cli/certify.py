"""``robustness certify``: decide, and write a certificate for either verdict."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from robustness.spelled import counted, plural

from .exit_codes import ExitCode
from .interruption import Overrun
from .named import FILE
from .options import ReadingCommand, graph_argument, load_graph
from .output import Console, ProgressLine, graph_document
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.results import RobustnessResult

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/certify/1"


@click.command(
    "certify", cls=ReadingCommand, short_help="Decide whether GRAPH is (R,S)-robust and write a certificate."
)
@graph_argument
@click.option("-r", type=click.IntRange(min=1), metavar="R", required=True, help="Is GRAPH (R,S)-robust?")
@click.option("-s", type=click.IntRange(min=1), metavar="S", default=1, show_default=True, help="1 is r-robustness.")
@click.option(
    "-o",
    "--output",
    type=FILE,
    metavar="FILE",
    required=True,
    help="Where the certificate goes; FILE.gz is compressed.",
)
@click.option(
    "--canonical",
    type=FILE,
    metavar="FILE",
    help="Also write the canonical graph, which 'python -m certificates verify' reads whatever GRAPH's format.",
)
@click.option(
    "--proof-format",
    type=click.Choice(["tree", "veripb"]),
    default="tree",
    show_default=True,
    help="veripb: also write OUTPUT.opb and OUTPUT.pbp for a third party's checker.",
)
@click.option(
    "--veripb-version",
    type=click.Choice(["3.0", "1.1"]),
    default="3.0",
    show_default=True,
    help="With veripb: the version of the proof format.",
)
@query_options(cluster=True, verifies=True)
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    r: int,
    s: int,
    output: Path,
    canonical: Path | None,
    proof_format: str,
    veripb_version: str,
) -> None:
    """Decide whether GRAPH is (R,S)-robust and write a certificate of the answer.

    The certificate proves either verdict to anybody: 'robustness verify GRAPH FILE', or 'python -m certificates
    verify', which needs nothing but Python. It has been verified before it is written, by N processes with --jobs N or
    --cluster local:N. Exit code 0 robust, 10 not
    robust, 30 undecided (nothing is written).
    """
    from certificates.file_bytes import certificate_blocks
    from certificates.stream import Stream
    from robustness.decision.bounds import quick_bounds
    from robustness.decision.certification import certify
    from robustness.files.writing import replace_file, require_different_files
    from robustness.results import RobustnessResult, Verdict

    proofs = [output.with_name(output.name + suffix) for suffix in (".opb", ".pbp")] if proof_format == "veripb" else []
    index = output.with_name(output.name + ".cubes")
    require_different_files([source], [output, index, canonical, *proofs, query.state])
    graph = load_graph(source)
    is_interrupted = False
    with ProgressLine(console) as line:

        def work() -> RobustnessResult:
            return certify(graph, r, s, output=output, **query.effort(line))

        try:
            result = query.wait_for(work, line)
        except (KeyboardInterrupt, Overrun) as stop:
            is_interrupted = isinstance(stop, KeyboardInterrupt)
            reason = "interrupted" if is_interrupted else "the time limit was reached"
            result = RobustnessResult(Verdict.UNDECIDED, r, s, bounds=quick_bounds(graph), stats={"reason": reason})
    files = dict(result.stats.get("written", {}))
    size = files.pop("bytes", 0)
    written: dict[str, str] = files
    if files:
        if canonical is not None:
            replace_file(canonical, graph.canonical_bytes())
            written["canonical"] = str(canonical)
        if proof_format == "veripb" and result.verdict.value == "robust":
            from robustness.decision.veripb import export

            data = Stream(certificate_blocks(output)).rest()
            model, proof = export(graph.canonical_bytes(), data, version=veripb_version)
            for suffix, text in ((".opb", model), (".pbp", proof)):
                replace_file(output.with_name(output.name + suffix), text)
                written[suffix[1:]] = str(output.with_name(output.name + suffix))
    if query.as_json:
        console.document(
            SCHEMA,
            {
                "graph": graph_document(graph),
                "verdict": result.verdict.value,
                "r": r,
                "s": s,
                "algorithm": result.algorithm,
                "bounds": None if result.bounds is None else result.bounds.as_dict(),
                "bytes": size,
                "files": written,
                **({"estimate": result.stats["estimate"]} if "estimate" in result.stats else {}),
                "seconds": round(result.seconds, 6),
            },
        )
    else:
        _tell(
            console,
            result,
            f"{source}, {counted(graph.n, 'node')}, {counted(graph.arc_count, 'arc')}",
            written,
            size,
            proof_format,
        )
    if is_interrupted:
        console.error("interrupted: what is printed holds, nothing else is claimed")
        ctx.exit(ExitCode.INTERRUPTED)
    ctx.exit(ExitCode.of_verdict(result.verdict.value))


def _tell(
    console: Console, result: RobustnessResult, network: str, written: dict[str, str], size: int, proof_format: str
) -> None:
    """Print the answer, what is known where there is none, and the files."""
    console.result(f"{result.summary()}: {network}")
    if not written:
        console.result(f"nothing is certified: {result.stats.get('reason', 'a limit was reached')}")
        if result.bounds is not None:
            low, high = result.bounds.lower, result.bounds.upper
            console.result(f"r* >= {low.value:<4} {low.reason}\nr* <= {high.value:<4} {high.reason}")
    elif proof_format == "veripb" and result.verdict.value == "not-robust":
        console.talk("no VeriPB proof: that a graph is not robust is shown by the pair of sets in the certificate")
    for kind, path in written.items():
        note = {"certificate": f" ({size:,} {plural(size, 'byte')}, verified)", "cubes": " (for verify --jobs)"}.get(
            kind, ""
        )
        console.talk(f"wrote {path}{note}")
