"""The forms in which the rows of a survey are written."""

from __future__ import annotations

import csv
import io
import json
from xml.etree import ElementTree as ET

import networkx as nx
import pytest

import robustness as rb
from robustness.surveying.row import Row
from robustness.surveying.tables import TABLES, cells


class TestTables:
    EVIL = '=a|b<script>\x1b[31m\x00&"x",\ny'

    def rows(self) -> rb.surveying.Survey:  # type: ignore[name-defined]
        return rb.survey({self.EVIL: nx.wheel_graph(5), "plain": nx.complete_graph(7)}, gate=rb.Gate(r=3))

    def test_csv_and_json_lines_keep_every_letter(self) -> None:
        found = self.rows()
        read = list(csv.DictReader(io.StringIO(TABLES["csv"](found.rows, found.models))))
        assert [row["network"] for row in read] == [self.EVIL, "plain"]
        assert read[1]["delayed guaranteed"] == "2"
        lines = [json.loads(line) for line in TABLES["jsonl"](found.rows, found.models).splitlines()]
        assert [line["network"] for line in lines] == [self.EVIL, "plain"]
        assert {line["schema"] for line in lines} == {"robustness/survey-row/1"}

    def test_junit_has_a_failure_for_a_refuted_gate_and_an_error_for_what_was_not_asked(self) -> None:
        asked = self.rows()
        rows = (*asked.rows, Row("gone.json", gate="error", error="no such file"))
        found = rb.surveying.Survey(rows, asked.models, missing=("late",))
        suite = ET.fromstring(TABLES["junit"](found.listed, found.models))  # noqa: S314 - our own
        assert suite.tag == "testsuite"
        assert {name: suite.get(name) for name in ("tests", "failures", "errors", "skipped")} == {
            "tests": "4", "failures": "1", "errors": "2", "skipped": "0"
        }  # fmt: skip
        assert float(suite.get("time", "")) >= max(float(case.get("time", "")) for case in suite)
        assert {case.tag for case in suite} == {"testcase"}
        outcomes = [[(each.tag, each.get("type")) for each in case] for case in suite]
        out = ("system-out", None)
        assert outcomes == [
            [("failure", "refuted"), out], [out], [("error", "unreadable")], [("error", "not reached")]
        ]  # fmt: skip
        (failure,) = suite.iter("failure")
        assert failure.text is not None
        assert failure.text.startswith("weakest pair: no node of S1 = {")
        assert failure.text.endswith("hears 3 nodes outside its set")

    def test_every_table_has_a_row_for_what_was_not_reached(self) -> None:
        whole = self.rows()
        found = rb.surveying.Survey(whole.rows[1:], whole.models, missing=("late",))
        for kind, write in TABLES.items():
            text = write(found.listed, found.models)
            assert "late" in text, kind
            assert "not reached before the survey ended" in text, kind
        assert "late" in str(found)
        assert "late" in found._repr_html_()
        assert [row.gate for row in found.listed] == ["passed", "undecided"]

    def test_a_single_node_survives_any_number_and_what_was_not_read_needs_no_links(self) -> None:
        asked = rb.survey({"one": nx.path_graph(1)}, gate=rb.Gate(survive=5), mending=1.0)
        rows = (Row("gone", gate="error", error="no such file"), *asked.rows)
        models = ("malicious", "delayed")
        head, gone, one = cells(rows, models)
        assert [one[head.index(model)] for model in models] == ["any", "any"]
        assert (gone[head.index("links")], gone[head.index("gate")], gone[-1]) == ("", "error", "no such file")
        assert len({len(line) for line in (head, gone, one)}) == 1

    def test_a_frame_has_its_columns_without_rows_too(self) -> None:
        pytest.importorskip("pandas")
        whole = self.rows()
        late = rb.surveying.Survey(whole.rows, whole.models, missing=("late",)).to_frame()
        assert list(late["network"]) == [self.EVIL, "plain", "late"]
        assert list(rb.surveying.Survey((), whole.models).to_frame().columns) == list(late.columns)

    def test_text_markdown_and_html_cannot_be_steered(self) -> None:
        found = self.rows()
        for kind in ("table", "markdown"):
            text = TABLES[kind](found.rows, found.models)
            assert "\x1b" not in text
            assert text.count("\n") == (3 if kind == "table" else 4)
        assert "<script>" not in found._repr_html_()
        assert str(found).splitlines()[0].split() == [
            "network", "nodes", "arcs", "r*", "s", *found.models, "gate", "seconds", "note"
        ]  # fmt: skip
