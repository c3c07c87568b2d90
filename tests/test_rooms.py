"""The rooms of the house: arrows between them run one way, nobody reaches for a neighbour's private names, all fit."""

from __future__ import annotations

import ast
import graphlib
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("robustness", "certificates", "cli")
FILES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for path in FILES
    if path.name != "__main__.py"
}

#: Lines that a file and a function may have; a longer one does more than one thing.
MOST_LINES, MOST_LINES_OF_A_FUNCTION = 450, 80

#: Which code the kernels run as is decided when they are first imported, before any of them is.
BUSY_PACKAGES = {"robustness", "robustness/kernels"}

#: A file name that two rooms use is a word of the house, with one meaning in all of them.
WORDS_OF_THE_HOUSE = {
    "__init__": "the names of the room",
    "__main__": "what python -m runs",
    "front": "the public function of the room",
    "results": "what the front returns",
    "ladder": "what settles a question, in order",
    "shortcuts": "what settles a question without a search",
    "question": "what is asked, and the definition that an answer is checked against",
    "exhaustive": "the definition tried out",
    "cp_sat": "the question as a programme for CP-SAT",
    "certification": "from an answer to a certificate",
    "errors": "the exceptions of the package",
    "growth": "a robust seed from which all nodes grow",
    "joint": "joint robustness over windows, in the kernel, on the command line and in a figure",
    "tolerance": "what a network tolerates, in the kernel and on the command line",
    "mending": "links that reach a goal, in the kernel and on the command line",
    "registry": "a table of names that users type",
    "wording": "sentences about the room's results",
    "page": "the page that the room writes",
}


def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def imported(path: Path) -> Iterator[tuple[str, str]]:
    """Yield (module, name) for what a file takes from ours when it is imported or run, or for types alone."""
    pending: list[ast.AST] = [tree(path)]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            prefix = "cli." if node.level else ""
            for alias in node.names:
                whole = f"{prefix}{node.module}.{alias.name}"
                yield (whole, "") if whole in MODULES else (f"{prefix}{node.module}", alias.name)
        pending.extend(ast.iter_child_nodes(node))


def room(module: str) -> str:
    """Return the room a module is in: a folder of ``robustness``, a file beside the folders, or a whole package."""
    parts = module.split(".")
    return ".".join(parts[:2]) if parts[0] == "robustness" else parts[0]


def test_arrows_between_rooms_run_one_way() -> None:
    arrows: dict[str, set[str]] = defaultdict(set)
    for module, path in MODULES.items():
        if module == "robustness":
            continue  # hands on the names of all rooms, and loads none before a name is asked for
        for target, _ in imported(path):
            if target.split(".")[0] in PACKAGES and room(target) != room(module):
                arrows[room(module)].add(room(target))
    # Raises CycleError, which names the rooms of the circle.
    assert list(graphlib.TopologicalSorter(arrows).static_order())


def test_modules_form_no_circle() -> None:
    arrows: dict[str, set[str]] = defaultdict(set)
    for module, path in MODULES.items():
        if path.name == "__init__.py":
            continue
        arrows[module] = {target for target, _ in imported(path) if target in MODULES} - {module}
    assert list(graphlib.TopologicalSorter(arrows).static_order())


@pytest.mark.parametrize("package", PACKAGES)
def test_nobody_takes_a_private_name(package: str) -> None:
    taken = {
        f"{path.relative_to(ROOT)}: {target}.{name}"
        for path in FILES
        if path.is_relative_to(ROOT / package)
        for target, name in imported(path)
        if target.split(".")[0] in PACKAGES
        if any(part.startswith("_") and not part.startswith("__") for part in (*target.split("."), name))
    }
    assert not taken


def test_files_fit_a_head() -> None:
    files = [*FILES, *(ROOT / "tests").rglob("*.py"), *(ROOT / "benchmarks").rglob("*.py")]
    long = {path.name: n for path in files if (n := len(path.read_text(encoding="utf-8").splitlines())) > MOST_LINES}
    assert not long


def test_functions_fit_a_screen() -> None:
    """Lines of code: docstrings, which are as long as the definition takes, do not count."""
    long = {}
    for path in FILES:
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                first = node.body[1] if ast.get_docstring(node) is not None and len(node.body) > 1 else node.body[0]
                lines = (node.end_lineno or 0) - first.lineno + 1
                if lines > MOST_LINES_OF_A_FUNCTION:
                    long[f"{path.relative_to(ROOT)}:{node.name}"] = lines
    assert not long


def test_a_package_holds_names_only() -> None:
    """``__init__.py`` imports and lists; the registries of plain names are data and may stand there."""
    allowed = ast.Import | ast.ImportFrom | ast.Expr | ast.Assign | ast.AnnAssign | ast.If
    busy = {
        str(path.relative_to(ROOT))
        for path in FILES
        if path.name == "__init__.py" and str(path.parent.relative_to(ROOT)) not in BUSY_PACKAGES
        if not all(isinstance(node, allowed) for node in tree(path).body)
    }
    assert not busy


def test_a_file_name_has_one_meaning() -> None:
    places: dict[str, list[str]] = defaultdict(list)
    for path in FILES:
        places[path.stem].append(str(path.relative_to(ROOT)))
    twice = {stem: found for stem, found in places.items() if len(found) > 1 and stem not in WORDS_OF_THE_HOUSE}
    assert not twice
