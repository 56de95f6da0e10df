"""Press keys of the operator page faster than the machine answers, write and choose another machine meanwhile."""

from __future__ import annotations

from typing import Any

import httpx

from support.operator_page import until

_HOLD = """([what, asks]) => {
  const real = window.fetch;
  window.waiting = [];
  window.fetch = async (url, options) => {
    if (!String(url).includes(what)) return real(url, options);
    const answer = asks ? null : await real(url, options);
    await new Promise((go) => window.waiting.push(go));
    return answer ?? real(url, options);
  };
  window.letGo = () => { window.fetch = real; for (const go of window.waiting) go(); };
}"""


def turn_faster_than_answers(page: Any, served: Any) -> None:
    """Turn a switch twice and an override up twice before anything of it has arrived: the last press counts."""
    served.command("set_overrides", feed=1.0)
    until(page, lambda: page.input_value("#override-feed") == "100")
    _hold(page, "commands", asks=True)
    page.click("#single_block")
    _see_more(page)
    assert page.get_attribute("#single_block", "aria-pressed") == "true"
    page.click("#single_block")
    _see_more(page)
    assert page.get_attribute("#single_block", "aria-pressed") == "false"
    page.click("#block_delete")
    page.focus("#override-feed")
    for percent in ("105", "110"):
        page.keyboard.press("ArrowRight")
        _see_more(page)
        assert page.input_value("#override-feed") == percent
    assert page.get_attribute("#block_delete", "aria-pressed") == "true"
    assert page.evaluate("waiting.length") == 3  # the second of a key is sent after the first
    page.evaluate("letGo()")
    until(page, lambda: served.status()["channels"][0]["overrides"]["feed"] == 1.1)
    page.click("#block_delete")
    served.command("set_overrides", feed=1.0)
    until(page, lambda: page.input_value("#override-feed") == "100")
    until(page, lambda: not served.status()["channels"][0]["switches"]["block_delete"])
    assert not served.status()["channels"][0]["switches"]["single_block"]


def choose_before_the_answer(page: Any) -> None:
    """Choose another machine while the path of the first is on its way: it is not drawn for the other."""
    page.select_option("#machine", "two")
    page.wait_for_selector("#channel", state="visible")
    before = page.get_attribute("#path", "data-points")
    _hold(page, "/path?", asks=False)
    page.select_option("#machine", "machine")
    until(page, lambda: page.evaluate("waiting.length") > 0)
    page.select_option("#machine", "two")
    page.wait_for_selector("#channel", state="visible")
    page.evaluate("letGo()")
    _see_more(page)
    assert page.get_attribute("#path", "data-points") == before
    page.select_option("#machine", "machine")
    page.wait_for_selector("#path:not([data-points='0']) canvas")


def type_before_the_scenario_comes(page: Any) -> None:
    """Open the scenario and type before it has been told: nothing is typed, and no empty one is followed."""
    _hold(page, "/scenario", asks=False)
    page.click("#tab-scenario")
    page.focus("#scenario-text")
    page.keyboard.type("7")
    assert page.input_value("#scenario-text") == ""
    assert page.is_disabled("#scenario-put")
    page.evaluate("letGo()")
    page.wait_for_selector("#scenario-put:enabled")
    before = page.input_value("#scenario-text")
    assert before.startswith('title = "A short stop"')
    page.keyboard.type("7")
    assert sorted(page.input_value("#scenario-text")) == sorted(f"{before}7")


def write_before_the_text_comes(page: Any) -> None:
    """Ask for a program, and write into the editor before it has come: what is written stays."""
    page.click("#tab-programs")
    page.select_option("#names", "O0044")
    _hold(page, "/programs/O0044", asks=False)
    page.click("#edit")
    until(page, lambda: page.evaluate("waiting.length") > 0)
    page.fill("#text", "(mine)\n")
    page.evaluate("letGo()")
    page.wait_for_selector("#said:has-text('O0044 came late')")
    assert page.input_value("#text") == "(mine)\n"
    page.click("#edit")
    until(page, lambda: page.input_value("#text").startswith("O0044"))


def set_breakpoints_before_the_answer(page: Any, served: Any) -> None:
    """Set two breakpoints before the first has been answered: both are there."""

    def kept() -> list[int]:
        return sorted(each["line"] for each in served.http.get("/inventory").json()["breakpoints"])

    page.click("#tab-run")
    _hold(page, "commands", asks=True)
    for line in (2, 3):
        page.click(f"#lines li:nth-child({line})")
        page.click("#breakpoint")
        page.wait_for_selector(f"#lines li:nth-child({line}).breakpoint")
    _see_more(page)
    assert page.locator("#lines .breakpoint").count() == 2
    page.evaluate("letGo()")
    until(page, lambda: kept() == [2, 3])
    for line in (3, 2):
        page.click(f"#lines li:nth-child({line})")
        page.click("#breakpoint")
    until(page, lambda: kept() == [])


