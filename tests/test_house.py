"""The rules of the house: what the wheel holds, which way the arrows point, and that the lock file is whole."""

from __future__ import annotations

import ast
import configparser
import email
import importlib.metadata
import io
import itertools
import os
import re
import subprocess
import sys
import tokenize
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.markers import default_environment
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("robustness", "certificates", "cli")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LOCK = (ROOT / "requirements.lock").read_text(encoding="utf-8")
LOCKED = dict(re.findall(r"^([\w.-]+)==(\S+)", LOCK, flags=re.MULTILINE))


def sources(package: str) -> list[Path]:
    """Return the modules of ``package``, which exist."""
    found = sorted((ROOT / package).rglob("*.py"))
    assert found, f"no module in {package}"
    return found


def imports(path: Path, *, at_import: bool = False) -> Iterator[str]:
    """Yield the absolute names that ``path`` imports; with ``at_import`` only those run when it is imported."""
    pending: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            # The command line goes by two names, cli here and robustness.cli where it is installed, and uses neither.
            is_own = path.parent == ROOT / "cli" and (node.module or "") in {each.stem for each in sources("cli")}
            assert node.level == (1 if is_own else 0), f"{path}: imports are absolute, and within cli relative"
            yield from (f"{'cli.' if is_own else ''}{node.module}.{alias.name}" for alias in node.names)
        if at_import and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        if at_import and isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            pending.extend(node.orelse)
            continue
        pending.extend(ast.iter_child_nodes(node))


