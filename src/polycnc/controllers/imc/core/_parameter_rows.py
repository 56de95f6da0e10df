"""The rows of the card's parameter memory: name, address, type, scope, access, meaning.

Scope A is one per axis, G one for the card. Access: `rw`, `ro` (writes are refused), `w` (a write acts, reading gives
something else or nothing). The card's own document (chapter 5) gives names, addresses and types; scopes, most
meanings and the rows of the path spaces come from the parameter header that is shipped with the card's library.
"""

from __future__ import annotations

_COORDINATES = "xyzabcdefghijklm"

_AXIS = """
{p}vel {0} S16.16 A rw velocity that the coordinate system plans now
{p}tgvel {2} S16.16 A rw target of continuous motion; a write starts, changes or (0) stops it
{p}slope {4} F16 A ro set while the velocity changes, 0 at the target speed
{p}pos {6} S32 A rw command position of the coordinate system
{p}tgpos {8} S32 A rw target of an absolute move
{p}dist {10} S32 A rw distance of a relative move; 0 means absolute; the card clears it
{p}maxvel {12} S16.16 A rw highest speed of a move
{p}accel {14} S16.16 A rw acceleration
{p}decel {16} S16.16 A rw deceleration
{p}track {18} F16 A rw 0 ordinary moves, FFFFh follow a target that changes
{p}go {19} F16 A rw FFFFh starts a move, 0 stops it; 0 when it is done
{p}moving {21} F16 A ro set while the coordinate system plans
"""

