"""The file of a scenario: steps with names, what starts each, what it does, and when that ends."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, PrivateAttr, model_validator

from polycnc.errors import SourcePosition
from polycnc.machine import KeyPath, Locator, StrictModel, load_toml, parse_toml, problem, validate

MOST_STEPS = 1000
_MOST_TIMES = 100_000
_MOST_S = 1e9
Name = Annotated[str, Field(min_length=1, max_length=64)]
Seconds = Annotated[float, Field(ge=0.0, le=_MOST_S)]


class When(StrictModel):
    """A condition on the status: `value` is a path in it, like `axes.X.machine`; one of the others is compared."""

    value: Annotated[str, Field(min_length=1, max_length=200)]
    above: float | None = None
    below: float | None = None
    equals: str | bool | int | float | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if sum(each is not None for each in (self.above, self.below, self.equals)) != 1:
            raise problem("a condition has one of `above`, `below`, `equals`")
        return self


class Step(StrictModel):
    """One step. It begins at a machine time, at a request of a door, at a line of a program, or on a condition.

    `at_s` counts from the begin of the scenario, or of the step `after`. `do` is an action, `with` has its values. It
    ends after `for_s` or `for_requests`, if at all. It begins `times` times, `every_s` apart.
    """

    name: Name
    do: Name
    at_s: Seconds | None = None
    after: Name | None = None
    at_request: Annotated[int, Field(ge=1)] | None = None
    door: Name | None = None
    at_line: Annotated[int, Field(ge=1)] | None = None
    program: Name | None = None
    when: When | None = None
    for_s: Annotated[float, Field(gt=0.0, le=_MOST_S)] | None = None
    for_requests: Annotated[int, Field(ge=1)] | None = None
    times: Annotated[int, Field(ge=1, le=_MOST_TIMES)] = 1
    every_s: Annotated[float, Field(gt=0.0, le=_MOST_S)] | None = None
    values: dict[str, Any] = Field(default_factory=dict, alias="with")

    @model_validator(mode="after")
    def _check(self) -> Self:
        starts = [each for each in (self.at_s, self.at_request, self.at_line, self.when) if each is not None]
        if len(starts) != 1:
            raise problem("a step begins at one of `at_s`, `at_request`, `at_line`, `when`")
        if self.after is not None and self.at_s is None:
            raise problem("`after` goes with `at_s`: the time since that step began", at=("after",))
        if self.program is not None and self.at_line is None:
            raise problem("`program` goes with `at_line`", at=("program",))
        counts = self.at_request is not None or self.for_requests is not None
        if counts and self.door is None:
            raise problem("requests are those of a `door`")
        if self.for_s is not None and self.for_requests is not None:
            raise problem("a step ends after `for_s` or after `for_requests`", at=("for_requests",))
        if (self.times > 1) != (self.every_s is not None):
            raise problem("a step that is repeated has `times` and `every_s`")
        if self.every_s is not None and self.for_s is not None and self.for_s >= self.every_s:
            raise problem("`for_s` is shorter than `every_s`", at=("for_s",))
        if self.every_s is not None and self.for_requests is not None:
            raise problem("a step that is repeated ends after `for_s`", at=("for_requests",))
        return self


class Script(StrictModel):
    """A scenario: its title, and its steps in the order in which they are looked at."""

    title: Annotated[str, Field(max_length=200)] = ""
    step: Annotated[tuple[Step, ...], Field(min_length=1, max_length=MOST_STEPS)]
    _source: str = PrivateAttr("")
    _locator: Locator | None = PrivateAttr(None)

    @property
    def source(self) -> str:
        """The text that it was read from."""
        return self._source

    def position(self, path: KeyPath) -> SourcePosition | None:
        """Return where a key is in its text, None without one."""
        return None if self._locator is None else self._locator.position(path)

    @model_validator(mode="after")
    def _check(self) -> Self:
        known: set[str] = set()
        for index, each in enumerate(self.step):
            if each.name in known:
                raise problem(f"two steps are called {each.name}", at=("step", index, "name"))
            if each.after is not None and each.after not in known:
                raise problem(
                    f"step {each.name}: no step before it is called {each.after}", at=("step", index, "after")
                )
            known.add(each.name)
        return self


def load_script(path: Path) -> Script:
    """Read the file of a scenario.

    Raises:
        UsageError: It cannot be read, or says what cannot be.
    """
    data, locator = load_toml(path)
    script = validate(Script, data, locator)
    script._source, script._locator = path.read_text("utf-8-sig"), locator
    return script


def read_script(text: str, name: str = "scenario") -> Script:
    """Read the text of a scenario; `name` is what errors call it.

    Raises:
        ConfigurationError: It says what cannot be.
    """
    data, locator = parse_toml(text, name)
    script = validate(Script, data, locator)
    script._source, script._locator = text, locator
    return script
