"""Scenes of a Power Mate's programs: transfer, memory, directory, execution, MDI, and what each state allows."""
# mypy: disable-error-code="func-returns-value"
# Acts that follow each other are a tuple of calls.

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.fwlib import EW
from support.fanuc_scenes_a import Bench, registered, runs, short, stream, text
from support.power_mate import psd

# ---------------------------------------------------------------------- transfer


def _download(b: Bench, data: bytes, piece: int = 256) -> str:
    """Send a stream in pieces and return all codes, equal ones once."""
    codes = [b.cell("cnc_dwnstart")]
    for at in range(0, len(data), piece):
        part = data[at : at + piece]
        codes.append(b.cell("cnc_download", part, len(part)))
    codes.append(b.cell("cnc_dwnend"))
    return " ".join(code for k, code in enumerate(codes) if not k or code != codes[k - 1])


def _upload(b: Bench, number: int, piece: int = 0xFFFF) -> str:
    if (code := b.code("cnc_upstart", number)) != EW.EW_OK:
        return short(code)
    pieces: list[bytes] = []
    while not pieces or pieces[-1]:
        record, count = b.get("cnc_upload", piece)
        assert len(record.data) == count
        pieces.append(record.data)
    b.code("cnc_upend")
    return " ".join(map(text, pieces))


def _sent(b: Bench, words: str, data: bytes, piece: int = 256) -> None:
    b.say(f"{words}{text(data)}: {_download(b, data, piece)}")
    b.look()


