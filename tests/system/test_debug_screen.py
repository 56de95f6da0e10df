"""The screen of `polycnc debug`, driven by its keys as a person would."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

import pytest

pytest.importorskip("textual")

from textual.widgets import Static

from polycnc.cli._debug_screen import DebugScreen, Listing
from polycnc.cnc import RunState
from polycnc.nc import ProgramText
from polycnc.runner import Debugger
from support.command import polycnc

MAIN = "(BRACKET)\nN10 G1 X4.5 F6000\nN20 M98 P815\nN30 X7.25 Y1.5\nN60 M30\n"
SUB = "O0815\nN110 Y2.25\nN120 Y3.5\nM99\n"


@pytest.fixture
def debugger(tmp_path: Path) -> Debugger:
    (tmp_path / "main.nc").write_text(MAIN)
    (tmp_path / "O0815.nc").write_text(SUB)
    return Debugger(ProgramText.from_path(tmp_path / "main.nc"), dialect="fanuc")


def seen(app: DebugScreen) -> str:
    """Return what the screen shows as text."""
    width = app.size.width
    return "\n".join(
        "".join(segment.text for segment in strip)[:width].rstrip()
        for strip in app.screen._compositor.render_strips()
    )


def remark(app: DebugScreen) -> str:
    return str(app.query_one("#remark", Static).render())


def test_a_person_runs_stops_steps_and_looks(debugger: Debugger) -> None:
    async def person() -> None:
        app = DebugScreen(debugger, rate=0.0)
        async with app.run_test(size=(120, 32)) as pilot:
            assert "(BRACKET)" in seen(app)
            assert "no block executed yet" in seen(app)
            await pilot.press("down", "down", "down", "b")
            await pilot.pause()
            assert "●     4" in seen(app)
            await pilot.press("space")
            app.pass_time(100_000)
            await pilot.pause()
            # Before line 4: the last block was the return of the sub-program, in its own file.
            text = seen(app)
            assert "O0815.nc" in text
            assert "▶ M99" in text
            assert "main.nc:3" in text
            assert "stopped at block" in text
            await pilot.press("s")
            app.pass_time(100_000)
            await pilot.pause()
            text = seen(app)
            assert "▶ N30 X7.25 Y1.5" in text
            assert "7.250" in text
            assert "G1 " in text
            assert "F6000" in text
            await pilot.press("minus", "minus")
            await pilot.pause()
            assert "80%" in seen(app)
            await pilot.press("space")
            app.pass_time(100_000)
            await pilot.pause()
            assert debugger.status.channel.run_state is RunState.COMPLETED
            await pilot.press("q")

    asyncio.run(person())


def test_it_lets_time_pass_by_itself_and_holds(debugger: Debugger) -> None:
    async def person() -> None:
        app = DebugScreen(debugger, rate=0.001)
        app.cycles_per_tick = 1
        async with app.run_test() as pilot:
            await pilot.press("space")
            for _ in range(1000):
                await pilot.pause(0.01)
                if debugger.status.cycle > 1:
                    break
            await pilot.press("space")
            await pilot.pause()
            assert debugger.status.channel.run_state is RunState.HOLD
            assert debugger.status.cycle > 1

    asyncio.run(person())


def test_a_refusal_is_said_on_the_screen(debugger: Debugger) -> None:
    async def person() -> None:
        app = DebugScreen(debugger, rate=0.0)
        async with app.run_test() as pilot:
            debugger.control.emergency_stop()
            await pilot.press("space")
            await pilot.pause()
            assert "the emergency stop is on" in remark(app)
            assert "400 emergency stop" in seen(app)
            debugger.control.emergency_stop(False)
            await pilot.press("r", "space")
            await pilot.pause()
            assert remark(app) == ""
            assert debugger.running

    asyncio.run(person())


def test_a_long_program_is_drawn_in_no_time_and_strange_bytes_do_no_harm() -> None:
    text = b"N1 G0 X1 \xff\x1b[31m\n" + b"G1 X1\n" * 200_000
    debugger = Debugger(ProgramText("long", text))

    async def person() -> None:
        app = DebugScreen(debugger, rate=0.0)
        async with app.run_test(size=(80, 20)) as pilot:
            await pilot.press("pagedown", "pagedown")
            await pilot.pause()
            assert app.query_one(Listing).cursor == 41
            assert "41" in seen(app)
            assert "\x1b" not in seen(app)

    asyncio.run(person())


def test_the_command_ends_with_one_message_where_it_cannot_begin(tmp_path: Path) -> None:
    failed = polycnc("debug", tmp_path / "none.nc", status=2)
    assert "no such file" in failed.stderr
    assert "Traceback" not in failed.stderr


def test_without_textual_the_command_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from polycnc.cli._debug import debug_command
    from polycnc.errors import UsageError

    monkeypatch.delitem(sys.modules, "polycnc.cli._debug_screen", raising=False)
    monkeypatch.setitem(sys.modules, "textual.app", None)
    (tmp_path / "p.nc").write_text("M30\n")
    with pytest.raises(UsageError, match="needs textual") as caught:
        debug_command(tmp_path / "p.nc")
    assert "polycnc[debug]" in caught.value.hint
