"""The page of the sender door: what it takes and answers, from its rows."""

from polycnc.servers.grbl import SETTINGS, GrblAlarm, GrblError

_HEAD = """# The sender door (grbl)

What a served machine answers to senders of grbl 1.1: CNCjs, Universal Gcode Sender, bCNC, gSender and their like, on a
TCP port (8123) and on a pseudo terminal. The [tutorial](../tutorials/your-sender.md) connects one. The interface is
grbl's own, as its project documents it; where a machine is more than a grbl, this page says what it does.
`polycnc.servers.grbl.GrblCore` is the door without sockets: `receive(bytes)` and `turn()` return bytes.

## Lines

Each line is answered with `ok` or `error:n`, in the order in which lines came. A line is checked before its `ok`,
after everything that was sent before; a wrong one changes nothing and stops nothing. The receive buffer is 128 bytes
for those who count characters, the planner takes 15 blocks. A dwell, M words, G10 and probing are answered when they
have been executed. G and M codes are those of the dialect `grbl`, with G38.2 and G38.3; G28.1, G30.1, G38.4, G38.5
and G43.1 are answered with `error:20`.

| line | what it does |
| --- | --- |
| `$$` `$x=value` | shows the settings, writes one (at rest) |
| `$G` `$#` `$I` `$N` `$` | modal words, offsets and the last probing, version, startup lines, help |
| `$J=...` | jogs: G20 G21 G90 G91 G53, axis words, F; modal words stay |
| `$H` | references Z, then X and Y; answered at the end |
| `$X` | unlocks an alarm |
| `$C` | checks lines without motion; a second one ends that with a reset |
| `$SLP` | sleeps until a reset |
| `$RST=$` `$RST=#` `$RST=*` | settings, offsets, everything to defaults; those of the axes stay the machine's |
| `$N0=...` `$N1=...` | keeps a startup line; it is not executed |

## Real-time bytes

They act at once, also between the bytes of a line.

| byte | what it does |
| --- | --- |
| `?` | status report |
| `!` `~` | feed hold, cycle start |
| `0x18` (Ctrl-X) | reset; in motion the axes brake and `ALARM:3` locks |
| `0x84` | safety door: holds until `~` |
| `0x85` | cancels a jog: the axes brake, the rest of it is dropped |
| `0x90` to `0x94` | feed override 100 %, +10, -10, +1, -1; 10 to 200 % |
| `0x95` `0x96` `0x97` | rapid override 100, 50, 25 % |
| `0x99` to `0x9D` | spindle override 100 %, +10, -10, +1, -1 |

Other bytes above 0x7F do nothing, 0x9E (spindle stop) and 0xA0, 0xA1 (coolant) among them.

## Status report

`<State|MPos:x,y,z|Bf:blocks,bytes|FS:feed,speed|WCO:x,y,z>`: `$10` bit 1 chooses `MPos` or `WPos`, bit 2 adds `Bf`.
`WCO` and `Ov` come with the first reports, when they change and every tenth report at rest. `$13=1` writes inches.

| state | the machine |
| --- | --- |
| Idle | rests; nothing of what has come is left |
| Run | executes a line, or another program of the control |
| Hold:1, Hold:0 | brakes for a feed hold; rests in it, or at M0 |
| Jog, Home, Check, Sleep | what was asked for |
| Door:2, Door:0 | brakes for the safety door; rests and goes on with `~` |
| Alarm | is locked |

"""


def page() -> str:
    """Return the page."""
    text = (
        _HEAD
        + "## Settings\n\nThose of the axes are the axes' own and act when they are written; the speed of the "
    )
    text += "spindle and the laser mode are shown.\nThe others are kept and shown; "
    text += "$10, $13 and $22 act on the door.\n\n| setting | what it is | unit |\n| --- | --- | --- |\n"
    text += "".join(f"| ${row.number} | {row.text} | {row.unit} |\n" for row in SETTINGS)
    text += "\n## Errors\n\n| error | why |\n| --- | --- |\n"
    text += "".join(f"| {int(each)} | {each.text} |\n" for each in GrblError)
    text += "\n## Alarms\n\n| alarm | why |\n| --- | --- |\n"
    return text + "".join(f"| {int(each)} | {each.text} |\n" for each in GrblAlarm)
