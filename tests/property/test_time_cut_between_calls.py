"""However the cycles between the calls of a program are cut, the board and the card that it calls do the same."""

from __future__ import annotations

import random

import numpy as np
import pytest

from polycnc.controllers.apci import pcap
from support import apci_bench, imc_bench
from support.apci_mixture import MIXED, Mixture
from support.imc_walk import CARD_FILE, OTHERWISE, walk

ALWAYS, LONG = range(2), range(2, 1002)
SEEDS = [ALWAYS, pytest.param(LONG, marks=[pytest.mark.long, pytest.mark.timeout(0)])]
CALLS, ROUNDS = 120, 12


class _Cutter:
    """Cuts cycles into calls: each by itself, or a few at a time."""

    def __init__(self, seed: int, mean: float) -> None:
        self._rng, self._mean = random.Random(seed), mean

    def cuts(self, cycles: int) -> list[int]:
        """Return lengths that come to so many cycles."""
        found = list[int]()
        while cycles:
            found.append(min(int(self._rng.expovariate(1.0 / self._mean)) + 1, cycles) if self._mean else 1)
            cycles -= found[-1]
        return found


class _Card(imc_bench.Bench):
    """A card whose time passes in cuts."""

    def __init__(self, text: str, cutter: _Cutter) -> None:
        super().__init__(text)
        self._cutter = cutter

    def leap(self, cycles: int) -> None:
        """Let cycles pass, and keep the memory at their end."""
        for cut in self._cutter.cuts(cycles)[:-1]:
            assert self.card.advance(cut) == cut
            cycles -= cut
        super().leap(cycles)


class _Scans:
    """A board's time in cuts."""

    def __init__(self, board: object, cutter: _Cutter) -> None:
        self._board, self._cutter = board, cutter

    def __getattr__(self, name: str) -> object:
        return getattr(self._board, name)

    def advance(self, scans: int) -> int:
        """Let scans pass."""
        return sum(self._board.advance(cut) for cut in self._cutter.cuts(scans))  # type: ignore[attr-defined]


@pytest.mark.parametrize("seeds", SEEDS)
def test_any_cut_between_calls_leaves_a_card_the_same_memory(seeds: range) -> None:
    for seed in seeds:
        text = f"ready = true\n{OTHERWISE if seed % 2 else ''}{CARD_FILE}"
        whole = imc_bench.Bench(text)
        walk(whole, seed, CALLS)
        for mean in (0.0, 2.0):
            cut = _Card(text, _Cutter(seed, mean))
            walk(cut, seed, CALLS)
            assert cut.answers == whole.answers, seed
            for k, (one, other) in enumerate(zip(cut.memory, whole.memory, strict=True)):
                assert np.array_equal(one, other), f"seed {seed}, cut by {mean}, step {k}"


@pytest.mark.parametrize("seeds", SEEDS)
def test_any_cut_between_calls_leaves_a_board_the_same_registers(seeds: range) -> None:
    for seed in seeds:
        found = list[tuple[object, ...]]()
        for cutter in (None, _Cutter(seed, 0.0), _Cutter(seed, 3.0)):
            bench = apci_bench.Bench(MIXED)
            if cutter is not None:
                bench.board = _Scans(bench.board, cutter)  # type: ignore[assignment]
            try:
                Mixture(bench, seed).run(ROUNDS)
            finally:
                pcap.detach()
            found.append((bench.tracks, bench.told, bench.interrupts))
        assert found[1] == found[0], f"seed {seed} scan by scan"
        assert found[2] == found[0], f"seed {seed} in cuts"
