"""One control cycle of the card, and many: queues, paths, contour, events, axes, machine, feedback, errors, homing.

Python is entered again only when something happens that it waits for.
"""

from __future__ import annotations

from polycnc.controllers.imc.core._addresses import DELAY, SPACE, STARTPATH, TICKS, TIMER
from polycnc.controllers.imc.core._axis_turn import axes_turn
from polycnc.controllers.imc.core._contour import contour_cycle
from polycnc.controllers.imc.core._errors import axis_errors, errors_cycle
from polycnc.controllers.imc.core._events import events_cycle
from polycnc.controllers.imc.core._feedback import encoders_cycle, flags_cycle, probes_cycle, terminals_cycle
from polycnc.controllers.imc.core._homing import homing_cycle
from polycnc.controllers.imc.core._path import begin_space_cycle, end_space_cycle, go_along
from polycnc.controllers.imc.core._queue import AT_SEGMENT, DONE, take_instruction
from polycnc.controllers.imc.core._segment import begin_segment
from polycnc.controllers.imc.core._state import CFIFO, IFIFO, PFIFO1, QFIFO, CardState
from polycnc.controllers.imc.core._words import get_u16, get_u32, put16, put32
from polycnc.kernel import KernelState, compiled, entry, follow_cycle, sources_cycle

TURNS = 128  # instructions, segments included, that a queue may get through in one cycle


@compiled
def _may_go_on(s: CardState, f: int) -> bool:
    """Tell whether queue `f`, having carried out an instruction, takes another one in the same cycle."""
    if f == QFIFO:
        return False
    if f == IFIFO:
        return bool(s.card[0]["hold"] == 0)
    return bool(s.memory[s.axis.shape[0], STARTPATH + (f - PFIFO1) * SPACE] != 0)


@compiled
def _queue_cycle(s: CardState, f: int) -> None:
    """Carry out what queue `f` may in one cycle: all of IFIFO, one instruction of QFIFO, a path up to where it gets."""
    g = f - PFIFO1
    lead = 1.0  # a segment that begins from rest has the whole cycle
    s.card[0]["hold"] = 0
    for _ in range(TURNS):
        if g >= 0 and s.space[g]["active"] != 0:
            lead = go_along(s, g)
            if lead < 0.0:
                return
            continue
        result = take_instruction(s, f)
        if result == AT_SEGMENT:
            begin_segment(s, g, lead)
        elif result != DONE or not _may_go_on(s, f):
            return


@compiled
def queues_cycle(s: CardState) -> None:
    """Give every queue its turn, and the path spaces after two of them."""
    for f in range(CFIFO):
        path = f >= PFIFO1
        if path and not begin_space_cycle(s, f - PFIFO1):
            continue
        if path or s.fifo[f]["head"] != s.fifo[f]["tail"] or s.fifo[f]["waiting"] != 0:
            s.card[0]["immediate"] = f == IFIFO
            _queue_cycle(s, f)
            s.card[0]["immediate"] = 0
        if path:
            end_space_cycle(s, f - PFIFO1)


@compiled
def _timers_cycle(s: CardState) -> None:
    m, n = s.memory, s.axis.shape[0]
    timer = get_u16(m, n, TIMER)
    if timer != 0:
        put16(m, n, TIMER, timer - 1)
    delay = get_u32(m, n, DELAY)
    if delay != 0:
        put32(m, n, DELAY, max(delay - s.card[0]["delay_step"], 0))
    put32(m, n, TICKS, get_u32(m, n, TICKS) + 1)


@compiled
def _machine_cycle(s: CardState, state: KernelState) -> None:
    """Put out the pulses, and let the machine follow them."""
    for i in range(s.axis.shape[0]):
        state.base[i] = float(s.axis[i]["machine"] >> 16)
        state.work[1, i] = state.servo.actual[i]
    sources_cycle(state)
    follow_cycle(state)


@compiled
def _feedback_cycle(s: CardState, state: KernelState, i: int) -> None:
    """Let axis `i` measure and show what it has done."""
    actual = state.servo.actual[i]
    encoders_cycle(s, i, actual)
    levels = terminals_cycle(s, state, i)
    homing_cycle(s, state, i)
    probes_cycle(s, state, i, actual, state.work[1, i])
    flags_cycle(s, i)
    axis_errors(s, i, levels)


@compiled
def control_cycle(s: CardState, state: KernelState) -> None:
    """Run one control cycle."""
    queues_cycle(s)
    contour_cycle(s)
    if s.card[0]["events"] != 0:
        events_cycle(s)
    _timers_cycle(s)
    errors_cycle(s)
    axes_turn(s)
    _machine_cycle(s, state)
    for i in range(s.axis.shape[0]):
        _feedback_cycle(s, state, i)
    s.card[0]["cycle"] += 1


@entry(steps=lambda s, state, cycles, mask: cycles * 6 * len(state.setpoint))
def run_cycles(s: CardState, state: KernelState, cycles: int, mask: int) -> int:
    """Run up to `cycles` control cycles, fewer when something of `mask` happens; return how many were run."""
    card = s.card[0]
    for done in range(cycles):
        card["attention"] = 0
        control_cycle(s, state)
        if card["attention"] & mask:
            return done + 1
    return cycles
