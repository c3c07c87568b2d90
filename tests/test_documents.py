"""Output that the documents show is output that the commands give.

A fenced block under ``<!-- output of: COMMAND | COMMAND -->`` is what those commands print in a folder with the
examples; times are left as they stand. ``python tests/test_documents.py`` writes the blocks anew.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from html import unescape
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(
    r"^<!-- output of: (?P<commands>.*?) -->\n```(?P<language>\w*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL
)
SHOWN = [(page, match) for page in PAGES for match in BLOCK.finditer(page.read_text(encoding="utf-8"))]
#: What differs from run to run: times.
VARIABLE = re.compile(r'("seconds": |seconds +|time +|in )[0-9.e-]+( s)?')


def test_every_picture_has_a_command_that_makes_it() -> None:
    """``make figures`` names each picture of the documents, or the folder that a program fills with it."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    target = re.search(r"^figures:.*\n((?:\t.*\n)+)", makefile, re.MULTILINE)
    assert target is not None
    programs = (path.read_text(encoding="utf-8") for path in (ROOT / "examples").glob("*.py"))
    fills_docs = "\n".join(text for text in programs if "docs/figures\n" in text)
    pictures = [path for path in (ROOT / "docs" / "figures").rglob("*") if path.is_file()]
    assert len(pictures) > 20
    for path in pictures:
        name = str(path.relative_to(ROOT))
        folder = re.search(rf" {path.parent.relative_to(ROOT)}\n", target[1]) is not None
        is_audit = path.parent.name == "audit" and "robustness.paper.audit docs" in target[1]
        assert name in target[1] or is_audit or (folder and (path.parent.name == "paper" or path.name in fills_docs)), (
            name
        )


def output(commands: str) -> str:
    """Return what a pipeline of our commands prints, in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        said = b""
        shutil.copytree(ROOT / "examples", Path(folder) / "examples")
        for command in commands.split(" | "):
            program, *arguments = shlex.split(command)
            assert program == "robustness"
            command_line = [sys.executable, "-m", "cli", *arguments]
            wide = {**os.environ, "COLUMNS": "100"}
            done = subprocess.run(
                command_line, input=said, cwd=folder, capture_output=True, timeout=120, check=False, env=wide
            )
            assert done.returncode in (0, 10, 30), done.stderr.decode()
            said = done.stdout
    return said.decode()


def as_shown(commands: str, language: str) -> str:
    """Return the output as a page shows it: JSON with a key a line, what is nested on one line."""
    text = output(commands)
    if language != "json":
        return text
    rows = [f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in json.loads(text).items()]
    return "{\n" + ",\n".join(rows) + "\n}\n"


def lasting(text: str) -> str:
    return VARIABLE.sub(r"\1*", text)


def test_there_are_blocks() -> None:
    assert SHOWN
    unmarked = [page.name for page in PAGES if re.search(r"(?<!-->\n)```json\n", page.read_text(encoding="utf-8"))]
    assert unmarked == []
    after_a_command = re.compile(r"^robustness .*\n```\n\n```text\n", re.MULTILINE)
    # The tutorial is one session, which tests/tolerance/test_documentation.py runs as a whole.
    pages = [page.name for page in PAGES if after_a_command.search(page.read_text(encoding="utf-8"))]
    assert pages == ["tutorial-platoon.md"]


@pytest.mark.parametrize(("page", "match"), SHOWN, ids=lambda value: getattr(value, "name", None))
def test_the_block_is_what_the_commands_print(page: Path, match: re.Match[str]) -> None:
    assert lasting(match["text"]) == lasting(as_shown(match["commands"], match["language"]))


def test_the_first_screen_prints_what_it_shows() -> None:
    page = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    code, shown = re.findall(r"^```(?:python|text)\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    assert sum(map(bool, code.splitlines())) == 3
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout == shown


def test_every_reference_has_an_address_that_lasts() -> None:
    text = (ROOT / "docs" / "references.md").read_text(encoding="utf-8")
    entries = re.split(r"^\d+\. ", text, flags=re.MULTILINE)[1:]
    assert len(entries) > 5
    assert [each for each in entries if not re.search(r"https://(doi\.org/10|arxiv\.org/abs)", each)] == []


def test_users_and_developers_have_pages_of_their_own() -> None:
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    assert re.findall(r":caption: (.*)", index) == ["Tutorials", "How to", "Why it is true", "Reference"]
    assert "adr" not in index


def test_the_atlas_is_whole() -> None:
    rows = [json.loads(line) for line in (ROOT / "docs" / "atlas.jsonl").read_text(encoding="utf-8").splitlines()]
    names = [row["network"] for row in rows]
    assert len(names) == len(set(names))
    assert sum(name.startswith("topohub:") for name in names) == 707
    assert sum(name.startswith("census:") for name in names) == 1 + 2 + 6 + 21 + 112
    assert [row["network"] for row in rows if row["error"]] == []


def rewrite() -> None:
    """Write every block anew."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")

        def made(match: re.Match[str]) -> str:
            shown = as_shown(match["commands"], match["language"])
            if lasting(shown) == lasting(match["text"]):
                return match[0]
            return f"<!-- output of: {match['commands']} -->\n```{match['language']}\n{shown}```"

        page.write_text(BLOCK.sub(made, text), encoding="utf-8")


