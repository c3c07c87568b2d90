"""A certificate read in pieces, packed or not, is the one read whole; and a bomb is no way around the limits."""

from __future__ import annotations

import gzip
import os
import random
import sys
import tracemalloc
import zlib
from collections.abc import Iterator
from pathlib import Path

import networkx as nx
import pytest

from certificates import CertificateError, MalformedCertificate, Misuse, file_bytes, stream, verify, verify_any
from certificates import __main__ as program
from certificates.file_bytes import certificate_blocks, file_blocks
from certificates.stream import Stream
from robustness import Digraph
from tests.certificates.forging import certificate, searched

ROOT = Path(__file__).parent
FOUND = Digraph.from_networkx(nx.gnp_random_graph(14, 0.6, seed=1))
CANONICAL = FOUND.canonical_bytes()
PROOF = certificate(FOUND, 4, 1, body=searched(FOUND, 4, 1))


def pieces(data: bytes, draw: random.Random) -> Iterator[bytes]:
    """Cut data anywhere; some pieces are empty."""
    while data:
        size = draw.choice((0, 1, 1, 2, 3, 7, 50))
        yield data[:size]
        data = data[size:]


def outcome(graph: bytes, data: object) -> object:
    try:
        return verify_any(graph, data)  # type: ignore[arg-type]  # or what else a caller may pass
    except CertificateError as problem:
        return type(problem), str(problem)


@pytest.mark.parametrize("folder", ["accepted", "rejected", "malformed"])
def test_every_sample_in_pieces_has_the_outcome_of_the_whole(folder: str) -> None:
    draw = random.Random(folder)
    samples = sorted(ROOT.glob(f"{folder}/*.cert"))
    assert len(samples) > 5
    for path in samples:
        graph = path.with_suffix(".graph")
        data = path.read_bytes()
        about = graph.read_bytes() if graph.exists() else CANONICAL
        for _ in range(5):
            assert outcome(about, pieces(data, draw)) == outcome(about, data), path


def test_every_cut_of_a_refutation_is_refused_as_it_is_whole() -> None:
    draw = random.Random(1)
    for end in range(len(PROOF)):
        assert outcome(CANONICAL, pieces(PROOF[:end], draw)) == outcome(CANONICAL, PROOF[:end])
        assert outcome(CANONICAL, PROOF[:end]) != outcome(CANONICAL, PROOF)


@pytest.mark.parametrize("data", [None, 7, "text", bytearray(PROOF), ["text"], [PROOF, 7], iter([b"", None]), [None]])
def test_misuse(data: object) -> None:
    with pytest.raises(Misuse, match="two bytes objects"):
        verify(CANONICAL, data)  # type: ignore[arg-type]  # on purpose


def test_a_first_line_is_looked_for_within_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    end = PROOF.index(b"\n")
    for most, is_fine in ((end + 1, True), (end, False)):
        monkeypatch.setattr(stream, "MAX_HEADER_BYTES", most)
        for data in (PROOF, [PROOF[i : i + 1] for i in range(len(PROOF))]):
            if is_fine:
                assert verify(CANONICAL, data).r == 4
            else:
                with pytest.raises(MalformedCertificate, match="one line"):
                    verify(CANONICAL, data)


def test_the_limit_counts_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "MAX_CERTIFICATE_BYTES", len(PROOF) - 1)
    with pytest.raises(MalformedCertificate, match="at most"):
        verify(CANONICAL, [PROOF[:-1], PROOF[-1:]])


def test_a_place_in_a_stream() -> None:
    reader = Stream([b"ab", b"", b"\ncdef", b"gh"])
    assert reader.line(take=False) == b"ab"
    assert (reader.line(), reader.place) == (b"ab", 0)
    reader.skip(3)
    assert (reader.place, reader.peek(), reader.next(), reader.place) == (3, ord("f"), ord("f"), 4)
    reader.skip(1)
    assert Stream.of(reader) is reader
    assert (reader.rest(), reader.next(), reader.peek(), reader.is_over()) == (b"h", -1, -1, True)
    reader.skip(5)
    assert (reader.place, reader.left()) == (6, 0)
    assert Stream(b"abc").left() == 3


