"""Hypothesis strategies for part programs: good and bad blocks mixed, words that dialects share or not."""

from __future__ import annotations

import hypothesis.strategies as st

lengths = st.one_of(
    st.integers(-40, 40).map(str),
    st.integers(-40_000, 40_000).map(lambda value: f"{value / 1000:.3f}"),
    st.sampled_from(["0", "-0", ".5", "+3.", "1.2345678901234567", "299.9999999", "301", "400"]),
)
feeds = st.sampled_from(["F100", "F.5", "F2500.", "F0", "F-1", ""])
axis_words = st.builds("{}{}".format, st.sampled_from("XYZXYZXYZAC"), lengths)
positions = st.lists(axis_words, min_size=1, max_size=4).map(" ".join)
straight = st.builds(
    "{} {} {}".format, st.sampled_from(["", "G0", "G1", "G01", "G90", "G91"]), positions, feeds
)
circles = st.builds("{} {}{} {}".format, st.sampled_from(["G2", "G3"]), st.sampled_from("IJ"), lengths, feeds)
half_circles = st.builds(
    lambda code, way, half, letter: (
        f"G91 {code} {letter}{2 * half} {'I' if letter == 'X' else 'J'}{half}{way}"
    ),
    st.sampled_from(["G2", "G3"]),
    st.sampled_from(["", " Z1", " P2", " A5", " F200", " K0", " K1"]),
    st.integers(-30, 30),
    st.sampled_from("XY"),
)
radii = st.builds("{} X{} Y{} R{}".format, st.sampled_from(["G2", "G3", ""]), lengths, lengths, lengths)
splines = st.builds(
    "{} X{} Y{} {}".format,
    st.sampled_from(["G5", "G5.1"]),
    lengths,
    lengths,
    st.sampled_from(["I3 J4", "I3 J4 P-5 Q6", "P-2 Q7", "I0 J0 P1 Q0", "I5", "P1", "I9 J-30 P2 Q5 Z1"]),
)
_MODES = (
    *(
        "G17",
        "G18",
        "G19",
        "G20",
        "G21",
        "G70",
        "G71",
        "G61",
        "G64",
        "G64 P0.2",
        "G9 X1",
        "G93",
        "G94",
        "G95",
    ),
    *("G54", "G55", "G56", "G53 X5", "G92 X1 Y2", "G92.1", "G28 X0", "G90.1", "G91.1", "G43 H1", "G49"),
    *("M3 S500", "M5", "M8", "T1 M6", "G4 P.1", "G41 D1", "G42 D2", "G40", "G81 Z-5 R2", "G80", "G98", "G99"),
    *(
        "(remark)",
        "(MSG, hello)",
        "/X5",
        "N100",
        "%",
        "O7",
        "",
        "M98 P900",
        "#1=2",
        "G1 X",
        "Q5",
        "H3",
        "G2 G3",
    ),
)
modes = st.sampled_from(_MODES)
blocks = st.one_of(straight, straight, straight, half_circles, circles, radii, splines, modes)
programs = st.lists(blocks, min_size=1, max_size=25).map(lambda lines: "G1 F500\n" + "\n".join(lines) + "\n")
"""Programs for a machine with the axes X Y Z A C."""
