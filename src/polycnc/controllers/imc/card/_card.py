"""The virtual card: its parameter memory, queues, terminals and time. The function library talks to this.

Everything happens in control cycles of 1 ms. Reading is immediate; an instruction that has been pushed takes effect in
the next cycle that is run, or later, as its queue says.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum

from polycnc.controllers.imc.card._config import CardConfig
from polycnc.controllers.imc.card._power_on import CYCLE_S, make_card, make_machine
from polycnc.controllers.imc.card._status import AxisStatus, CardStatus
from polycnc.controllers.imc.core._addresses import COUNTS, EVENTS, GIN, GINLAT, MOVING
from polycnc.controllers.imc.core._cycle import run_cycles
from polycnc.controllers.imc.core._event_codes import LOAD_MOST
from polycnc.controllers.imc.core._instructions import (
    InstallEvents,
    Instruction,
    Points,
    Segment,
    WaitParam,
    WaitTime,
    encode,
    signed,
    written_words,
)
from polycnc.controllers.imc.core._parameters import WORDS, address, parameter
from polycnc.controllers.imc.core._state import (
    AXIS_RESTED,
    CAPTURES,
    CFIFO,
    COORDINATES,
    EVENTS_MOST,
    CardState,
)
from polycnc.controllers.imc.core._write_effects import empty_now, write_now
from polycnc.errors import UsageError
from polycnc.kernel import KernelState
from polycnc.machine import PIECE_CYCLES, Array, Clock, Snapshot, arrays_of, wait

INPUTS = 32
OUTPUTS = 48
_OUTPUTS = ("gout1", "gout2", "gout3")
_KIND = "card"
_CLEAR_ALL = address("clearimc")


class Fifo(IntEnum):
    """The queues, numbered as the card's functions number them."""

    SEL_IFIFO = 0
    SEL_QFIFO = 1
    SEL_PFIFO1 = 2
    SEL_PFIFO2 = 3
    SEL_CFIFO = 4


_TAKE_INSTRUCTIONS = frozenset(Fifo) - {Fifo.SEL_CFIFO}


