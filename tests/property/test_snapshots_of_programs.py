"""Programs whose language is under way, put back in the middle: they end as if nobody had looked, to the bit."""

from __future__ import annotations

import json
import pickle
import random
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from polycnc.cnc import ProgramRun, RunOptions, RunSnapshot, RunState
from polycnc.machine import Machine, Snapshot, SnapshotError, load_machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.cpl import CplLanguage
from polycnc.nc.macro import MacroLanguage
from support.cpl_host import RecordingHost
from support.cpl_programs import cpl_programs
from support.macro_programs import macro_programs
from support.runs import program_run

_STEP = 700


class Rig:
    """A run of custom macros in files, and all that it tells."""

    def __init__(self, main: Path) -> None:
        self.printed = bytearray()
        self.language = MacroLanguage()
        self.language.output.sink = self.printed.extend
        config = load_machine(None)
        self.run = ProgramRun(
            Machine(config, segments=256),
            ProgramText.from_path(main),
            load_dialect("fanuc"),
            options=RunOptions(),
            language=self.language,
        )

    def go(self, cycles: int) -> int:
        """Let time pass, also where the program stands and is told to go on; return how much."""
        done = 0
        while done < cycles:
            if self.run.state is RunState.PROGRAM_STOP:
                self.run.resume()
            if not self.run.active:
                break
            done += self.run.advance(cycles - done)
            if self.run.state is RunState.PROGRAM_STOP:
                break
        return done

    def kept(self) -> tuple[bytes, bytes]:
        """Return run and machine as the contents of two files."""
        return self.run.snapshot().to_bytes(), self.run.machine.snapshot().to_bytes()

    def restore_state(self, kept: tuple[bytes, bytes]) -> None:
        self.run.machine.restore(Snapshot.from_bytes(kept[1]))
        self.run.restore(RunSnapshot.from_bytes(kept[0]))

    def end(self) -> tuple[object, ...]:
        """Go on to the end; return all that can be seen then."""
        while self.run.active or self.run.state is RunState.PROGRAM_STOP:
            self.go(100_000)
        self.run.feed.blocks.pass_marks()  # how many are left depends on how often somebody looked
        variables = self.language.variables
        return (
            self.run.state,
            str(self.run.error),
            self.run.machine.clock.cycles,
            self.run.machine.snapshot(),
            self.run.snapshot(),
            list(variables.common),
            list(variables.local),
            self.run.channel.messages.all(),
        )


class CplRig(Rig):
    """A run of CPL programs that a host keeps; it answers from the machine."""

    def __init__(self, programs: dict[str, str]) -> None:
        functions: dict[str, Callable[..., object]] = {
            "MPOS": self.position,
            "CLOCK": self.clock,
            "IC": self.interface,
        }
        self.printed = bytearray()
        self.machine = Machine(load_machine(None), segments=256)
        self.host = RecordingHost(functions, programs)
        self.cpl = CplLanguage(self.host)
        self.run = ProgramRun(
            self.machine,
            ProgramText.from_text(programs["main.cpl"], "main.cpl"),
            load_dialect("bosch"),
            options=RunOptions(),
            language=self.cpl,
        )

    def position(self, axis: int) -> float:
        return self.machine.setpoints["XYZ"[axis - 1]]

    def clock(self) -> int:
        return round(self.machine.clock.cycles * self.machine.clock.cycle_s * 1000)

    def interface(self, bit: int) -> bool:
        return self.machine.setpoints["X"] > bit

    def end(self) -> tuple[object, ...]:
        while self.run.active:
            self.go(100_000)
        self.run.feed.blocks.pass_marks()
        return (
            self.run.state,
            str(self.run.error),
            self.machine.clock.cycles,
            self.machine.snapshot(),
            self.run.snapshot(),
            dict(self.host.permanent),
            dict(self.cpl.globals),
            self.run.channel.messages.all(),
        )


def written(folder: Path, seed: int) -> Path:
    for name, text in macro_programs(seed).items():
        (folder / name).write_text(text)
    return folder / "main.nc"