def lines_of(path: Path) -> tuple[int, int]:
    """Return the lines of code of a file, without comments and docstrings, and all its lines."""
    text = path.read_text(encoding="utf-8")
    code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.string.strip() and token.type != tokenize.COMMENT:
            code |= set(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            code -= set(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    return len(code), len(text.splitlines())


def place(path: Path) -> str:
    """Return where the wheel has a file: the folder cli is the package robustness.cli there."""
    inside = str(path.relative_to(ROOT))
    return f"robustness/{inside}" if inside.startswith("cli/") else inside


def run(*arguments: str, cwd: Path, **environment: str) -> str:
    """Run this Python with ``arguments``, expect success, and return what it wrote."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


class TestWheel:
    def test_holds_exactly_the_three_packages(self, wheel: Path) -> None:
        names = zipfile.ZipFile(wheel).namelist()
        assert {name.split("/")[0] for name in names if ".dist-info/" not in name} == {"robustness", "certificates"}
        modules = {place(path) for package in PACKAGES for path in sources(package)}
        markers = {place(ROOT / package / "py.typed") for package in PACKAGES}
        assert {name for name in names if name.endswith((".py", "py.typed"))} == modules | markers
        types = {str(path.relative_to(ROOT)) for path in (ROOT / "robustness" / "kernels").glob("*.pxd")}
        code = {name.partition(".")[0] for name in names if name.endswith((".so", ".pyd"))}
        assert {name for name in names if name.endswith(".pxd")} == types
        assert {path.rpartition(".")[0] for path in types} - {"robustness/kernels/words"} == code

    def test_names_the_command_and_the_dependencies(self, wheel: Path) -> None:
        with zipfile.ZipFile(wheel) as archive:
            (entry_points,) = (name for name in archive.namelist() if name.endswith("entry_points.txt"))
            parser = configparser.ConfigParser()
            parser.read_string(archive.read(entry_points).decode())
            metadata = email.message_from_bytes(archive.read(entry_points.replace("entry_points.txt", "METADATA")))
        assert dict(parser["console_scripts"]) == {"robustness": "robustness.__main__:main"}
        assert metadata["Name"] == "graph-robustness"
        assert metadata["Requires-Python"] == ">=3.11"
        requirements = [Requirement(text) for text in metadata.get_all("Requires-Dist", [])]
        assert {each.name for each in requirements if each.marker is None} == {
            "networkx",
            "numpy",
            "ortools",
            "click",
        }
        assert set(metadata.get_all("Provides-Extra", [])) == {
            "plot",
            "topologies",
            "formats",
            "cluster",
            "testing",
            "dev",
        }

    def test_works_with_the_sources_out_of_reach(self, wheel: Path, tmp_path: Path) -> None:
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(tmp_path)
        program = (
            "import robustness.cli, certificates as c\nprint(*(p.__file__ for p in (robustness, c, robustness.cli)))"
        )
        places = run("-c", program, cwd=tmp_path, PYTHONPATH=str(tmp_path)).split()
        assert places == [str(tmp_path / place(ROOT / package / "__init__.py")) for package in PACKAGES]


class TestArrows:
    """cli -> robustness -> certificates -> the standard library, and never back."""

    @pytest.mark.parametrize(
        ("package", "allowed"),
        [
            ("certificates", {"certificates"}),
            ("robustness", {"robustness", "certificates"}),
            ("cli", {"cli", "robustness", "certificates"}),
        ],
    )
    def test_one_way(self, package: str, allowed: set[str]) -> None:
        ours = {*PACKAGES, "tests", "benchmarks", "examples", "docs"}
        for path in sources(package):
            wrong = {name for name in imports(path) if name.split(".")[0] in ours - allowed}
            assert not wrong, f"{path.relative_to(ROOT)} imports {wrong}"

    def test_the_kernel_needs_the_standard_library_alone(self) -> None:
        for path in sources("certificates"):
            foreign = {name.split(".")[0] for name in imports(path)} - sys.stdlib_module_names - {"certificates"}
            assert not foreign, f"{path.relative_to(ROOT)} imports {foreign}"

    def test_the_layers_of_the_kernel_call_those_above_them(self) -> None:
        """As docs/trust.md lists them, with sizes in lines of code and in all."""
        text = (ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
        table = re.findall(r"^\| [^|`]*\(((?:`\w+`(?:, )?)+)\) \| (\d+) \| ([\d,]+) \|$", text, re.MULTILINE)
        parts = re.findall(r"^\| `(\w+)` \| [^|]* \| (\d+) \| (\d+) \|$", text, re.MULTILINE)
        above: set[str] = set()
        for names, *sizes in table:
            layer = re.findall(r"\w+", names)
            above |= {f"certificates.{name}" for name in layer}
            files = [ROOT / "certificates" / f"{name}.py" for name in layer]
            for path in files:
                ours = {name.rpartition(".")[0] for name in imports(path) if name.startswith("certificates.")}
                assert ours <= above, f"{path.name} imports from {ours - above}, a layer below it"
            for said, lines in zip(sizes, zip(*map(lines_of, files), strict=True), strict=True):
                assert abs(int(said.replace(",", "")) - sum(lines)) <= 10, f"{names}: {sum(lines)} lines"
        assert {f"certificates.{path.stem}" for path in sources("certificates")} - above == {"certificates.__init__"}
        assert [name for name, *_ in parts] == re.findall(r"\w+", table[0][0])
        for name, *sizes in parts:
            for said, lines in zip(sizes, lines_of(ROOT / "certificates" / f"{name}.py"), strict=True):
                assert abs(int(said) - lines) <= 5, f"{name}: {lines} lines"

    def test_the_kernel_runs_on_a_bare_python(self, tmp_path: Path) -> None:
        modules = [
            ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
            for path in sources("certificates")
            if path.stem != "__main__"
        ]
        # -S: without site-packages, so a third-party import fails.
        program = f"import importlib; [importlib.import_module(name) for name in {modules!r}]; print('imported')"
        assert run("-S", "-c", program, cwd=tmp_path, PYTHONPATH=str(ROOT)) == "imported\n"

    def test_every_third_party_import_is_declared(self) -> None:
        project = PYPROJECT["project"]
        runtime = [extra for name, extra in project["optional-dependencies"].items() if name != "dev"]
        declared = {Requirement(text).name for text in itertools.chain(project["dependencies"], *runtime)}
        for path in (path for package in PACKAGES for path in sources(package)):
            foreign = {name.split(".")[0] for name in imports(path)} - sys.stdlib_module_names - set(PACKAGES)
            if path.parent.name == "kernels":
                foreign.discard("cython")  # only the compiler knows it; without it, robustness.kernels.uncompiled does
            assert foreign <= declared, f"{path.relative_to(ROOT)} imports {foreign - declared}"

    def test_solvers_plots_and_topologies_are_imported_where_they_are_needed(self) -> None:
        late = {"ortools", "matplotlib", "topohub", "pandas", "scipy"}
        for path in (path for package in PACKAGES for path in sources(package)):
            early = {name.split(".")[0] for name in imports(path, at_import=True)} & late
            assert not early, f"{path.relative_to(ROOT)} imports {early} when it is imported"

    def test_the_front_loads_nothing_heavy(self, tmp_path: Path) -> None:
        program = "import sys, robustness, certificates, cli; print(*sorted(sys.modules))"
        loaded = set(run("-c", program, cwd=tmp_path, PYTHONPATH=str(ROOT)).split())
        assert not loaded & {"ortools", "matplotlib", "topohub", "hypothesis", "pandas", "pytest"}

    def test_no_plotting_in_the_simulation(self) -> None:
        for path in sources("robustness/simulation"):
            drawn = {name for name in imports(path) if re.search(r"matplotlib|plot", name)}
            assert not drawn, f"{path.relative_to(ROOT)} imports {drawn}"


def test_no_test_depends_on_the_speed_of_the_machine() -> None:
    timed = re.compile(r"assert .*(?:monotonic|perf_counter|process_time|time\.time)\(\) - ")
    found = [path.name for path in (ROOT / "tests").rglob("*.py") if timed.search(path.read_text(encoding="utf-8"))]
    assert found == []


class TestLock:
    def test_every_pin_has_hashes(self) -> None:
        blocks = re.split(r"\n(?=[\w.-]+==)", LOCK)[1:]
        assert len(blocks) == len(LOCKED) > 20
        assert [block.split()[0] for block in blocks if "--hash=sha256:" not in block] == []

    def test_names_no_address(self) -> None:
        assert re.findall(r"\S*(?://|file:|@ |--index|--find-links|--trusted).*", LOCK) == []

    def test_holds_what_every_python_and_platform_needs(self) -> None:
        missing = set()
        systems = [("linux", "Linux", "posix"), ("darwin", "Darwin", "posix")]
        for (platform, system, os_name), minor in itertools.product(systems, (11, 12, 13, 14)):
            environment = {
                **default_environment(),
                "extra": "",
                "python_version": f"3.{minor}",
                "python_full_version": f"3.{minor}.0",
                "sys_platform": platform,
                "platform_system": system,
                "os_name": os_name,
            }
            for name in LOCKED:
                for text in importlib.metadata.requires(name) or []:
                    requirement = Requirement(text)
                    needed = requirement.marker is None or requirement.marker.evaluate(environment)
                    if needed and canonicalize_name(requirement.name) not in LOCKED:
                        missing.add((name, text))
        assert not missing

    def test_installs_on_the_oldest_python_of_each_series(self) -> None:
        demands = {name: importlib.metadata.metadata(name).get("Requires-Python") or "" for name in LOCKED}
        for version in ("3.11.0", "3.12.0", "3.13.0", "3.14.0"):
            assert [name for name, demand in demands.items() if version not in SpecifierSet(demand)] == []

    def test_satisfies_the_declared_requirements(self) -> None:
        project = PYPROJECT["project"]
        for text in itertools.chain(
            project["dependencies"], *project["optional-dependencies"].values(), PYPROJECT["build-system"]["requires"]
        ):
            requirement = Requirement(text)
            assert LOCKED[canonicalize_name(requirement.name)] in requirement.specifier


class TestNames:
    def test_no_file_is_named_for_nothing(self) -> None:
        vague = re.compile(r"(utils?|helpers?|common|misc|.*_(v2|old|new))\.py")
        assert [path.name for package in PACKAGES for path in sources(package) if vague.fullmatch(path.name)] == []


def test_a_missing_package_is_told_with_the_extra_that_has_it() -> None:
    """In quotes, without which zsh takes the brackets for a pattern; by its own name only where no extra has it."""
    extras = PYPROJECT["project"]["optional-dependencies"]
    held = {re.split(r"[<>=]", each)[0] for name, needs in extras.items() if name != "dev" for each in needs}
    told = [
        advice
        for path in (ROOT / "robustness").rglob("*.py")
        for advice in re.findall(
            r"raise MissingExtra\([^\n]*?pip install ([^\n]*?)\"\)", path.read_text(encoding="utf-8")
        )
    ]
    assert len(told) > 8
    for advice in told:
        extra = re.fullmatch(r"'graph-robustness\[(\w+)\]'", advice)
        assert extra[1] in extras if extra else advice.isalpha() and advice not in held, advice
