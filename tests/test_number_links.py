"""The fast reader of long lists of whole numbers says, word for word, what the other readers say, or nothing."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from unittest import mock

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from robustness import UnreadableTopology
from robustness.files import ReadingOptions, decode_topology, number_links, table
from robustness.files.found import Found

fast = number_links.number_links

#: Cells: ends that are few, so that links repeat and turn round; odd spellings; what is no number.
cells = (
    st.integers(0, 6).map(str)
    | st.sampled_from(["10", "123456789", "99999999999999999999", "999999999999999999", "00", "01", "7.0", "-1", "+1"])
    | st.sampled_from(["a", "1e3", "", "１", "0x1", "source", "nodes", '"1"', "1_0"])
)
plain = st.integers(0, 12).map(str)
separators = st.sampled_from([" ", "\t", ",", ";", "  ", " \t", ", "])
ends = st.sampled_from(["\n", "\n", "\n", "\r\n", "\r", "\n\n", " \n", ",\n", "\x0b\n", "\x0c"])
comments = st.sampled_from(
    [
        "# directed\n",
        "# undirected\n",
        "#\n",
        "# source target\n",
        "% sym\n",
        "# bipartite\n",
        "// x\n",
        "\ufeff",
        " # x\n",
    ]
)


@st.composite
def texts(draw: st.DrawFn) -> bytes:
    """Mostly lists of whole numbers; some have one thing in them that is something else."""
    separator = draw(separators)
    count = draw(st.integers(3, 14))
    lines = [separator.join((draw(plain), draw(plain))) + "\n" for _ in range(count)]
    if draw(st.booleans()):
        place = draw(st.integers(0, count - 1))
        row = draw(st.lists(cells, min_size=1, max_size=4))
        lines[place] = draw(st.sampled_from([separator, " ", "\t"])).join(row) + draw(ends)
    if draw(st.booleans()):
        lines.insert(draw(st.sampled_from([0, 0, 0, len(lines) // 2])), draw(comments))
    if draw(st.booleans()):
        lines.insert(0, draw(comments))
    if draw(st.integers(0, 3)) == 0:
        lines[0:0] = [f"{draw(st.integers(0, 20))} {draw(st.sampled_from([count, count - 1, 0, 5]))}\n"]
    text = "".join(lines)
    if draw(st.integers(0, 3)) == 0:
        text = text.rstrip("\n")
    return text.encode()


@pytest.fixture(autouse=True)
def short_is_long() -> Iterator[None]:
    with mock.patch.object(number_links, "_FEWEST_LINES", 1):
        yield


def said(data: bytes, suffix: str, options: ReadingOptions, *, is_fast: bool) -> tuple[object, ...]:
    """Return all that a reader says: the graph, how it was read, warnings; or the refusal."""
    reader = fast if is_fast else (lambda *_: None)
    with mock.patch.object(table, "number_links", reader), warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        try:
            graph = decode_topology(data, suffix, options=options)
        except UnreadableTopology as problem:
            return str(problem), [str(each.message) for each in heard]
    graph_says = graph.sha256, graph.directed, graph.read_as, graph.node_attributes, graph.link_attributes
    return *graph_says, [str(each.message) for each in heard]


many = settings(max_examples=600, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@many
@given(texts(), st.sampled_from([".edgelist", ".csv", ".txt"]), st.sampled_from([None, True, False]))
@example(b"5 5\n" + b"1 2\n2 3\n3 4\n4 5\n5 1\n", ".txt", None)
@example(b"1 4\n1 2\n2 3\n3 4\n", ".txt", None)
@example(b"# directed\n1 2\n2 1\n2 3\n3 1\n", ".edgelist", None)
@example(b"1 2\n2 1\n2 3\n3 1\n", ".edgelist", None)
@example(b"1,2\n2,3\n3,1", ".csv", None)
@example(b"1 1\n2 2\n3 1\n", ".edgelist", None)
@example(b"1 2\n01 2\n3 1\n", ".edgelist", None)
@example(b"# a\r\n1 2\n1 2\n3 1\n", ".edgelist", None)
def test_both_say_the_same(data: bytes, suffix: str, directed: bool | None) -> None:
    options = ReadingOptions(directed=directed)
    assert said(data, suffix, options, is_fast=True) == said(data, suffix, options, is_fast=False)


def found(data: bytes, options: ReadingOptions | None = None) -> Found | None:
    return fast(data, options or ReadingOptions(), "", "")


@pytest.mark.parametrize("separator", [b" ", b"\t", b","])
def test_it_is_not_idle(separator: bytes) -> None:
    """Plain lists are read by it, with comments above and without a last newline."""
    for data in (b"9 2\n2 3\n3 9\n3 2\n", b"# directed\n# more\n0 1\n1 2\n2 0\n0 7", b"1 9\n1 9\n9 3\n"):
        text = data.replace(b" ", separator) if not data.startswith(b"#") else data
        assert found(text) is not None
    assert [node.id for node in found(b"9 4\n4 3\n3 9\n").nodes] == ["9", "4", "3"]  # type: ignore[union-attr]
    assert found(b"9 4\n4 3\n3 9\n").ends.tolist() == [[0, 1], [1, 2], [2, 0]]  # type: ignore[union-attr]


@pytest.mark.parametrize(
    "text",
    [
        *("", "#", "# x", "1\n2\n", "1 2 3\n4 5 6\n", "1 2\n3\n", "1 2\n\n3 4\n", " 1 2\n3 4\n", "1  2\n3  4\n"),
        *("1 2\n3\t4\n", "1 2\n3 4 \n", "1 2\r\n3 4\r\n", "1 2\n3 x\n", "1 2\n3 -4\n", "1 2\n03 4\n", "1 2\n3 04\n"),
        *("1 2\n3 4\n# x\n5 6\n", "1 2\n3 1234567890123456789\n", "3 2\n1 2\n2 3\n", "1 1\n2 2\n3 4\n", "\n1 2\n3 4\n"),
    ],
)
def test_what_it_leaves_to_others(text: str) -> None:
    assert found(text.encode()) is None


@pytest.mark.parametrize("options", [{"rows": "hear"}, {"columns": {"source": 1, "target": 2}}, {"skip_lines": 0}])
def test_options_are_for_others(options: dict[str, object]) -> None:
    assert found(b"1 9\n9 3\n3 1\n") is not None
    assert found(b"1 9\n9 3\n3 1\n", ReadingOptions(**options)) is None  # type: ignore[arg-type]


def test_a_file_of_usual_length_is_read_the_usual_way() -> None:
    with mock.patch.object(number_links, "_FEWEST_LINES", 1000):
        lines = [f"{k} {k + 1}\n" for k in range(1200)]
        assert found("".join(lines[:900]).encode()) is None
        assert found("".join(lines).encode()) is not None


def test_a_hundred_thousand_links() -> None:
    data = "".join(f"{(k * 7919) % 30011} {(k * 104729 + 1) % 30011}\n" for k in range(100_000)).encode()
    options = ReadingOptions(directed=True)
    assert said(data, ".edgelist", options, is_fast=True) == said(data, ".edgelist", options, is_fast=False)
    assert re.search("directed, 30011 nodes", str(said(data, ".edgelist", options, is_fast=True)))
