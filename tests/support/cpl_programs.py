"""Random CPL programs: loops, jumps, fields, texts, calls with arguments, and waits."""

from __future__ import annotations

import random

_CALLED = ("ALPHA", "BETA")


def cpl_programs(seed: int) -> dict[str, str]:
    """Return a main program, "main.cpl", and those that it calls; all of them end."""
    chance = random.Random(seed)
    head = ["DIM A(6) : DIM T$(9) : V=1.25", "A(2)=0.5", 'T$="ABCDEFG"', "#G=2", "@7=3"]
    return {
        "main.cpl": _lines(head + _body(chance, _CALLED, 7), "G1 F4000"),
        "ALPHA": _lines(["V=P1*0.5", "DIM T$(4)", "DIM A(6)", "A(2)=0.75", *_body(chance, _CALLED[1:], 2)]),
        "BETA": _lines(["V=P1+1", "DIM T$(3)", "DIM A(3)", "A(2)=1", "#G=#G+1", *_body(chance, (), 2)]),
    }


def _lines(statements: list[str], first: str = "") -> str:
    """Return statements with their line numbers; NC blocks have their own."""
    lines = [f"N1 {first}"] if first else []
    for number, statement in enumerate(statements, 1):
        plain = statement[:2] in ("N1", "N2", "N3", "N4")
        lines.append(statement if plain else f"{number * 10} {statement}")
    return "\n".join(lines) + "\n"


def _value(chance: random.Random) -> str:
    return chance.choice(
        (
            f"{chance.uniform(0.4, 6):.3f}",
            "V/2+1.5",
            "MPOS(1)/3+0.25",
            "#G*0.7",
            "SIN(V*40)*2+3",
            "@7/2",
            "LEN(T$)*0.3",
            "A(2)+1",
        )
    )


def _body(chance: random.Random, called: tuple[str, ...], count: int, depth: int = 0) -> list[str]:
    return [line for _ in range(count) for line in _statement(chance, called, depth)]


def _statement(chance: random.Random, called: tuple[str, ...], depth: int) -> list[str]:
    kind = chance.randrange(14)
    axis, counter = chance.choice("XYZ"), f"I{depth}%"
    if kind <= 1:
        return [f"V={_value(chance)}", "@7=@7+1"]
    if kind <= 3:
        return [f"N10 G1 {axis}[{_value(chance)}]"]
    if kind == 4:
        return [f"N20 X{chance.uniform(1, 6):.2f}", f"N30 Y{chance.uniform(1, 6):.2f} Z1.5", "N40 G4 F0.03"]
    if kind == 5 and depth < 3:
        return [
            f"FOR {counter}=1 TO {chance.randrange(2, 4)}",
            *_body(chance, called if not depth else (), 2, depth + 1),
            "NEXT",
        ]
    if kind == 6 and depth < 3:
        return [
            f"{counter}=0",
            f"WHILE {counter}<{chance.randrange(2, 4)} DO",
            f"{counter}={counter}+1",
            *_body(chance, (), 2, depth + 1),
            "END",
        ]
    if kind == 7 and depth < 3:
        return [
            f"IF V>{chance.uniform(1, 4):.2f} THEN",
            *_body(chance, (), 1, depth + 1),
            "ELSE",
            *_body(chance, (), 1, depth + 1),
            "ENDIF",
        ]
    if kind == 8:
        return [f"WAIT(,{chance.randrange(20, 70)})"]
    if kind == 9:
        return ["WAIT", f"V=MPOS({chance.randrange(1, 4)})+0.5"]
    if kind == 10:
        return [f"WAIT(IC({chance.randrange(1, 3)})=TRUE,{chance.randrange(10, 60)},W%)"]
    if kind <= 12 and called:
        return [f"CALL {chance.choice(called)} [{_value(chance)}]"]
    return [f'T$="{chance.choice(("QW", "ERTZ"))}"', "#G=#G+LEN(T$)"]