def type_while_an_offset_is_taught(page: Any, served: Any) -> None:
    """Type into a cell while another offset is taught: what is typed stays, and the taught one is shown after it."""
    page.click("#tab-offsets")
    _hold(page, "/offsets/G58", asks=False)
    page.click("#teach-G58")
    until(page, lambda: page.evaluate("waiting.length") > 0)
    page.fill("[aria-label='G59 X']", "3.75")
    page.evaluate("letGo()")
    page.wait_for_selector("#said:has-text('Program zero is here')")
    _see_more(page)
    assert page.input_value("[aria-label='G59 X']") == "3.75"
    page.fill("[aria-label='G59 X']", "0")
    page.evaluate("document.activeElement.blur()")
    taught = served.http.get("/offsets").json()["G58"]["X"]
    until(page, lambda: float(page.input_value("[aria-label='G58 X']")) == taught)


def choose_before_a_block_is_taken(page: Any, served: Any) -> None:
    """Choose another machine while a block is on its way to the first: no machine begins to move."""
    page.click("[data-mode=mdi]")
    page.wait_for_selector("[data-mode=mdi][aria-pressed=true]")
    _hold(page, "commands", asks=False)
    page.fill("#mdi", "G91 G1 X1.5 F600")
    page.press("#mdi", "Enter")
    until(page, lambda: page.evaluate("waiting.length") > 0)
    page.select_option("#machine", "two")
    page.wait_for_selector("#channel", state="visible")
    page.evaluate("letGo()")
    _see_more(page)
    two = str(served.http.base_url).replace("/machine/", "/two/")
    for status in (served.status(), httpx.get(f"{two}status").json()):
        assert {each["run_state"] for each in status["channels"]} <= {"ready", "reset", "completed"}
    assert page.input_value("#mdi") == ""
    page.evaluate("localStorage.removeItem('mdi')")
    page.select_option("#machine", "machine")
    page.wait_for_selector("#channel", state="hidden")


def hold_before_the_start_is_given(page: Any, served: Any) -> None:
    """Press feed hold while a cycle start still waits for the mode: it does not start after the hold."""
    _hold(page, "commands", asks=True)
    for key in ("[data-mode=auto]", "#cycle_start", "#feed_hold"):
        page.click(key)
    until(page, lambda: page.evaluate("waiting.length") > 1)
    assert page.evaluate("waiting.length") == 2
    page.evaluate("letGo()")
    page.wait_for_selector("[data-mode=auto][aria-pressed=true]")
    _see_more(page)
    assert served.status()["channels"][0]["run_state"] in ("ready", "reset", "completed")


def choose_two_before_either_answers(page: Any) -> None:
    """Choose another machine and the first again: the last choice counts, and no key acts before it is shown."""
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    _hold(page, "/status", asks=False)
    for name in ("two", "machine"):
        page.select_option("#machine", name)
    page.keyboard.press("Alt+r")
    until(page, lambda: page.evaluate("waiting.length") > 1)
    page.evaluate("letGo()")
    page.wait_for_selector("main:not([inert])")
    _see_more(page)
    assert page.input_value("#machine") == "machine"
    assert page.is_hidden("#channel")
    assert not [each for each in asked if each.endswith("/commands")]


def answer_late(page: Any, served: Any) -> None:
    """Do all of it."""
    turn_faster_than_answers(page, served)
    choose_before_the_answer(page)
    type_before_the_scenario_comes(page)
    write_before_the_text_comes(page)
    set_breakpoints_before_the_answer(page, served)
    type_while_an_offset_is_taught(page, served)
    hold_before_the_start_is_given(page, served)
    choose_before_a_block_is_taken(page, served)
    choose_two_before_either_answers(page)


def _hold(page: Any, what: str, *, asks: bool) -> None:
    """Let what is asked of these addresses (`asks`), or the answer, wait until `letGo()`."""
    page.evaluate(_HOLD, [what, asks])


def _see_more(page: Any) -> None:
    """Wait until the stream has shown three later states."""
    for _ in range(3):
        shown = page.text_content("#clock")
        until(page, lambda shown=shown: page.text_content("#clock") != shown)
