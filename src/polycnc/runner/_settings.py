"""What is run or checked: a program, and on what and how."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from polycnc.errors import UsageError
from polycnc.machine import DEFAULT_MACHINE, MachineConfig, load_machine
from polycnc.nc import ChosenDialect, Dialect, ProgramText, choose_dialect, further_axes
from polycnc.outputs import check_output, keep_inputs
from polycnc.runner._execution import LOOP_LIMIT_S
from polycnc.runner._program_control import Surroundings, check_screen_file, root_of

if TYPE_CHECKING:
    from polycnc.controllers.bosch import ChannelHost
    from polycnc.stock import Body, Form

Program = str | Path | ProgramText

LATHE = "lathe2"
"""The machine for programs of lathes, where none is named."""


def machine_for(
    machine: str | Path | MachineConfig | None, dialect: Dialect, text: ProgramText
) -> MachineConfig:
    """Return the machine that was named, else one for a program: a lathe, or a mill with the axes it has words for.

    Raises:
        UsageError: no such machine.
    """
    if machine is not None:
        return load_machine(machine)
    if dialect.diameter_axes:
        return load_machine(LATHE)
    further = further_axes(text, dialect)
    return load_machine(f"{DEFAULT_MACHINE}+{further}" if further else None)


@dataclass(frozen=True, slots=True)
class RunSettings:
    """Set on what programs are run or checked, and how: what `polycnc.run` tells of each argument.

    Raises:
        UsageError: a limit or an override that cannot be.
    """

    machine: str | Path | MachineConfig | None = None
    dialect: str | Dialect | None = None
    servo: bool = False
    skip_levels: frozenset[int] = frozenset()
    stop_at_m0: bool = False
    feed_override: float = 1.0
    root: str | Path | None = None
    keys: tuple[str, ...] = ()
    screen: str | Path | None = None
    ignore: tuple[str, ...] = ()
    loop_limit_s: float = LOOP_LIMIT_S
    stock: str | Body | None = None
    resolution_mm: float | None = None
    fixtures: tuple[str, ...] = ()
    target: str | None = None
    tolerance_mm: float | None = None
    tools: str | Path | None = None
    save_parameters: str | Path | None = None
    """Where the parameters that outlive the program are written at its end."""
    past_errors: bool = False
    """Whether a refused block is left out and the rest is run, so that what can be read is drawn."""

    def __post_init__(self) -> None:
        if not self.loop_limit_s > 0.0:
            raise UsageError(f"a limit of {self.loop_limit_s:g} s for loops", hint="Give seconds above 0.")
        if not self.feed_override > 0.0:
            raise UsageError(f"a feed override of {self.feed_override:g}", hint="Give more than 0, up to 2.")
        for what, given in (
            ("a resolution", self.resolution_mm is not None),
            ("fixtures", bool(self.fixtures)),
            ("a target", self.target is not None),
        ):
            if given and self.stock is None and load_machine(self.machine).stock is None:
                raise UsageError(f"{what} without stock", hint="Say what is cut too, like stock='auto'.")
        if self.tolerance_mm is not None and self.target is None:
            raise UsageError("a tolerance without a target", hint="Name the STL file of what is to come out.")
        self.form()

    def with_stock_of(self, config: MachineConfig) -> RunSettings:
        """Return these settings, with what the machine file says of stock where they say nothing.

        Raises:
            UsageError: the machine file says what cannot be.
        """
        stock, resolution_mm = self.stock, self.resolution_mm
        if stock is None and config.stock is not None:
            stock = config.stock.form
            resolution_mm = resolution_mm or config.stock.resolution_mm
        if stock is None:
            return self
        fixtures = self.fixtures or tuple(each.form for each in config.fixtures)
        try:
            return replace(self, stock=stock, resolution_mm=resolution_mm, fixtures=fixtures)
        except UsageError as error:
            raise UsageError(f"stock of '{config.name}': {error.what}", hint=error.hint) from None

    def form(self) -> Form | None:
        """Return what body is cut; None if none is.

        Raises:
            UsageError: no such form.
        """
        if self.stock is None:
            return None
        from polycnc.stock import TOLERANCE_MM, Body, Form, check_fixtures

        check_fixtures(self.fixtures)
        tolerance_mm = TOLERANCE_MM if self.tolerance_mm is None else self.tolerance_mm
        beside = self.fixtures, self.target, tolerance_mm
        if isinstance(self.stock, str):
            return Form(self.stock, self.resolution_mm, *beside)
        if not isinstance(self.stock, Body):
            raise UsageError(
                f"'{self.stock!r}' is no stock", hint="Give its text, like 'auto', or result.stock of a run."
            )
        if self.resolution_mm is not None:
            raise UsageError("a resolution for a body that has one", hint="Leave it out.")
        return Form("", None, *beside, given=self.stock)

    def dialect_of(self, text: ProgramText) -> ChosenDialect:
        """Return the dialect of a program, without the codes that are ignored, and why it was guessed.

        Raises:
            UsageError: no such dialect or code.
        """
        chosen = choose_dialect(text, self.dialect)
        if not self.ignore:
            return chosen
        return replace(chosen, dialect=chosen.dialect.leaving_out(self.ignore))

    def machine_of(self, text: ProgramText) -> MachineConfig:
        """Return the machine for a program, see `machine_for`, with the tools of a file.

        Raises:
            UsageError: no such machine, dialect, code or list of tools.
        """
        config = (
            load_machine(self.machine)
            if self.machine is not None
            else machine_for(None, self.dialect_of(text).dialect, text)
        )
        if self.tools is None:
            return config
        from polycnc.runner.machine_sources import with_tools

        return with_tools(config, self.tools)

    def root_of(self, program: Program) -> Path:
        """Return the folder with the files of the control.

        Raises:
            UsageError: There is no such folder.
        """
        return root_of(program, self.root)

    def surroundings_of(self, program: Program) -> Surroundings:
        """Return where a program runs.

        Raises:
            UsageError: There is no such folder.
        """
        return Surroundings(self.root_of(program), self.keys, self.skip_levels)

    def check_parameters(self, program: Program, dialect: Dialect) -> None:
        """Check that the parameters that outlive a program can be written where they should.

        Raises:
            UsageError: the dialect has none, or the place is wrong.
        """
        if self.save_parameters is None:
            return
        if dialect.language != "rs274":
            raise UsageError(
                f"programs in the dialect {dialect.name} keep no file of parameters",
                hint="Leave --save-parameters out, or run a program of LinuxCNC.",
            )
        check_output(self.save_parameters, (".var",), "a file of parameters")
        keep_inputs(self.save_parameters, self._files_with(program), "a file of parameters")

    def check_screen(self, program: Program, text: ProgramText, control: ChannelHost | None) -> None:
        """Check that what a program shows can be written where it should.

        Raises:
            UsageError: the program shows nothing, or the place is wrong.
        """
        if self.screen is None:
            return
        keep_inputs(self.screen, self._files_with(program), "a screen")
        check_screen_file(self.screen, text, control)

    def _files_with(self, program: Program) -> list[str | Path]:
        """Return what names the files that a run reads."""
        return [each for each in (program, self.machine, self.dialect) if isinstance(each, str | Path)]


def program_text(program: Program) -> ProgramText:
    """Return a program from a path, or from a text of several lines."""
    if isinstance(program, ProgramText):
        return program
    if isinstance(program, str) and ("\n" in program or "\r" in program):
        return ProgramText.from_text(program)
    try:
        return ProgramText.from_path(program)
    except UsageError as error:
        if isinstance(program, str) and " " in program:
            error.hint = "Check the name and the folder; a program text needs a newline at its end."
        raise
