"""Four times the input takes four times as long: processor time of n and 4 n, exponent under 1.2."""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from polycnc import runner
from polycnc.machine import parse_machine, preset_text
from polycnc.servers.scenarios import load_script
from support.often import often

MOST = 1.2
TRIES = 8


def _lines(line: Callable[[int], str], count: int) -> str:
    return "".join(line(n) for n in range(1, count + 1))


PROGRAMS: dict[str, Callable[[int], str]] = {
    "tools": lambda n: _lines(lambda i: f"T{i}M6\nG1 X{i % 7} F900\n", n) + "M30\n",
    "macros in a file": lambda n: (
        _lines(lambda i: f"G65 P{i} A3.\n", n)
        + "M30\n%\n"
        + _lines(lambda i: f"O{i}\n#500=#500+#1\nM99\n", n)
    ),
    "sub-programs in a file": lambda n: (
        _lines(lambda i: f"M98 P{i}\n", n)
        + "M30\n%\n"
        + _lines(lambda i: f"O{i}\nG1 X{i % 7} F900\nM99\n", n)
    ),
    "labels": lambda n: "#1=0\n" + _lines(lambda i: f"GOTO {i}\nN{i} #1=#1+1\n", n) + "M30\n",
    "dwells": lambda n: _lines(lambda i: f"G4 P{i % 3 + 1}\n", n) + "M30\n",
}


def _assert_linear(seconds: Callable[[int], float], count: int) -> None:
    seconds(count // 4)  # compiled by then
    few = many = math.inf
    gc.collect()
    gc.freeze()  # what other tests left is not gone through more often by the longer one
    for _ in range(TRIES):
        few, many = min(few, seconds(count)), min(many, seconds(4 * count))
        if many / few < 4.0**MOST:
            return
    raise AssertionError(
        f"{count}: {few:.3f} s, {4 * count}: {many:.3f} s, exponent {math.log(many / few, 4):.2f}"
    )


@pytest.mark.parametrize("name", PROGRAMS)
def test_the_time_of_a_program_grows_with_its_length(name: str) -> None:
    def seconds(count: int) -> float:
        text = PROGRAMS[name](count)
        before = time.process_time()
        assert runner.run(text, None, "fanuc", check=False).ok
        return time.process_time() - before

    _assert_linear(seconds, 250)


def test_the_power_of_a_laser_in_each_block_costs_little_and_grows_with_the_program() -> None:
    text = preset_text("mill3").replace("[[axis]]", "[spindle]\nlaser = true\n[[axis]]", 1)
    config = parse_machine(text, "m.toml")

    def seconds(count: int, word: str = " S{}") -> float:
        program = "M4 S1\nG1 F3000\n" + _lines(
            lambda i: f"X{i * 0.01:.2f} Y{i % 2 * 0.003}{word.format(i % 900)}\n", count
        )
        before = time.process_time()
        assert runner.run(program, config, "grbl", check=False).ok
        return time.process_time() - before

    _assert_linear(seconds, 2_500)
    words = plain = math.inf
    for _ in range(TRIES):
        words, plain = min(words, seconds(10_000)), min(plain, seconds(10_000, ""))
        if words < 2.0 * plain:
            return
    raise AssertionError(f"with words {words:.3f} s, without {plain:.3f} s")


@pytest.mark.parametrize("blocks", often([1_000_000, 10_000_000], 1))
def test_a_window_wider_than_the_program_costs_nothing(blocks: int) -> None:
    """Braking takes longer than the queue is: each block would look through all that is known."""
    text = preset_text("mill3").replace("[[axis]]", f"[path]\nlook_ahead_blocks = {blocks}\n[[axis]]", 1)
    config = parse_machine(text, "m.toml")

    def seconds(count: int) -> float:
        program = "F3000\n" + _lines(lambda i: f"G1 X{i * 0.01:.2f} Y{i % 2 * 0.003}\n", count) + "M30\n"
        before = time.process_time()
        assert runner.run(program, config, "din", check=False).ok
        return time.process_time() - before

    _assert_linear(seconds, 15_000)


OTHERS: dict[str, tuple[str, Callable[[int], str]]] = {
    "sub-programs by O": (
        "linuxcnc",
        lambda n: (
            _lines(lambda i: f"o<s{i}> sub\n#<_total>=[#1+{i}]\no<s{i}> endsub\n", n)
            + _lines(lambda i: f"o<s{i}> call [2]\n", n)
            + "M2\n"
        ),
    ),
    "choices by O": (
        "linuxcnc",
        lambda n: _lines(lambda i: f"o{i} if [#1 GT {i}]\n#1=[#1+2]\no{i} else\n#1=[#1+1]\no{i} endif\n", n),
    ),
    "named parameters": ("linuxcnc", lambda n: _lines(lambda i: f"#<p{i}>={i}\nG1 X[#<p{i}>/90] F900\n", n)),
    "labels of CPL": (
        "bosch",
        lambda n: (
            "1 A%=0\n" + _lines(lambda i: f"{i}0 A%=A%+1\n{i}1 GOTO {i + 1}0\n", n) + f"{n + 1}0 A%=1\n"
        ),
    ),
    "strings of CPL": (
        "bosch",
        lambda n: "1 DIM S$(30)\n" + _lines(lambda i: f"{i}0 S$=STR$({i})\n{i}1 B{i}%=LEN(S$)\n", n),
    ),
    "brackets of CPL": ("bosch", lambda n: "1 A%=2\n" + _lines(lambda i: f"N{i} G1 X[A%*{i % 7}] F900\n", n)),
}


@pytest.mark.parametrize("name", OTHERS)
def test_the_time_of_other_languages_grows_with_the_program(name: str, tmp_path: Path) -> None:
    dialect, text = OTHERS[name]

    def seconds(count: int) -> float:
        program = text(count)
        before = time.process_time()
        assert runner.run(program, None, dialect, check=False, root=tmp_path).ok
        return time.process_time() - before

    _assert_linear(seconds, 120)


STEP = '[[step]]\nname = "s{0}"\nat_s = {0}.5\ndo = "emergency_stop"\nfor_s = 0.25\n'


def test_the_time_of_a_scenario_grows_with_its_steps(tmp_path: Path) -> None:
    def seconds(count: int) -> float:
        path = tmp_path / "day.toml"
        path.write_text(_lines(STEP.format, count))
        before = time.process_time()
        assert len(load_script(path).step) == count
        return time.process_time() - before

    _assert_linear(seconds, 120)


def test_the_time_of_an_agent_grows_with_what_it_has_seen() -> None:
    pytest.importorskip("starlette", reason="pip install 'polycnc[serve]'")
    from support.mtconnect import Rig

    def seconds(count: int) -> float:
        rig = Rig()
        rig.control.programs.create("PART", "G91\n" + _lines(lambda i: f"G1 X{i % 7 - 3}.25 F900\n", 2000))
        rig.control.select_program("PART")
        rig.control.cycle_start()
        before = time.process_time()
        for _ in range(count):
            rig.control.advance(3)
            rig.observe()
        rig.get("/sample", "count=10000")
        return time.process_time() - before

    _assert_linear(seconds, 120)