@pytest.mark.parametrize("seeds", [range(7), pytest.param(range(7, 500), marks=pytest.mark.long)])
def test_a_macro_program_goes_on_from_any_cycle(tmp_path: Path, seeds: range) -> None:
    within = stops = 0
    for seed in seeds:
        folder = tmp_path / str(seed)
        folder.mkdir()
        main, chance = written(folder, seed), random.Random(seed)
        rig = Rig(main)
        rig.run.start()
        taken = []
        while rig.run.active or rig.run.state is RunState.PROGRAM_STOP:
            rig.go(chance.randrange(1, _STEP))
            taken.append((rig.kept(), len(rig.printed)))
            within += bool(rig.run.reading.stack)
            stops += rig.run.state is RunState.PROGRAM_STOP
        printed, wanted = bytes(rig.printed), rig.end()
        assert rig.run.state is RunState.COMPLETED, f"seed {seed}: {rig.run.error}"
        for kept, before in chance.sample(taken, min(5, len(taken))):
            other = Rig(main)
            other.restore_state(kept)
            assert other.kept() == kept
            assert other.end() == wanted, f"seed {seed}"
            assert printed[:before] + bytes(other.printed) == printed
    assert within > len(seeds)
    assert stops > len(seeds) / 3


@pytest.mark.parametrize(
    "seeds",
    [
        range(7),
        range(129, 130),  # a program that was called twice was two texts, until a snapshot made them one
        pytest.param(range(7, 500), marks=pytest.mark.long),
    ],
)
def test_a_cpl_program_goes_on_from_any_cycle(seeds: range) -> None:
    within = waits = 0
    for seed in seeds:
        programs, chance = cpl_programs(seed), random.Random(seed)
        rig = CplRig(programs)
        rig.run.start()
        taken = []
        pieces: list[int] = []
        while rig.run.active:
            pieces.append(chance.randrange(1, 90))
            rig.go(pieces[-1])
            if rig.cpl.running:  # permanent variables are durable, and in a snapshot only as long
                taken.append((rig.kept(), len(pieces)))
            within += bool(rig.run.reading.stack)
            waits += any(source.waits for source in rig.cpl.running)
        wanted = rig.end()
        assert rig.run.state is RunState.COMPLETED, f"seed {seed}: {rig.run.error}"
        for kept, passed in chance.sample(taken, min(6, len(taken))):
            other = CplRig(programs)
            other.restore_state(kept)
            assert other.kept() == kept
            for cycles in pieces[passed:]:  # how far is planned ahead depends on how often somebody looks
                other.go(cycles)
            assert other.end() == wanted, f"seed {seed}"
    assert within > len(seeds) / 2
    assert waits > len(seeds) / 2


MAIN = """POPEN
#100=3
WHILE[#1LT4]DO1
#1=#1+1
G65 P7001 A#1 B2.5
#100=#100+1
END1
M0
DPRNT[E#500[53]]
PCLOS
M30
"""
CALLED = """O7001
G1 X#1 Y[#2*#100/4] F3000
DPRNT[A#1[53]*B#100[53]]
G4 X0.05
#500=#500+#5041
G1 X[7-#1]
M99
"""


def in_the_middle(folder: Path) -> tuple[Rig, tuple[bytes, bytes]]:
    """Return a run in the second round of a loop, within the macro that it calls."""
    (folder / "main.nc").write_text(MAIN)
    (folder / "O7001.nc").write_text(CALLED)
    rig = Rig(folder / "main.nc")
    rig.run.start()
    for _ in range(1000):
        rig.go(7)
        if rig.run.reading.stack and rig.language.variables.locals_of(0)[1] == 2.0:
            break
    assert rig.run.reading.stack
    return rig, rig.kept()


_AGAIN = """
import pickle, sys
from pathlib import Path
sys.path[:0] = sys.argv[2:]
from test_snapshots_of_programs import Rig
rig = Rig(Path(sys.argv[1], "main.nc"))
rig.restore_state((Path(sys.argv[1], "run").read_bytes(), Path(sys.argv[1], "machine").read_bytes()))
end = rig.end()
Path(sys.argv[1], "end").write_bytes(pickle.dumps((rig.kept(), [*end[:3], *end[5:]], bytes(rig.printed))))
"""