def transfers(b: Bench) -> None:
    """What a download takes and what comes out again: cuts, numbers, characters, ends, parameters, full memory."""
    b.title("pieces of a download and of an upload")
    b.control()
    program = stream("O1234(TEST)", "M3 S1200", "G0Z0", "G1F500X120.Y-30.", "M30")
    b.look()
    for piece in (256, 7, 1):
        b.say(f"{piece} characters each: {_download(b, b'JUNK O99' + program, piece)}")
        b.look()
        b.say(f"  {_upload(b, 1234, piece)}")
        b.code("cnc_delete", 1234)
    b.title("lengths of a piece")
    for number in (-0x8000, -1, 0, 1, 2, 255, 256, 257, 0x7FFF):
        opened = b.cell("cnc_dwnstart")
        codes = [b.cell("cnc_download", b"\n" + b"(" * 400, number), b.cell("cnc_dwnend")]
        b.say(f"{number}: {opened} {' '.join(codes)}; too few characters: {_short_piece(b, number)}")
    b.say(f"of an upload: {_upload_lengths(b)}")
    b.title("numbers of programs")
    b.device.select_mode("EDIT")
    b.code("cnc_delall")
    for name in (
        "O0", "O1", "O01", "O0001", "O9999", "O09999", "O10000", "O00009999", "O123456789", "O", "O-1", "O1.",
        "N1", "O7X",
        "(C)", ":5", "O5O6", "O8(A)G1", "o9",
    ):  # fmt: skip
        _sent(b, "", stream(name, "M30"))
        b.code("cnc_delall")
    b.title("characters")

    def taken(before: bytes, after: bytes) -> str:
        def code(byte: int) -> str:
            answer = _download(b, b"\nO3\n" + before + bytes((byte,)) + after + b"\nM30\n%")
            b.remove(3)
            return answer

        return runs((byte, code(byte)) for byte in range(256))

    b.say(f"in a block: {taken(b'G1', b'X2')}")
    b.say(f"in a comment: {taken(b'(A', b'B)')}")
    b.say(f"first in a block: {taken(b'', b'G1')}")
    b.title("what is kept")
    for blocks in (
        ("O5 ( A  B )", "G1 X 1 (C )  Y2", "", " ", "M30"), ("O6",), ("O7", "M30", "O8", "M2", "O9(X)", "M99"),
        ("O7", "M030", "O8", "M02", "O9", "M00099"), ("O7", "G1", "O8", "G1"),
        ("O7", "M300", "G1", "M30(M2)", "O8", "(M30)", "M99P5"),
        ("O7", "M30", "G1", "O8", "M30"), ("O7", "M30.", "O7", "M30"), ("O7", "G1", "O7", "M30"), ("", "", "O7", "M30"),
    ):  # fmt: skip
        for parameter in (64, 0):
            b.code("cnc_wrparam", 5, psd(3201, 0, cdata=parameter))
            b.say(f"3201 = {parameter}, {text(stream(*blocks))}: {_download(b, stream(*blocks))}")
            kept = [
                int(each)
                for each in b.get("cnc_rdprogdir", 0, 1, 9999, 99).prg_data.decode()[1:-1].split("O")
                if each
            ]
            b.say(f"  {', '.join(_upload(b, number) for number in kept)}")
            b.code("cnc_delall")
    allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-./*=,#[]&?@: "
    comment = bytes(each for each in range(0x20, 0x7F) if each not in b"()%").decode()
    data = stream("O7", f"N1{allowed}", f"({comment})", f"G1{allowed[::-1]}({comment[::-1]})X", "M30")
    b.say(f"every character: {_download(b, data)}")
    b.say(f"  {_upload(b, 7)}")
    b.code("cnc_delall")
    for data in (
        b"",
        b"%",
        b"\n",
        b"\n%",
        b"\n\n%",
        b"O7\nM30\n%",
        b"\nO7\nM30\n",
        b"\nO7\nM30%",
        b"\nO7\nM30\n%\nO8\nM30\n%",
        b"%\nO7\nM30\n%",
        b"\nO7\nM30\n%X",
        b"\nO7\nM3",
    ):
        _sent(b, "", data)
        b.code("cnc_delall")


def _short_piece(b: Bench, number: int) -> str:
    b.code("cnc_dwnstart")
    codes = b.cell("cnc_download", b"\n" * max(0, number - 1), number)
    b.code("cnc_dwnend")
    return codes


def _upload_lengths(b: Bench) -> str:
    registered(b.device, O2=";M30")
    made = [
        f"before upstart {b.cell('cnc_upload', 9)}, {b.cell('cnc_upend')}",
        f"start {b.cell('cnc_upstart', 2)}",
        f"again {b.cell('cnc_upstart', 2)}",
    ]
    made += [f"{number} {b.cell('cnc_upload', number)}" for number in (0, 1, 0xFFFF, 1)]
    made += [f"end {b.cell('cnc_upend')}, {b.cell('cnc_upend')}, {b.cell('cnc_upload', 1)}"]
    made += [f"of O{number} {b.cell('cnc_upstart', number)}" for number in (-1, 0, 1, 9999, 0x7FFF)]
    return "; ".join(made)


def rules(b: Bench) -> None:
    """Parameters, keys and the size of the memory: what each lets through."""
    b.title("TV check: 0000#0, blocks with their end of block have an even number of characters")
    b.control()
    for value in (0, 1, 3, 2):
        b.code("cnc_wrparam", 5, psd(0, 0, cdata=value))
        for blocks in (
            ("O77", "G01", "M30"),
            ("O77", "G1", "M30"),
            ("O7", "G01", "M30"),
            ("O77", "G01X", "M30"),
            ("O77", "M30", "M3"),
        ):
            b.say(
                f"0000 = {value}, {text(stream(*blocks))}: {_download(b, stream(*blocks))}, MDI "
                f"{_mdi(b, stream(*blocks))}"
            )
            b.remove(77, 7)
    b.title("3201#2: a registered program, and the selected one")
    b.control()
    registered(b.device, O7=";G1;M30", O8=";M30")
    b.device.select_program(8)
    for value in (64, 64 + 4, 4):
        b.code("cnc_wrparam", 5, psd(3201, 0, cdata=value))
        for parts in (
            ("O7", f"G{value}", "M30"),
            ("O8", "G2", "M30"),
            ("O9", "M30", "O7", "G3", "M30"),
            ("O9", "M30", "O9", "M30"),
        ):
            _sent(b, f"3201 = {value}, ", stream(*parts))
    b.say(f"{_upload(b, 7)}, {_upload(b, 8)}")
    b.title("programs that parameters protect: download, MDI call, delete, search, upload")
    edges = (7999, 8000, 8500, 8999, 9000, 9500, 9999)
    for words, changes in (
        ("3202 = 0", {}), ("#0", {3202: 1}), ("#4", {3202: 16}), ("all but #0", {3202: 254}),
        ("all but #4", {3202: 239}),
        ("password", {3210: 321}), ("password and another key word", {3210: 321, 3211: 322}),
        ("password and key word", {3210: 321, 3211: 321}),
        ("#0 and #4 and key word", {3202: 17, 3210: 5, 3211: 5}), ("key word alone", {3211: 5}),
    ):  # fmt: skip
        for select in (True, False):
            b.control()
            for number in edges if select else ():
                b.device.programs.register(number, f"O{number}\nM30\n")
            for number, value in changes.items():
                assert (
                    b.code(
                        "cnc_wrparam",
                        8,
                        psd(number, 0, cdata=value) if number == 3202 else psd(number, 0, ldata=value),
                    )
                    == EW.EW_OK
                )
            if select:
                deleted = " ".join(f"{number} {b.cell('cnc_delete', number)}" for number in (8000, 9999))
                found = " ".join(b.cell("cnc_search", number) for number in edges)
                up = " ".join(
                    f"{b.cell('cnc_upstart', number)}{b.code('cnc_upend')}" for number in (8500, 9500)
                )
                b.device.programs.unselect()
                b.device.select_mode("EDIT")
                b.say(
                    f"{words}: delete {deleted}, search {found}, upload {up}, delall {b.cell('cnc_delall')} "
                    f"leaves {_numbers(b)}"
                )
            else:
                sent = ", ".join(f"{number} {_download(b, stream(f'O{number}', 'M30'))}" for number in edges)
                b.say(f"{words}: download {sent}")
    b.title("keys")
    for value in (0, 128, 127):
        for key in (1, 2, 3, 4, None):
            b.control()
            registered(b.device, O7=";M30", O8=";M30")
            b.code("cnc_wrparam", 5, psd(3290, 0, cdata=value - 256 if value > 127 else value))
            opened = b.cell("cnc_dwnstart")
            b.device.protect_key(True, key=key)
            b.device.select_mode("EDIT")
            codes = (
                f"in an open one {b.cell('cnc_download', stream('O9', 'M30'), 9)} {b.cell('cnc_dwnend')}, "
                f"start {b.cell('cnc_dwnstart')} {b.cell('cnc_dwnend')}"
            )
            b.say(
                f"3290 = {value}, key {key or 'all'}: {opened}, {codes}, delete {b.cell('cnc_delete', 7)}, "
                f"search {b.cell('cnc_search', 8)}, upload {b.cell('cnc_upstart', 8)}, delall "
                f"{b.cell('cnc_delall')} leaves {_numbers(b)}"
            )
    b.title("a memory that gets full")
    for characters in (32, 31, 30):
        b.control(characters=characters, most_programs=2)
        registered(b.device, O1=";G1X1.;M30")
        _sent(b, f"{characters} characters in all, ", stream("O0002", "G1X2.", "M30"))
        _sent(b, "", stream("O3", "M30"), 3)
    b.control(most_programs=2)
    for number in (1, 2, 3):
        _sent(b, "two programs at the most, ", stream(f"O{number}", "M30"))
    _sent(b, "", stream("O4", "M30", "O5", "M30"))


def _numbers(b: Bench) -> str:
    return str(b.get("cnc_rdprogdir", 0, 1, 9999, 256).prg_data.decode())


def _mdi(b: Bench, data: bytes) -> str:
    b.device.select_mode("MDI")
    code = b.cell("cnc_wrmdiprog", len(data), data)
    b.device.select_mode("MEM")
    return code


def directory(b: Bench) -> None:
    """The directory: kinds, ranges, lengths, comments; how full the memory is."""
    b.title("the four programs of the manual")
    b.control(characters=3000, most_programs=20)
    for number, comment, size in (
        (12, "(TEST)", 420),
        (200, "(WORK1)", 352),
        (201, "", 537),
        (9001, "(SUB-PRO1)", 781),
    ):
        head = f"O{number:04d}{comment}\n"
        b.device.programs.register(
            number,
            head + "G04\n" * ((size - len(head) - 4) // 4) + "M30" + " " * ((size - len(head)) % 4) + "\n",
        )
    b.look()
    for kind in range(-1, 4):
        for first, last in (
            (1, 9999),
            (12, 201),
            (13, 199),
            (12, 12),
            (200, 200),
            (201, 9001),
            (9002, 9999),
            (9999, 9999),
            (0, 9999),
            (1, 10000),
            (1, 0),
            (201, 200),
            (-1, 9999),
            (1, 0x7FFF),
            (-0x8000, -0x8000),
        ):
            b.call("cnc_rdprogdir", kind, first, last, 64)
    for length in (-0x8000, -1, 0, 1, 2, 15, 16, 17, 18, 47, 48, 49, 53, 54, 55, 0x7FFF):
        b.table(
            f"length {length}",
            ("code", "text"),
            ((kind, _directory(b, kind, length)) for kind in range(3)),
        )
    for kind in (-1, 0, 1, 2):
        for length in (-1, 0, 11, 12, 13, 30, 31, 32, 33, 0x7FFF):
            b.call("cnc_rdproginfo", kind, length)
    b.title("comments")
    b.control()
    for number, comment in enumerate(
        (
            "(" + "A" * 47 + ")",
            "(" + "B" * 48 + ")",
            "(" + "C" * 49 + ")",
            "()",
            "(D)(E)",
            "( F G )",
            "G1(H)",
            "(lower)",
            "(J",
        ),
        1,
    ):
        _download(b, stream(f"O{number}{comment}", "M30"))
    for number in range(1, 10):
        b.call("cnc_rdprogdir", 2, number, number, 70)
    b.title("as many as there can be")
    b.control()
    for number in range(9999, 9999 - 80 * 125, -80):
        b.device.programs.register(number, f"O{number:04d}({number})\nM30\n")
    for kind in range(3):
        b.say(_directory(b, kind, 0x7FFF)[1])
    b.look()
    b.title("nothing registered, and the most")
    b.control(most_programs=3, characters=30)
    b.look()
    registered(b.device, O9999=";M30", O1=";M30", O50=";M30")
    b.look()


def _directory(b: Bench, kind: int, length: int) -> tuple[str, str]:
    code, record = fwlib.cnc_rdprogdir(b.handle, kind, 1, 9999, length)
    return short(code), text(record.prg_data) if code == EW.EW_OK else ""


# ---------------------------------------------------------------------- execution


def execution(b: Bench) -> None:
    """What is executed, block by block: sub-programs, sequence numbers, texts of every length, MDI, searches."""
    b.title("three programs within each other, in single block")
    device = b.control()
    registered(
        device,
        O1234=";N10G90;G1X1.F60000;/N20M98P5678;N30X2.;M98P25678;N99999X3.;M30",
        O5678=";Y1.;N210M98P9876;/2N220Y2.;M99",
        O9876=";Z1.;N0Z2.;N7Z0;M99",
    )
    b.do("search O1234", lambda: b.code("cnc_search", 1234))
    device.control.set_switches(single_block=True)
    for _ in range(19):
        b.say("> start")
        device.cycle_start()
        device.advance(400)
        b.look()
    device.control.set_switches(single_block=False)
    b.do("reset", device.reset)
    b.say("lengths of the text in O9876")
    device.cycle_start()
    device.advance(5000, until=lambda: bool(b.get("cnc_rdseqnum").data == 7))
    for length in (0, 1, 4, 5, 8, 9, 12, 13, 0xFFFF):
        b.call("cnc_rdexecprog", length)
    b.do("reset on the way", device.reset)
    device.advance(300)
    b.title("searches and rewind")
    registered(device, O4=";N5G4P1;N50G4P1;N5X1.;N050X2.;N007X3.;/N8X4.;N99999;X5N9;M30")
    b.do("search O4", lambda: b.code("cnc_search", 4))
    for number in (5, 50, 7, 8, 99999, 9, 0, -1, 6, 100000, -0x80000000, 0x7FFFFFFF):
        b.call("cnc_seqsrch", number)
        b.look()
    b.do("search N50 and start", lambda: (b.code("cnc_seqsrch", 50), device.cycle_start()))
    b.advance(3000)
    for words, act in (
        ("search N8, rewind", lambda: (b.code("cnc_seqsrch", 8), b.code("cnc_rewind"))),
        ("search N7, reset", lambda: (b.code("cnc_seqsrch", 7), device.reset())),
        ("search N7, search O1234", lambda: (b.code("cnc_seqsrch", 7), b.code("cnc_search", 1234))),
        ("search N20, EDIT, MEM",
        lambda: (b.code("cnc_seqsrch", 20), device.select_mode("EDIT"), device.select_mode("MEM"))),
        ("search N20, off and on", lambda: (b.code("cnc_seqsrch", 20), device.power_cycle())),
        ("search in JOG", lambda: (device.select_mode("JOG"), b.call("cnc_search", 4), b.call("cnc_search", 3))),
        ("search in EDIT", lambda: (device.select_mode("EDIT"), b.call("cnc_search", 4), b.call("cnc_search", 3))),
    ):  # fmt: skip
        b.do(words, act)


def mdi(b: Bench) -> None:
    """The MDI program: what it may be, where it begins, and its pointers while it runs."""
    device = b.control()
    registered(device, O515=";G1Z1.F60000;N44Z2.;M99", O6=";M30")
    device.select_program(6)
    device.select_mode("MDI")
    b.look()
    b.title("lengths and texts")
    longest = stream("O9", "G1X1.F60000", "(" + "C" * 177 + ")", "%")[:-2]
    for data in (longest, longest.replace(b"CC", b"C", 1), longest.replace(b"C", b"CC", 1)):
        b.say(f"{len(data)} characters: {b.cell('cnc_wrmdiprog', len(data), data)}")
    for number in (-1, 0, 1, 5, 198, 199, 200, 0x7FFF):
        b.say(f"length {number}: {b.cell('cnc_wrmdiprog', number, longest)}")
    for blocks in (
        ("O7", "G1X1.5F60000", "M30"), ("O1234",), ("O7", ""), ("O7", "M30", "O8", "M30"), ("N1", "M30"), ("O0", "M30"),
        ("O9999", "G4P1"), ("O10000", "M30"), ("O7", "g1"), ("O7", "G1!"), ("O7", "(A"), ("O7", "M30", "G1"),
        ("O7", "G1 X2 (A B)"),
    ):  # fmt: skip
        b.say(f"> {text(stream(*blocks))}: {b.cell('cnc_wrmdiprog', len(stream(*blocks)), stream(*blocks))}")
        b.look()
    for data in (b"\nO7\nM30\n", b"O7\nM30\n%", b"X\nO7\nG4\n%", b"\nO7\nM3%"):
        b.say(f"> {text(data)}: {b.cell('cnc_wrmdiprog', len(data), data)}")
        b.look()
    b.title("pointers")
    for blocks in (("O1", "G4P1"), ("O1", "G4P1", "M30")):
        b.call("cnc_wrmdiprog", len(stream(*blocks)), stream(*blocks))
        b.say(f"  {runs((pointer, b.cell('cnc_wrmdipntr', pointer)) for pointer in range(-2, 5))}")
    data = stream("O1", "G1X1.F60000", "N20Y1.", "M98P515", "N30X2.", "M30")
    b.call("cnc_wrmdiprog", len(data), data)
    b.look()
    for pointer in (0, 1, 4, 5, -1, 3, -0x80000000, 0x7FFFFFFF):
        b.call("cnc_wrmdipntr", pointer)
        b.look()
    b.call("cnc_wrmdipntr", 1)
    device.control.set_switches(single_block=True)
    for _ in range(7):
        b.say("> start")
        device.cycle_start()
        device.advance(300)
        b.look()
    b.say(
        f"while a block is stopped at: {b.cell('cnc_wrmdiprog', len(data), data)}, {b.cell('cnc_wrmdipntr', 1)}"
    )
    device.control.set_switches(single_block=False)
    edit = device.programs.edit(6, background=True)
    b.say(f"while O6 is edited: {b.cell('cnc_wrmdiprog', len(data), data)}, {b.cell('cnc_wrmdipntr', 2)}")
    edit.close()
    device.reset()
    edit = device.programs.edit(6, background=True)
    b.say(f"and after a reset: {b.cell('cnc_wrmdiprog', len(data), data)}, {b.cell('cnc_wrmdipntr', 2)}")
    edit.close()
    b.say(f"not any more: {b.cell('cnc_wrmdipntr', 2)}, {b.cell('cnc_wrmdipntr', 1)}")
    for words, act in (
        ("start", device.cycle_start), ("reset", device.reset), ("MEM", partial(device.select_mode, "MEM")),
        ("MDI", partial(device.select_mode, "MDI")), ("off and on", device.power_cycle),
        ("MDI again", partial(device.select_mode, "MDI")),
    ):  # fmt: skip
        b.do(words, act)
        device.advance(600)
        b.look()
    b.say(f"pointer without a program: {b.cell('cnc_wrmdipntr', 0)}, {b.cell('cnc_wrmdipntr', 1)}")


# ---------------------------------------------------------------------- what each state allows


def _run_to(b: Bench, stop: Callable[[PowerMate], object] = lambda device: None, *, program: int = 7) -> None:
    b.device.select_program(program)
    b.device.cycle_start()
    b.device.advance(60)
    stop(b.device)
    b.device.advance(400)


def _single(b: Bench) -> None:
    b.device.control.set_switches(single_block=True)
    _run_to(b)
    b.device.cycle_start()
    b.device.advance(300)


def _alarm(number: int) -> Callable[[Bench], object]:
    return lambda b: b.device.raise_alarm(number)


def _other_handle(b: Bench, name: str, *given: int) -> None:
    _, other = fwlib.cnc_allclibhndl()
    getattr(fwlib, name)(other, *given)


MDI_PROGRAM = stream("O1", "G4", "G4", "M30")
STATES: dict[str, Callable[[Bench], object]] = {
    "at rest": lambda b: None,
    "O7 moves": _run_to,
    "O7 held": lambda b: _run_to(b, lambda device: device.feed_hold()),
    "O7 after a block": _single,
    "O9 at M0": lambda b: _run_to(b, program=9),
    "O10 in alarm": lambda b: _run_to(b, program=10),
    "alarm 000": _alarm(0),
    "alarm 100": _alarm(100),
    "alarm 101": _alarm(101),
    "alarm 417": _alarm(417),
    "alarm 1007": _alarm(1007),
    "emergency stop": lambda b: b.device.emergency_stop(),
    "O7 after reset": lambda b: (_run_to(b), b.device.reset(), b.device.advance(300)),
    "background edit of O8": lambda b: b.device.programs.edit(8, background=True),
    "a background edit, closed": lambda b: b.device.programs.edit(8, background=True).close(),
    "edit of O9": lambda b: (b.device.select_mode("EDIT"), b.device.programs.edit(9)),
    "a download of this handle": lambda b: b.code("cnc_dwnstart"),
    "a download of another handle": lambda b: _other_handle(b, "cnc_dwnstart"),
    "a comparison": lambda b: b.device.start_compare(),
    "an upload of this handle": lambda b: b.code("cnc_upstart", 8),
    "an upload of another handle": lambda b: _other_handle(b, "cnc_upstart", 8),
    "a download that was stopped": lambda b: (b.code("cnc_dwnstart"), b.device.feed_hold()),
    "a download that was reset": lambda b: (b.code("cnc_dwnstart"), b.device.reset()),
    "nothing selected": lambda b: b.device.programs.unselect(),
    "nothing registered": lambda b: (b.device.select_mode("EDIT"), b.code("cnc_delall")),
    "an MDI program": lambda b: (b.device.select_mode("MDI"), b.device.mdi.put(MDI_PROGRAM)),
    "an upload, then alarm 000": lambda b: (b.code("cnc_upstart", 8), b.device.raise_alarm(0)),
    "a download, then alarm 101": lambda b: (b.code("cnc_dwnstart"), b.device.raise_alarm(101)),
    "a download and an upload, then off and on": lambda b: (
        b.code("cnc_dwnstart"),
        b.code("cnc_upstart", 8),
        b.device.power_cycle(),
    ),
    "a download, then key 3 and a background edit": lambda b: (
        b.code("cnc_dwnstart"),
        b.device.protect_key(True, key=3),
        b.device.programs.edit(8, background=True),
    ),
    "key 3": lambda b: b.device.protect_key(True, key=3),
    "9000 protected": lambda b: b.code("cnc_wrparam", 5, psd(3202, 0, cdata=16)),
}  # fmt: skip
MODES = [mode for mode in PowerMateMode if mode is not PowerMateMode.NONE]
FEW = [PowerMateMode.MDI, PowerMateMode.MEM, PowerMateMode.EDIT, PowerMateMode.JOG, PowerMateMode.RMT]
CALLS: tuple[tuple[str, tuple[object, ...]], ...] = (
    ("rdprgnum", ()), ("rdseqnum", ()), ("rdexecprog", (9,)), ("rdprogdir", (0, 1, 9999, 99)), ("rdproginfo", (0, 12)),
    ("rdmdipntr", ()), ("wrmdipntr", (0,)), ("wrmdiprog", (len(MDI_PROGRAM), MDI_PROGRAM)), ("wrmdipntr", (1,)),
    ("seqsrch", (30,)), ("seqsrch", (31,)), ("rewind", ()), ("download", (b"\nO5\nM30\n%", 9)), ("dwnend", ()),
    ("dwnstart", ()),
    ("download", (b"\nO6\n", 4)), ("dwnend", ()), ("upload", (9,)), ("upstart", (8,)), ("upload", (0,)),
    ("upload", (3,)), ("upend", ()), ("upend", ()),
    ("search", (7,)), ("search", (8,)), ("search", (11,)), ("search", (0,)), ("delete", (11,)),
    ("delete", (0,)), ("delete", (7,)),
    ("delete", (9001,)), ("delete", (8,)), ("delall", ()),
)  # fmt: skip


def states(b: Bench) -> None:
    """Every program function in every state and mode; what it changed stands below."""
    for words, begin in STATES.items():
        modes = MODES if words in ("at rest", "O7 moves") else FEW
        b.title(words)
        columns, effects = [], []
        for mode in modes:
            device = b.control()
            registered(
                device,
                O7=";G1X9.F3000;N30Y9.;Z9.;M30", O8=";N30M30", O9=";G4P1;N30M0;M30", O10=";N30X1.F9000;G1Q9;M30",
                O9001=";M99",
            )  # fmt: skip
            device.select_program(7)
            begin(b)
            device.select_mode(mode)
            column, changes = _asked(b)
            columns.append(column)
            effects.append(f"{mode.label}: {changes}")
        rows = (
            (_call_text(*call), cells) for call, cells in zip(CALLS, zip(*columns, strict=True), strict=True)
        )
        b.table("", [mode.label for mode in modes], ((name, list(cells)) for name, cells in rows))
        b.lines += _alike(effects)


def _call_text(name: str, given: tuple[object, ...]) -> str:
    return (
        f"{name} {' '.join(text(each) if isinstance(each, bytes) else str(each) for each in given)}".strip()
    )


def _asked(b: Bench) -> tuple[list[str], str]:
    cells, changes, before = [], [], _state(b)
    for name, given in CALLS:
        cells.append(b.cell(f"cnc_{name}", *given))
        if (now := _state(b)) != before:
            changes.append(
                f"{_call_text(name, given)} "
                f"{'; '.join(f'{a} -> {c}' for a, c in zip(before, now, strict=True) if a != c)}"
            )
        before = now
    return cells, ", ".join(changes) or "nothing changes"


def _state(b: Bench) -> tuple[str, ...]:
    device = b.device
    return (
        _numbers(b), f"O{device.programs.selected}", f"MDI {len(device.state.mdi.blocks)} {device.state.mdi.start}",
        f"line {device.state.cursor}", "transfer" if device.transfer else "no transfer",
    )  # fmt: skip


def _alike(lines: list[str]) -> Iterator[str]:
    known: dict[str, list[str]] = {}
    for line in lines:
        mode, changes = line.split(": ", 1)
        known.setdefault(changes, []).append(mode)
    for changes, modes in known.items():
        yield f"{', '.join(modes)}: {changes}"
