"""Numbers of MACODA parameters before and since V5.1 (Manual 003, annex A.4)."""

from __future__ import annotations

import pytest

from polycnc.controllers.bosch import present_number

NUMBERS = [
    (1001, 1, 1003, 1), (1001, 2, 1003, 2), (1001, 3, 1001, 1), (1001, 4, 1003, 4), (1001, 5, 1003, 5),
    (1001, 6, 1050, 1), (1001, 7, 7010, 30), (1001, 1003, 6020, 12), (1010, 3, 1010, 11), (1010, 4, 1010, 12),
    (1010, 6, 1010, 1), (1010, 9, 1010, 2), (1015, 1, 1015, 2), (1015, 6, 1015, 100), (1015, 7, 1015, 1),
    (1030, 4, 7030, 10), (1030, 5, 7030, 310), (1030, 8, 7030, 210), (1030, 9, 7030, 220), (1030, 10, 7030, 110),
    (1030, 101, 7040, 110), (1030, 301, 7050, 110), (1030, 302, 7050, 120), (1030, 303, 7050, 130),
    (1030, 201, 7020, 10), (1030, 202, 7010, 110), (1040, 11, 1050, 3), (1040, 12, 1050, 4),
]  # fmt: skip


@pytest.mark.parametrize(
    ("block", "index", "new_block", "new_index"),
    [pytest.param(*row, marks=pytest.mark.covers(f"cpl.macoda.map.{row[0]}_{row[1]:05}")) for row in NUMBERS],
)
def test_old_parameters_have_new_numbers(block: int, index: int, new_block: int, new_index: int) -> None:
    assert present_number(f"{block} {index:05}") == f"{new_block} {new_index:05}"


def test_other_parameters_keep_their_numbers() -> None:
    assert present_number("7060 00020") == "7060 00020"
