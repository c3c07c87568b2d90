"""The page about many networks: its words, that it loads nothing and runs no label, and what it does in a browser."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli.main import robustness
from robustness.files import write_topology
from robustness.reporting import Report
from robustness.reporting.front import report_of
from robustness.reporting.wording import headline, in_words
from robustness.surveying import Row, Survey
from robustness.threat_models import THREAT_MODELS

pytest.importorskip("matplotlib")

NASTY = "</script><script>document.title='taken'</script><img src=x onerror=\"document.title='taken'\">'\"&"


def networks() -> dict[str, nx.Graph]:
    wheel = nx.relabel_nodes(nx.wheel_graph(5), {0: NASTY, 1: "n10", 2: "n2"})
    return {
        "wheel" + NASTY: wheel,
        "complete": nx.complete_graph(7),
        "path": nx.path_graph(8),
        "one": nx.path_graph(1),
    }


class Tags(HTMLParser):
    """Every tag of a page with its attributes, and which of them are not closed in order."""

    VOID = frozenset({"meta", "link", "input", "img", "br", "line", "rect", "polyline"})

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def made() -> Report:
    return rb.report(networks(), gate=rb.Gate(survive=1), title="Fleet " + NASTY)


class TestWords:
    def test_what_a_manager_reads_first(self, made: Report) -> None:
        assert headline(made.survey, rb.Gate(survive=1)) == (
            "2 of 4 networks survive 1 malicious node under every threat model; 2 fail, each with a counterexample."
        )
        assert "A network of 7 nodes and 21 links." in Tags(made.html).text

    @pytest.mark.parametrize(
        ("nodes", "guaranteed", "refuted", "words"),
        [
            (4, 1, 2, "The network survives 1 malicious node under the threat model delayed. Nothing"),
            (4, 0, 1, "The network does not survive 1 malicious node under the threat model delayed. Nothing"),
            (4, -1, 0, "The network does not survive 1 malicious node"),
            (4, 0, 3, "Whether the network survives 1 malicious node under the threat model delayed was not decided"),
            (4, 0, None, "Whether the network survives 1 malicious node"),
            (1, 0, None, "The network survives 1 malicious node"),
        ],
    )
    def test_without_a_gate_nothing_is_claimed_that_is_not_known(
        self, nodes: int, guaranteed: int, refuted: int | None, words: str
    ) -> None:
        row = Row("a", nodes, 0, False, guaranteed={"delayed": guaranteed}, refuted={"delayed": refuted})
        assert headline(Survey((row,), ("delayed",)), rb.Gate()).startswith(words)
        other = replace(row, network="b", guaranteed={"delayed": 5}, refuted={"delayed": 6}, nodes=12)
        both = headline(Survey((row, other), ("delayed",)), rb.Gate())
        assert both.startswith(f"{1 + words.startswith('The network survives')} of 2 networks survive")
        assert ("1 was not decided within the limit" in both) == words.startswith("Whether")

    def test_of_networks_that_nobody_decided_none_is_said_to_fail(self) -> None:
        """None of two survive is false when one of them may."""
        lost = Row("a", 4, 0, False, guaranteed={"delayed": 0}, refuted={"delayed": 1})
        open_ = replace(lost, network="b", refuted={"delayed": 3})
        unread = Row("c", error="c: is empty")
        assert headline(Survey((lost, lost), ("delayed",)), rb.Gate()).startswith("None of 2 networks survive")
        assert headline(Survey((lost, open_), ("delayed",)), rb.Gate()).startswith("Of 2 networks none was shown to su")
        one = headline(Survey((open_, unread), ("delayed",), missing=("d", "e")), rb.Gate())
        assert one.startswith("Whether the one network that was read survives 1 malicious node")
        assert one.endswith(" 1 could not be read. 2 were not reached.")

    def test_all_pass(self) -> None:
        graphs = {"a": nx.complete_graph(7), "b": nx.complete_graph(8)}
        text = Tags(rb.report(graphs, gate=rb.Gate(r=3), models=["malicious"], pictures=False).html).text
        assert "Both networks are 3-robust." in text

    def test_a_limit_and_a_file_that_cannot_be_read_are_said(self, tmp_path: Path) -> None:
        (tmp_path / "broken.json").write_text("{")
        made = rb.report([tmp_path / "broken.json"], gate=rb.Gate(survive=1), pictures=False)
        assert "The network must survive 1 malicious node under every threat model; it could not be read." in made.html
        cut = rb.report({"a": nx.complete_graph(4)}, total_time_limit=1e-9, gate=rb.Gate(survive=1), pictures=False)
        assert "it was not reached: nothing is claimed." in cut.html

    @pytest.mark.parametrize(
        ("gates", "models", "words"),
        [
            (
                ["passed"],
                ["delayed"],
                "The network is 2-robust and survives 1 malicious node under the threat model delayed.",
            ),
            (["refuted"], [], "The network must be 2-robust and survive 1 malicious node under "),
            (
                ["passed"] * 3,
                ["delayed", "malicious"],
                "All 3 networks are 2-robust and survive 1 malicious node under the threat models "
                "delayed and malicious.",
            ),
            (["passed", "refuted"], [], "1 of 2 networks is 2-robust and survives"),
            (["refuted", "error", "error"], [], "Of 3 networks none was shown to be 2-robust and survive"),
            (["refuted", "undecided"], [], "Of 2 networks none was shown to be 2-robust and survive 1 malicious"),
            (["refuted", "refuted"], [], "None of 2 networks are 2-robust and survive 1 malicious"),
            (["passed", "missing"], [], "; 1 was not reached: nothing is claimed about it."),
            (["missing", "missing"], [], "survive 1 malicious node under every threat model; 2 were not reached: "),
            (["refuted", "error", "error"], [], "; 1 fails, with a counterexample; 2 could not be read."),
            (
                ["passed", "undecided", "refuted", "refuted"],
                [],
                "; 2 fail, each with a counterexample; 1 was not decided within the limit: nothing is claimed about "
                "it.",
            ),
        ],
    )
    def test_numbers_and_models_are_told_as_they_are(self, gates: list[str], models: list[str], words: str) -> None:
        asked = tuple(models or THREAT_MODELS)
        rows = tuple(Row(str(k), gate=gate) for k, gate in enumerate(gates) if gate != "missing")
        found = Survey(rows, asked, missing=("late",) * gates.count("missing"))
        told = headline(found, rb.Gate(r=2, survive=1))
        assert words in told
        assert ("under every threat model" in told) == (not models)

    @pytest.mark.parametrize(
        ("guaranteed", "refuted", "words"),
        [
            (0, 1, "It survives no malicious node."),
            (2, 3, "It survives 2 malicious nodes."),
            (1, 3, "It survives at least 1 malicious node; how many more is not known."),
            (-1, 0, "It does not even agree when nobody lies."),
            (-1, 1, "That it agrees at all was not proven."),
        ],
    )
    def test_no_more_is_said_than_is_known(self, guaranteed: int, refuted: int, words: str) -> None:
        row = Row("x", 5, 8, False, 1, 1, 1, 1, {"delayed": guaranteed}, {"delayed": refuted})
        assert words in in_words(row, ["delayed"])


class TestShown:
    def test_short_in_a_prompt_and_data_on_request(self, made: Report) -> None:
        assert repr(made).startswith("<Report: 4 networks, refuted, ")
        assert repr(made.survey) == "<Survey: 4 networks, refuted>"
        assert str(made) == str(made.survey)
        assert made.as_dict() == made.survey.as_dict()


class TestMending:
    def test_what_a_network_lacks_is_proposed_and_what_passes_gets_nothing(self) -> None:
        graphs = {"path": nx.path_graph(5), "complete": nx.complete_graph(5)}
        made = rb.report(graphs, gate=rb.Gate(r=2), models=["malicious"], pictures=False)
        parts = made.html.split("<details class='network'")
        found = rb.mend(nx.path_graph(5), 2)
        links = f"{len(found.links)} more link{'s' * (len(found.links) != 1)}"
        assert f"With {links} it is 2-robust. Fewer do not suffice: this is proven." in parts[1]
        assert "What would mend it" not in parts[2]

    def test_without_a_gate_it_is_one_more_r(self) -> None:
        graphs = {"cycle": nx.cycle_graph(5), "small": nx.complete_graph(3)}
        made = rb.report(graphs, models=[], pictures=False)
        first, second = made.html.split("<details class='network'")[1:]
        assert "it is 2-robust" in first
        assert "No further links between these nodes" in second

    def test_none_on_request_and_bad_limits_are_refused(self) -> None:
        assert "What would mend it" not in rb.report({"a": nx.cycle_graph(5)}, mending=0, pictures=False).html
        with pytest.raises(rb.InvalidParameter, match="seconds of at least 0, not -1"):
            rb.report({"a": nx.cycle_graph(5)}, mending=-1, pictures=False)


class TestBounds:
    @pytest.mark.parametrize(
        ("row", "cell"),
        [
            (Row("x", r=2, r_at_most=2), "<td class='number' data-value='2'>2</td>"),
            (Row("x", r=2, r_at_most=4), "<td class='number' data-upper='4' data-value='2'>2..4</td>"),
            (Row("x", r=2), "<td class='number' data-upper='' data-value='2'>&gt;=2</td>"),
            (Row("x"), "<td class='number' data-value=''>?</td>"),
        ],
    )
    def test_a_cell_has_both_ends(self, row: Row, cell: str) -> None:
        assert cell in report_of(Survey((row,), ()), {}).html

    @pytest.mark.parametrize(
        ("names", "groups"),
        [
            (["a/1", "a/2", "b/1"], ["a", "b"]),
            (["a/1", "a/2"], []),
            (["a/1", "b/1"], []),
            (["a/1", "a/2", "b"], []),
            (["/home/1", "/home/2", "b/1"], []),
            ([NASTY + "/1", NASTY + "/2", "b/1"], [NASTY.partition("/")[0], "b"]),
        ],
    )
    def test_collections_are_offered_where_names_have_them(self, names: list[str], groups: list[str]) -> None:
        made = report_of(Survey(tuple(map(Row, names)), ()), {})
        options = re.findall(r"<option>(.*?)</option>", made.html)
        assert [unescape(each) for each in options] == groups
        assert Tags(made.html).open == []


class TestSafety:
    def test_tags_nest_and_labels_are_data(self, made: Report) -> None:
        page = Tags(made.html)
        assert page.open == []
        assert [tag for tag, _ in page.tags].count("script") == 1
        assert not [name for _, attributes in page.tags for name in attributes if name.startswith("on")]
        assert NASTY in page.text

    def test_loads_nothing(self, made: Report) -> None:
        for tag, attributes in Tags(made.html).tags:
            for name in ("src", "href", "action", "data", "xlink:href"):
                address = attributes.get(name)
                assert address is None or address.startswith(("#", "data:")), (tag, address)
        assert re.findall(r"url\((?!#)|@import|https?://", made.html) == []

    def test_the_same_networks_give_the_same_page(self) -> None:
        graphs = {"wheel": nx.wheel_graph(5)}
        first, second = (re.sub(r"data-value='[\d.]+'>[\d.]+<", "", rb.report(graphs).html) for _ in range(2))
        assert first == second


class TestState:
    """A journal holds what a page shows, so a page that was killed becomes the page that it would have been."""

    @staticmethod
    def page_of(state: Path | None, **how: Any) -> str:
        made = rb.report(networks(), gate=rb.Gate(survive=1), models=["malicious"], state=state, **how)
        return re.sub(r"data-value='[\d.]+'>[\d.]+<", "", made.html)

    def test_what_is_kept_is_not_found_out_again(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        fresh, plain = self.page_of(None), self.page_of(None, pictures=False)
        state = tmp_path / "state"
        assert self.page_of(state, jobs=2) == fresh
        monkeypatch.setattr("robustness.surveying.front.measure", lambda *_: 1 / 0)
        assert self.page_of(state) == fresh
        assert self.page_of(state, pictures=False) == plain

    def test_what_a_journal_lacks_for_a_page_is_asked_anew(self, tmp_path: Path) -> None:
        fresh, state = self.page_of(None), tmp_path / "state"
        rb.survey(networks(), gate=rb.Gate(survive=1), models=["malicious"], state=state, mending=5.0)
        self.page_of(state, pictures=False)
        assert state.read_bytes().count(b"\n") == 8
        assert self.page_of(state) == fresh
        assert state.read_bytes().count(b"\n") == 12
        assert self.page_of(state) == fresh
        assert state.read_bytes().count(b"\n") == 12

    @pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGINT])
    def test_a_killed_run_goes_on_where_it_was(self, ending: signal.Signals, tmp_path: Path) -> None:
        nets, state, page = tmp_path / "nets", tmp_path / "state", tmp_path / "page.html"
        nets.mkdir()
        for k in range(3):
            write_topology(nx.gnp_random_graph(9, 0.4, seed=k), nets / f"{k}.json")
        write_topology(nx.random_regular_graph(20, 90, seed=1), nets / "9.json")
        asked = ["report", str(nets), "--no-models", "--mending", "1", "--state", str(state), "-o", str(page)]
        with subprocess.Popen(
            [sys.executable, "-m", "cli", *asked],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parent.parent)},
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        ) as process:
            while not state.exists() or state.read_bytes().count(b"\n") < 3:
                assert process.poll() is None
                time.sleep(0.05)
            process.send_signal(ending)
            process.wait(timeout=60)
        assert page.exists() == (ending is signal.SIGINT)
        (nets / "9.json").unlink()
        before = state.read_bytes()
        done = CliRunner().invoke(robustness, asked)
        assert (done.exit_code, state.read_bytes()) == (0, before)
        pictures = [tag for tag, attributes in Tags(page.read_text(encoding="utf-8")).tags if tag == "figure"]
        assert len(pictures) == 3


class TestCommand:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        for name, graph in (("wheel", nx.wheel_graph(5)), ("complete", nx.complete_graph(7))):
            write_topology(graph, tmp_path / f"{name}.json")
        return tmp_path

    def run(self, *arguments: object) -> Result:
        return CliRunner().invoke(robustness, ["report", *map(str, arguments)])

    def test_page_certificates_and_the_worst_exit_code(self, folder: Path) -> None:
        page = folder / "out" / "report.html"
        page.parent.mkdir()
        done = self.run(folder, "-o", page, "--require", 1, "--certificates", folder / "out" / "certs")
        assert done.exit_code == 10, done.output
        text = page.read_text(encoding="utf-8")
        (command,) = {line for line in re.findall(r"<code>(python -I -m [^<]*)</code>", text) if "complete" in line}
        words = command.replace("&#x27;", "'").split()
        checked = subprocess.run([sys.executable, *words[1:]], capture_output=True, text=True, check=False)
        assert checked.returncode == 0, checked.stderr
        assert self.run(folder / "complete.json", "-o", page, "--require", 1, "--no-pictures").exit_code == 0

    @pytest.mark.parametrize("option", ["-o", "--state"])
    def test_no_page_over_an_input(self, option: str, folder: Path) -> None:
        done = self.run(folder / "wheel.json", "-o", folder / "page.html", option, folder / "wheel.json")
        assert done.exit_code == 2
        assert rb.read_topology(folder / "wheel.json").n == 5

    def test_ctrl_c_leaves_a_page_with_what_is_finished(self, folder: Path) -> None:
        write_topology(nx.gnp_random_graph(90, 0.5, seed=1), folder / "hard.json")
        page = folder / "page.html"
        names = [folder / "complete.json", folder / "hard.json"]
        program = [sys.executable, "-m", "cli", "report", *names, "-o", page, "--no-pictures", "--mending", "0"]
        program += ["--certificates", folder]
        process = subprocess.Popen(
            [*map(str, program)],
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parent.parent)},
        )
        while not list(folder.glob("complete*.cert")):  # the other one takes hours
            assert process.poll() is None
            time.sleep(0.1)
        time.sleep(3)  # the row follows its certificate at once
        process.send_signal(signal.SIGINT)
        _, talk = process.communicate(timeout=60)
        assert process.returncode == 130, talk
        assert "interrupted" in talk
        assert "complete.json" in page.read_text(encoding="utf-8")
