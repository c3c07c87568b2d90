"""Options that name a file or a folder."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from cli.main import robustness
from cli.named import FILE, FILE_NAME, FOLDER, PLACE

SQUARE = str(Path(__file__).parents[1] / "data" / "square.json")


def paths_of(command: click.Command, *names: str) -> Iterator[tuple[tuple[str, ...], click.Parameter]]:
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            assert below is not None
            yield from paths_of(below, *names, name)
    yield from ((names, each) for each in command.params if isinstance(each.type, click.Path))


def test_all_paths_are_of_one_kind() -> None:
    found = list(paths_of(robustness))
    assert len(found) > 30
    assert [(names, each.name) for names, each in found if each.type not in (FILE, FILE_NAME, FOLDER, PLACE)] == []


@pytest.mark.parametrize("command", ["certify", "mend", "thin", "tolerance", "check", "draw"])
def test_a_variable_of_the_shell_that_is_not_set_names_nothing(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    option = "--state" if command == "check" else "-o"
    outcome = CliRunner().invoke(
        robustness, [command, SQUARE, *([] if command == "tolerance" else ["-r", "2"]), option, ""]
    )
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert "names nothing: is a variable of the shell not set?" in outcome.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("place", [".", "/", ".."])
def test_a_folder_is_no_certificate(place: str) -> None:
    for asked in (["certify", SQUARE, "-r", "2", "-o"], ["joint", SQUARE, "-r", "2", "--certificate"]):
        outcome = CliRunner().invoke(robustness, [*asked, place])
        assert outcome.exit_code == 2
        assert f"File '{place}' is a directory." in outcome.stderr
