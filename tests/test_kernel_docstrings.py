"""Every kernel takes few arguments, and says shape and type of each array as its ``.pxd`` declares them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parent.parent / "robustness" / "kernels"
KERNELS = sorted(path.stem for path in FOLDER.glob("*.pxd") if path.stem != "words")

#: More than this belongs into a named tuple or an object.
MOST_ARGUMENTS = 12

TYPES = {
    "word": "uint64",
    "number": "int64",
    "long long": "int64",
    "int": "int32",
    "signed char": "int8",
    "unsigned char": "uint8",
    "double": "float64",
}
ARRAY = r"(?:const )?(word|number|long long|int|signed char|unsigned char|double)\[([:, 1]+)\] "
ARGUMENT, ATTRIBUTES = re.compile(ARRAY + r"(\w+)"), re.compile(ARRAY + r"(\w+(?:, \w+)*)$", re.MULTILINE)
DECLARATION = re.compile(r"^( *)cp?def (?:(?:\([^)]*\) |[\w ]+ )?(\w+)\(([^)]*)\)|class (\w+):|(.*\[.*))", re.MULTILINE)
SAID = re.compile(r"^\s*(\w+(?:, \w+)*) : arrays? of (\w+), shape \(([^)]*)\)$", re.MULTILINE)

Arrays = dict[str, tuple[str, int]]


def declared(pattern: re.Pattern[str], text: str) -> Arrays:
    """Return type and number of dimensions of the arrays that a piece of a .pxd declares."""
    return {
        name: (TYPES[kind], 1 + shape.count(","))
        for kind, shape, names in pattern.findall(text)
        for name in names.split(", ")
    }


def said(docstring: str | None) -> Arrays:
    """Return the same of the arrays that a docstring describes."""
    return {
        name: (kind, len([length for length in shape.split(",") if length.strip()]))
        for names, kind, shape in SAID.findall(docstring or "")
        for name in names.split(", ")
    }


def functions(tree: ast.AST) -> Iterator[tuple[str, ast.FunctionDef, str | None]]:
    """Yield the path of every function, the function, and the docstring of its class, if it has one."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef):
            yield node.name, node, None
        elif isinstance(node, ast.ClassDef):
            for each in node.body:
                if isinstance(each, ast.FunctionDef):
                    yield f"{node.name}.{each.name}", each, ast.get_docstring(node)


def without_locals(types: str) -> str:
    """Return a .pxd without the types of local variables."""
    return re.sub(r"@cython\.locals\([^)]*\)", "", types)


def declarations(types: str) -> dict[str, Arrays]:
    """Return the arrays of every function of a .pxd (``name``, ``Class.name``) and class (``Class``)."""
    found: dict[str, Arrays] = {}
    owner = ""
    for indent, function, arguments, named, attributes in DECLARATION.findall(without_locals(types)):
        if named:
            owner, found[named] = named, {}
        elif function:
            found[f"{owner}.{function}" if indent else function] = declared(ARGUMENT, " ".join(arguments.split()))
        elif indent:
            found[owner] |= declared(ATTRIBUTES, attributes)
    return found


def problems(source: str, types: str) -> Iterator[str]:
    """Yield what is missing or wrong in the docstrings of a kernel."""
    tree = ast.parse(source)
    arrays = declarations(types)
    docstrings = {path: said(around) | said(ast.get_docstring(node)) for path, node, around in functions(tree)}
    docstrings |= {node.name: said(ast.get_docstring(node)) for node in tree.body if isinstance(node, ast.ClassDef)}
    for path, expected in arrays.items():
        for name, kind in expected.items():
            if docstrings[path].get(name) != kind:
                yield f"{path}: {name} is {kind}, and the docstring says {docstrings[path].get(name)}"
    for path, node, _ in functions(tree):
        taken = [argument for argument in (*node.args.posonlyargs, *node.args.args) if argument.arg != "self"]
        if len(taken) > MOST_ARGUMENTS:
            yield f"{path} takes {len(taken)} arguments"


@pytest.mark.parametrize("kernel", KERNELS)
def test_arrays_are_described_as_they_are_declared(kernel: str) -> None:
    source, types = ((FOLDER / f"{kernel}{ending}").read_text(encoding="utf-8") for ending in (".py", ".pxd"))
    assert list(problems(source, types)) == []


@pytest.mark.parametrize("kernel", KERNELS)
def test_no_array_is_overlooked(kernel: str) -> None:
    types = without_locals((FOLDER / f"{kernel}.pxd").read_text(encoding="utf-8"))
    attributes = re.findall(r"^    cdef [^(\n]*\[[^(\n]*$", types, re.MULTILINE)
    more = sum(line.count(",") - re.findall(r"\[[:, 1]+\]", line)[0].count(",") for line in attributes)
    assert sum(map(len, declarations(types).values())) == len(re.findall(r"\[[:, 1]+\]", types)) + more


@pytest.mark.parametrize(
    ("docstring", "problem"),
    [
        ("No shape.", "says None"),
        ("x : array of int32, shape (n,)", "says ('int32', 1)"),
        ("x : array of float64, shape (n, 2)", "says ('float64', 2)"),
        ("x : array of float64, shape (n,)", None),
    ],
)
def test_a_wrong_docstring_is_found(docstring: str, problem: str | None) -> None:
    source = f'def go(x):\n    """{docstring}"""\n'
    found = list(problems(source, "cpdef go(double[::1] x)\n"))
    assert [problem in each for each in found] == [True] if problem else found == []


def test_many_arguments_are_found() -> None:
    source = f"def go({', '.join(f'x{i}' for i in range(13))}):\n    pass\n"
    assert list(problems(source, "")) == ["go takes 13 arguments"]
