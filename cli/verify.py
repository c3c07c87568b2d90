"""``robustness verify``: check a certificate with the kernel alone, and compare its claim with the question asked."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .choices import FACES
from .exit_codes import ExitCode
from .named import PLACE
from .options import ReadingCommand, Seconds, asked_reading, graph_argument, json_option, load_graph
from .output import Console, ProgressLine
from .query import speaking

if TYPE_CHECKING:
    from certificates.questions import Claim
    from certificates.stream import Stream
    from robustness.mending import Confirmation

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/verify/1"


@click.command("verify", cls=ReadingCommand, short_help="Verify a certificate of any kind and compare its claim.")
@graph_argument
@click.argument("certificate", type=PLACE)
@click.option(
    "--expect",
    type=click.Choice(["robust", "not-robust", "together", "apart"]),
    help="The verdict that must be proven; of malicious nodes: the network keeps together, or can be split apart.",
)
@click.option("-r", type=int, metavar="R", help="The r that the claim must be about, or imply.")
@click.option("-s", type=int, metavar="S", help="The s that the claim must be about, or imply.")
@click.option("--window", type=int, metavar="L", help="The number of steps that a joint claim must be about.")
@click.option(
    "-f", "f", type=int, metavar="F", help="The number of malicious nodes that the claim must be about, or imply."
)
@click.option("--model", type=click.Choice(tuple(FACES)), help="With -f: the threat model that it must be about.")
@click.option(
    "--checker",
    type=click.Choice(["python", "verified"]),
    default="python",
    show_default=True,
    help="verified: the checker that is proved correct, which 'make formal' builds; for certificates of robustness and "
    "of what malicious nodes can do.",
)
@click.option(
    "--choices",
    type=click.IntRange(min=0),
    metavar="N",
    help="Of a mending certificate: nodes of the kernel's tree over choices; 10000 unless given.",
)
@click.option(
    "--timeout",
    type=Seconds(),
    metavar="SECONDS",
    help="Of a mending certificate: for the solver that confirms the bound.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    metavar="N",
    help="Processes, for a long refutation that 'certify' wrote with its FILE.cubes.",
)
@json_option
@speaking
def command(
    ctx: click.Context,
    console: Console,
    source: str,
    certificate: Path,
    expect: str | None,
    r: int | None,
    s: int | None,
    window: int | None,
    f: int | None,
    model: str | None,
    checker: str,
    choices: int | None,
    timeout: float | None,
    jobs: int,
    as_json: bool,
) -> None:
    """Verify CERTIFICATE, of any kind, for GRAPH and compare the claim that it proves with the question asked.

    For a certificate of joint robustness GRAPH is the sequence that 'joint --canonical' wrote. A claim that implies the
    one asked for answers too. Of a mending certificate, about the network before mending, the lower bound is confirmed
    from the certificate alone: by the kernel's tree over choices (--choices), else by HiGHS (--timeout). Exit code 0:
    it proves its claim, and the claim answers the question. 10: it does not. 3: a file is malformed. 30: neither
    decided about the lower bound. Without a question the claim is printed, and said to be compared with none.
    """
    from certificates.mending import FORMAT as MENDING_FORMAT
    from certificates.questions import Question, comparison, format_of
    from certificates.stream import Stream

    faces, bound = FACES[model] if model is not None else (None, None)
    question = Question(expect, r, s, window, f, faces, bound)
    if question.gap():
        raise click.UsageError("a question about malicious nodes takes --expect together or apart, -f and --model.")
    with ProgressLine(console) as line:
        stream = Stream(_pieces(certificate, line))
        whole = stream.rest() if checker == "verified" or format_of(stream) == MENDING_FORMAT else b""
        if checker == "verified":
            claim = _verified_formally(source, whole)
        else:
            shared = _verified_in_parallel(console, source, certificate, stream, jobs, line) if jobs > 1 else None
            claim = shared or _verified(source, whole or stream)
    answers, how = comparison(claim, question)
    confirmation = _confirmed(source, whole, timeout, choices) if answers and hasattr(claim, "least") else None
    if confirmation is not None:
        _tell_confirmation(ctx, console, confirmation, how, as_json=as_json)
    if as_json:
        console.document(SCHEMA, _document(claim) | {"as_asked": answers, "comparison": how, "checker": checker})
    elif answers:
        by = "; by the checker that is proved correct" if checker == "verified" else ""
        console.result(f"verified: {claim}; {how}{by}")
    if not answers:
        console.error(f"rejected: {how}; proved is that {claim}")
        ctx.exit(ExitCode.REFUTED)
    ctx.exit(ExitCode.DONE)


def _pieces(certificate: Path, line: ProgressLine) -> Iterator[bytes]:
    """Yield the certificate as it is asked for, and tell how much of it has been."""
    from certificates.file_bytes import certificate_blocks
    from robustness.errors import UnreadableTopology

    def tell(done: int, size: int) -> None:
        line.note = f"{100 * done // size if size else 0} % of the certificate verified"
        line.tick()

    try:
        yield from certificate_blocks(certificate, tell)
    except OSError as problem:
        raise UnreadableTopology(f"{certificate}: cannot be read: {problem.strerror}") from None


def _verified_in_parallel(
    console: Console, source: str, certificate: Path, stream: Stream, jobs: int, line: ProgressLine
) -> Claim | None:
    """Return what several processes prove, where certify left word of the cubes, and None for anything else."""
    from certificates.questions import format_of
    from certificates.tolerance import FORMATS as TOLERANCE_FORMATS
    from certificates.verification import FORMAT
    from robustness.parallel_verification import cubes_beside, verify_in_parallel

    def tell(words: str) -> None:
        line.note = words
        line.tick()

    cubes = cubes_beside(certificate) if format_of(stream) in (FORMAT, *TOLERANCE_FORMATS) else ()
    if not cubes:
        console.talk(f"one process verifies: there is no {certificate.name}.cubes of a long refutation beside it")
        return None
    claim = verify_in_parallel(load_graph(source).canonical_bytes(), certificate, cubes, jobs, tell)
    if claim is None:
        console.talk("the cubes were not accepted one by one: one process verifies the whole")
    return claim


def _verified(source: str, certificate: bytes | Stream) -> Claim:
    """Return what the certificate proves about the graph or the sequence of graphs that ``source`` names."""
    from certificates.joint import FORMAT as JOINT_FORMAT
    from certificates.questions import format_of, verify_any

    if format_of(certificate) == JOINT_FORMAT:
        return verify_any(_sequence_bytes(source), certificate)
    if isinstance(certificate, bytes):
        return verify_any(_mended_bytes(source, certificate), certificate)
    return verify_any(load_graph(source).canonical_bytes(), certificate)


def _mended_bytes(source: str, certificate: bytes) -> bytes:
    """Return what a mending certificate is about: the network, or of thinning its nodes without any link."""
    from robustness.mending.rebuilding import subject_of

    return subject_of(load_graph(source), certificate).canonical_bytes()


def _confirmed(source: str, certificate: bytes, timeout: float | None, choices: int | None) -> Confirmation:
    from certificates.least_cost import DEFAULT_CHOICES
    from robustness.mending import confirm_least

    most = DEFAULT_CHOICES if choices is None else choices
    return confirm_least(_mended_bytes(source, certificate), certificate, time_limit=timeout, choices=most)


def _tell_confirmation(
    ctx: click.Context, console: Console, confirmation: Confirmation, how: str, *, as_json: bool
) -> None:
    """Print what the kernel proved and what the solver says, and end with the exit code."""
    codes = {"confirmed": ExitCode.DONE, "refuted": ExitCode.REFUTED, "undecided": ExitCode.UNDECIDED}
    if as_json:
        said = {"bound": confirmation.verdict.value, "solver": confirmation.solver, "reason": confirmation.reason}
        console.document(SCHEMA, _document(confirmation.claim) | {"as_asked": True, "comparison": how} | said)
    else:
        console.result(f"verified: {confirmation.claim}; {how}\n{confirmation}")
    ctx.exit(codes[confirmation.verdict.value])


def _verified_formally(source: str, certificate: bytes) -> Claim:
    """Return what the checker that is proved correct says that the certificate proves about the graph."""
    from certificates import MalformedCertificate
    from certificates.questions import format_of

    from .verified import FORMATS, NAME, CheckerUnavailable, find_checker, verify_with

    if (form := format_of(certificate)) not in FORMATS:
        raise MalformedCertificate(f"certificates of the format {form} are for --checker python only")
    found = find_checker()
    if found is None:
        raise click.UsageError(f"no {NAME} on the PATH: 'make formal' builds it where Coq and OCaml are installed.")
    try:
        return verify_with(found, load_graph(source).canonical_bytes(), certificate)
    except CheckerUnavailable as problem:
        raise click.UsageError(f"{problem}.") from None


def _sequence_bytes(source: str) -> bytes:
    """Return the canonical bytes of a sequence: those of the file itself, or of what it says in another format."""
    from certificates.joint import MAX_SEQUENCE_BYTES, SEQUENCE_FORMAT
    from robustness.time_varying import canonical_sequence
    from robustness.time_varying.reading import read_sequence
    from robustness.whole_file import read_at_most

    path = Path(source)
    if path.is_file():
        data = read_at_most(path, MAX_SEQUENCE_BYTES)
        if SEQUENCE_FORMAT.encode() in data[:64]:
            return data
    return canonical_sequence(read_sequence(source, reading=asked_reading()))


def _document(claim: Claim) -> dict[str, object]:
    """Return what a claim says, as far as claims of its kind say it."""
    names = ["verdict", "r", "s", "window", "f", "faces", "bound", "evidence", "sha256", "tree_nodes"]
    names += ["goal", "cost", "least", "links", "violations", "mended_sha256"]
    return {name: getattr(claim, name) for name in names if hasattr(claim, name)}
