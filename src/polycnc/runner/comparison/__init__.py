"""Compare two programs, a program and a trace, or one program on two machines."""

from polycnc.runner.comparison._compare import DEFAULT_TOLERANCE_MM, Comparison, compare
from polycnc.runner.comparison._compared import Compared, PathDeviation
from polycnc.runner.comparison._distance import Boxes, greatest_distance, in_one_order
from polycnc.runner.comparison._first_difference import BlockDifference, first_difference

__all__ = [
    "DEFAULT_TOLERANCE_MM",
    "BlockDifference",
    "Boxes",
    "Compared",
    "Comparison",
    "PathDeviation",
    "compare",
    "first_difference",
    "greatest_distance",
    "in_one_order",
]
