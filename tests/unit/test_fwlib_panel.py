"""The software operator's panel through the library: what is written acts on the control (Manual 000)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from polycnc.cnc import RunState
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW


def at(control: PowerMate) -> tuple[Any, int]:
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    return session, handle


SIGNALS = {
    0: ("mode", 4), 3: ("rpd_ovrd", 2), 4: ("jog_ovrd", 17), 5: ("feed_ovrd", 13), 7: ("blck_del", 1),
    8: ("sngl_blck", 1), 9: ("machn_lock", 1), 10: ("dry_run", 1), 11: ("mem_prtct", 1), 12: ("feed_hold", 1),
}  # fmt: skip
UNUSED = (1, 2, 6, 13, 14, 15)
ALL = 0x1FB9


@pytest.mark.covers("fanuc.IODBSGNL.machn_lock.0", "fanuc.IODBSGNL.machn_lock.1")
@pytest.mark.covers("fanuc.cnc_wropnlsgnl")
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.machn_lock")
def test_the_machine_lock_lets_programs_run_without_the_axes() -> None:
    control, library, handle = written(machn_lock=1)
    control.programs.register(7, "O0007\nG1X3.F6000\nG4X0.05\nM30\n")
    control.select_program(7)
    seen = []
    for lock in (1, 0):
        control.cycle_start()
        control.advance(5)
        sgnl = fwlib.IODBSGNL(type=1 << 9, machn_lock=1 - lock)
        assert library.cnc_wropnlsgnl(handle, sgnl) == 0  # within the program: from the next start on
        control.advance(1000)
        assert control.status().channel.run_state is RunState.COMPLETED
        seen.append(control.machine.actual["X"])
    assert seen == [0.0, 3.0]


def short(bits: int) -> int:
    return bits - 0x10000 if bits & 0x8000 else bits


def written(**members: int) -> tuple[PowerMate, Any, int]:
    control = PowerMate()
    library, handle = at(control)
    bits = {name: bit for bit, (name, _) in SIGNALS.items()}
    sgnl = fwlib.IODBSGNL(type=sum(1 << bits[name] for name in members), **members)
    assert library.cnc_wropnlsgnl(handle, sgnl) == 0
    return control, library, handle


@pytest.mark.covers("fanuc.cnc_wropnlsgnl", "fanuc.cnc_rdopnlsgnl")
@pytest.mark.parametrize(
    ("bit", "name", "value"),
    [
        pytest.param(
            bit, name, value, id=name,
            marks=pytest.mark.covers(f"fanuc.cnc_rdopnlsgnl.slct_data.bit{bit}", f"fanuc.IODBSGNL.type.bit{bit}"),
        )
        for bit, (name, value) in SIGNALS.items()
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.type")
def test_a_bit_selects_its_signal_alone(bit: int, name: str, value: int) -> None:
    control = PowerMate()
    library, handle = at(control)
    _, before = library.cnc_rdopnlsgnl(handle, ALL)
    members = dict(SIGNALS.values())
    code = library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=1 << bit, **members))
    assert code == 0
    _, after = library.cnc_rdopnlsgnl(handle, ALL)
    for other in members:
        assert getattr(after, other) == (value if other == name else getattr(before, other))
    _, alone = library.cnc_rdopnlsgnl(handle, 1 << bit)
    assert (alone.type, getattr(alone, name)) == (1 << bit, value)
    assert sum(getattr(alone, other) for other in members) == value
    assert library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=ALL, **members)) == 0
    _, others = library.cnc_rdopnlsgnl(handle, ALL & ~(1 << bit))
    assert others.type == ALL & ~(1 << bit)
    assert {other: getattr(others, other) for other in members} == members | {name: 0}
    assert library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=ALL & ~(1 << bit))) == 0
    found = library.cnc_rdopnlsgnl(handle, ALL)[1]
    assert {other: getattr(found, other) for other in members} == dict.fromkeys(members, 0) | {name: value}


@pytest.mark.covers("fanuc.cnc_rdopnlsgnl")
@pytest.mark.covers(
    *(f"fanuc.cnc_rdopnlsgnl.slct_data.bit{bit}" for bit in UNUSED),
    *(f"fanuc.IODBSGNL.type.bit{bit}" for bit in UNUSED),
    *(f"fanuc.IODBSGNL.{element}" for element in ("datano", "hndl_ax", "hndl_mv", "spdl_ovrd")),
)
@pytest.mark.covers("fanuc.cnc_wropnlsgnl")
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.type")
def test_unused_bits_select_nothing() -> None:
    control = PowerMate()
    library, handle = at(control)
    _, before = library.cnc_rdopnlsgnl(handle, ALL)
    unused = short(sum(1 << bit for bit in UNUSED))
    sgnl = fwlib.IODBSGNL(type=unused, **{name: 99 for name, _ in SIGNALS.values()}, hndl_ax=3, spdl_ovrd=2)
    assert library.cnc_wropnlsgnl(handle, sgnl) == 0
    assert library.cnc_rdopnlsgnl(handle, ALL)[1] == before
    assert bytes(library.cnc_rdopnlsgnl(handle, unused)[1]) == bytes(30)


@pytest.mark.covers("fanuc.cnc_rdopnlsgnl", "fanuc.cnc_wropnlsgnl")
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("rpd_ovrd", 4), ("rpd_ovrd", -1), ("jog_ovrd", 25), ("feed_ovrd", 21), ("mode", 6), ("mode", -1),
        ("blck_del", 2), ("sngl_blck", 2), ("machn_lock", -2), ("dry_run", 2), ("mem_prtct", 3), ("feed_hold", -1),
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wropnlsgnl.err.EW_DATA")
def test_a_bad_value_writes_nothing(name: str, value: int) -> None:
    control, library, handle = written(feed_ovrd=7, dry_run=1)
    _, before = library.cnc_rdopnlsgnl(handle, ALL)
    members = dict(SIGNALS.values()) | {name: value}
    assert library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=ALL, **members)) is EW.EW_DATA
    assert library.cnc_rdopnlsgnl(handle, ALL)[1] == before
    assert control.control.overrides.feed == 0.7


@pytest.mark.covers("fanuc.cnc_rdopnlsgnl")
@pytest.mark.parametrize(
    ("value", "aut"),
    [
        pytest.param(value, aut, marks=pytest.mark.covers(f"fanuc.IODBSGNL.mode.{value}"))
        for value, aut in enumerate((0, 1, 3, 4, 5, 9))
    ],
)
@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.mode")
def test_mode(value: int, aut: int) -> None:
    control, library, handle = written(mode=value)
    assert library.cnc_statinfo(handle)[1].aut == aut
    assert control.pmc.read("F", 73, 73)[0] == (0, 1, 3, 4, 5, 0x15)[value]
    control.power_cycle()
    assert library.cnc_statinfo(handle)[1].aut == aut
    assert library.cnc_rdopnlsgnl(handle, 1)[1].mode == value


@pytest.mark.parametrize(
    ("value", "mm_min"),
    [
        pytest.param(value, speed, marks=pytest.mark.covers(f"fanuc.IODBSGNL.rpd_ovrd.{value}"))
        for value, speed in enumerate((15000, 7500, 3750, 500))
    ],
)
@pytest.mark.covers("fanuc.IODBSGNL.rpd_ovrd")
@pytest.mark.covers("fanuc.IODBSGNL")
def test_rapid_override(value: int, mm_min: int) -> None:
    control, _, _ = written(rpd_ovrd=value)
    control.programs.memory.create("O0004", b"O0004\nG0 X300.\n")
    control.select_program(4)
    control.cycle_start()
    control.advance(300)
    assert round(control.status().axes["X"].velocity * 60.0) == mm_min
    assert control.pmc.read("F", 76, 76) == bytes([value << 4])
    control.power_cycle()
    assert (control.signals.rapid_override, control.pmc.read("F", 76, 76)[0]) == (value, value << 4)


@pytest.mark.covers("fanuc.IODBSGNL.rpd_ovrd.3")
def test_f0_follows_its_parameter_at_once() -> None:
    control, _, _ = written(rpd_ovrd=3)
    control.programs.memory.create("O0004", b"O0004\nG0 X300.\n")
    control.select_program(4)
    control.parameters.set(1421, 700, 1)
    control.cycle_start()
    control.advance(300)
    seen = [round(control.status().axes["X"].velocity * 60.0)]
    for mm_min in (250, 15_000):
        control.parameters.set(1421, mm_min, 1)
        control.advance(600)
        seen.append(round(control.status().axes["X"].velocity * 60.0))
    assert seen == [700, 250, 15_000]


JOG_PERCENT = (
    0, 0.1, 0.14, 0.2, 0.27, 0.37, 0.52, 0.72, 1.0, 1.4, 2.0, 2.7, 3.7, 5.2, 7.2, 10.0, 14.0, 20.0, 27.0, 37.0, 52.0,
    72.0, 100, 140, 200,
)  # fmt: skip


@pytest.mark.parametrize(
    ("value", "percent"),
    [
        pytest.param(value, percent, marks=pytest.mark.covers(f"fanuc.IODBSGNL.jog_ovrd.{value}"))
        for value, percent in enumerate(JOG_PERCENT)
    ],
)
@pytest.mark.covers("fanuc.IODBSGNL.jog_ovrd")
@pytest.mark.covers("fanuc.IODBSGNL")
def test_jog_override(value: int, percent: float) -> None:
    control, _, _ = written(jog_ovrd=value, mode=4)
    control.signals.give(100, 4)
    control.advance(400)
    assert control.status().axes["Z"].velocity * 60.0 == pytest.approx(3000.0 * percent / 100.0, abs=1e-6)
    counts = int.from_bytes(control.pmc.read("F", 79, 80), "little")  # as the PMC sees it: 0.01 %, inverted
    assert 0xFFFF - counts == round(percent * 100)
    control.power_cycle()
    assert control.signals.jog_override == percent


@pytest.mark.parametrize(
    ("value", "percent"),
    [
        pytest.param(value, 10 * value, marks=pytest.mark.covers(f"fanuc.IODBSGNL.feed_ovrd.{value}"))
        for value in range(21)
    ],
)
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.feed_ovrd")
def test_feed_override(value: int, percent: int) -> None:
    control, _, _ = written(feed_ovrd=value)
    control.programs.memory.create("O0004", b"O0004\nG1 Y90. F450\n")
    control.select_program(4)
    control.cycle_start()
    control.advance(300)
    assert control.status().axes["Y"].velocity * 60.0 == pytest.approx(450.0 * percent / 100.0, abs=1e-6)
    assert control.pmc.read("F", 78, 78) == bytes([255 - percent])
    control.power_cycle()
    assert (control.signals.feed_override, control.pmc.read("F", 78, 78)) == (percent, bytes([255 - percent]))


PROGRAM = b"O0004\nG1 X2. F600\n/Y3.\nZ4.\n"


@pytest.mark.parametrize(
    ("member", "value", "seen"),
    [
        pytest.param("blck_del", 0, 3000, marks=pytest.mark.covers("fanuc.IODBSGNL.blck_del.0")),
        pytest.param("blck_del", 1, 0, marks=pytest.mark.covers("fanuc.IODBSGNL.blck_del.1")),
        pytest.param("sngl_blck", 0, 3000, marks=pytest.mark.covers("fanuc.IODBSGNL.sngl_blck.0")),
        pytest.param("sngl_blck", 1, 0, marks=pytest.mark.covers("fanuc.IODBSGNL.sngl_blck.1")),
    ],
)
@pytest.mark.covers("fanuc.IODBSGNL.blck_del")
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.sngl_blck")
def test_switches_of_a_program(member: str, value: int, seen: int) -> None:
    control, _, _ = written(**{member: 1 - value})
    control.panel.set({member: value})
    control.programs.memory.create("O0004", PROGRAM)
    control.select_program(4)
    control.cycle_start()
    control.advance(3000)
    assert control.positions.read()[1].machine == seen


@pytest.mark.parametrize(
    ("value", "mm_min"),
    [
        pytest.param(0, 240, marks=pytest.mark.covers("fanuc.IODBSGNL.dry_run.0")),
        pytest.param(1, 3000, marks=pytest.mark.covers("fanuc.IODBSGNL.dry_run.1")),
    ],
)
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.dry_run")
def test_dry_run(value: int, mm_min: int) -> None:
    control, _, _ = written(dry_run=1 - value)
    control.panel.set({"dry_run": value})
    control.programs.memory.create("O0004", b"O0004\nG1 X90. F240\n")
    control.select_program(4)
    control.cycle_start()
    control.advance(400)
    assert control.status().axes["X"].velocity * 60.0 == pytest.approx(mm_min)


@pytest.mark.covers("fanuc.cnc_wropnlsgnl")
@pytest.mark.covers("fanuc.IODBSGNL.mem_prtct.0", "fanuc.IODBSGNL.mem_prtct.1")
@pytest.mark.covers("fanuc.IODBSGNL.mem_prtct")
@pytest.mark.covers("fanuc.IODBSGNL")
@pytest.mark.covers("fanuc.concept.write_protection_programs", "fanuc.concept.protect_key")
def test_memory_protection() -> None:
    control, library, handle = written(mem_prtct=1)
    assert control.state.protection_keys == {1, 2, 3, 4}
    assert library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=1 << 11, mem_prtct=0)) == 0
    assert control.state.protection_keys == set()


@pytest.mark.covers("fanuc.IODBSGNL.feed_hold.0", "fanuc.IODBSGNL.feed_hold.1")
@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.IODBSGNL", "fanuc.IODBSGNL.feed_hold")
@pytest.mark.covers("fanuc.cnc_wropnlsgnl")
def test_feed_hold_holds_and_keeps_from_starting() -> None:
    control, library, handle = written(feed_hold=0)
    control.programs.memory.create("O0004", b"O0004\nG1 X90. F240\n")
    control.select_program(4)
    control.cycle_start()
    control.advance(100)
    library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=1 << 12, feed_hold=1))
    control.advance(100)
    assert library.cnc_statinfo(handle)[1].run == 2
    control.signals.give(7, 4)
    control.signals.give(7, 0)
    control.advance(10)
    assert library.cnc_statinfo(handle)[1].run == 2
    library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=1 << 12, feed_hold=0))
    control.signals.give(7, 4)
    control.signals.give(7, 0)
    control.advance(10)
    assert control.control.channels[0].run_state is RunState.ACTIVE


OTHERS = ("blck_del", "sngl_blck", "machn_lock", "dry_run", "mem_prtct", "feed_hold")


@pytest.mark.parametrize("value", [0, 1])
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.covers(f"fanuc.IODBSGNL.{name}.0", f"fanuc.IODBSGNL.{name}.1"))
        for name in OTHERS
    ],
)
@pytest.mark.covers("fanuc.cnc_wropnlsgnl", "fanuc.IODBSGNL")
def test_a_switch_of_the_panel_is_that_switch_alone(name: str, value: int) -> None:
    """F75 has BDTO, SBKO, MLKO, DRNO, KEYO and SPO in bits 2 to 7."""
    control, library, handle = written(**dict.fromkeys(OTHERS, 1 - value))
    bits = {each: bit for bit, (each, _) in SIGNALS.items()}
    sgnl = fwlib.IODBSGNL(type=1 << bits[name], **dict.fromkeys(OTHERS, value))
    assert library.cnc_wropnlsgnl(handle, sgnl) == 0
    switches = control.control.switches
    found = {
        "blck_del": 1 in switches.block_delete,
        "sngl_blck": switches.single_block,
        "machn_lock": switches.machine_lock,
        "dry_run": switches.dry_run,
        "mem_prtct": control.state.protection_keys == {1, 2, 3, 4},
        "feed_hold": control.signals.state.hold_is_on,
    }
    assert found == {each: bool(value if each == name else 1 - value) for each in OTHERS}
    assert bool(control.pmc.read("F", 2, 2)[0] & 0x80) is switches.dry_run
    bit = 4 << OTHERS.index(name)
    assert control.pmc.read("F", 75, 75)[0] == (bit if value else 0xFC & ~bit)


# ---------------------------------------------------------------------- general-purpose signals and names


@pytest.mark.covers("fanuc.cnc_rdopnlgnrl", "fanuc.cnc_wropnlgnrl")
@pytest.mark.parametrize(
    "bit",
    [
        pytest.param(
            bit,
            marks=pytest.mark.covers(
                f"fanuc.IODBGNRL.sgnal.bit{bit}", f"fanuc.cnc_rdopnlgnrl.slct_data.bit{bit}",
                f"fanuc.cnc_wropnlgnrl.type.bit{bit}",
            ),
        )
        for bit in range(8)
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.IODBGNRL.sgnal")
@pytest.mark.covers("fanuc.IODBGNRL")
def test_a_general_purpose_signal(bit: int) -> None:
    control = PowerMate()
    library, handle = at(control)
    assert library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=1 << bit, sgnal=0xFF)) == 0
    code, found = library.cnc_rdopnlgnrl(handle, 0xFF)
    assert (code, found.sgnal, found.type) == (0, 1 << bit, 0xFF)
    assert control.pmc.read("F", 72, 72)[0] == 1 << bit
    library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=0xFF, sgnal=0xFF))
    assert library.cnc_rdopnlgnrl(handle, 1 << bit)[1].sgnal == 1 << bit
    library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=1 << bit, sgnal=0))
    assert library.cnc_rdopnlgnrl(handle, 0xFF)[1].sgnal == 0xFF ^ 1 << bit
    others = 0xFF ^ 1 << bit  # what is not selected is not written, and not read
    for value in (0, 0xFF):
        library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=0xFF, sgnal=value))
        library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=others, sgnal=0xFF ^ value))
        assert library.cnc_rdopnlgnrl(handle, 0xFF)[1].sgnal == (0xFF ^ value) ^ 1 << bit
    library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=0xFF, sgnal=0xFF))
    _, found = library.cnc_rdopnlgnrl(handle, others)
    assert (found.type, found.sgnal) == (others, others)
    control.power_cycle()
    assert library.cnc_rdopnlgnrl(handle, 0xFF)[1].sgnal == 0xFF


@pytest.mark.covers("fanuc.cnc_wropnlgsname", "fanuc.cnc_wropnlgnrl")
@pytest.mark.covers("fanuc.cnc_rdopnlgnrl", "fanuc.cnc_rdopnlgsname")
@pytest.mark.covers(
    "fanuc.cnc_rdopnlgnrl.slct_data.bits15_8", "fanuc.cnc_wropnlgnrl.type.bits15_8",
    "fanuc.cnc_rdopnlgsname.slct_data.bits15_8", "fanuc.IODBRDNA.type.bits15_8",
)  # fmt: skip
@pytest.mark.covers("fanuc.IODBRDNA", "fanuc.IODBRDNA.type")
def test_bits_above_the_eighth_select_nothing() -> None:
    library, handle = at(PowerMate())
    library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=-256, sgnal=0x5A))
    library.cnc_wropnlgsname(handle, fwlib.IODBRDNA(type=-256, sgnl3_name=b"COOLANT"))
    assert library.cnc_rdopnlgnrl(handle, 0xFF)[1].sgnal == 0
    assert library.cnc_rdopnlgsname(handle, 4)[1].sgnl3_name == b" " * 8
    assert bytes(library.cnc_rdopnlgnrl(handle, -256)[1]) == bytes(5)
    assert bytes(library.cnc_rdopnlgsname(handle, -256)[1]) == bytes(76)


@pytest.mark.covers("fanuc.cnc_rdopnlgsname", "fanuc.cnc_wropnlgsname")
@pytest.mark.parametrize(
    "bit",
    [
        pytest.param(
            bit,
            marks=pytest.mark.covers(
                f"fanuc.cnc_rdopnlgsname.slct_data.bit{bit}", f"fanuc.IODBRDNA.type.bit{bit}"
            ),
        )
        for bit in range(8)
    ],
)
@pytest.mark.covers(
    "fanuc.IODBRDNA.type",
    "fanuc.IODBRDNA.sgnl1_name",
    "fanuc.IODBRDNA.sgnl2_name",
    "fanuc.IODBRDNA.sgnl3_name",
    "fanuc.IODBRDNA.sgnl4_name",
    "fanuc.IODBRDNA.sgnl5_name",
    "fanuc.IODBRDNA.sgnl6_name",
    "fanuc.IODBRDNA.sgnl7_name",
    "fanuc.IODBRDNA.sgnl8_name",
)
@pytest.mark.covers("fanuc.IODBRDNA")
def test_a_signal_has_a_name_of_eight_characters(bit: int) -> None:
    library, handle = at(PowerMate())
    names = {f"sgnl{k}_name": f"NAME-OF-{k}".encode() for k in range(1, 9)}
    assert (
        library.cnc_wropnlgsname(
            handle, fwlib.IODBRDNA(type=1 << bit, **{k: v[:9] for k, v in names.items()})
        )
        == 0
    )
    _, every = library.cnc_rdopnlgsname(handle, 0xFF)
    memory = bytes(every)
    for k in range(8):
        text = b"NAME-OF-" if k == bit else b" " * 8
        assert memory[4 + 9 * k : 13 + 9 * k] == text + b"\0"
    _, one = library.cnc_rdopnlgsname(handle, 1 << bit)
    assert one.type == 1 << bit
    assert bytes(one).count(b"NAME-OF-") == 1
    assert bytes(one)[4:].count(b" ") == 0
    rest = fwlib.IODBRDNA(type=0xFF ^ 1 << bit, **{f"sgnl{k}_name": b"OTHER" for k in range(1, 9)})
    assert library.cnc_wropnlgsname(handle, rest) == 0
    _, found = library.cnc_rdopnlgsname(handle, 0xFF)
    kept = {f"sgnl{bit + 1}_name": b"NAME-OF-"}
    assert {name: getattr(found, name) for name in names} == dict.fromkeys(names, b"OTHER   ") | kept
    _, found = library.cnc_rdopnlgsname(handle, 0xFF ^ 1 << bit)
    assert (found.type, getattr(found, f"sgnl{bit + 1}_name")) == (0xFF ^ 1 << bit, b"")


@pytest.mark.covers("fanuc.cnc_rdopnlgnrl", "fanuc.cnc_rdopnlgsname")
@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.cnc_wropnlsgnl", "fanuc.cnc_wropnlgnrl", "fanuc.cnc_wropnlgsname")
def test_the_panel_outlasts_switching_off(tmp_path: Path) -> None:
    control = PowerMate(memory=tmp_path / "memory")
    library, handle = at(control)
    library.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=0x21, mode=4, feed_ovrd=3))
    library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=0x30, sgnal=0x20))
    library.cnc_wropnlgsname(handle, fwlib.IODBRDNA(type=2, sgnl2_name=b"LIGHT"))
    control.power_cycle()
    assert control.control.overrides.feed == 0.3
    control.close()
    again = PowerMate(memory=tmp_path / "memory")
    library, handle = at(again)
    assert library.cnc_statinfo(handle)[1].aut == 5
    assert library.cnc_rdopnlgnrl(handle, 0xFF)[1].sgnal == 0x20
    assert library.cnc_rdopnlgsname(handle, 2)[1].sgnl2_name == b"LIGHT   "
    again.close()


@pytest.mark.parametrize(("mode", "byte"), [(0, 0), (1, 1), (2, 3), (3, 4), (4, 5), (5, 0x15)])
@pytest.mark.covers(
    "fanuc.IODBSGNL.mode.0",
    "fanuc.IODBSGNL.mode.1",
    "fanuc.IODBSGNL.mode.2",
    "fanuc.IODBSGNL.mode.3",
    "fanuc.IODBSGNL.mode.4",
    "fanuc.IODBSGNL.mode.5",
)
def test_the_mode_of_the_panel_is_shown_to_the_pmc_by_its_signals(mode: int, byte: int) -> None:
    """MD1O, MD2O, MD4O are bits 0 to 2 of F73, ZRNO is bit 4: MEM 1, EDIT 3, HND 4, JOG 5, REF 5 with ZRNO."""
    control, _, _ = written(mode=mode)
    assert control.signals.f(73) == byte
