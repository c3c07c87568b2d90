"""Sequences from files: every form that is read, and errors that name file and place."""

from __future__ import annotations

import io
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

import robustness as rb
from robustness.files import ReadingOptions, encode_topology, write_topology
from robustness.time_varying import TimeVaryingGraph, encode_sequence, read_sequence
from robustness.time_varying.contacts import bin_length, decode_contacts
from tests.time_varying.brute_force import all_arcs

STEPS = [[[0, 1]], [], [[1, 2], [2, 0]]]
COMPACT = {"nodes": [0, 1, 2], "period": 2, "steps": STEPS}


def node_link(arcs: list[list[int]]) -> dict[str, object]:
    edges = [{"source": u, "target": v} for u, v in arcs]
    return {"directed": True, "nodes": [{"id": k} for k in range(3)], "edges": edges}


def written(folder: Path, name: str, content: object) -> Path:
    path = folder / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def arcs_of(sequence: TimeVaryingGraph) -> list[list[list[object]]]:
    graphs = [sequence.graph_at(k) for k in range(len(sequence))]
    return [[[graph.labels[u], graph.labels[v]] for u, v in graph.arcs()] for graph in graphs]


@pytest.mark.parametrize(
    "document",
    [
        COMPACT,
        {**COMPACT, "nodes": [{"id": 0}, {"id": 1}, {"id": 2}]},
        {"period": 2, "steps": [node_link(arcs) for arcs in STEPS]},
        {"period": 2, "graphs": [node_link(arcs) for arcs in STEPS]},
        {
            "nodes": [{"id": 0}, {"id": 1}, {"id": 2}],
            "directed": True,
            "period": 2,
            "steps": [{"links": [{"source": u, "target": v} for u, v in arcs]} for arcs in STEPS],
        },
    ],
)
def test_json(tmp_path: Path, document: dict[str, object]) -> None:
    sequence = read_sequence(written(tmp_path, "steps.json", document))
    assert (arcs_of(sequence), sequence.period) == (STEPS, 2)


def test_a_bare_list_is_a_finite_trace(tmp_path: Path) -> None:
    sequence = read_sequence(written(tmp_path, "steps.json", [node_link(arcs) for arcs in STEPS]))
    assert (arcs_of(sequence), sequence.period) == (STEPS, None)


def test_undirected_arcs_are_both(tmp_path: Path) -> None:
    sequence = read_sequence(written(tmp_path, "steps.json", {**COMPACT, "directed": False}))
    assert arcs_of(sequence)[0] == [[0, 1], [1, 0]]


def test_the_period_given_goes_before_the_one_in_the_file(tmp_path: Path) -> None:
    assert read_sequence(written(tmp_path, "steps.json", COMPACT), period=3).period == 3
    with pytest.raises(rb.InvalidParameter, match="period"):
        read_sequence(written(tmp_path, "steps.json", COMPACT), period=4)


def test_standard_input_is_json() -> None:
    assert arcs_of(read_sequence("-", stdin=io.BytesIO(json.dumps(COMPACT).encode()))) == STEPS


@pytest.mark.parametrize("with_header", [True, False])
def test_json_lines(tmp_path: Path, with_header: bool) -> None:
    lines: list[object] = [{"nodes": [0, 1, 2], "period": 2}, *STEPS] if with_header else [node_link(a) for a in STEPS]
    text = "\n\n".join(map(json.dumps, lines)) + "\n"
    for suffix in (".jsonl", ".ndjson"):
        sequence = read_sequence(written(tmp_path, f"steps{suffix}", text))
        assert (arcs_of(sequence), sequence.period) == (STEPS, 2 if with_header else None)


def test_a_directory_in_the_order_of_the_numbers(tmp_path: Path) -> None:
    for k, name in enumerate(["step2.json", "step9.graphml", "step10.json"]):
        graph = nx.empty_graph(3)
        graph.add_edge(k, (k + 1) % 3)
        write_topology(nx.relabel_nodes(graph, str), tmp_path / name)
    written(tmp_path, ".hidden", "no topology")
    sequence = read_sequence(tmp_path, period=3)
    assert sequence.period == 3
    assert [step[0] for step in arcs_of(sequence)] == [["0", "1"], ["1", "2"], ["0", "2"]]


