"""``robustness verify``: check a certificate with the kernel alone, and compare its claim with the question asked."""

from __future__ import annotations

from pathlib import Path

import click

from cli.exit_codes import ExitCode
from cli.options import graph_argument, json_option, load_graph, talk_options
from cli.output import Console, pass_console

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/verify/1"


@click.command("verify")
@graph_argument
@click.argument("certificate", type=click.Path(path_type=Path))
@click.option("--expect", type=click.Choice(["robust", "not-robust"]), help="The verdict that must be proven.")
@click.option("-r", type=int, help="The r that the claim must be about.")
@click.option("-s", type=int, help="The s that the claim must be about.")
@json_option
@talk_options
@pass_console
@click.pass_context
def command(
    ctx: click.Context,
    console: Console,
    source: str,
    certificate: Path,
    expect: str | None,
    r: int | None,
    s: int | None,
    as_json: bool,
) -> None:
    """Verify CERTIFICATE for GRAPH and print the claim that it proves.

    Exit code 0: it proves its claim, and the claim is the one asked for. 10: it does not. 3: a file is malformed.
    """
    from certificates import verify
    from certificates.__main__ import read_at_most
    from certificates.verification import MAX_CERTIFICATE_BYTES
    from robustness.errors import UnreadableTopology

    graph = load_graph(source)
    try:
        data = read_at_most(certificate, MAX_CERTIFICATE_BYTES)
    except OSError as problem:
        raise UnreadableTopology(f"{certificate}: cannot be read: {problem.strerror}") from None
    claim = verify(graph.canonical_bytes(), data)
    asked = {"verdict": expect, "r": r, "s": s}
    wrong = [name for name, value in asked.items() if value is not None and value != getattr(claim, name)]
    if as_json:
        console.document(
            SCHEMA,
            {
                "verdict": claim.verdict,
                "r": claim.r,
                "s": claim.s,
                "evidence": claim.evidence,
                "sha256": claim.sha256,
                "tree_nodes": claim.tree_nodes,
                "as_asked": not wrong,
            },
        )
    else:
        console.result(f"verified: {claim}")
    if wrong:
        console.error(f"rejected: the certificate proves another claim than asked for ({', '.join(wrong)} differ)")
        ctx.exit(ExitCode.REFUTED)
    ctx.exit(ExitCode.DONE)
