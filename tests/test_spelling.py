"""Words: ``tests/spelling.txt`` is kept, and every docstring says something. Run by ``make lint`` as well."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
LIST = ROOT / "tests" / "spelling.txt"
RULES = dict(
    line.split(" -> ") for line in LIST.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")
)
WRONG = re.compile(
    rf"(?<![\w.-])({'|'.join(map(re.escape, sorted(RULES, key=len, reverse=True)))})(?![\w-])", re.IGNORECASE
)
FOLDERS = ("robustness", "certificates", "cli", "docs", "tests", "benchmarks", "examples")
TEXTS = sorted(
    path
    for folder in FOLDERS
    for kind in ("*.py", "*.md")
    for path in (ROOT / folder).rglob(kind)
    if not {"python-api", "__pycache__", "_build"} & set(path.parts)
) + sorted(ROOT.glob("*.md"))


def slips(text: str) -> list[str]:
    """Return what is written wrongly, with what is meant."""
    return [f"{found}: write {RULES[found.lower()]}" for found in WRONG.findall(text) if found.lower() in RULES]


def test_the_list_is_in_order_and_finds_what_it_lists() -> None:
    assert list(RULES) == sorted(RULES)
    assert not set(RULES) & set(RULES.values())
    for wrong, right in RULES.items():
        assert slips(f"a {wrong} here") == [f"{wrong}: write {right}"]
        assert not slips(f"a {right} here")


def test_every_text_is_spelled_as_listed() -> None:
    assert len(TEXTS) > 300
    found = {}
    for path in TEXTS:
        wrong = slips(path.read_text(encoding="utf-8")) if path != Path(__file__) else []
        if wrong:
            found[str(path.relative_to(ROOT))] = wrong
    assert not found


@pytest.mark.parametrize("package", ["robustness", "certificates", "cli"])
def test_every_docstring_says_something(package: str) -> None:
    """A word alone, or a value, is no definition: ``1.`` does not say of what."""
    mute = []
    for path in sorted((ROOT / package).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                text = ast.get_docstring(node)
                if text is not None and len(re.findall(r"[A-Za-z]{2,}|``.+?``|`.+?`", text)) < 2:
                    mute.append(f"{path.relative_to(ROOT)}: {text!r}")
    assert not mute


def test_every_path_in_the_documents_exists() -> None:
    named = re.compile(
        r"(?<![\w/.])((?:robustness|certificates|cli|tests|benchmarks|examples|docs)/[\w/-]+\.(?:py|md|pxd|txt))\b"
    )
    pages = [
        *(ROOT / "docs").glob("*.md"),
        *(ROOT / "docs" / "adr").glob("*.md"),
        ROOT / "CONTRIBUTING.md",
        ROOT / "README.md",
    ]
    gone = {
        f"{page.name}: {place}"
        for page in pages
        for place in named.findall(page.read_text(encoding="utf-8"))
        if not (ROOT / place).exists()
    }
    assert not gone


@pytest.mark.parametrize("package", ["robustness", "certificates", "cli"])
def test_no_sentence_runs_on_in_the_next_attribute(package: str) -> None:
    """Each parameter and attribute is described by sentences of its own, since each is looked up alone."""
    run_on = []
    for path in sorted((ROOT / package).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                lines = [line.strip() for line in (ast.get_docstring(node) or "").splitlines()]
                code = [line.startswith((">>>", "...")) for line in lines]
                for line, before, is_code in zip(lines[1:], code, code[1:], strict=False):
                    if (line.endswith(" ...") and not is_code) or (re.match(r"\.\.\. [a-z]", line) and not before):
                        run_on.append(f"{path.relative_to(ROOT)}: {line}")
    assert not run_on
