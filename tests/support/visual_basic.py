"""Modules of Visual Basic 6, taken over into Visual Basic .NET word by word and compiled by an SDK of .NET.

Nobody sells a compiler of Visual Basic 6 any more. What differs in the language of today is a matter of words: integers
have 32 and 16 bits, types are structures, arrays are made first, a call has brackets, records go as rows.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from support.command import environment

_HEAD = "Imports System\nImports System.Runtime.InteropServices\nImports Microsoft.VisualBasic\n"
_WORDS = (
    (r"\r", ""),
    (r"^Attribute .*\n", ""),
    (r"^Option Explicit\n", ""),
    (r" ' an address$", ""),
    (r"\bAs Integer\b", "As Short"),
    (r"\bAs Long\b", "As Integer"),
)
_DECLARATIONS = (
    (
        r"^    (\w+)\(0 To (\d+)\) As (\w+)$",
        r"    <MarshalAs(UnmanagedType.ByValArray, SizeConst:=\2 + 1)> Public \1() As \3",
    ),
    (
        r"^    (\w+) As String \* (\d+)$",
        r"    <MarshalAs(UnmanagedType.ByValTStr, SizeConst:=\2)> Public \1 As String",
    ),
    (r"^    (\w+) As (\w+)$", r"    Public \1 As \2"),
    (r"^Public Type (\w+)$", r"<StructLayout(LayoutKind.Sequential, Pack:=4)> Public Structure \1"),
    (r"^End Type$", "End Structure"),
    (r"(ByVal|ByRef) (\w+) As", r"\1 [\2] As"),
    (r"ByRef \[tsrp_\] As TSRP", r"<[In], Out> ByVal [tsrp_]() As TSRP"),
    (
        r'^Public Declare (Sub|Function) (\w+) Lib ("[^"]*") (.*)$',
        r"<DllImport(\3)> Public \1 [\2] \4\nEnd \1",
    ),
)
_STATEMENTS = (
    (r"^(    Dim (\w+) As AS_)$", r"\1\n    ReDim \2.san(17)"),
    (r"^    (cl|ja|rddp|Debug\.Print) (.*)$", r"    \1(\2)"),
    (r"Debug\.Print", "Console.WriteLine"),
    (r"((?:InitMcuSystem3|ja|rddp)\([^()]*?)(\w+)\(0\)", r"\1\2"),
)


def _taken_over(text: str, name: str, rules: tuple[tuple[str, str], ...]) -> str:
    for pattern, new in (*_WORDS, *rules):
        text = re.sub(pattern, new, text, flags=re.MULTILINE)
    return f"{_HEAD}Public Module {name}\n{text}\nEnd Module\n"


def declarations(text: str) -> str:
    """Return a module of `Public Declare` and `Public Type` as Visual Basic .NET reads it."""
    return _taken_over(text, "declared", _DECLARATIONS)


def statements(text: str) -> str:
    """Return a module with `Sub Main`, of the statements that the examples use, as Visual Basic .NET reads it."""
    return _taken_over(text, "program", _STATEMENTS)


class DotNet:
    """The SDK of .NET on the PATH; skips the test where there is none with a compiler of Visual Basic."""

    def __init__(self) -> None:
        self._command = shutil.which("dotnet") or ""
        found = (
            re.findall(r"^(\S+) \[(.+)\]$", self._run("--list-sdks"), re.MULTILINE) if self._command else []
        )
        if not found:
            pytest.skip("no compiler of Visual Basic here (an SDK of .NET)")
        version, folder = found[-1]
        self._compiler = Path(folder) / version / "Roslyn" / "bincore" / "vbc.dll"
        self._framework, self._references = max(
            (tuple(map(int, each.parts[-3].split("."))), each)
            for each in Path(folder).parent.glob("packs/Microsoft.NETCore.App.Ref/*.*.*[0-9]/ref/*")
        )

    def _run(self, *command: str | Path, cwd: Path | None = None, at: dict[str, str] | None = None) -> str:
        ran = subprocess.run(
            [self._command, *command],
            cwd=cwd,
            env=environment(DOTNET_CLI_TELEMETRY_OPTOUT="1", DOTNET_NOLOGO="1", **(at or {})),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return ran.stdout

    def says(self, sources: dict[str, str], folder: Path, at: dict[str, str]) -> str:
        """Compile sources by name in a folder, run the program there, and return what it prints."""
        for name, text in sources.items():
            (folder / name).write_text(text, encoding="utf-8")
        self._run(
            "exec", self._compiler, "-nologo", "-noconfig", "-target:exe", "-out:program.dll",
            '-define:_MYTYPE="Empty"',
            f"-sdkpath:{self._references}", f"-vbruntime:{self._references / 'Microsoft.VisualBasic.Core.dll'}",
            *(f"-r:{each}" for each in sorted(self._references.glob("*.dll"))), *sources, cwd=folder,
        )  # fmt: skip
        version = ".".join(map(str, self._framework))
        (folder / "program.runtimeconfig.json").write_text(
            f'{{"runtimeOptions": {{"framework": {{"name": "Microsoft.NETCore.App", "version": "{version}"}}}}}}'
        )
        return self._run("exec", "program.dll", cwd=folder, at=at)
