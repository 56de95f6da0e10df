"""Event commands and trigger types, numbered as the card numbers them (manual 004, 3.7)."""

from __future__ import annotations

from enum import IntEnum

LOAD_MOST = 31  # events in one load


class EventCommand(IntEnum):
    """What an event does; a trailing i takes a constant, B makes the result a flag."""

    CMD_ADD32 = 0
    CMD_ADD32i = 1
    CMD_ADD48 = 2
    CMD_ADD48i = 3
    CMD_CMP32 = 4
    CMD_CMP32i = 5
    CMD_CMP48 = 6
    CMD_CMP48i = 7
    CMD_SCA32 = 8
    CMD_SCA32i = 9
    CMD_SCA48 = 10
    CMD_SCA48i = 11
    CMD_MUL32L = 12
    CMD_MUL32iL = 13
    CMD_MUL32A = 14
    CMD_MUL32iA = 15
    CMD_COP16 = 16
    CMD_COP32 = 17
    CMD_COP48 = 18
    CMD_SET16 = 19
    CMD_SET32 = 20
    CMD_SET48 = 21
    CMD_OR16 = 22
    CMD_OR16i = 23
    CMD_OR16B = 24
    CMD_OR16iB = 25
    CMD_AND16 = 26
    CMD_AND16i = 27
    CMD_AND16B = 28
    CMD_AND16iB = 29
    CMD_XOR16 = 30
    CMD_XOR16i = 31
    CMD_XOR16B = 32
    CMD_XOR16iB = 33


class EventType(IntEnum):
    """When an event acts, by the result of the last one that acts always."""

    IMC_Allways = 0
    IMC_Edge_Zero = 1
    IMC_Edge_NotZero = 2
    IMC_Edge_Great = 3
    IMC_Edge_GreatEqu = 4
    IMC_Edge_Little = 5
    IMC_Edge_Carry = 6
    IMC_Edge_NotCarry = 7
    IMC_IF_Zero = 8
    IMC_IF_NotZero = 9
    IMC_IF_Great = 10
    IMC_IF_GreatEqu = 11
    IMC_IF_Little = 12
    IMC_IF_Carry = 13
    IMC_IF_NotCarry = 14


ADD, COMPARE, SCALE, MULTIPLY, TAKE, OR, AND, XOR = range(8)

# By command: operation, words of the first operand, of the second parameter (0: the constant), of the result, flag.
SHAPES: tuple[tuple[int, int, int, int, int], ...] = (
    (ADD, 2, 2, 2, 0),
    (ADD, 2, 0, 2, 0),
    (ADD, 3, 3, 3, 0),
    (ADD, 3, 0, 3, 0),
    (COMPARE, 2, 2, 2, 0),
    (COMPARE, 2, 0, 2, 0),
    (COMPARE, 3, 3, 3, 0),
    (COMPARE, 3, 0, 3, 0),
    (SCALE, 2, 3, 2, 0),
    (SCALE, 2, 0, 2, 0),
    (SCALE, 3, 3, 3, 0),
    (SCALE, 3, 0, 3, 0),
    (MULTIPLY, 2, 2, 2, 0),
    (MULTIPLY, 2, 0, 2, 0),
    (MULTIPLY, 2, 2, 3, 0),
    (MULTIPLY, 2, 0, 3, 0),
    (TAKE, 0, 1, 1, 0),
    (TAKE, 0, 2, 2, 0),
    (TAKE, 0, 3, 3, 0),
    (TAKE, 0, 0, 1, 0),
    (TAKE, 0, 0, 2, 0),
    (TAKE, 0, 0, 3, 0),
    *((operation, 1, words, 1, flag) for operation in (OR, AND, XOR) for flag in (0, 1) for words in (1, 0)),
)


def constant_words(command: EventCommand) -> int:
    """Return how many words of constant a command takes, 0 if its second operand is a parameter."""
    operation, _, second, words, _ = SHAPES[command]
    if second:
        return 0
    if operation == SCALE:
        return 3
    return 2 if operation == MULTIPLY else words
