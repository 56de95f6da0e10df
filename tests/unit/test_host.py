"""A host: one thread owns a device, many command and watch it."""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import pytest

from polycnc.machine import Clock, Host, HostError, Snapshot, SnapshotError
from support.time_sources import FakeWall

THREADS = 8


@dataclass(frozen=True)
class Seen:
    """All numbers of one status come from one cycle."""

    cycle: int
    doubled: int
    balance: int
    log: int


class Account:
    """A device whose every cycle and command changes two numbers in turn: a reader between them sees it."""

    def __init__(self) -> None:
        self.clock = Clock(0.001)
        self.doubled = 0
        self.left = self.right = 0
        self.log: list[tuple[int, int]] = []
        self.owners: set[int] = set()
        self.fail_at = 10**12
        self.stop_at = 10**12

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        self.owners.add(threading.get_ident())
        if until:
            cycles = min(cycles, max(self.stop_at - self.clock.cycles, 0))
        for _ in range(cycles):
            self.clock.tick(1)
            self.doubled += 2
            if self.clock.cycles >= self.fail_at:
                raise ZeroDivisionError("the drive burns")
        return cycles

    def move(self, thread: int, number: int, amount: int) -> int:
        self.owners.add(threading.get_ident())
        self.left -= amount
        self.log.append((thread, number))
        self.right += amount
        return len(self.log)

    def status(self) -> Seen:
        return Seen(self.clock.cycles, self.doubled, self.left + self.right, len(self.log))

    def snapshot(self) -> Snapshot:
        return Snapshot.take("an account", "", self.clock.cycles, ())

    def restore(self, snapshot: Snapshot) -> None:
        raise SnapshotError("an account does not go back", hint="Open another one.")


@pytest.fixture
def account() -> Account:
    return Account()


@pytest.fixture
def wall() -> FakeWall:
    return FakeWall()


@pytest.fixture
def frozen(account: Account, wall: FakeWall) -> Iterator[Host[Account]]:
    with Host(account, wall, rate=0.0) as host:
        yield host


def test_commands_of_many_threads_are_all_done_in_order_and_no_reader_sees_half_of_one(
    wall: FakeWall,
) -> None:
    account, each = Account(), 40
    results: list[list[int]] = [[] for _ in range(THREADS)]
    torn: list[Seen] = []
    backwards: list[tuple[Seen, Seen]] = []
    begin = threading.Barrier(2 * THREADS)
    with Host(account, wall, rate=math.inf) as host:

        def command(thread: int) -> None:
            begin.wait()
            for number in range(each):
                move = partial(Account.move, thread=thread, number=number, amount=3 * thread + number)
                if number % 3:
                    results[thread].append(host.call(move))
                else:
                    results[thread].append(host.post(move).result())
                if host.status.log < results[thread][-1]:
                    torn.append(host.status)  # a result came before its status

        def logged_more(log: int, status: Seen) -> bool:
            return status.log > log

        def read() -> None:
            begin.wait()
            last = host.status
            while last.log < THREADS * each:
                # Not as often as it can: that would leave the commands to starve.
                news = host.wait(partial(logged_more, last.log))
                for seen in (news, host.status):
                    if seen.doubled != 2 * seen.cycle or seen.balance != 0:
                        torn.append(seen)
                    if seen.cycle < last.cycle or seen.log < last.log:
                        backwards.append((last, seen))
                    last = seen

        commanders = [threading.Thread(target=command, args=(k,)) for k in range(THREADS)]
        readers = [threading.Thread(target=read) for _ in range(THREADS)]
        for thread in commanders + readers:
            thread.start()
        for thread in commanders:
            thread.join()
        for thread in readers:
            thread.join()
        assert host.status.log == THREADS * each
    assert (torn, backwards) == ([], [])
    # Each has its own answer.
    assert sorted(answer for answers in results for answer in answers) == list(range(1, THREADS * each + 1))
    for thread_number, answers in enumerate(results):
        assert [n for k, n in account.log if k == thread_number] == list(range(each))
        assert answers == sorted(answers)
    assert account.clock.cycles > 0
    assert len(account.owners) == 1
    assert threading.get_ident() not in account.owners


def test_a_result_comes_with_a_status_behind_the_command(frozen: Host[Account]) -> None:
    assert frozen.status == Seen(0, 0, 0, 0)
    assert frozen.call(lambda account: account.move(1, 2, 3)) == 1
    assert frozen.status == Seen(0, 0, 0, 1)


def test_an_error_of_a_command_reaches_who_posted_it_and_nobody_else(frozen: Host[Account]) -> None:
    first = frozen.post(lambda account: account.move(1, 0, 5))
    second = frozen.post(lambda account: account.log[17])
    third = frozen.post(lambda account: account.move(1, 1, 5))
    assert (first.result(), third.result()) == (1, 2)
    with pytest.raises(IndexError):
        second.result()
    assert frozen.failure is None


def test_a_frozen_host_steps_and_jumps(frozen: Host[Account], account: Account) -> None:
    assert frozen.call(lambda device: device.clock.cycles) == 0
    frozen.pace.step(37)
    assert frozen.wait(lambda status: status.cycle >= 37).cycle == 37
    account.stop_at = 5_011
    host = frozen
    host.pace.jump_to_event()
    assert host.wait(lambda status: status.cycle > 37).cycle == 100_037  # no events were named


def test_a_jump_ends_at_an_event(account: Account, wall: FakeWall) -> None:
    account.stop_at = 5_011
    with Host(account, wall, rate=0.0, events=1) as host:
        host.pace.jump_to_event()
        assert host.wait(lambda status: status.cycle > 0) == Seen(5_011, 10_022, 0, 0)