@given(st.lists(st.lists(st.sampled_from(all_arcs(4))), min_size=1, max_size=5), st.integers(1, 5) | st.none())
def test_written_and_read_again(steps: list[list[tuple[int, int]]], period: int | None) -> None:
    labels = [0, "0", (1, "a"), -7]
    arcs = [[(labels[u], labels[v]) for u, v in step] for step in steps]
    sequence = TimeVaryingGraph.from_arcs(labels, arcs, period and min(period, len(steps)))
    again = read_sequence("-", stdin=io.BytesIO(encode_sequence(sequence)))
    assert (again.labels, again.period, arcs_of(again)) == (sequence.labels, sequence.period, arcs_of(sequence))


@pytest.mark.filterwarnings("ignore:read as")
class TestContacts:
    def test_bins_count_from_the_earliest_contact(self, tmp_path: Path) -> None:
        text = "time,source,target\n25,b,c\n20,a,b\n20.5,b,a\n44,c,a\n"
        sequence = read_sequence(written(tmp_path, "contacts.csv", text), step=5)
        assert sequence.labels == ("a", "b", "c")
        assert arcs_of(sequence) == [[["a", "b"], ["b", "a"]], [["b", "c"]], [], [], [["c", "a"]]]

    def test_bins_are_exact_where_floating_point_is_not(self) -> None:
        assert int(0.3 // 0.1) == 2
        data = b"0,a,b\n0.1,b,a\n0.2,a,b\n0.3,b,a\n"
        for step in ("0.1", 0.1):
            assert [len(arcs) for arcs in arcs_of(decode_contacts(data, bin_length(step)))] == [1, 1, 1, 1]

    def test_columns_by_name_in_any_order_and_among_others(self) -> None:
        data = b"\xef\xbb\xbfTarget, rssi,TIME,source\nb,-70,0,a\n\n , , , \nc,-71,1,b\n"
        assert arcs_of(decode_contacts(data, Fraction(1))) == [[["a", "b"]], [["b", "c"]]]

    def test_without_a_header_the_first_three_columns(self) -> None:
        assert arcs_of(decode_contacts(b'-1,1,2 x,y\n0,"2, left",1 x,y\n', Fraction(1))) == [
            [["1", "2 x"]],
            [["2, left", "1 x"]],
        ]

    @pytest.mark.parametrize(
        ("name", "text", "options"),
        [
            ("x.txt", "0\ta\tb\n1\tb\tc\n", {}),
            ("x.dat", "20 a b 1A 1B\n21 b c 1A 1B\n", {}),
            ("x.dat", "20 454 640 MP MP\n40 1 939 2BIO3 2BIO3\n40 3 9 2BIO3 MP\n", {}),
            ("x.csv", "Source,Target,Timestamp\na,b,0\nb,c,1\n", {}),
            ("x.csv", "# timestamp,user_a,user_b,rssi\n0,a,b,-70\n1,b,c,-71\n1,a,-1,0\n", {}),
            ("x.csv", "t,i,j\n0,a,b\n1,b,c\n", {}),
            ("x.csv", "1,2,1600000000\n2,3,1600000001\n", {"columns": {"source": 1, "target": 2, "time": 3}}),
            ("x.csv", "a,b,w,when\na,b,1,0\nb,c,1,1\n", {"columns": {"source": "a", "target": "b", "time": "when"}}),
            ("x.txt", "0.0 CONN a b up\n1.0 CONN a b down\n1.0 CONN b c up\n1.5 CONN b c down\n", {}),
            ("x.csv", "start,end,source,target\n0,1,a,b\n1,2,b,c\n", {}),
        ],
    )
    def test_traces_as_they_are_shipped(self, tmp_path: Path, name: str, text: str, options: dict[str, Any]) -> None:
        step = 20 if text.startswith("20 454") else None
        sequence = read_sequence(written(tmp_path, name, text), step=step, reading=ReadingOptions(**options))
        assert len(sequence) == 2
        if step is None:
            first, second = arcs_of(sequence)
            a, b, c = sequence.labels
            assert [a, b] in first
            assert [b, c] in second

    def test_a_contact_that_lasts(self, tmp_path: Path) -> None:
        text = "start,end,source,target\n0,3,a,b\n1,1,b,c\n2,2.5,c,a\n"
        sequence = read_sequence(written(tmp_path, "x.csv", text))
        assert [len(arcs) for arcs in arcs_of(sequence)] == [1, 2, 2]
        backwards = written(tmp_path, "y.csv", "start,end,source,target\n3,0,a,b\n")
        with pytest.raises(rb.UnreadableTopology, match="line 2: a contact ends at 0 before it starts at 3"):
            read_sequence(backwards)

    def test_a_connection_log_keeps_what_is_up_to_the_end(self, tmp_path: Path) -> None:
        text = "0 CONN a b up\n2 CONN b c up\n3 CONN b c down\n4 CONN c a up\n"
        sequence = read_sequence(written(tmp_path, "x.log", text))
        assert [len(arcs) // 2 for arcs in arcs_of(sequence)] == [1, 1, 2, 1, 1]
        assert not sequence.directed

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("0,1,1\n1,0,1\n1,1,0\n", r"may be a matrix and no contacts: .*--columns time=1"),
            (
                "1,2,1600000000\n2,3,1600000001\n",
                r"may be time,source,target and may be source,target,time: .*--columns",
            ),
            ("5,2,1600000000\n2,3,1600000001\n", r"may be source,target,time: .*--columns"),
            ("1,2,3\n", r"may be source,target,time: .*--columns"),
            ("1,2,5,0\n2,3,5,1\n", r"of 4 columns of numbers any may be the time"),
            ("source,target,weight\na,b,1\n", r"no column is time; there are source, target, weight"),
        ],
    )
    def test_what_may_be_two_things_is_asked(self, tmp_path: Path, text: str, message: str) -> None:
        with pytest.raises(rb.UnreadableTopology, match=message):
            read_sequence(written(tmp_path, "x.csv", text))

    def test_both_ways(self, tmp_path: Path) -> None:
        sequence = read_sequence(written(tmp_path, "contacts.csv", "0,a,b\n"), both_ways=True)
        assert arcs_of(sequence) == [[["a", "b"], ["b", "a"]]]
        assert not sequence.directed

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "is empty"),
            ("time,source,target\n", "at least one contact"),
            ("0,a,b\n1,a\n", r"line 2: has 2 columns, but line 1 has 3"),
            ("time,source,target\nnoon,a,b\n", r"line 2: the time is a decimal number, not 'noon'"),
            ("x,source,target\n0,a,b\n", r"line 1: no column is time; there are source, target, x: .*--columns time=3"),
            ("0,a,b\n\nnan,a,b\n", r"line 3: the time is a decimal number, not 'nan'"),
            ("inf,a,b\n", r"line 1: the time is a decimal number, not 'inf'"),
            ("1e999999999,a,b\n", r"line 1: the time is a decimal number"),
            ("1e-999999999,a,b\n", r"line 1: the time is a decimal number"),
            ("0,a,\n1,b,c\n", r"line 1: a contact has a source and a target"),
            ('0,a,b\n0,"a,b\n', r"line 2: .*unexpected end of data"),
            ("0,a,b\n1e12,b,a\n", r"more than 1000000 steps"),
        ],
    )
    def test_what_is_no_contact_trace(self, tmp_path: Path, text: str, message: str) -> None:
        path = written(tmp_path, "contacts.csv", text)
        with pytest.raises(rb.UnreadableTopology, match=rf"contacts\.csv: .*{message}") as caught:
            read_sequence(path)
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("step", [0, -1, "x", "nan", float("inf"), "1e99"])
    def test_a_bin_has_a_length(self, tmp_path: Path, step: object) -> None:
        path = written(tmp_path, "contacts.csv", "0,a,b\n")
        with pytest.raises(rb.InvalidParameter, match="positive decimal number"):
            read_sequence(path, step=step)

    @pytest.mark.parametrize("options", [{"step": 1}, {"both_ways": True}])
    def test_options_of_contact_traces_go_with_them_only(self, tmp_path: Path, options: dict[str, object]) -> None:
        for source in (written(tmp_path, "steps.json", COMPACT), tmp_path, "-"):
            with pytest.raises(rb.InvalidParameter, match="contact trace"):
                read_sequence(source, **options)

    def test_a_self_loop_names_its_step(self) -> None:
        with pytest.warns(rb.GraphWarning, match=r"^step 1: 1 self-loop"):
            decode_contacts(b"0,a,b\n1,a,a\n", Fraction(1))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("s.json", "[", r"line 1, column 2"),
        ("s.json", "7", "an object with 'steps', or a list of steps"),
        ("s.json", "{}", "needs one list 'steps'"),
        ("s.json", {"steps": [], "graphs": []}, "needs one list 'steps'"),
        ("s.json", {"steps": {}}, "needs one list 'steps'"),
        ("s.json", [], "at least one step"),
        ("s.json", '{"steps": [], "steps": []}', "the key 'steps' stands twice"),
        ("s.json", "[" * 100_000, "nested too deeply"),
        ("s.json", "[" + "9" * 5000 + "]", "number cannot be read"),
        ("s.json", {"steps": [[[0, 1]]]}, "need 'nodes'"),
        ("s.json", {**COMPACT, "nodes": 3}, "'nodes' is a list"),
        ("s.json", {**COMPACT, "nodes": [0, 1, 1, 2]}, "distinct"),
        (
            "s.json",
            {**COMPACT, "nodes": [0, 1, 2.5]},
            "a label is an integer, a string or .*, not a number",
        ),
        ("s.json", {**COMPACT, "period": 4}, r"'period' is an integer in 1\.\.number of steps = 1\.\.3"),
        ("s.json", {**COMPACT, "period": True}, "'period' is an integer"),
        ("s.json", {**COMPACT, "directed": 1}, "'directed' is true or false"),
        ("s.json", {**COMPACT, "steps": [[[0, 1]], [[0, 9]]]}, r"step 1: an arc joins .* 9 is none"),
        ("s.json", {**COMPACT, "steps": [[[0, 1]], [[0, 1, 2]]]}, r"step 1: arc 0: is a list of two labels"),
        ("s.json", {**COMPACT, "steps": [[], [[0, None]]]}, r"step 1: a label is .* not null"),
        ("s.json", {**COMPACT, "steps": [[], [7]]}, r"step 1: arc 0: is a list of two labels"),
        ("s.json", [node_link([]), 7], r"step 1: is node-link JSON like the other steps"),
        ("s.json", [node_link([]), {}], r"step 1: .*'nodes'"),
        (
            "s.json",
            [node_link([]), {**node_link([]), "nodes": [{"id": 0}]}],
            r"step 1: every step has .* node 1 is missing",
        ),
        ("s.jsonl", "", "is empty"),
        ("s.jsonl", '{"nodes": [0]}\n', "at least one step"),
        ("s.jsonl", '{"nodes": [0, 1]}\n\n[[0, 1]]\n[[0 1]]\n', r"line 4: column 5"),
        ("s.jsonl", '{"nodes": [0, 1]}\n\n[[0, 1]]\n[[0, 2]]\n', r"step 1 \(line 4\): .* 2 is none"),
        ("s.jsonl", '{"a": 1, "a": 2}\n', "line 1: the key 'a' stands twice"),
        ("s.yaml", "", r"a sequence is a directory or a \.json, .* not '\.yaml'"),
        ("s", "", "a sequence is a directory"),
    ],
)
def test_what_is_no_sequence(tmp_path: Path, name: str, content: object, message: str) -> None:
    path = written(tmp_path, name, content)
    with pytest.raises(rb.UnreadableTopology, match=message) as caught:
        read_sequence(path)
    assert str(caught.value).startswith(str(path)[:200])
    assert "\n" not in str(caught.value)


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "steps.jsonl"
    path.write_bytes(b'{"nodes": []}\n\xff\n')
    with pytest.raises(rb.UnreadableTopology, match=r"line 2: byte 0xff is not UTF-8"):
        read_sequence(path)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    for name in ("none.json", "none.csv", "a\0b.json"):
        with pytest.raises(rb.UnreadableTopology, match="cannot be read"):
            read_sequence(tmp_path / name)


