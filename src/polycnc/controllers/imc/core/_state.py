"""Everything that one card is made of in the control cycle, as arrays that Python and the compiled cycle share.

The parameter memory is the state: a planner reads its velocity and position from the words that a client reads, and
writes them back. Only what no address shows stands beside it. Positions are integers of 2**-16 pulses (48 bits, of
which the integer part is the parameter and the fraction the word below it), velocities integers of 2**-16 pulses per
control cycle, so nothing is lost over any time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.controllers.imc.core._addresses import word_table
from polycnc.controllers.imc.core._parameters import WORDS
from polycnc.kernel import PROFILE_COLUMNS, PROFILE_PHASES, Segments, make_segments

Floats = npt.NDArray[np.float64]
Whole = npt.NDArray[np.int64]

COORDINATES = 16  # of a path space or a contour group
SPACES = 2
RELEASED = SPACES + 1  # of `by`
EVENTS_MOST = 128
SMOOTH_ROWS = 1 << 16  # cycles of command that smoothing may look back
CAPTURES = 1024  # captured positions kept for each axis

# The queues.
IFIFO, QFIFO, PFIFO1, PFIFO2, CFIFO = 0, 1, 2, 3, 4
QUEUES = 5

# What moves a coordinate system.
IDLE = 0
MOVE = 1  # a point-to-point profile
VELOCITY = 2  # a ramp to a velocity that is kept
GEAR = 3
SYNC = 4
GIVEN = 5  # a path space or a contour says how much

GOAL = 2  # of `prepared`

# What stops `run_cycles`, bits of `attention` and of its mask.
AXIS_RESTED = 1  # moving of an axis became 0
AXIS_ERROR = 2  # an axis has a new error bit

CARD_ROW = np.dtype(
    [
        ("cycle", np.int64),
        ("attention", np.int64),
        ("events", np.int64),  # installed
        ("wrap_to_origin", np.int64),  # what a position does that leaves 32 bits: 1 restarts at 0, 0 wraps
        ("immediate", np.int64),  # it is the turn of IFIFO
        ("hold", np.int64),  # what was written has to be done before IFIFO goes on
        ("delay_step", np.int64),  # what delayus counts down by in a cycle
        ("short_factor", np.int64),  # factors of events have 16 fraction bits, not 32
        ("stopped", np.int64),  # an emergency stop has been carried out
        ("group_row", np.int64),  # of a contour: cycles of the present point done, -1 none
        ("group_count", np.int64),  # axes of the present point
        ("group_smooth", np.int64),
    ],
    align=True,
)

SYSTEM_ROW = np.dtype(
    [
        ("mode", np.int64),
        ("target", np.int64),  # of VELOCITY
        ("left", np.int64),  # of MOVE: distance at the time of planning
        ("done", np.int64),  # of MOVE: part of it gone
        ("velocity", np.int64),  # that was written last: another one in memory is a client's
        ("cycles", np.int64),
        ("phases", np.int64),
        ("duration", np.float64),
        ("paused", np.int64),
        ("stale", np.int64),  # of MOVE: it has to be planned
        ("followed", np.int64),  # target that a tracking move was planned for
        ("speed_at", np.int64),  # of MOVE: address of the parameter that limits its speed
    ],
    align=True,
)

AXIS_ROW = np.dtype(
    [
        ("commands", np.int64),  # writes to act on, bit by action
        ("given", np.int64),  # what path and contour have for this cycle
        ("by", np.int64),  # path space (0, 1) or contour (2) that GIVEN comes from; 3: it was the last of it
        ("machine", np.int64),  # pulses put out, as a position of 2**-16 that never wraps
        ("counts", np.int64),  # encoder reading
        ("counts_per_pulse", np.float64),
        ("aux", np.int64),  # counts of the auxiliary encoder that have not been seen yet
        ("aux_rate", np.float64),  # that it gains by itself in a cycle
        ("aux_part", np.float64),
        ("smooth", np.int64),  # in use
        ("lag", np.int64),  # sum of increments times the cycles they still have to go
        ("recent", np.int64),  # sum of the last increments
        ("pending", np.int64),  # command that smoothing holds back
        ("settled", np.int64),  # cycles at rest
        ("last_error", np.int64),
        ("was_moving", np.int64),
        ("inverted", np.int64),  # terminals that are low while their switch is on, bit by number
        ("unwired", np.int64),  # terminals without a switch: never active, whatever aioctr says
        ("levels", np.int64),  # terminals of the last cycle
        ("probe_origin", np.float64),
        ("probe_pitch", np.float64),
        ("probe_now", np.int64),
        # Gear and synchronous motion.
        ("rest", np.int64),  # of the product ratio times increment, 2**-48
        ("locked", np.int64),
        ("ratio", np.int64),  # that it is locked to
        (
            "gear_source",
            np.int64,
        ),  # address that the gear follows; while another gear waits, registers are its
        ("gear_master", np.int64),
        ("gear_ratio", np.int64),
        ("waits", np.int64),  # a gear waits for startsyn
        (
            "prepared",
            np.int64,
        ),  # synsrcvar has been written and nothing started since: 2 with a goal in mcstgvel
        ("armed", np.int64),  # synsrcvar has been written and mcstgvel not since: 2 in this turn, 1 before
        ("sync_noted", np.int64),  # source when startsyn or enasyn was written
        ("sync_from", np.int64),  # source at the start
        ("sync_source", np.int64),  # its address
        ("sync_axis", np.int64),
        ("sync_span", np.int64),  # change of the source over the whole motion
        ("sync_type", np.int64),  # 0 to a velocity
        ("sync_target", np.int64),  # that velocity
        ("sync_share", np.float64),  # done
        ("sync_velocity", np.float64),  # at the start, pulses per cycle
        ("sync_distance", np.float64),  # to go
        ("sync_slope", np.float64),  # of the way at the start, pulses per whole share
        ("sync_way", np.int64),  # gone
        ("sync_part", np.float64),  # below 2**-16
        # Homing.
        ("home", np.int64),
        ("home_count", np.int64),
        ("home_edge", np.float64),
        # Captures.
        ("captured", np.int64),
        ("fetched", np.int64),
    ],
    align=True,
)

FIFO_ROW = np.dtype(
    [
        ("head", np.int64),  # cells taken
        ("tail", np.int64),  # cells put
        ("words", np.int64),  # 16-bit words waiting
        ("cut", np.int64),  # tail when an instruction that empties the queue was put into IFIFO
        ("since", np.int64),  # 16-bit words put after that
        ("depth", np.int64),  # words that fit
        ("waiting", np.int64),
        ("address", np.int64),  # of the wait; negative: time alone
        ("axis", np.int64),
        ("mask", np.int64),
        ("data", np.int64),
    ],
    align=True,
)

SPACE_ROW = np.dtype(
    [
        ("active", np.int64),
        ("count", np.int64),  # coordinates
        ("mask", np.int64),  # axes, bit by number
        ("cycles", np.int64),
        ("phases", np.int64),
        ("lead", np.float64),
        ("duration", np.float64),
        ("place", np.float64),
        ("speed", np.float64),
        ("end_speed", np.float64),
        ("feed", np.float64),  # override in use
        ("weight", np.float64),  # path length for a unit of what the speed counts on
        ("stopping", np.int64),
        ("stale", np.int64),  # the rest of the segment has to be planned
        ("points", np.int64),  # the segment is a point of a contour
    ],
    align=True,
)

EVENT_ROW = np.dtype(
    [
        ("operation", np.int64),
        ("first_words", np.int64),
        ("second_words", np.int64),  # 0: the constant
        ("words", np.int64),  # of the result
        ("boolean", np.int64),
        ("type", np.int64),
        ("first", np.int64),
        ("first_row", np.int64),
        ("second", np.int64),
        ("second_row", np.int64),
        ("constant", np.int64),
        ("target", np.int64),
        ("target_axis", np.int64),
        ("held", np.int64),  # condition at the last evaluation; it starts as unknown, -1
    ],
    align=True,
)


class CardState(NamedTuple):
    """A card of n axes; its kernel state stands beside it."""

    card: npt.NDArray[np.void]  # [1] of CARD_ROW
    memory: npt.NDArray[np.int16]  # [n + 1, WORDS]; the last row is the card's own
    word: npt.NDArray[np.int8]  # [WORDS, 2] whether the card's, what a write does
    axis: npt.NDArray[np.void]  # [n] of AXIS_ROW
    system: npt.NDArray[np.void]  # [2, n] of SYSTEM_ROW: MCS, PCS
    phases: Floats  # [2 n + SPACES, PROFILE_PHASES, PROFILE_COLUMNS]
    fifo: npt.NDArray[np.void]  # [QUEUES] of FIFO_ROW
    ring: Whole  # [QUEUES, cells]
    space: npt.NDArray[np.void]  # [SPACES] of SPACE_ROW
    place: Whole  # [SPACES + 1, COORDINATES, 2]: axis, position given; last the contour: axis, displacement
    seg: Segments  # [SPACES] the running segments
    point: Floats  # [2 SPACES, COORDINATES] scratch: start and end of a segment
    counted: npt.NDArray[np.uint8]  # [SPACES, COORDINATES] scratch: coordinates that the speed counts on
    event: npt.NDArray[np.void]  # [EVENTS_MOST] of EVENT_ROW
    history: Whole  # [n, SMOOTH_ROWS] increments
    capture: Whole  # [n, CAPTURES]


def make_card_state(axes: int, depths: tuple[int, int, int, int, int]) -> CardState:
    """Allocate a card of `axes` axes as it is switched on, its queues `depths` words deep."""
    card = np.zeros(1, CARD_ROW)
    card["group_row"] = -1
    fifo = np.zeros(QUEUES, FIFO_ROW)
    fifo["depth"] = depths
    cells = 1 << (4 * max(depths)).bit_length()  # the leanest instruction takes 8 cells for 3 words
    system = np.zeros((2, axes), SYSTEM_ROW)
    row = np.zeros(axes, AXIS_ROW)
    row["counts_per_pulse"] = 1.0
    row["probe_origin"] = np.inf
    row["sync_share"] = -1.0
    return CardState(
        card=card,
        memory=np.zeros((axes + 1, WORDS), np.int16),
        word=np.array(word_table(), np.int8),
        axis=row,
        system=system,
        phases=np.zeros((2 * axes + SPACES, PROFILE_PHASES, PROFILE_COLUMNS)),
        fifo=fifo,
        ring=np.zeros((QUEUES, cells), np.int64),
        space=np.zeros(SPACES, SPACE_ROW),
        place=np.zeros((SPACES + 1, COORDINATES, 2), np.int64),
        seg=make_segments(SPACES, COORDINATES),
        point=np.zeros((2 * SPACES, COORDINATES)),
        counted=np.zeros((SPACES, COORDINATES), np.uint8),
        event=np.zeros(EVENTS_MOST, EVENT_ROW),
        history=np.zeros((axes, SMOOTH_ROWS), np.int64),
        capture=np.zeros((axes, CAPTURES), np.int64),
    )
