"""Make the channels of a program run: one for each program that is selected, and for each beginning anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from polycnc.cnc._run_state import RunOptions
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Channel, ChannelOptions, Dialect, Language, Library, ProgramText


@dataclass(frozen=True, slots=True)
class RunChannels:
    """What the channels of a run have in common."""

    machine: Machine
    path: int
    dialect: Dialect
    options: RunOptions
    config: MachineConfig | None
    library: Library | None
    language: Language | None
    axes: Sequence[str] | None

    def make(
        self,
        program: ProgramText,
        skip_levels: frozenset[int],
        *,
        before: Channel | None = None,
        keeps_modal: bool = True,
        attaches: bool = True,
    ) -> Channel:
        """Return the channel of a program, which takes over from the one before what lasts."""
        return Channel(
            program,
            self.dialect,
            self.machine,
            path=self.path,
            config=self.config,
            library=self.library,
            language=self.language,
            axes=self.axes,
            skip_levels=skip_levels,
            options=ChannelOptions(
                stands_at_stops=self.options.stands_at_stops,
                answers=self.options.answers,
                marks=self.options.stands_at_stops,
                collect_errors=self.options.collect_errors,
                mark_refused=self.options.mark_refused,
                past_refused=self.options.past_refused,
                ordinary_blocks=self.options.ordinary_blocks,
            ),
            before=before,
            keeps_modal=keeps_modal,
            attaches=attaches,
        )