class Card:
    """A card as its card file describes it, just switched on.

    `record_cycles` is the size of the recorder's buffer (`kernel.recorder`), 0 for none; a full one keeps what
    it has.
    """

    def __init__(self, config: CardConfig | None = None, *, record_cycles: int = 0) -> None:
        self.config = config or CardConfig()
        self.kernel: KernelState = make_machine(self.config, record_cycles)
        self.state: CardState = make_card(self.config)
        self.clock = Clock(CYCLE_S)

    def __repr__(self) -> str:
        return f"<Card of {self.axes} axes: {self.clock.now_s:.3f} s>"

    # ------------------------------------------------------------------ memory

    @property
    def axes(self) -> int:
        """Number of axes."""
        return self.config.number_of_axes

    def is_axis(self, axis: int) -> bool:
        """Tell whether there is an axis of this number."""
        return 0 <= axis < self.axes

    def _row(self, at: int, axis: int) -> int:
        if not 0 <= at < WORDS:
            raise UsageError(f"there is no address {at}", hint=f"addresses are 0 to {WORDS - 1}")
        if self.state.word[at, 0]:
            return self.axes
        if not self.is_axis(axis):
            raise UsageError(f"there is no axis {axis}", hint=f"the card has axes 0 to {self.axes - 1}")
        return axis

    def read_words(self, at: int, axis: int, count: int) -> tuple[int, ...]:
        """Return `count` words from address `at` on, as unsigned numbers, low word first.

        Each word is that of `axis`, or of the card where the address is the card's.

        Raises:
            UsageError: There is no such address or axis.
        """
        return tuple(int(self.state.memory[self._row(k, axis), k]) & 0xFFFF for k in range(at, at + count))

    def read_raw(self, at: int, axis: int = 0, words: int = 1) -> int:
        """Return `words` words from address `at` on as one signed number.

        Raises:
            UsageError: There is no such address or axis.
        """
        value = sum(word << 16 * k for k, word in enumerate(self.read_words(at, axis, words)))
        return signed(value, words)

    def read(self, name: str, axis: int = 0) -> float:
        """Return the value of the parameter called `name`: pulses, pulses/ms, or a plain number; a set flag is -1.

        Raises:
            UsageError: There is no such parameter or axis.
        """
        each = parameter(name)
        raw = self.read_raw(each.address, axis, each.words)
        if each.type.startswith("U") and raw < 0:
            raw += 1 << 16 * each.words
        return each.from_raw(raw)

    def write_raw(self, at: int, value: int, axis: int = 0, words: int = 1) -> None:
        """Write `words` words of `value` from address `at` on, between two cycles, with all that it sets off.

        Raises:
            UsageError: There is no such address or axis.
        """
        for k in range(at, at + words):
            self._row(k, axis)
        write_now(self.state, at, axis, words, signed(value, words))

    def write(self, name: str, value: float, axis: int = 0) -> None:
        """Write the parameter called `name`, in the units that `read` gives.

        Raises:
            UsageError: There is no such parameter or axis.
        """
        each = parameter(name)
        self.write_raw(each.address, each.to_raw(value), axis, each.words)

    # ------------------------------------------------------------------ queues

    def push(self, fifo: int, instruction: Instruction) -> bool:
        """Put an instruction into a queue; False if there is no room for it, and it is not taken then.

        Raises:
            UsageError: The queue does not take such an instruction: waits are not for IFIFO, segments only for
                PFIFO1 and PFIFO2, points of a
                contour too, nothing but displacements (`push_points`) for CFIFO. Or a load is not of 1 to 31
                events, a segment not of 1 to 16 coordinates, or there are no points. Or the instruction takes more
                words than the queue ever holds.
        """
        if fifo not in _TAKE_INSTRUCTIONS:
            raise UsageError(f"queue {fifo} takes no instructions", hint="give SEL_IFIFO to SEL_PFIFO2")
        if isinstance(instruction, WaitTime | WaitParam) and fifo == Fifo.SEL_IFIFO:
            raise UsageError("IFIFO cannot wait", hint="use SEL_QFIFO, SEL_PFIFO1 or SEL_PFIFO2")
        if isinstance(instruction, Segment):
            if fifo not in (Fifo.SEL_PFIFO1, Fifo.SEL_PFIFO2):
                raise UsageError("a segment is for a path space", hint="use SEL_PFIFO1 or SEL_PFIFO2")
            least = 1 if instruction.center is None else 2
            if not least <= len(instruction.ends) <= COORDINATES:
                raise UsageError(
                    f"a segment of {len(instruction.ends)} axes", hint=f"{least} to {COORDINATES}"
                )
        if isinstance(instruction, Points):
            if fifo not in (Fifo.SEL_PFIFO1, Fifo.SEL_PFIFO2):
                raise UsageError("these points are for a path space", hint="use SEL_PFIFO1 or SEL_PFIFO2")
            if not instruction.displacements:
                raise UsageError("there are no points", hint="give one displacement at least")
        if isinstance(instruction, InstallEvents) and not 1 <= len(instruction.events) <= LOAD_MOST:
            raise UsageError(f"a load of {len(instruction.events)} events", hint=f"1 to {LOAD_MOST}")
        cells = encode(instruction)
        taken = self._put(fifo, cells, cells[2])
        if taken and fifo == Fifo.SEL_IFIFO:
            _note_emptied(self.state, written_words(instruction))
        return taken

    def push_points(self, words: Sequence[int]) -> bool:
        """Put displacements of contour points into CFIFO, all axes of a point one after the other; False if full.

        Raises:
            UsageError: They are more than the queue ever holds.
        """
        return self._put(Fifo.SEL_CFIFO, [signed(word, 1) for word in words], len(words))

    def _put(self, fifo: int, cells: list[int], words: int) -> bool:
        q, ring = self.state.fifo[fifo], self.state.ring[fifo]
        depth = int(q["depth"])
        waiting = int(q["words"]) + words
        if waiting > depth:
            if words > depth:
                raise UsageError(
                    f"{words} words never fit into {Fifo(fifo).name}",
                    hint=f"it holds {depth}; send less at once",
                )
            return False
        tail, size = int(q["tail"]), ring.shape[0]
        for k, cell in enumerate(cells):
            ring[(tail + k) & (size - 1)] = cell
        q["tail"] = tail + len(cells)
        q["words"] = waiting
        q["since"] += words
        self.state.memory[self.axes, COUNTS[fifo]] = signed(waiting, 1)
        return True

    def waiting_words(self, fifo: int) -> int:
        """Return how many 16-bit words wait in a queue."""
        return int(self.state.fifo[fifo]["words"])

    def clear_fifo(self, fifo: int) -> None:
        """Drop everything in a queue, at once, and the wait it is in.

        Raises:
            UsageError: There is no such queue.
        """
        if not 0 <= fifo <= CFIFO:
            raise UsageError(f"there is no queue {fifo}", hint="give SEL_IFIFO to SEL_CFIFO")
        empty_now(self.state, int(fifo))

    @property
    def room_for_events(self) -> int:
        """How many events can still be installed."""
        return EVENTS_MOST - int(self.state.memory[self.axes, EVENTS])

    # ------------------------------------------------------------------ captures

    def read_capture(self, axis: int, most: int) -> tuple[tuple[int, ...], int]:
        """Fetch up to `most` captured positions of an axis, oldest first; return them and how many are left.

        Raises:
            UsageError: There is no such axis.
        """
        self._row(address("cappos"), axis)
        row = self.state.axis[axis]
        count = max(0, min(most, int(row["captured"] - row["fetched"])))
        values = tuple(int(self.state.capture[axis, (row["fetched"] + k) % CAPTURES]) for k in range(count))
        for _ in range(count):
            write_now(self.state, address("popcapfifo"), axis, 1, -1)
        return values, int(row["captured"] - row["fetched"])

    # ------------------------------------------------------------------ the outside

    def set_input(self, number: int, closed: bool) -> None:
        """Close or open the contact at general input `number`, from 1; a closed one reads 0.

        Raises:
            UsageError: There is no such input.
        """
        if not 1 <= number <= INPUTS:
            raise UsageError(f"there is no input {number}", hint=f"inputs are 1 to {INPUTS}")
        at, bit = divmod(number - 1, 16)
        memory, n = self.state.memory, self.axes
        old = int(memory[n, GIN + at])
        new = old & ~(1 << bit) if closed else old | 1 << bit
        memory[n, GIN + at] = signed(new, 1)
        memory[n, GINLAT + at] = signed(int(memory[n, GINLAT + at]) | (old & ~new & 0xFFFF), 1)

    def output(self, number: int) -> bool:
        """Return general output `number`, from 1.

        Raises:
            UsageError: There is no such output.
        """
        if not 1 <= number <= OUTPUTS:
            raise UsageError(f"there is no output {number}", hint=f"outputs are 1 to {OUTPUTS}")
        at, bit = divmod(number - 1, 16)
        return bool(int(self.state.memory[self.axes, address(_OUTPUTS[at])]) >> bit & 1)

    def turn_handwheel(self, axis: int, counts: int) -> None:
        """Turn what is wired to the auxiliary encoder of an axis by some counts, within the next cycle.

        Raises:
            UsageError: There is no such axis.
        """
        self.state.axis[self._row(address("encs"), axis)]["aux"] += counts

    def spin_handwheel(self, axis: int, counts_per_cycle: float) -> None:
        """Let what is wired to the auxiliary encoder of an axis turn steadily.

        Raises:
            UsageError: There is no such axis.
        """
        self.state.axis[self._row(address("encs"), axis)]["aux_rate"] = counts_per_cycle

    def touch_probe(self, axis: int) -> None:
        """Give a pulse of the probe in the next cycle; with bit 10 of encpctr set it captures the position.

        Raises:
            UsageError: There is no such axis.
        """
        self.state.axis[self._row(address("encp"), axis)]["probe_now"] = 1

    # ------------------------------------------------------------------ time

    @property
    def time_s(self) -> float:
        """Time since the card was switched on."""
        return self.clock.now_s

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        """Run up to `cycles` control cycles; return how many were run.

        Fewer after a cycle in which one of the attentions `until` happened (`_state`: AXIS_RESTED, AXIS_ERROR).
        """
        done = 0
        while done < cycles:
            ran = int(run_cycles(self.state, self.kernel, min(cycles - done, PIECE_CYCLES), until or 0))
            self.clock.tick(ran)
            done += ran
            if until and self.state.card[0]["attention"] & until:
                break
        return done

    def is_moving(self, axis: int) -> bool:
        """Tell whether an axis is planning or smoothing a motion."""
        return bool(self.state.memory[axis, MOVING])

    def wait(self, axes: Sequence[int] | None = None, limit_s: float = 3600.0) -> None:
        """Run until no axis of `axes` (all if None) moves, at least one cycle, at most `limit_s`."""
        chosen = range(self.axes) if axes is None else axes
        self.advance(1)
        wait(self, lambda: not any(map(self.is_moving, chosen)), until=AXIS_RESTED, limit_s=limit_s)

    # ------------------------------------------------------------------ state

    def status(self) -> CardStatus:
        """Return what the card is and does in the present cycle."""
        return _status(self)

    def snapshot(self) -> Snapshot:
        """Return the whole state of the card and of the drives around it, and the clock."""
        beside = {"epoch": self.clock.epoch.isoformat()}
        return Snapshot.take(_KIND, self._made_from, self.clock.cycles, self._arrays(), beside)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this card, or of one with the same card file.

        Raises:
            SnapshotError: It is of something else, or damaged; nothing has changed.
        """
        arrays = self._arrays()
        snapshot.check(_KIND, self._made_from, arrays)
        epoch = snapshot.moment("epoch")
        snapshot.restore_state(arrays)
        self.clock.go_back(snapshot.cycle, epoch)

    @property
    def _made_from(self) -> str:
        return self.config.model_dump_json()

    def _arrays(self) -> list[Array]:
        return arrays_of((self.kernel, self.state))


def _status(card: Card) -> CardStatus:
    """Return the status of a card in its present cycle."""
    return CardStatus(
        cycle=card.clock.cycles,
        time_s=card.clock.now_s,
        axes=tuple(
            AxisStatus(
                command=card.read("curpos", i),
                encoder=card.read("encp", i),
                velocity=card.read("curvel", i),
                is_moving=card.is_moving(i),
                error=card.read_words(parameter("error").address, i, 1)[0],
            )
            for i in range(card.axes)
        ),
        inputs=_bits(card, "gin1", "gin2"),
        outputs=_bits(card, "gout1", "gout2", "gout3"),
        queued=tuple(int(words) for words in card.state.fifo["words"]),
    )


def _bits(card: Card, *names: str) -> int:
    words = (card.read_words(parameter(name).address, 0, 1)[0] for name in names)
    return sum(word << 16 * k for k, word in enumerate(words))


def _note_emptied(state: CardState, written: frozenset[int]) -> None:
    """Note how far each queue that an instruction of IFIFO empties is filled now: what comes later stays."""
    for q, count in zip(state.fifo, COUNTS, strict=True):
        if count in written or _CLEAR_ALL in written:
            q["cut"], q["since"] = q["tail"], 0
