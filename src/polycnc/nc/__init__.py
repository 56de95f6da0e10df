"""Part programs: block scanner, dialects, modal state, coordinate systems, tool compensation, the channel."""

from polycnc.nc._block_records import (
    CONTEXT_SHIFT,
    LINE_MASK,
    BlockRecord,
    BlockRecords,
    Call,
    ModalWords,
    line_of,
)
from polycnc.nc._block_source import (
    BlockSource,
    BoundLanguage,
    CallProgram,
    Drain,
    EndSource,
    Language,
    LastingLanguage,
    Pause,
    Returning,
    SourceItem,
    Statement,
    TextSpan,
    WordsBlock,
)
from polycnc.nc._channel import Channel
from polycnc.nc._channel_snapshot import CHANNEL_CLASSES, ChannelSnapshot, Suppressed, Texts
from polycnc.nc._dialect import DEFAULT_DIALECT, DIALECTS, Dialect, dialect_for, load_dialect
from polycnc.nc.blocks._actions import Action, Group, MAction
from polycnc.nc.blocks._calls import Library
from polycnc.nc.blocks._channel_state import ChannelState, Spindle, of_another_channel
from polycnc.nc.blocks._messages import Message
from polycnc.nc.blocks._moves import Stop
from polycnc.nc.blocks._placement import Placement
from polycnc.nc.blocks._probe import Probe
from polycnc.nc.blocks._queue import Event
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan_plain import Block, Word, scan_block

__all__ = [
    "CHANNEL_CLASSES",
    "CONTEXT_SHIFT",
    "DEFAULT_DIALECT",
    "DIALECTS",
    "LINE_MASK",
    "Action",
    "Block",
    "BlockRecord",
    "BlockRecords",
    "BlockSource",
    "BoundLanguage",
    "Call",
    "CallProgram",
    "Channel",
    "ChannelSnapshot",
    "ChannelState",
    "Dialect",
    "Drain",
    "EndSource",
    "Event",
    "Group",
    "Language",
    "LastingLanguage",
    "Library",
    "MAction",
    "Message",
    "ModalWords",
    "Pause",
    "Placement",
    "Probe",
    "ProgramText",
    "Returning",
    "SourceItem",
    "Spindle",
    "Statement",
    "Stop",
    "Suppressed",
    "TextRules",
    "TextSpan",
    "Texts",
    "Word",
    "WordsBlock",
    "dialect_for",
    "line_of",
    "load_dialect",
    "of_another_channel",
    "scan_block",
]
