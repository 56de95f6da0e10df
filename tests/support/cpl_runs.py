"""CPL programs run on a control whose root is a folder of the test."""

from __future__ import annotations

from pathlib import Path

from polycnc.nc import ProgramText
from polycnc.runner import RunResult, run
from support.programs import MILL


class Root:
    """The root of a control: `run` executes a program in it, `read` returns the bytes of a file."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def run(
        self, program: str, *, check: bool = True, keys: tuple[str, ...] = (), screen: str = ""
    ) -> RunResult:
        """Run a program; its errors are raised unless `check` is off."""
        text = ProgramText.from_text(program, str(self.folder / "main.npg"))
        return run(
            text, MILL, "bosch", root=self.folder, check=check, keys=keys,
            screen=self.folder / screen if screen else None,
        )  # fmt: skip

    def error(self, program: str) -> str:
        """Return the first line of the error that a program ends with."""
        alarms = self.run(program, check=False).alarms
        assert alarms, "the program ran to its end"
        assert alarms[0].file.endswith("main.npg")
        return f"{alarms[0].line}: {alarms[0].text}"

    def read(self, name: str) -> bytes:
        """Return what a file holds."""
        return (self.folder / name).read_bytes()

    def write(self, name: str, content: bytes) -> None:
        """Make a file."""
        (self.folder / name).write_bytes(content)

    def said(self, program: str) -> list[str]:
        """Return the messages of a run."""
        return [message.text.removeprefix("MSG: ") for message in self.run(program).messages]
