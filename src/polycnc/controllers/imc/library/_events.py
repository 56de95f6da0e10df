"""Commands and trigger types of events, by the names of the manual's header (manual 004, 6)."""

from __future__ import annotations

from polycnc.controllers.imc.core._event_codes import EventCommand, EventType

IMC_EVENT_CMD = EventCommand
IMC_EventType = EventType

(
    CMD_ADD32,
    CMD_ADD32i,
    CMD_ADD48,
    CMD_ADD48i,
    CMD_CMP32,
    CMD_CMP32i,
    CMD_CMP48,
    CMD_CMP48i,
    CMD_SCA32,
    CMD_SCA32i,
    CMD_SCA48,
    CMD_SCA48i,
    CMD_MUL32L,
    CMD_MUL32iL,
    CMD_MUL32A,
    CMD_MUL32iA,
    CMD_COP16,
    CMD_COP32,
    CMD_COP48,
    CMD_SET16,
    CMD_SET32,
    CMD_SET48,
    CMD_OR16,
    CMD_OR16i,
    CMD_OR16B,
    CMD_OR16iB,
    CMD_AND16,
    CMD_AND16i,
    CMD_AND16B,
    CMD_AND16iB,
    CMD_XOR16,
    CMD_XOR16i,
    CMD_XOR16B,
    CMD_XOR16iB,
) = IMC_EVENT_CMD

(
    IMC_Allways,
    IMC_Edge_Zero,
    IMC_Edge_NotZero,
    IMC_Edge_Great,
    IMC_Edge_GreatEqu,
    IMC_Edge_Little,
    IMC_Edge_Carry,
    IMC_Edge_NotCarry,
    IMC_IF_Zero,
    IMC_IF_NotZero,
    IMC_IF_Great,
    IMC_IF_GreatEqu,
    IMC_IF_Little,
    IMC_IF_Carry,
    IMC_IF_NotCarry,
) = IMC_EventType

COP48 = CMD_COP48  # as the manual misprints it

# fmt: off
__all__ = [
    "CMD_ADD32", "CMD_ADD48", "CMD_AND16", "CMD_AND16B", "CMD_CMP32", "CMD_CMP48", "CMD_COP16",
    "CMD_COP32", "CMD_COP48", "CMD_MUL32A", "CMD_MUL32L", "CMD_OR16", "CMD_OR16B", "CMD_SCA32",
    "CMD_SCA48", "CMD_SET16", "CMD_SET32", "CMD_SET48", "CMD_XOR16", "CMD_XOR16B", "COP48",
    "IMC_EVENT_CMD", "CMD_ADD32i", "CMD_ADD48i", "CMD_AND16i", "CMD_AND16iB", "CMD_CMP32i", "CMD_CMP48i",
    "CMD_MUL32iA", "CMD_MUL32iL", "CMD_OR16i", "CMD_OR16iB", "CMD_SCA32i", "CMD_SCA48i", "CMD_XOR16i",
    "CMD_XOR16iB", "IMC_Allways", "IMC_Edge_Carry", "IMC_Edge_Great", "IMC_Edge_GreatEqu",
    "IMC_Edge_Little", "IMC_Edge_NotCarry", "IMC_Edge_NotZero", "IMC_Edge_Zero", "IMC_EventType",
    "IMC_IF_Carry", "IMC_IF_Great", "IMC_IF_GreatEqu", "IMC_IF_Little", "IMC_IF_NotCarry",
    "IMC_IF_NotZero", "IMC_IF_Zero",
]
# fmt: on
