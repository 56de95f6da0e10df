import math
import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.errors import UsageError
from polycnc.machine import StoreError, _store_file
from polycnc.machine._store import Area, Entry, Store
from support.often import share


@pytest.fixture(params=["memory", "file"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    with Store(None if request.param == "memory" else tmp_path / "machine.db") as opened:
        yield opened


def plain_database(path: Path, *statements: str) -> bytes:
    """Make a SQLite file that is not ours and return its bytes."""
    with closing(sqlite3.connect(path)) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()
    return path.read_bytes()


# --- areas


def test_an_area_is_a_mapping(store: Store) -> None:
    parameters = store.area("parameters", int)
    parameters[1020] = 88
    parameters["x"] = -(2**63)
    parameters[5] = 2**63 - 1
    assert parameters[1020] == 88
    assert list(parameters) == [5, 1020, "x"]
    assert dict(parameters) == parameters.load() == {5: 2**63 - 1, 1020: 88, "x": -(2**63)}
    assert len(parameters) == 3
    assert 5 in parameters
    assert "5" not in parameters
    assert parameters.get("none", 7) == 7
    assert parameters.pop(5) == 2**63 - 1
    del parameters["x"]
    assert parameters.load() == {1020: 88}
    with pytest.raises(KeyError):
        parameters[5]
    with pytest.raises(KeyError):
        del parameters[5]
    parameters.clear()
    assert len(parameters) == 0


def test_areas_do_not_see_each_other(store: Store) -> None:
    store.area("fanuc.parameters", int)[1] = 10
    store.area("fanuc.macros", int)[1] = 20
    store.area("fanuc.macros", int).clear()
    assert store.area("fanuc.parameters", int).load() == {1: 10}


def test_a_program_has_bytes_and_attributes(store: Store) -> None:
    programs = store.area("programs", bytes)
    text = b"%\r\nO1(PART)\n\x00\xff\n%"
    programs.put("O1", text, {"comment": "PART", "protected": True, "size": len(text)})
    assert programs["O1"] == text
    assert programs.attributes("O1") == {"comment": "PART", "protected": True, "size": len(text)}
    programs["O1"] = b"M30"
    assert programs.attributes("O1")["comment"] == "PART"
    programs.put("O1", b"M30", {})
    assert programs.attributes("O1") == {}
    programs["O2"] = b""
    assert programs.attributes("O2") == {}
    with pytest.raises(KeyError):
        programs.attributes("O3")


@pytest.mark.parametrize(
    "value", [0.0, -0.0, 1.0, 0.1, 5e-324, 1.7976931348623157e308, math.inf, -math.inf, 2.0**53 + 2]
)
def test_numbers_come_back_bit_by_bit(store: Store, value: float) -> None:
    macros = store.area("macros", float)
    macros[100] = value
    assert macros[100].hex() == value.hex()
    assert type(macros[100]) is float


def test_a_whole_number_becomes_a_float_where_floats_live(store: Store) -> None:
    macros = store.area("macros", float)
    macros[1] = 3
    assert type(macros[1]) is float


def test_tables_are_json_objects(store: Store) -> None:
    tables = store.area("tables", dict)
    row = {"X": 1.5, "name": "Nullpunkt Ä", "flags": [1, None, True], "inner": {"a": 0.1}}
    tables["V1.npv"] = row
    assert tables["V1.npv"] == row
    assert tables.load() == {"V1.npv": row}


BAD_VALUES: list[tuple[type[Any], object, str]] = [
    (int, 1.0, "1.0 is not of type int"),
    (int, True, "True is not of type int"),
    (int, 2**63, "is over 64 bits"),
    (float, "1", "'1' is not of type float"),
    (float, math.nan, "NaN cannot be stored"),
    (str, b"a", "b'a' is not of type str"),
    (bytes, "a", "'a' is not of type bytes"),
    (dict, [1], r"\[1\] is not of type dict"),
    (dict, {"a": math.nan}, "not a JSON object"),
    (dict, {"a": object()}, "not a JSON object"),
    (float, None, "None is not of type float"),
]


@pytest.mark.parametrize(("of", "value", "message"), BAD_VALUES)
def test_a_value_that_cannot_be_kept_is_refused(
    store: Store, of: type[Any], value: object, message: str
) -> None:
    area = store.area("macros", of)
    with pytest.raises(UsageError, match=message) as caught:
        area[1] = value
    assert caught.value.hint
    assert len(area) == 0


def test_an_area_read_as_another_type_is_refused(store: Store) -> None:
    store.area("macros", float)[1] = 2.5
    with pytest.raises(UsageError, match="macros 1 holds float, not int"):
        store.area("macros", int)[1]


@pytest.mark.parametrize(
    "name", ["", "Macros", "a b", "a.", ".a", "a..b", "1a", "a-b", "a'; DROP TABLE item; --"]
)
def test_names_of_areas_and_histories(store: Store, name: str) -> None:
    with pytest.raises(UsageError, match="cannot name a part of a store"):
        store.area(name, int)
    with pytest.raises(UsageError, match="cannot name a part of a store"):
        store.history(name)


@pytest.mark.parametrize("key", [1.5, True, None, b"a", (1, 2)])
def test_keys_are_numbers_or_text(store: Store, key: Any) -> None:
    with pytest.raises(UsageError, match="cannot be a key"):
        store.area("macros", int)[key] = 1


keys = st.integers(-(2**63), 2**63 - 1) | st.text(st.characters(exclude_categories=["Cs"]))
changes = st.lists(st.tuples(st.sampled_from("sdp"), keys, st.binary(max_size=20)), max_size=30)


@settings(deadline=None, max_examples=share(60))
@given(changes)
def test_an_area_behaves_like_a_dictionary(steps: list[tuple[str, int | str, bytes]]) -> None:
    with Store() as store:
        area, model = store.area("programs", bytes), dict[int | str, bytes]()
        for step, key, value in steps:
            if step == "s":
                area[key] = model[key] = value
            elif step == "p":
                assert area.pop(key, None) == model.pop(key, None)
            else:
                assert area.setdefault(key, value) == model.setdefault(key, value)
        assert area.load() == model
        assert list(area) == sorted(
            model,
            key=lambda key: (isinstance(key, str), key if isinstance(key, int) else 0, str(key).encode()),
        )


# --- transactions


def test_a_transaction_is_kept_whole_or_not_at_all(store: Store) -> None:
    area = store.area("offsets", float)
    area["X"] = 1.0
    with store.transaction():
        area["X"] = 2.0
        with store.transaction():
            area["Z"] = 3.0
    assert area.load() == {"X": 2.0, "Z": 3.0}

    def write_and_fail() -> None:
        area["X"] = 9.0
        with store.transaction():
            area["Y"] = 9.0
        store.history("alarms").append({"number": 1})
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), store.transaction():
        write_and_fail()
    assert area.load() == {"X": 2.0, "Z": 3.0}
    assert len(store.history("alarms")) == 0


def test_save_stores_everything_or_nothing(store: Store) -> None:
    area = store.area("macros", float)
    area.save({number: number / 2 for number in range(100, 200)})
    assert area[199] == 99.5
    with pytest.raises(UsageError, match="NaN"):
        area.save({1: 1.0, 2: math.nan})
    assert len(area) == 100


def test_threads_wait_for_a_transaction(store: Store) -> None:
    area = store.area("macros", int)
    area[1] = 0

    def count() -> None:
        for _ in range(50):
            with store.transaction():
                area[1] = area[1] + 1

    threads = [threading.Thread(target=count) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert area[1] == 200


# --- histories


def test_a_history_keeps_its_order_and_never_reuses_a_number(store: Store) -> None:
    alarms, keys = store.history("alarms"), store.history("keys")
    first = alarms.append({"number": 417, "axis": 1})
    keys.append({"key": "RESET"})
    second = alarms.append({"number": 510})
    assert second > first
    assert alarms.read() == [Entry(first, {"number": 417, "axis": 1}), Entry(second, {"number": 510})]
    assert alarms.read(after=first) == [Entry(second, {"number": 510})]
    assert alarms.read(count=1) == [Entry(first, {"number": 417, "axis": 1})]
    assert (len(alarms), len(keys)) == (2, 1)
    assert alarms.trim(keep=0) == 2
    assert (len(alarms), len(keys)) == (0, 1)
    assert alarms.append({}) > second


def test_a_history_can_be_trimmed_to_its_newest_entries(store: Store) -> None:
    alarms = store.history("alarms")
    for index in range(10):
        alarms.append({"index": index})
    assert [entry.content["index"] for entry in alarms.last(3)] == [7, 8, 9]
    assert alarms.trim(keep=4) == 6
    assert [entry.content["index"] for entry in alarms.read()] == [6, 7, 8, 9]
    assert alarms.trim(keep=4) == 0


def test_an_entry_is_a_json_object(store: Store) -> None:
    with pytest.raises(UsageError, match="not a JSON object"):
        store.history("alarms").append({"at": object()})
    assert len(store.history("alarms")) == 0


# --- the file


def test_a_file_remembers_after_closing(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    with Store(path) as store:
        store.area("keep_relays", bytes)["K"] = bytes(range(20))
        number = store.history("alarms").append({"number": 1})
    assert [entry.name for entry in tmp_path.iterdir()] == ["machine.db"]
    with Store(str(path)) as store:
        assert store.area("keep_relays", bytes)["K"] == bytes(range(20))
        assert store.history("alarms").read() == [Entry(number, {"number": 1})]


def test_an_acknowledged_write_is_on_the_disk(tmp_path: Path) -> None:
    with Store(tmp_path / "machine.db") as store:
        assert store.query("PRAGMA journal_mode") == [("wal",)]
        assert store.query("PRAGMA synchronous") == [(2,)]  # FULL
        assert store.query("PRAGMA locking_mode") == [("exclusive",)]


def test_a_closed_store_says_so() -> None:
    store = Store()
    area = store.area("macros", int)
    store.close()
    store.close()
    with pytest.raises(UsageError, match="the store is closed"):
        area[1] = 1


def test_a_file_belongs_to_one_store(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    with Store(path) as store:
        store.area("macros", int)[1] = 5
        with pytest.raises(
            UsageError, match=r"cannot open the store '.*': database is locked\na store belongs to one"
        ):
            Store(path)
        store.area("macros", int)[1] = 6
    with Store(path) as store:
        assert store.area("macros", int)[1] == 6


def test_a_file_that_is_not_a_store_is_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_bytes(b"G0 X0\n" * 100)
    other = tmp_path / "other.db"
    content = plain_database(other, "CREATE TABLE t (x)", "PRAGMA user_version = 1")
    for file, before in ((path, b"G0 X0\n" * 100), (other, content)):
        with pytest.raises(UsageError, match="is not a store of polycnc\nname a store, or a new file"):
            Store(file)
        with Store() as store, pytest.raises(UsageError, match="is not a store of polycnc"):
            store.snapshot(file)
        with Store() as store, pytest.raises(UsageError, match="is not a store of polycnc"):
            store.restore(file)
        assert file.read_bytes() == before
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["notes.txt", "other.db"]


def test_a_newer_store_is_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    Store(path).close()
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("PRAGMA user_version = 99")
    before = path.read_bytes()
    with pytest.raises(
        UsageError, match="has version 99, and this polycnc knows versions up to 1\nuse the polycnc"
    ):
        Store(path)
    with Store() as store, pytest.raises(UsageError, match="has version 99"):
        store.restore(path)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["machine.db"]


def test_a_damaged_store_says_so(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    with Store(path) as store:
        store.area("programs", bytes)["O1"] = bytes(100_000)
    content = bytearray(path.read_bytes())
    content[100:4096] = b"\xff" * 3996
    path.write_bytes(content)
    with pytest.raises(UsageError, match=r"is damaged: .*\nrestore a snapshot of it"), Store(path) as store:
        pass


def test_places_where_no_store_can_be(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot read|cannot open"):
        Store(tmp_path)
    with pytest.raises(UsageError, match=r"cannot write '.*': .*\ncheck that the folder exists"):
        Store(tmp_path / "none" / "machine.db")
    with Store() as store, pytest.raises(UsageError, match="there is no snapshot"):
        store.restore(tmp_path / "none.db")


def test_an_empty_file_becomes_a_store(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    path.touch()
    with Store(path) as store:
        store.area("macros", int)[1] = 1


def test_leftovers_of_another_store_are_not_mixed_in(tmp_path: Path) -> None:
    (tmp_path / "machine.db-wal").write_bytes(b"unmerged")
    with pytest.raises(
        UsageError, match=r"machine\.db-wal' shows that the store is in use or was not closed"
    ):
        Store(tmp_path / "machine.db")
    assert [entry.name for entry in tmp_path.iterdir()] == ["machine.db-wal"]


def test_older_stores_are_brought_forward(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, snapshot = tmp_path / "machine.db", tmp_path / "old.db"
    with Store(path) as store:
        store.area("macros", int)[1] = 5
        store.snapshot(snapshot)
    newer = (
        *_store_file.MIGRATIONS,
        ("ALTER TABLE item ADD COLUMN unit TEXT", "UPDATE item SET unit = 'mm'"),
    )
    monkeypatch.setattr(_store_file, "MIGRATIONS", newer)
    with Store(path) as store:
        assert store.query("SELECT key, value, unit FROM item") == [(1, 5, "mm")]
        assert store.query("PRAGMA user_version") == [(2,)]
        store.area("macros", int)[1] = 6
        store.restore(snapshot)
        assert store.query("SELECT key, value, unit FROM item") == [(1, 5, "mm")]
        assert store.query("PRAGMA user_version") == [(2,)]


def test_a_migration_that_fails_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "machine.db"
    with Store(path) as store:
        store.area("macros", int)[1] = 5
    with monkeypatch.context() as patch:
        broken = (*_store_file.MIGRATIONS, ("DELETE FROM item", "INSERT INTO nowhere VALUES (1)"))
        patch.setattr(_store_file, "MIGRATIONS", broken)
        with pytest.raises(UsageError, match="no such table: nowhere"):
            Store(path)
    with Store(path) as store:
        assert store.area("macros", int).load() == {1: 5}


# --- snapshots


def test_snapshot_and_restore_bring_everything_back(store: Store, tmp_path: Path) -> None:
    snapshot = tmp_path / "monday.db"
    programs, alarms = store.area("programs", bytes), store.history("alarms")
    programs.put("O1", b"G0 X0", {"comment": "A"})
    number = alarms.append({"number": 1})
    store.snapshot(snapshot)
    assert not list(tmp_path.glob("monday.db-*"))
    assert not list(tmp_path.glob(".monday*"))
    assert snapshot.read_bytes()[18:20] == b"\1\1"  # a plain file, that needs none beside it to be read
    programs["O1"] = b"G1"
    programs["O2"] = b"new"
    alarms.append({"number": 2})
    content = snapshot.read_bytes()
    store.restore(snapshot)
    assert snapshot.read_bytes() == content
    assert programs.load() == {"O1": b"G0 X0"}
    assert programs.attributes("O1") == {"comment": "A"}
    assert alarms.read() == [Entry(number, {"number": 1})]
    programs["O3"] = b"goes on"
    assert len(programs) == 2


def test_a_restored_file_lasts(tmp_path: Path) -> None:
    with Store() as source:
        source.area("macros", int)[1] = 5
        source.snapshot(tmp_path / "snapshot.db")
    with Store(tmp_path / "machine.db") as store:
        store.area("macros", int)[2] = 6
        store.restore(tmp_path / "snapshot.db")
        store.area("macros", int)[3] = 7
    with Store(tmp_path / "machine.db") as store:
        assert store.area("macros", int).load() == {1: 5, 3: 7}
    with Store(tmp_path / "snapshot.db") as store:  # a snapshot is a store itself
        assert store.area("macros", int).load() == {1: 5}


def test_a_snapshot_replaces_a_closed_snapshot(store: Store, tmp_path: Path) -> None:
    for value in (1, 2):
        store.area("macros", int)[1] = value
        store.snapshot(tmp_path / "snapshot.db")
    with Store(tmp_path / "snapshot.db") as copy:
        assert copy.area("macros", int)[1] == 2


def test_a_snapshot_never_replaces_a_store_in_use(tmp_path: Path) -> None:
    with Store(tmp_path / "a.db") as a, Store(tmp_path / "b.db") as b:
        a.area("macros", int)[1] = 1
        b.area("macros", int)[1] = 2
        with pytest.raises(UsageError, match="is the store itself"):
            a.snapshot(tmp_path / "." / "a.db")
        with pytest.raises(UsageError, match="in use or was not closed"):
            a.snapshot(tmp_path / "b.db")
        with pytest.raises(UsageError, match="in use or was not closed"):
            a.restore(tmp_path / "b.db")
        assert a.area("macros", int)[1] == 1
        assert b.area("macros", int)[1] == 2


def test_no_snapshot_inside_a_transaction(store: Store, tmp_path: Path) -> None:
    store.snapshot(tmp_path / "before.db")
    with pytest.raises(UsageError, match="snapshot inside a transaction"), store.transaction():
        store.snapshot(tmp_path / "inside.db")
    with pytest.raises(UsageError, match="restore inside a transaction"), store.transaction():
        store.restore(tmp_path / "before.db")
    assert not (tmp_path / "inside.db").exists()


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="needs access rights that bind")
def test_a_file_without_access_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    Store(path).close()
    path.chmod(0)
    with pytest.raises(UsageError, match="cannot read"):
        Store(path)


# --- what goes wrong while it is open


def test_a_full_store_says_so_and_keeps_what_it_acknowledged(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    with Store(path) as store:
        programs = store.area("programs", bytes)
        programs["O17"] = b"G1 X3" * 7
        store.query("PRAGMA max_page_count = 12")
        with pytest.raises(
            StoreError, match=r"cannot use the store '.*': database or disk is full\nmake room"
        ):
            programs["O18"] = bytes(200_000)
        with pytest.raises(StoreError, match="is full"):
            programs.save({"O19": b"small", "O20": bytes(200_000)})
        assert programs.load() == {"O17": b"G1 X3" * 7}
        programs["O21"] = b"fits"
    with Store(path) as store:
        assert set(store.area("programs", bytes)) == {"O17", "O21"}


def _write_behind_a_rollback(store: Store, numbers: Area[int]) -> None:
    with store.transaction():
        numbers[3] = 31
        store.query("ROLLBACK")  # as SQLite does by itself after some errors
        numbers[4] = 41


def test_writes_behind_an_error_that_undid_the_transaction_are_refused(tmp_path: Path) -> None:
    with Store(tmp_path / "machine.db") as store:
        numbers = store.area("numbers", int)
        with pytest.raises(StoreError, match="an error has undone the transaction"):
            _write_behind_a_rollback(store, numbers)
        assert numbers.load() == {}


def test_a_page_that_is_damaged_says_so_when_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    with Store(path) as store:
        store.area("numbers", int).save({number: number for number in range(5000)})
    content = bytearray(path.read_bytes())
    content[2 * 4096 :] = b"\xa5" * (len(content) - 2 * 4096)
    path.write_bytes(content)
    with Store(path) as store, pytest.raises(StoreError, match=r"damaged: .*malformed.*\nrestore a snapshot"):
        store.area("numbers", int).load()


def test_a_file_with_our_name_and_other_tables_says_so(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    plain_database(
        path,
        "CREATE TABLE other (a)",
        f"PRAGMA application_id = {_store_file.APPLICATION_ID}",
        f"PRAGMA user_version = {len(_store_file.MIGRATIONS)}",
    )
    with Store(path) as store, pytest.raises(StoreError, match=r"is damaged: no such table: item\nrestore"):
        store.area("numbers", int)[1] = 2


@pytest.mark.parametrize("text", ['{"a": ', "[1]", "7", "[" * 5000])
def test_contents_that_are_no_json_object_say_so(store: Store, text: str) -> None:
    store.history("alarms").append({"number": 5})
    store.area("tables", dict)["a"] = {"b": 1}
    store.query("UPDATE entry SET content = ?", (text,))
    store.query("UPDATE item SET value = ?, attributes = ?", (text, text))
    with pytest.raises(StoreError, match="the store is damaged"):
        store.history("alarms").read()
    with pytest.raises(StoreError, match="the store is damaged"):
        store.history("alarms").last(1)
    with pytest.raises(StoreError, match="the store is damaged"):
        store.area("tables", dict).attributes("a")
    with pytest.raises(StoreError, match="the store is damaged"):
        store.area("tables", dict).load()


def test_what_is_too_large_or_no_text_is_refused(store: Store) -> None:
    numbers, texts = store.area("numbers", int), store.area("texts", str)
    with pytest.raises(UsageError, match="cannot be a key"):
        numbers[2**63] = 1
    with pytest.raises(StoreError, match="too large"):
        2**64 in numbers  # noqa: B015
    with pytest.raises(StoreError, match="cannot hold this text"):
        texts["a"] = "\ud800"
    with pytest.raises(StoreError, match="cannot hold this text"):
        texts["\udfff"] = "a"
    deep: dict[str, Any] = {}
    for _ in range(100_000):
        deep = {"in": deep}
    with pytest.raises(UsageError, match="not a JSON object"):
        store.history("alarms").append(deep)
    while deep:
        deep = deep["in"]
    with pytest.raises(StoreError, match=r"too (big|large)"):
        store.query("SELECT zeroblob(2000000000)")
    assert (len(numbers), len(texts), len(store.history("alarms"))) == (0, 0, 0)


@pytest.mark.parametrize("size", [400, 5000], ids=str)  # Python writes no number of over 4,300 digits
@pytest.mark.parametrize("kind", [int, float, str, bytes, dict])
def test_a_number_of_any_length_is_refused_in_a_sentence(store: Store, kind: type[Any], size: int) -> None:
    area: Area[Any] = store.area("values", kind)
    kept = kind() if kind is not float else 2.5
    area.put(7, kept, {"unit": "mm"})
    for number in (10**size, -(10**size)):
        with pytest.raises(UsageError, match=r"over 64 bits|too large|is not of type") as refused:
            area.put(7, number)
        assert refused.value.hint
        assert len(str(refused.value)) < 200
        with pytest.raises(UsageError, match="cannot be a key"):
            area.put(number, kept)
    with pytest.raises(UsageError, match="not a JSON object"):
        area.put(7, kept, {"unit": 10**5000})
    assert dict(area) == {7: kept}
    assert area.attributes(7) == {"unit": "mm"}


@pytest.mark.parametrize("text", ["", "mm", '{"unit": ', "[3]", '"mm"', '{"size": ' + "9" * 5000 + "}"])
def test_damaged_attributes_are_told_by_every_way_of_reading_them(store: Store, text: str) -> None:
    area = store.area("values", float)
    area.put(7, 2.5, {"unit": "mm"})
    store.query("UPDATE item SET attributes = ?", (text,))
    for read in (lambda: area.attributes(7), area.all_attributes):
        with pytest.raises(StoreError, match="the store is damaged") as refused:
            read()
        assert refused.value.hint
    assert area[7] == 2.5


@pytest.mark.parametrize("name", ["a\0b", "n" * 5000])
def test_a_name_that_no_file_can_have(tmp_path: Path, name: str) -> None:
    with pytest.raises(StoreError, match=r"cannot (use|write|read) '"):
        Store(tmp_path / name)
    with Store() as store:
        with pytest.raises(StoreError, match=r"cannot (use|write|read) '"):
            store.snapshot(tmp_path / name)
        with pytest.raises(StoreError, match=r"cannot (use|write|read) '|there is no snapshot"):
            store.restore(tmp_path / name)


def test_a_restore_that_does_not_fit_leaves_the_store_as_it_was(tmp_path: Path) -> None:
    with Store() as source:
        source.area("programs", bytes)["O1"] = bytes(300_000)
        source.snapshot(tmp_path / "large.db")
    with Store(tmp_path / "machine.db") as store:
        store.area("numbers", int)[5] = 55
        store.query("PRAGMA max_page_count = 12")
        with pytest.raises(StoreError, match="is full"):
            store.restore(tmp_path / "large.db")
        assert store.area("numbers", int).load() == {5: 55}
