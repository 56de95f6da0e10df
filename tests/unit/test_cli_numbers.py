"""Every number of every command is bounded, and what is outside is told in a sentence with exit status 2."""

from __future__ import annotations

import math
import re
import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import typer.main
from typer.testing import CliRunner

from polycnc.cli._app import app

HOSTILE = (
    "1e308",
    "-1e308",
    "1e-308",
    "inf",
    "-inf",
    "nan",
    "",
    "0",
    "-1",
    "1" + "0" * 400,
    "1" + "0" * 5000,
    "x",
    "0x1f",
)

FEW = ("nan", "1" + "0" * 400)


class Number(NamedTuple):
    """A number of a command: the words before it, its option and its bounds."""

    command: tuple[str, ...]
    option: str
    kind: type
    least: float | None
    most: float | None

    def takes(self, text: str) -> bool:
        """Tell whether the bounds let a text in."""
        try:
            value = self.kind(text)
        except ValueError:
            return False
        assert self.least is not None
        assert self.most is not None
        return bool(self.least <= value <= self.most)


def _commands(group: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from _commands(command, (*path, name))
        else:
            yield (*path, name), command


def _numbers() -> Iterator[Number]:
    for path, command in _commands(typer.main.get_command(app)):
        for each in command.params:
            found = each.type_descriptor.annotation
            kinds = {found, *typing.get_args(found)} & {int, float}
            if kinds:
                yield Number(path, each.opts[-1], kinds.pop(), each.min, each.max)


NUMBERS = list(_numbers())


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> str:
    made = tmp_path_factory.mktemp("numbers") / "main.npg"
    made.write_text("10 I%=3\nN20 G1 X2.5 F900\nM30\n")
    return str(made)


def test_there_are_numbers_of_many_commands() -> None:
    assert len(NUMBERS) > 20
    assert len({each.command for each in NUMBERS}) > 8


@pytest.mark.parametrize("texts", [FEW, pytest.param(HOSTILE, marks=pytest.mark.long)], ids=["few", "all"])
@pytest.mark.parametrize("number", NUMBERS, ids=lambda each: f"{' '.join(each.command)} {each.option}")
def test_every_number_is_bounded_and_refused_outside(
    number: Number, texts: tuple[str, ...], program: str
) -> None:
    assert number.least is not None
    assert number.most is not None
    assert math.isfinite(number.most)
    for text in [each for each in texts if not number.takes(each)]:
        done = CliRunner().invoke(app, [*number.command, f"{number.option}={text}", program])
        assert done.exit_code == 2, (text[:9], done.output, done.exception)
        assert number.option in done.output, (text[:9], done.output)
        assert re.search(r"is not between|is no (whole )?number|needs|Give ", done.output), done.output
        assert "Traceback" not in done.output


def test_help_names_what_is_given_and_no_types_of_the_code() -> None:
    for path, command in _commands(typer.main.get_command(app)):
        said = command.get_help(typer.Context(command, info_name=" ".join(path)))
        assert not re.search(r"<|[{]|\[\[|Path|\brange\b|\bstr\b", said.replace("<=", "")), said
        assert "<=" not in said
        for each in command.params:
            assert each.opts[-1] in said or (each.metavar or "").strip("[]") in said or each.hidden


def test_what_is_no_choice_is_told_without_the_words_of_a_library(program: str) -> None:
    wrong = {
        "run --units in": "'--units': 'in' is not one of 'mm', 'inch'.",
        "run --skip 0": "'--skip': '0' is not between 1 and 9.",
        "run --skip two": "'--skip': 'two' is no whole number.",
        "schema rnu": "Did you mean 'run'? Schemas are: run,",
        "conformance fanucc": "Did you mean 'fanuc'? Systems are: fanuc,",
        "warmup sotck": "Did you mean 'stock'? Jobs are: run,",
        "run --dialect fanc": "Did you mean 'fanuc'? Use din,",
        "post --control haas-mil": "Did you mean 'haas-mill'? Use bosch-pnc,",
    }
    for words, sentence in wrong.items():
        last = [program] if words.startswith(("run", "post")) else []
        done = CliRunner().invoke(app, [*words.split(), *last])
        assert done.exit_code == 2, (words, done.output)
        assert sentence in done.output, (words, done.output)


SHORT = {("run",), ("compare",), ("view",)}
"""Commands that end by themselves and at once."""


@pytest.mark.parametrize(
    "number",
    [each for each in NUMBERS if each.command in SHORT and each.kind is float],
    ids=lambda each: f"{' '.join(each.command)} {each.option}",
)
def test_what_bounds_let_in_is_carried_out_or_refused(
    number: Number, program: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    more = {"--resolution": ["--stock", "auto"]}.get(number.option, [])
    both = [program, program] if number.command == ("compare",) else [program]
    for text in {each for each in ("0", "1e-308") if number.takes(each)} | {repr(number.most)}:
        done = CliRunner().invoke(app, [*number.command, f"{number.option}={text}", *more, *both])
        assert done.exit_code in (0, 1, 2), (text, done.output, done.exception)
        assert "internal error" not in done.output, (text, done.output)
