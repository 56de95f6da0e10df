"""The buffer of observations against a plain list: numbers never skip, `from`, `count` and `at` agree with it."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from polycnc.servers.mtconnect import Buffer, Item, Observation
from polycnc.servers.plant import About

ITEMS = [Item(f"i{k}", f"n{k}", "EVENT", "PROGRAM") for k in range(3)]
ITEMS.append(Item("c", "c", "CONDITION", "SYSTEM", about=(About.SYSTEM, "", 0)))
VALUES = st.tuples(
    st.integers(0, 3), st.sampled_from(["NORMAL", "FAULT", "x"]), st.sampled_from(["", "p", "q"])
)


def filled(size: int, values: list[tuple[int, str, str]]) -> tuple[Buffer, list[Observation]]:
    """Return a buffer, and everything that was ever added to it."""
    buffer = Buffer(size)
    return buffer, [
        buffer.add(ITEMS[k], "t", value if k == 3 else value.lower(), "", key if k == 3 else "")
        for k, value, key in values
    ]


def state_of(seen: list[Observation]) -> dict[Item, list[int]]:
    """Return what holds after observations, as their numbers, by going through all of them."""
    state: dict[Item, list[Observation]] = {}
    for each in seen:
        held = state.setdefault(each.item, [])
        if each.item.about is None or not each.key:
            held[:] = [each]
        else:
            held[:] = [other for other in held if other.key != each.key and other.value not in ("NORMAL",)]
            if each.value != "NORMAL":
                held.append(each)
    return {item: [each.sequence for each in held] for item, held in state.items()}


@given(st.integers(1, 9), st.lists(VALUES, min_size=1, max_size=25))
def test_numbers_never_skip_and_memory_is_bounded(size: int, values: list[tuple[int, str, str]]) -> None:
    buffer, added = filled(size, values)
    assert [each.sequence for each in added] == list(range(1, len(values) + 1))
    assert (buffer.last, buffer.next) == (len(values), len(values) + 1)
    assert buffer.first == max(1, len(values) - size + 1)
    held, _ = buffer.sample(None, size, lambda item: True)
    assert held == added[-size:]


@given(st.integers(1, 12), st.lists(VALUES, min_size=1, max_size=25), st.data())
def test_samples_are_those_of_a_list(
    size: int, values: list[tuple[int, str, str]], data: st.DataObject
) -> None:
    buffer, added = filled(size, values)
    wanted = set(data.draw(st.lists(st.sampled_from(ITEMS), max_size=4)))
    start = data.draw(st.none() | st.integers(buffer.first, buffer.next))
    count = data.draw(st.integers(-size, size).filter(bool))
    found, following = buffer.sample(start, count, wanted.__contains__)
    held = added[buffer.first - 1 :]
    if count > 0:
        fitting = [each for each in held if each.sequence >= (start or 1) and each.item in wanted]
        assert found == fitting[:count]
        assert following == (found[-1].sequence + 1 if len(found) == count else buffer.next)
    else:
        fitting = [each for each in held if each.sequence <= (start or buffer.last) and each.item in wanted]
        assert found == fitting[count:]
        below = found[0].sequence if len(found) == -count else buffer.first
        assert following == max(1, below - 1)


@given(st.integers(1, 12), st.lists(VALUES, min_size=1, max_size=25), st.data())
def test_pieces_of_a_sample_are_the_whole(
    size: int, values: list[tuple[int, str, str]], data: st.DataObject
) -> None:
    buffer, added = filled(size, values)
    wanted = set(data.draw(st.lists(st.sampled_from(ITEMS), max_size=4)))
    number, got = buffer.first, list[Observation]()
    while number < buffer.next:
        piece, following = buffer.sample(number, data.draw(st.integers(1, 3)), wanted.__contains__)
        assert following > number
        got, number = got + piece, following
    assert got == [each for each in added[-size:] if each.item in wanted]


@given(st.integers(1, 12), st.lists(VALUES, min_size=1, max_size=25), st.data())
def test_the_state_at_a_number_is_that_of_all_until_it(
    size: int, values: list[tuple[int, str, str]], data: st.DataObject
) -> None:
    buffer, added = filled(size, values)
    at = data.draw(st.integers(buffer.first, buffer.last))
    found = {item: [each.sequence for each in held] for item, held in buffer.at(at).items()}
    assert found == state_of(added[:at])
    now = {item: [each.sequence for each in held] for item, held in buffer.now().items()}
    assert now == state_of(added)