def test_a_program_goes_on_in_another_process(tmp_path: Path) -> None:
    rig, _ = in_the_middle(tmp_path)
    for name, content in zip(("run", "machine"), rig.kept(), strict=True):
        (tmp_path / name).write_bytes(content)
    before = len(rig.printed)
    end = rig.end()
    folders = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]
    subprocess.run([sys.executable, "-c", _AGAIN, str(tmp_path), *folders], check=True, timeout=300)
    kept, values, printed = pickle.loads((tmp_path / "end").read_bytes())
    assert kept == rig.kept()
    assert values == [*end[:3], *end[5:]]
    assert bytes(rig.printed[before:]) == printed


# --- refused before anything changes


@pytest.mark.parametrize("name", ["main.nc", "called"])
def test_a_program_that_has_been_changed_is_refused(tmp_path: Path, name: str) -> None:
    rig, kept = in_the_middle(tmp_path)
    assert rig.run.reading.block is not None
    path = tmp_path / (Path(rig.run.reading.block.program).name if name == "called" else name)
    other = Rig(tmp_path / "main.nc")
    path.write_text(path.read_text().replace("#100=#100+1", "#100=#100+2") + "(CHANGED)\n")
    before = other.kept()
    with pytest.raises(SnapshotError, match=path.name):
        other.run.restore(RunSnapshot.from_bytes(kept[0]))
    assert other.kept() == before


def test_snapshots_of_other_runs_are_refused(tmp_path: Path) -> None:
    rig, kept = in_the_middle(tmp_path)
    run = RunSnapshot.from_bytes(kept[0])
    for other in (program_run("G1 X5\n", language=MacroLanguage()), program_run("G1 X5\n", dialect="fanuc")):
        before = other.snapshot()
        with pytest.raises(SnapshotError, match="another program run"):
            other.restore(run)
        with pytest.raises(SnapshotError, match="of a machine"):
            other.restore(rig.run.machine.snapshot())
        assert other.snapshot() == before


def test_a_run_without_its_language_is_refused(tmp_path: Path) -> None:
    rig, kept = in_the_middle(tmp_path)
    alone = ProgramRun(
        Machine(load_machine(None), segments=256),
        rig.run.program,
        load_dialect("fanuc"),
        options=RunOptions(),
    )
    with pytest.raises(SnapshotError):
        alone.restore(RunSnapshot.from_bytes(kept[0]))


def mutated(plain: Any, chance: random.Random) -> Any:
    """Return data with one thing in it changed."""
    if isinstance(plain, list | dict) and plain and chance.random() < 0.97:
        place = chance.choice(list(plain)) if isinstance(plain, dict) else chance.randrange(len(plain))
        changed = dict(plain) if isinstance(plain, dict) else list(plain)
        changed[place] = mutated(plain[place], chance)
        return changed
    return chance.choice(
        [None, True, -7, 3, 1e300, "X", [], ["()"], ["{}", ["()"]], ["Stop", 3], ["()", 1, 2], {}]
    )


@pytest.mark.parametrize("count", [80, pytest.param(20_000, marks=pytest.mark.long)])
def test_data_that_is_no_snapshot_is_refused_whole(tmp_path: Path, count: int) -> None:
    _, kept = in_the_middle(tmp_path)
    whole = RunSnapshot.from_bytes(kept[0])
    data, chance = json.loads(whole.beside), random.Random(7)
    other = Rig(tmp_path / "main.nc")
    other.run.start()
    other.go(23)
    before, refused = other.kept(), 0
    for _ in range(count):
        wrong = replace(
            whole, beside=json.dumps(mutated(data, chance), sort_keys=True, separators=(",", ":"))
        )
        try:
            other.run.restore(wrong)
        except SnapshotError:
            refused += 1
            assert other.kept() == before
        else:
            other.restore_state(before)
    assert refused > count / 2


def test_a_file_that_is_cut_or_changed_is_refused(tmp_path: Path) -> None:
    _, kept = in_the_middle(tmp_path)
    for wrong in (kept[0][:-3], kept[0][:200], b"", kept[0][:300] + b"?" + kept[0][301:]):
        with pytest.raises(SnapshotError):
            RunSnapshot.from_bytes(wrong)