def test_a_file_that_is_too_long(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robustness.files.front.SIZE_LIMIT", 20)
    with pytest.raises(rb.UnreadableTopology, match="larger than 20 bytes"):
        read_sequence(written(tmp_path, "steps.json", COMPACT))


class TestDirectory:
    def test_unreadable(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        def refused(_: Path) -> None:
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(Path, "iterdir", refused)
        with pytest.raises(rb.UnreadableTopology, match="cannot be read: Permission denied"):
            read_sequence(tmp_path)

    def test_empty(self, tmp_path: Path) -> None:
        with pytest.raises(rb.UnreadableTopology, match="at least one topology file"):
            read_sequence(tmp_path)

    def test_a_file_that_is_no_topology(self, tmp_path: Path) -> None:
        written(tmp_path, "notes.md", "")
        with pytest.raises(rb.UnreadableTopology, match=r"notes\.md: a step is a topology file"):
            read_sequence(tmp_path)

    def test_a_bad_file_is_named(self, tmp_path: Path) -> None:
        written(tmp_path, "k1.json", node_link([]))
        written(tmp_path, "k2.json", "{")
        with pytest.raises(rb.UnreadableTopology, match=r"k2\.json: line 1"):
            read_sequence(tmp_path)

    def test_a_changed_node_set_names_step_and_file(self, tmp_path: Path) -> None:
        (tmp_path / "k1.json").write_bytes(encode_topology(nx.empty_graph(3)))
        (tmp_path / "k2.json").write_bytes(encode_topology(nx.empty_graph(4)))
        with pytest.raises(rb.UnreadableTopology, match=r"step 1 \(k2\.json\): every step has .* node 3 is new"):
            read_sequence(tmp_path)