def test_time_follows_the_lent_clock_at_a_rate_that_changes(account: Account, wall: FakeWall) -> None:
    def catch_up(cycles: int) -> int:
        host.pace.step(0)  # wakes it; the wall clock of this test does not
        return int(host.wait(lambda status: status.cycle >= cycles).cycle)

    with Host(account, wall, rate=2.0) as host:
        wall.time_s += 0.35
        assert catch_up(700) == 700
        host.pace.rate = 0.5
        wall.time_s += 0.2
        assert catch_up(800) == 800
    assert account.doubled == 1600


def test_what_fails_in_the_owner_reaches_everybody_who_waits(account: Account, wall: FakeWall) -> None:
    account.fail_at = 1_700
    host = Host(account, wall, rate=0.0)
    host.start()
    waiting = threading.Event()
    raised: list[str] = []

    def watch() -> None:
        def never(status: Seen) -> bool:
            waiting.set()
            return False

        try:
            host.wait(never)
        except HostError as error:
            raised.append(str(error))

    watcher = threading.Thread(target=watch)
    watcher.start()
    waiting.wait()
    host.pace.step(1_701)
    watcher.join()
    assert raised == ["the device has failed: ZeroDivisionError: the drive burns\nmake a new one"]
    assert isinstance(host.failure, ZeroDivisionError)
    with pytest.raises(HostError, match="the drive burns") as caught:
        host.call(lambda device: device.status())
    assert caught.value.__cause__ is host.failure
    assert host.status.doubled == 2 * host.status.cycle  # the last good one stays
    host.close()


def test_a_status_that_fails_does_not_keep_the_answers(account: Account, wall: FakeWall) -> None:
    def break_status(device: Account) -> str:
        device.status = lambda: device.log[99]  # type: ignore[assignment, method-assign, return-value]
        return "done"

    host = Host(account, wall, rate=0.0)
    host.start()
    assert host.call(break_status) == "done"
    host.close()
    assert isinstance(host.failure, IndexError)


def test_closing_does_what_was_posted_and_refuses_what_comes_later(account: Account, wall: FakeWall) -> None:
    host = Host(account, wall, rate=0.0)
    with pytest.raises(HostError, match="not running"):
        host.post(lambda device: None)
    host.start()
    release = threading.Event()
    host.post(lambda device: release.wait())
    posted = [host.post(partial(Account.move, thread=0, number=n, amount=n)) for n in range(50)]
    closer = threading.Thread(target=host.close)
    closer.start()
    release.set()
    closer.join()
    assert [each.result() for each in posted] == list(range(1, 51))
    with pytest.raises(HostError, match="the host is not running\nstart it"):
        host.post(lambda device: None)
    with pytest.raises(HostError, match="the host is not running\nstart it"):
        host.call(lambda device: None)
    with pytest.raises(HostError, match="not running"):
        host.wait(lambda status: False)
    with pytest.raises(HostError, match="cannot be started"):
        host.start()
    host.close()
    assert account.move(9, 9, 9) == 51  # the device is the caller's again


def test_a_stopped_host_goes_on_and_does_not_catch_up(account: Account, wall: FakeWall) -> None:
    host = Host(account, wall, rate=1.0)
    wall.time_s += 9.0
    with host:
        with pytest.raises(HostError, match="cannot be started"):
            host.start()
        wall.time_s += 0.25
        host.pace.step(0)
        assert host.wait(lambda status: status.cycle >= 250).cycle == 250
        host.stop()
        host.stop()
        wall.time_s += 5.0
        account.move(3, 4, 5)
        with pytest.raises(HostError, match="not running"):
            host.post(lambda device: None)
        host.start()
        assert host.status == Seen(250, 500, 0, 1)
        assert host.call(lambda device: device.clock.cycles) == 250
        wall.time_s += 0.07
        host.pace.step(3)
        assert host.wait(lambda status: status.cycle >= 323).cycle == 323


def test_a_command_that_was_cancelled_is_not_done(frozen: Host[Account], account: Account) -> None:
    release, inside = threading.Event(), threading.Event()

    def block(device: Account) -> None:
        inside.set()
        release.wait()

    frozen.post(block)
    inside.wait()
    unwanted = frozen.post(lambda device: device.move(0, 0, 1))
    wanted = frozen.post(lambda device: device.move(0, 1, 1))
    assert unwanted.cancel()
    release.set()
    assert wanted.result() == 1
    assert account.log == [(0, 1)]


def test_a_command_that_would_wait_for_itself_is_refused(frozen: Host[Account]) -> None:
    with pytest.raises(HostError, match="a command waits for another command"):
        frozen.call(lambda device: frozen.call(lambda again: None))
    with pytest.raises(HostError, match="a command waits for another command"):
        frozen.call(lambda device: frozen.wait(lambda status: False))


def test_a_command_may_close_its_host(account: Account, wall: FakeWall) -> None:
    host = Host(account, wall, rate=0.0)
    host.start()
    host.call(lambda device: host.close())
    host.close()
    assert host.failure is None


def test_waiting_ends_with_its_time_by_the_lent_clock(frozen: Host[Account], wall: FakeWall) -> None:
    def tired(status: Seen) -> bool:
        wall.time_s += 0.7
        return False

    with pytest.raises(HostError, match=r"nothing of the kind for 2\.0 s"):
        frozen.wait(tired, timeout_s=2.0)
