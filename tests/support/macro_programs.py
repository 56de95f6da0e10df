"""Random programs with custom macros: loops, jumps, calls into files of their own, dwells, stops and outputs."""

from __future__ import annotations

import random

_CALLED = (7001, 7002, 7003)


def macro_programs(seed: int) -> dict[str, str]:
    """Return a main program and those that it calls, by the names of their files; all of them end."""
    chance = random.Random(seed)
    files = {
        "main.nc": f"#100=0\nPOPEN\nG21 G90 G0 X{chance.uniform(1, 4):.3f} Y2.5\nF{chance.randrange(2000, 9000)}\n"
    }
    for place, number in enumerate(_CALLED):
        files[f"O{number}.nc"] = f"O{number}\n" + _body(chance, _CALLED[place + 1 :], 2) + "M99\n"
    files["main.nc"] += _body(chance, _CALLED, 7) + "PCLOS\nM30\n"
    return files


def _body(chance: random.Random, callable_: tuple[int, ...], statements: int, loop: int = 1) -> str:
    return "".join(_statement(chance, callable_, loop) for _ in range(statements))


def _value(chance: random.Random) -> str:
    return chance.choice(
        (
            f"{chance.uniform(0.3, 7):.3f}",
            f"#{chance.randrange(1, 8)}/3+1.5",
            "#100/7",
            "#5041/2+0.25",
            "SIN[#100*11]*3",
            "#5001+0.125",
        )
    )


def _statement(chance: random.Random, called: tuple[int, ...], loop: int) -> str:
    kind = chance.randrange(16)
    number = chance.randrange(1, 8)
    label = chance.randrange(100, 9000)
    word = chance.choice("XYZ")
    if kind <= 1:
        return f"#{number}={_value(chance)}\n#100=#100+1\n"
    if kind == 2:
        return f"#{500 + number}=#{500 + number}+#100*0.37\n"
    if kind <= 4:
        return f"G1 {word}[{_value(chance)}]\n"
    if kind == 5:
        return f"G{chance.choice((0, 1))} X{chance.uniform(1, 8):.3f}\nG1 Y{chance.uniform(1, 8):.3f} Z1.75\n"
    if kind == 6:
        return f"G4 X{chance.uniform(0.01, 0.06):.3f}\n"
    if kind == 7:
        return f"#3006={number}(LOOK {number})\n" if chance.random() < 0.4 else "M0\n"
    if kind == 8:
        return f"DPRNT[A#100[53]*B#{number}[43]]\n"
    if kind == 9 and loop <= 3:
        counter = 20 + loop
        body = _body(chance, called if loop == 1 else (), 2, loop + 1)
        head = f"#{counter}=0\nWHILE[#{counter}LT{chance.randrange(2, 4)}]DO{loop}\n"
        return f"{head}#{counter}=#{counter}+1\n{body}END{loop}\n"
    if kind == 10:
        return f"IF[#100GT{chance.randrange(1, 9)}]GOTO{label}\n{_body(chance, (), 1, 4)}N{label}\n"
    if kind == 11 and called:
        return f"G65 P{chance.choice(called)} L{chance.randrange(1, 3)} A{chance.uniform(1, 3):.2f} B#100 X2.25\n"
    if kind == 12 and called:
        return f"M98 P{chance.choice(called)}\n"
    if kind == 13 and called and loop == 1:
        target = called[-1]
        return f"G66 P{target} A1.5\nG1 X{chance.uniform(1, 5):.2f}\nY{chance.uniform(1, 5):.2f}\nG67\n"
    if kind == 14:
        return f"G10 L2 P2 X{chance.uniform(0.1, 1):.2f}\nG55 G1 X{chance.uniform(1, 4):.2f}\nG54\n"
    begin = f"G41 D1 G1 X{chance.uniform(5, 6):.2f} Y6.5\nY{chance.uniform(7, 8):.2f}\n"
    return f"{begin}X2.25\n#{number}=#100\nG40 X1.5 Y1.75\n"