_OTHERS = """
encpfactor 73 U16.16 A rw scale of the main encoder
encpvel 75 S16.16 A ro counts of the main encoder in a control cycle
encp 78 S32 A rw actual position
encsfactor 81 U16.16 A rw scale of the auxiliary encoder
encsvel 83 S16.16 A ro counts of the auxiliary encoder in a control cycle
encs 86 S32 A rw position of the auxiliary encoder
run 128 F16 A rw the axis plans motion only while this is set
status 129 R16 A ro bit 0: curpos is at or beyond breakp
error 130 R16 A rw errors; write 0 to clear
poserrlim 131 U16 A rw limit of poserr
smooth 132 U16 A rw control cycles over which the command is averaged
trackwin 133 U16 A rw following window
settlewin 134 U16 A rw standstill window
settlen 135 U16 A rw control cycles of standstill before motion becomes 0
stopfilt 136 R16 A rw errors that stop the motion
stopmode 137 R16 A rw errors that stop it at once instead of braking
exitfilt 138 R16 A rw errors that clear run
psoftlim 139 S32 A rw positive software limit
nsoftlim 141 S32 A rw negative software limit
breakp 143 S32 A rw position for status bit 0
homepos 145 S32 A rw what curpos and encp become at the origin
lowvel 147 S16.16 A rw speed of the later phases of homing
highvel 149 S16.16 A rw speed of the first phase of homing
homeseq 151 R16 A rw how to search the origin
gohome 152 F16 A rw FFFFh starts the search of the origin, 0 gives it up
sethome 153 F16 A rw FFFFh makes the present position the origin
homed 154 F16 A rw set when the origin is found
capture 155 F16 A w a write captures the position
indexNum 156 U16 A rw index pulses to count before the origin is set
clear 157 F16 A w a write clears positions, errors, events and ticks
vellim 158 S16.16 A rw highest speed in any mode
accellim 160 S16.16 A rw highest acceleration in any mode
fixvel 162 S16.16 A rw speed of the compensation of static errors
homestpos 163 S32 A rw where to go after homing, if that is asked for
moveinpath2 165 F16 A ro the axis moves in path 2
haltstep 166 R16 A rw non-zero pauses the axis
haltmode 167 R16 A rw 0 pauses at once, non-zero with deceleration
master 169 U16 A rw axis that is followed
gearsrc 170 U16 A rw address of the parameter that is followed
engear 171 F16 A rw FFFFh engages the gear, 0 leaves it
gearoutmod 172 F16 A rw when left: 0 keeps the speed, FFFFh goes to gearoutvel
shiftmaster 174 F16 A rw 0: what the second system moves is added to mcstgpos
gearratio 175 S16.32 A rw slave increment per increment of the source
gearoutvel 178 S16.16 A rw speed after the gear is left
cirpos 184 S32 A rw size of a ring axis
ciraxis 186 F16 A rw 0 linear, FFFFh ring axis
biciraxis 187 F16 A rw 0: one-way ring 0..cirpos, else -cirpos..cirpos
enasyn 188 F16 A rw enables synchronous motion; cleared when it is complete
startsyn 189 F16 A rw starts synchronous motion; cleared when it is complete
syntype 190 F16 A rw 0 speed, non-zero position
synsrc 191 U16 A rw address of the parameter that paces
synaxis 192 U16 A rw axis of the parameter that paces
synsrcvar 193 S32 A rw change of that parameter over the whole synchronous motion
slavedist 197 S32 A rw where the slave goes meanwhile
slaveabs 199 F16 A rw 0: slavedist is a distance, non-zero: a position
segstart 200 S32 A ro start of the running segment on this axis
segend 202 S32 A ro end of the running segment on this axis
moveinpath1 204 F16 A ro the axis moves in path 1
pathabs 205 F16 A rw 0: segment data are distances, non-zero: positions
cirswap 214 S16 A rw turns of a ring axis
profiling 215 F16 A ro a planner is at work
smoothing 216 F16 A ro smoothing still gives motion
contouring 217 F16 A ro contour motion is at work
moving 218 F16 A ro a planner or smoothing is at work
motion 219 F16 A ro set until the axis is at rest and settled
outsettle 220 F16 A ro poserr is beyond settlewin
outtrack 221 F16 A ro poserr is beyond trackwin
poserr 223 S16 A ro curpos minus encp
curpos 225 S32 A ro command position: both systems, smoothed
curvel 227 S16.16 A ro command velocity: both systems, smoothed
cappos 229 S32 A ro captured position
encsctr 531 R16 A rw control of the auxiliary encoder
clrencs 532 F16 A w a write clears encs
encpctr 539 R16 A rw control of the main encoder: bit 10 probe capture, bit 15 follow the command
counter 541 F16 A rw index and probe pulses; a write clears
capture2 543 F16 A w capture, at its other address
ena 550 F16 A rw drive and pulses on
srst 551 R16 A rw reset of the drive
aio 562 R16 A rw bit 0 positive limit, 1 negative limit, 2 origin switch, as they are
aiod 563 R16 A rw direction of the axis terminals
stepmod 615 R16 A rw mode of the pulse output
dirtime 618 U16 A rw delay after a change of direction
steptime 619 R16 A rw width of a pulse
aioctr 680 R16 A rw polarity and use of the axis terminals
aiolat 682 R16 A rw terminals that became active; writing 1 clears a bit
clraiolat 682 R16 A rw aiolat when written
capfifo 696 S32 A ro captured position at the read pointer
popcapfifo 698 R16 A w a write goes to the next captured position
clrcapfifo 699 R16 A rw captured positions waiting; a write clears
capfifocnt 699 R16 A rw clrcapfifo when read
startgroup 256 F16 G rw FFFFh starts contour motion, 0 ends it
groupnum 257 U16 G rw axes of the contour group
{group}
groupsmooth 274 U16 G rw control cycles for each point of a contour
{user16}
{user32}
{user48}
waitfilt 479 R16 G rw no meaning known
waitequ 480 R16 G rw no meaning known
timer 481 U16 G rw counts down once per control cycle
events 489 U16 G rw installed events; 0 removes them
qwaittime 492 S32 G rw time left of the wait in QFIFO; 0 ends it
clearimc 494 R16 G w a write empties all queues
emstop 500 F16 G rw bits to set in the error of every axis
hpause 501 F16 G rw non-zero pauses all axes
ticks 502 U32 G rw control cycles
clkdiv 509 U16 G ro clock divider
fwversion 511 U16 G ro version of the firmware
clrififo 513 F16 G rw a write empties IFIFO
ififocnt 513 F16 G rw words waiting in IFIFO
clrCFIFO 519 F16 G rw a write empties CFIFO
cfifocnt 519 R16 G rw words waiting in CFIFO
clrqfifo 521 F16 G rw a write empties QFIFO
qfifocnt 521 F16 G rw words waiting in QFIFO
swfilter 548 R16 G rw filter of the digital inputs
eventid 549 U16 G rw no meaning known
gout3 555 R16 G rw outputs 33 to 48
gio 560 R16 G rw outputs 1 to 16
gout1 560 R16 G rw gio by its other name
giod 561 R16 G rw outputs 17 to 32
gout2 561 R16 G rw giod by its other name
clrPFIFO1 565 F16 G rw a write empties PFIFO1
PFIFOcnt1 565 F16 G rw words waiting in PFIFO1
eventbase 568 U16 G rw no meaning known
gin1lat 612 R16 G rw inputs 1 to 16 that became active; writing 1 clears a bit
gin2lat 613 R16 G rw inputs 17 to 32 that became active; writing 1 clears a bit
out1 624 F16 G rw no meaning known
out2 625 F16 G rw no meaning known
sysclk 628 U32 G ro system clock
naxis 634 U16 G ro axes of the card
hwversion 635 U16 G ro version of the hardware
clrPFIFO2 685 F16 G rw a write empties PFIFO2
PFIFOcnt2 685 F16 G rw words waiting in PFIFO2
delayus 704 U32 G rw counts down with time
delayout 704 U32 G rw delayus when read: 0 when it has passed
gin1 706 R16 G ro inputs 1 to 16; a closed contact reads 0
gin2 707 R16 G ro inputs 17 to 32
"""

