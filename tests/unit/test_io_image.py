import numpy as np
import pytest

from polycnc.errors import UsageError
from polycnc.machine._config import IoConfig
from polycnc.machine._io import IoImage, scan_edges


def test_sizes_come_from_the_configuration() -> None:
    image = IoImage(IoConfig(inputs=8, outputs=0, input_words=3, output_words=2))
    assert image.inputs.now.shape == (8,)
    assert image.outputs.now.shape == (0,)
    assert image.input_words.shape == (3,)
    assert image.output_words.shape == (2,)
    assert image.inputs.now.dtype == np.uint8
    assert image.input_words.dtype == np.int32
    default = IoImage()
    assert (default.inputs.now.size, default.output_words.size) == (64, 16)


def test_points_are_reached_by_address_and_by_name() -> None:
    image = IoImage(IoConfig(points={"door": "I3", "lamp": "O5", "load": "IW2", "speed": "OW1"}))
    for value, point in enumerate(("door", "lamp"), 0):
        image[point] = 1 - value
    image["load"] = -(2**31)
    image["speed"] = 2**31 - 1
    assert (image["I3"], image["O5"], image["IW2"], image["OW1"]) == (1, 0, -(2**31), 2**31 - 1)
    assert image.inputs.now[3] == 1
    assert image.input_words[2] == -(2**31)


def test_the_arrays_are_shared_with_whoever_writes_them() -> None:
    image = IoImage()
    image.outputs.now[7] = 1
    image.output_words[4] = 99
    assert (image["O7"], image["OW4"]) == (1, 99)


@pytest.mark.parametrize("point", ["I64", "O64", "IW16", "OW16", "I-1", "I03", "i3", "lamp", "Q1", "", "I3 "])
def test_a_point_that_does_not_exist_is_refused_with_those_that_do(point: str) -> None:
    image = IoImage(IoConfig(points={"door": "I3"}))
    with pytest.raises(UsageError) as caught:
        image[point] = 1
    assert caught.value.what == f"there is no I/O point '{point}'"
    assert caught.value.hint == "points: I0 to I63, O0 to O63, IW0 to IW15, OW0 to OW15; names: door"
    assert not image.inputs.now.any()


@pytest.mark.parametrize(("point", "value"), [("I0", 2), ("I0", -1), ("OW0", 2**31), ("OW0", -(2**31) - 1)])
def test_a_value_that_does_not_fit_is_refused_and_changes_nothing(point: str, value: int) -> None:
    image = IoImage()
    with pytest.raises(UsageError, match=f"{value} does not fit into '{point}'"):
        image[point] = value
    assert image[point] == 0


def test_an_edge_is_seen_by_exactly_one_scan() -> None:
    image = IoImage()
    image["I3"] = 1
    image["O5"] = 1
    assert image.scan() == 2
    assert image.rose("I3")
    assert image.rose("O5")
    assert not image.fell("I3")
    assert not image.rose("I2")
    image["I3"] = 0
    assert image.scan() == 1
    assert image.fell("I3")
    assert not image.rose("I3")
    assert not image.rose("O5")
    assert image.scan() == 0
    assert not image.fell("I3")


def test_a_change_back_before_the_scan_is_no_edge() -> None:
    image = IoImage()
    image["I0"] = 1
    image["I0"] = 0
    assert image.scan() == 0
    assert not image.rose("I0")
    assert not image.fell("I0")


def test_words_have_no_edges() -> None:
    with pytest.raises(UsageError, match="'IW0' is a word and has no edges"):
        IoImage().rose("IW0")


def test_the_scan_is_the_same_compiled_and_not() -> None:
    random = np.random.default_rng(3)
    compiled, plain = IoImage(), IoImage()
    uncompiled = getattr(scan_edges, "py_func", scan_edges)
    for _ in range(20):
        compiled.inputs.now[:] = plain.inputs.now[:] = random.integers(0, 2, 64)
        before = compiled.inputs.before.copy()
        assert (
            scan_edges(compiled.inputs) == uncompiled(plain.inputs) == np.sum(before != compiled.inputs.now)
        )
        for ours, theirs in zip(compiled.inputs, plain.inputs, strict=True):
            assert np.array_equal(ours, theirs)
        assert np.array_equal(compiled.inputs.rising, (before == 0) & (compiled.inputs.now == 1))
        assert np.array_equal(compiled.inputs.falling, (before == 1) & (compiled.inputs.now == 0))
