"""The committed samples: what is accepted, rejected and malformed stays so, and the script still writes such files."""

from __future__ import annotations

from pathlib import Path

import pytest

from certificates import MalformedCertificate, RejectedCertificate, verify
from certificates.graph import decode_graph
from robustness import Digraph
from tests.certificates.forging import holds
from tests.certificates.make_samples import HERE, samples, write

FOLDERS = ("accepted", "rejected", "malformed")
FILES = sorted(path for folder in FOLDERS for path in (HERE / folder).glob("*.cert"))


def check(path: Path) -> None:
    graph, data = path.with_suffix(".graph").read_bytes(), path.read_bytes()
    match path.parent.name:
        case "accepted":
            claim = verify(graph, data)
            found = decode_graph(graph)
            arcs = [(found.labels[u], found.labels[v]) for v, heard in enumerate(found.hears) for u in heard]
            assert (claim.verdict == "robust") is holds(Digraph(found.labels, arcs), claim.r, claim.s)
        case "rejected":
            with pytest.raises(RejectedCertificate):
                verify(graph, data)
        case "malformed":
            with pytest.raises(MalformedCertificate):
                verify(graph, data)
        case folder:
            pytest.fail(f"a sample in {folder}")


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_committed_samples(path: Path) -> None:
    check(path)


#: What docs/certificate-format.md says of the samples that are rejected.
CODES = {
    "another-graph-of-the-same-degrees": "other-subject",
    "the-proof-of-a-sibling": "refutation",
    "r-beyond-half": "beyond-half",
    "degree-too-small": "degree",
    "growth-too-thin": "growth",
    "derivation-that-skips-weaken": "derivation",
    "an-empty-set": "violation",
}


@pytest.mark.parametrize(("name", "code"), CODES.items())
def test_a_rejection_says_by_a_code_which_part_does_not_hold(name: str, code: str) -> None:
    path = HERE / "rejected" / f"{name}.cert"
    with pytest.raises(RejectedCertificate) as caught:
        verify(path.with_suffix(".graph").read_bytes(), path.read_bytes())
    assert caught.value.code == code


def test_the_script_writes_what_is_committed(tmp_path: Path) -> None:
    write(tmp_path)
    written = sorted(tmp_path.glob("*/*"))
    assert {path.relative_to(tmp_path) for path in written} == {
        path.relative_to(HERE) for folder in FOLDERS for path in (HERE / folder).iterdir()
    }
    for path in written:
        if path.suffix == ".cert":
            check(path)


def test_no_two_samples_are_the_same() -> None:
    every = [(graph, data) for _, _, graph, data in samples()]
    assert len(set(every)) == len(every) == len(FILES)
