"""Probing moves under way: every cycle is looked at until the probe meets a surface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.cnc._path_feed import PathFeed
from polycnc.kernel import PIDF, drop_queue
from polycnc.machine import Machine, first_contact
from polycnc.nc import Channel

Floats: TypeAlias = npt.NDArray[np.float64]


@dataclass
class Probing:
    """Look for the contact of one probing move; `before` is where the axes stood in the cycle before.

    `deletes` tells that the move ends at the contact, else it is measured in passing. `met` is set with the contact.
    """

    deletes: bool
    before: tuple[float, ...]
    met: bool = False

    def look(self, machine: Machine, channel: Channel, *, signal: bool = False) -> bool:
        """Look at one cycle; tell whether the contact is in it, whose position the channel takes.

        A `signal` from outside is a contact where the axes are.
        """
        now, config = positions(machine), channel.state.machine
        probe = channel.state.probe
        if probe is not None and probe.leaves:
            found = None
            if first_contact(config.surfaces, config.axis_names, now, now) is None:
                found = first_contact(config.surfaces, config.axis_names, now, self.before) or now
        else:
            found = first_contact(config.surfaces, config.axis_names, self.before, now) or (
                now if signal else None
            )
        self.before = now
        if found is None:
            return False
        self.met = True
        state = channel.state
        if state.probe is not None:
            state.probe = replace(state.probe, position=found)
        if state.skip_position is not None:
            state.skip_position = found
        return True


def cannot_begin(machine: Machine, channel: Channel) -> bool:
    """Tell whether a move that reports to its program cannot begin: the probe is in contact, or free, already."""
    probe, config = channel.state.probe, channel.state.machine
    if probe is None or not probe.code:
        return False
    now = positions(machine)
    in_contact = first_contact(config.surfaces, config.axis_names, now, now) is not None
    return in_contact != probe.leaves


def delete_rest(machine: Machine, channel: Channel, feed: PathFeed) -> None:
    """Drop the move along which a path stands; functions, stops and the program after it go on from there."""
    drop_queue(machine.state.seg, machine.state.paths, channel.path)
    channel.writer.put_again()
    feed.drop_probing()
    feed.clear()
    channel.state.modal.position[:] = machine.state.paths.position[channel.path]


def positions(machine: Machine) -> tuple[float, ...]:
    """Return where the axes are: as measured where servos are simulated, else as commanded (mm, degree)."""
    state = machine.state
    simulated = state.servo.row["mode"] == PIDF
    found: list[float] = np.where(simulated, state.servo.actual, state.setpoint).tolist()
    return tuple(found)