if __name__ == "__main__":
    rewrite()


def test_formulas_are_written_with_letters_that_common_fonts_have() -> None:
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        from mathml import mathml_of  # type: ignore[import-not-found]
    finally:
        sys.path.pop(0)
    formulas = [
        formula
        for page in PAGES
        for formula in re.findall(r"(?<!\\)\$\$?([^$\n]+?)\$\$?", page.read_text(encoding="utf-8"))
    ]
    assert len(formulas) > 300
    assert "<mo>\u2216</mo>" in unescape(mathml_of(r"A \setminus B"))
    # Letters, Latin to Greek; punctuation, letterlike signs, arrows, operators and brackets of the basic blocks.
    basic = re.compile(r"[\x20-\x7e\n\u00a0-\u03ff\u2010-\u2064\u2100-\u21ff\u2200-\u22ff\u2308-\u230b]*")
    for formula in formulas:
        shown = unescape(re.sub("<[^>]*>", "", mathml_of(formula)))
        assert basic.fullmatch(shown), (formula, shown)


def test_long_lines_of_code_are_wrapped() -> None:
    settings = (ROOT / "docs" / "conf.py").read_text(encoding="utf-8")
    (name,) = re.findall(r'html_css_files = \["(.*?)"\]', settings)
    rules = (ROOT / "docs" / "_static" / name).read_text(encoding="utf-8")
    assert re.search(r"\.highlight pre[^{]*\{[^}]*white-space: pre-wrap", rules)


def test_no_page_of_users_shows_a_table_of_hundreds_of_rows_unfolded() -> None:
    for page in PAGES:
        text = re.sub(r"<details>.*?</details>", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        longest = max((table.count("\n") for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)), default=0)
        assert longest < 100, (page.name, longest)


def test_whoever_reads_of_the_paper_learns_which() -> None:
    title = "Resilient Coordinated Movement of Connected Autonomous Vehicles"
    pages = {page: " ".join(page.read_text(encoding="utf-8").split()) for page in PAGES}
    speaking = {page: text for page, text in pages.items() if re.search(r"\b([Ss]ource|[Tt]he) paper\b", text)}
    assert len(speaking) > 5
    for page, text in speaking.items():
        assert title in text or "references.md" in text, page.name
    for page in ("README.md", "references.md", "glossary.md", "lemma-1.md", "paper-audit.md", "paper-experiments.md"):
        assert any(title in text for path, text in pages.items() if path.name == page), page
    shown = subprocess.run(
        [sys.executable, "-m", "cli", "simulate", "--help"], capture_output=True, text=True, check=True
    )
    assert title in " ".join(shown.stdout.split())
    assert title in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_no_line_of_code_ends_within_an_option() -> None:
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        from whole_words import kept_whole  # type: ignore[import-not-found]
    finally:
        sys.path.pop(0)
    page = "<p>a-b</p><pre class='x'><span>mend g.json --cost 1</span> &lt;di-yuan --state\n" + "y" * 40 + "-z</pre>"
    changed = kept_whole(page)
    whole = re.findall(r"<span class='whole'>(.*?)</span>", changed)
    assert whole == ["--cost", "di-yuan", "--state"]
    assert re.sub(r"<span class='whole'>(.*?)</span>", r"\1", changed) == page
    assert '"whole_words"' in (ROOT / "docs" / "conf.py").read_text(encoding="utf-8")
    assert ".whole { white-space: nowrap; }" in (ROOT / "docs" / "_static" / "wrapped.css").read_text(encoding="utf-8")