_SPACE = """
startpath{g} {0} F16 G rw non-zero enables the path space, 0 stops it by force
pathmoving{g} {2} F16 G ro interpolation is running
arcdir{g} {3} F16 G ro 0: the running arc is clockwise
asseglen{g} {9} F16 G rw 0: speed counts on X, Y, Z; k: on the k-th coordinate alone
pathvel{g} {10} S16.16 G ro path speed now
contourmod{g} {13} F16 G rw non-zero: the queue holds points of a contour
pathacc{g} {14} S16.16 G rw path acceleration
feedrate{g} {16} S16.16 G rw feed override, 0 pauses
pathaxisnum{g} {18} F16 G rw axes of a contour point, and the most a segment may have; 0: the segments say
{segmap}
segtgvel{g} {35} S16.16 G rw speed in the segment
segendvel{g} {37} S16.16 G rw speed at its end
segID{g} {39} U32 G ro segments executed
seglen{g} {41} U32 G ro length of the running segment
radius{g} {43} U32 G ro radius of the running arc
pwaittime{g} {47} S32 G rw time left of the wait in the queue; 0 ends it
"""


def _systems() -> str:
    mcs = [4 + offset for offset in range(23)]
    return _AXIS.format(*mcs, p="mcs") + _AXIS.format(*(a + 23 for a in mcs), p="pcs")


def _space(g: int) -> str:
    base = 352 + 53 * (g - 1)
    numbers = [base + offset for offset in range(53)]
    segmap = "\n".join(
        f"segmap_{name}{g} {base + 19 + k} F16 G rw axis of coordinate {name.upper()}"
        for k, name in enumerate(_COORDINATES)
    )
    return _SPACE.format(*numbers, g=g, segmap=segmap)


def rows() -> str:
    """Return all rows as text, one a line, the columns separated by single blanks."""
    group = "\n".join(
        f"group_{name} {258 + k} U16 G rw axis of contour coordinate {name.upper()}"
        for k, name in enumerate(_COORDINATES)
    )
    cells = {
        width: "\n".join(
            f"user{width}b{k} {first + k * width // 16} S{width} G rw free cell" for k in range(count)
        )
        for width, first, count in ((16, 307, 10), (32, 317, 10), (48, 337, 5))
    }
    others = _OTHERS.format(group=group, user16=cells[16], user32=cells[32], user48=cells[48])
    return _systems() + others + _space(1) + _space(2)
