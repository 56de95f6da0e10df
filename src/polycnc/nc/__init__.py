"""Part programs: block scanner, dialects, modal state, coordinate systems, tool compensation, the channel."""

from polycnc.nc.blocks._channel_state import ChannelState, of_another_channel
from polycnc.nc.blocks._events import Event, EventRun, run_word
from polycnc.nc.blocks._messages import CODE_SYSTEM, NOT_EXECUTED, Message
from polycnc.nc.blocks._moves import Stop
from polycnc.nc.blocks._probe import Probe
from polycnc.nc.blocks._tip import TIPS
from polycnc.nc.channel._channel import Channel
from polycnc.nc.channel._channel_snapshot import CHANNEL_CLASSES, ChannelSnapshot, Texts
from polycnc.nc.channel._languages import language_for
from polycnc.nc.channel._line_check import LineCheck
from polycnc.nc.channel._options import ChannelOptions
from polycnc.nc.channel._preparation import NAMED_END
from polycnc.nc.channel._sub_programs import Library, SubPrograms
from polycnc.nc.dialect._dialect import DEFAULT_DIALECT, DIALECTS, Dialect, load_dialect
from polycnc.nc.dialect._further_axes import further_axes
from polycnc.nc.dialect._guess import ChosenDialect, choose_dialect, dialect_for
from polycnc.nc.modal._actions import Action, Family, Group, MAction
from polycnc.nc.modal._modal_snapshot import Spindle
from polycnc.nc.modal._placement import Placement, Shifts
from polycnc.nc.modal._suppressed import Suppressed
from polycnc.nc.records._block_records import (
    CONTEXT_SHIFT,
    LINE_MASK,
    BlockRecord,
    BlockRecords,
    Call,
    ModalWords,
    Zero,
    line_of,
)
from polycnc.nc.sources._block_source import (
    BlockSource,
    BoundLanguage,
    CallProgram,
    Drain,
    EndSource,
    KeepingLanguage,
    Language,
    LastingLanguage,
    Pause,
    Returning,
    SourceItem,
    Statement,
    TextSpan,
    WordsBlock,
)
from polycnc.nc.text._incoming import ROOM_BYTES, IncomingText
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan_plain import Block, Word, scan_block

__all__ = [
    "CHANNEL_CLASSES",
    "CODE_SYSTEM",
    "CONTEXT_SHIFT",
    "DEFAULT_DIALECT",
    "DIALECTS",
    "LINE_MASK",
    "NAMED_END",
    "NOT_EXECUTED",
    "ROOM_BYTES",
    "TIPS",
    "Action",
    "Block",
    "BlockRecord",
    "BlockRecords",
    "BlockSource",
    "BoundLanguage",
    "Call",
    "CallProgram",
    "Channel",
    "ChannelOptions",
    "ChannelSnapshot",
    "ChannelState",
    "ChosenDialect",
    "Dialect",
    "Drain",
    "EndSource",
    "Event",
    "EventRun",
    "Family",
    "Group",
    "IncomingText",
    "KeepingLanguage",
    "Language",
    "LastingLanguage",
    "Library",
    "LineCheck",
    "MAction",
    "Message",
    "ModalWords",
    "Pause",
    "Placement",
    "Probe",
    "ProgramText",
    "Returning",
    "Shifts",
    "SourceItem",
    "Spindle",
    "Statement",
    "Stop",
    "SubPrograms",
    "Suppressed",
    "TextRules",
    "TextSpan",
    "Texts",
    "Word",
    "WordsBlock",
    "Zero",
    "choose_dialect",
    "dialect_for",
    "further_axes",
    "language_for",
    "line_of",
    "load_dialect",
    "of_another_channel",
    "run_word",
    "scan_block",
]
