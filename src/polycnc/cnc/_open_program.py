"""A program that is fed while it is executed: each line is checked as it comes, and nothing of what runs notices."""

from __future__ import annotations

from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._run_state import RunState
from polycnc.machine import Clock
from polycnc.nc import IncomingText, LineCheck, ModalWords


class OpenProgram:
    """Feed a program that a channel executes, or will execute; see `Control.open_program`.

    Blocks are prepared as they come, with all that has come to look ahead at. Where nothing more has come the path
    rests at its end and goes on with the next block, without a mark. `end` says that nothing more comes.
    """

    def __init__(self, channel: ControlChannel, text: IncomingText, clock: Clock) -> None:
        self._channel = channel
        self._text = text
        self._clock = clock
        self._check: tuple[ProgramRun, LineCheck] | None = None
        self._rehearses = False

    @property
    def name(self) -> str:
        """What blocks of it are shown under."""
        return self._text.name

    @property
    def is_open(self) -> bool:
        """Whether more may be fed: neither `end`, its last block, a reset nor another program has ended it."""
        return not self._text.ended and self._run is not None

    @property
    def room(self) -> int:
        """How many bytes may be fed now, 0 where it is not open."""
        return self._text.room if self.is_open else 0

    @property
    def full(self) -> bool:
        """Whether nothing may be fed until the channel has read on."""
        return self.room == 0

    @property
    def starved(self) -> bool:
        """Whether the path rests because nothing more has come."""
        run = self._run
        return run is not None and not self._channel.broken and run.reading.starved

    @property
    def lines(self) -> int:
        """How many whole lines have been fed."""
        return self._text.lines

    @property
    def waiting(self) -> int:
        """How many of them have not been prepared."""
        return self._text.waiting

    @property
    def queued(self) -> int:
        """How many lines wait and how many moves are queued that have not been executed."""
        run = self._run
        return 0 if run is None else self._text.waiting + run.reading.queued

    def modal_ahead(self) -> ModalWords:
        """Return the modal words in force after all that has been fed, as far as that is known.

        Raises:
            ControlError: It is not open.
        """
        run = self._open_run()
        return run.channel.records.words(self._text.opening, self._checked(run).state.snapshot())

    def position_ahead(self) -> tuple[float, ...]:
        """Return where the axes will be after all that has been fed (machine coordinates, mm or degree).

        Raises:
            ControlError: It is not open.
        """
        return tuple(self._checked(self._open_run()).state.modal.position.tolist())

    def probed(self) -> tuple[float, ...] | None:
        """Return where the last probing move met something (machine coordinates), None where it did not."""
        run = self._run
        found = None if run is None else run.channel.state.probe
        return None if found is None else found.position

    def rehearse(self, text: str) -> None:
        """Check whole lines as those that come next, and those after them; nothing is executed from now on.

        Raises:
            ProgramError: As `feed`.
            ControlError: It is not open.
        """
        run = self._open_run()
        if not self._rehearses:
            self._checked(run)
            self._rehearses = True
        self._checked(run).check(
            self._text.piece((text.encode("utf-8", "replace"),)), run.channel.skip_levels
        )

    def feed(self, text: str | bytes) -> None:
        """Add text, cut wherever; a line counts once its newline has come. Refused text changes nothing.

        Raises:
            ProgramError: A block of it cannot be executed after those before it. Blocks that a language executes, and
                what comes after a call, are checked as far as they are words.
            ControlError: There is no room for it, the program is no longer open, or an alarm has stopped it.
        """
        run = self._open_run()
        data = text.encode("utf-8", "replace") if isinstance(text, str) else text
        if len(data) > self._text.room:
            raise ControlError(
                Refusal.FULL,
                f"{len(data)} bytes do not fit: {self.name} has room for {self._text.room}",
                hint="Let time pass until blocks have been executed.",
            )
        arrived = self._text.arrived(data)
        if arrived.lines:
            self._checked(run).check(self._text.piece(arrived.lines), run.channel.skip_levels)
        self._text.put(arrived)
        self._has_come(run)

    def end(self) -> None:
        """Say that nothing more comes; a last line without a newline counts. The program ends after its last block.

        Raises:
            ProgramError: The last line cannot be executed.
            ControlError: As `feed`.
        """
        run = self._open_run()
        last = self._text.arrived(b"")
        if last.rest:
            last = last._replace(lines=(*last.lines, last.rest), rest=b"")
            self._checked(run).check(self._text.piece(last.lines), run.channel.skip_levels)
        self._text.put(last)
        self._text.ended = True
        self._has_come(run)

    # ------------------------------------------------------------------ within

    @property
    def _run(self) -> ProgramRun | None:
        """The run that executes it, None where there is none any more."""
        run = self._channel.run
        return run if run is not None and run.program is self._text else None

    def _open_run(self) -> ProgramRun:
        run = self._run
        if run is None or self._text.ended:
            raise ControlError(
                Refusal.IDLE, f"{self.name} is not open any more", hint="Open another program."
            )
        if self._channel.run_state is RunState.ALARM:
            raise ControlError(Refusal.ALARM, f"an alarm has stopped {self.name}", hint="Reset first.")
        return run

    def _checked(self, run: ProgramRun) -> LineCheck:
        if self._check is None or self._check[0] is not run:
            self._check = run, run.line_check()
        check = self._check[1]
        if run.state is not RunState.READY and run.channel.starved and not self._rehearses:
            check.follow(run.channel.state)
        return check

    def _has_come(self, run: ProgramRun) -> None:
        run.feed.wake()
        self._clock.changes += 1