class TestFiles:
    @pytest.mark.parametrize("size", [1, 2, 3, 50, 2**16])
    def test_packed_or_not_whatever_the_name(self, size: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(file_bytes, "_BLOCK", size)
        half = len(PROOF) // 2
        packed = gzip.compress(PROOF)
        two = gzip.compress(PROOF[:half]) + gzip.compress(b"") + gzip.compress(PROOF[half:])
        for data in (PROOF, packed, two):
            (tmp_path / "proof").write_bytes(data)
            blocks = list(certificate_blocks(tmp_path / "proof"))
            assert b"".join(blocks) == PROOF
            assert max(map(len, blocks)) <= max(size, 2)
            assert verify(CANONICAL, certificate_blocks(tmp_path / "proof")).r == 4
        for short in (b"", b"\x1f", b"x"):
            (tmp_path / "proof").write_bytes(short)
            assert b"".join(certificate_blocks(tmp_path / "proof")) == short

    def test_what_is_damaged_is_malformed(self, tmp_path: Path) -> None:
        packed = gzip.compress(PROOF)
        path = tmp_path / "proof"
        for end in range(2, len(packed)):
            path.write_bytes(packed[:end])
            with pytest.raises(MalformedCertificate):
                verify(CANONICAL, certificate_blocks(path))
        for place in range(len(packed) - 8, len(packed)):  # the sums at the end
            path.write_bytes(packed[:place] + bytes([packed[place] ^ 1]) + packed[place + 1 :])
            with pytest.raises(MalformedCertificate, match="damaged"):
                verify(CANONICAL, certificate_blocks(path))
        path.write_bytes(packed + b"more")
        with pytest.raises(MalformedCertificate, match="damaged"):
            verify(CANONICAL, certificate_blocks(path))

    def test_a_bomb_takes_no_room(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """64 MiB of zeros after a newline, in 64 KiB: unpacked a piece at a time, and refused at the limit."""
        path = tmp_path / "bomb"
        packer = zlib.compressobj(9, zlib.DEFLATED, 31)
        header = PROOF[: PROOF.index(b"\n") + 1]
        path.write_bytes(packer.compress(header + bytes(2**26)) + packer.flush())
        assert path.stat().st_size < 2**17
        monkeypatch.setattr(stream, "MAX_CERTIFICATE_BYTES", 2**24)
        tracemalloc.start()
        with pytest.raises(MalformedCertificate, match="at most"):
            Stream(certificate_blocks(path)).left()
        assert tracemalloc.get_traced_memory()[1] < 2**20
        tracemalloc.stop()
        monkeypatch.setattr(file_bytes, "MAX_CERTIFICATE_BYTES", 2**10)
        path.write_bytes(gzip.compress(b"") * 1000)
        with pytest.raises(MalformedCertificate, match="a compressed certificate has at most"):
            Stream(certificate_blocks(path)).left()

    def test_a_long_refutation_is_never_held_whole(self, tmp_path: Path) -> None:
        """A body of 8 MiB behind a header that is rejected at its end: what is read is let go."""
        (tmp_path / "proof").write_bytes(PROOF + bytes(2**23))
        tracemalloc.start()
        with pytest.raises(CertificateError, match=f"{2**23} bytes follow"):
            verify(CANONICAL, certificate_blocks(tmp_path / "proof"))
        assert tracemalloc.get_traced_memory()[1] < 2**21
        tracemalloc.stop()

    @pytest.mark.skipif(os.name != "posix", reason="files that are pipes")
    def test_through_a_pipe(self) -> None:
        reading, writing = os.pipe()
        os.write(writing, gzip.compress(PROOF))
        os.close(writing)
        assert verify(CANONICAL, certificate_blocks(f"/dev/fd/{reading}")).r == 4
        os.close(reading)

    def test_how_far_the_reading_is(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(file_bytes, "_BLOCK", 4)
        (tmp_path / "file").write_bytes(b"0123456789")
        told: list[tuple[int, int]] = []
        assert len(list(file_blocks(tmp_path / "file", lambda *each: told.append(each)))) == 3
        assert told == [(0, 10), (4, 10), (8, 10)]


def test_the_command_tells_a_terminal_how_far_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "graph").write_bytes(CANONICAL)
    (tmp_path / "proof").write_bytes(gzip.compress(PROOF))
    for is_terminal in (False, True):
        with monkeypatch.context() as patch:
            patch.setattr(sys.stderr, "isatty", lambda there=is_terminal: there, raising=False)
            assert program.main(["verify", str(tmp_path / "graph"), str(tmp_path / "proof")]) == 0
        said = capsys.readouterr()
        assert said.out.startswith("verified: ")
        assert ("0 % of the certificate read" in said.err) is is_terminal
