"""Press keys of the operator page faster than the machine answers, and choose another machine meanwhile."""

from __future__ import annotations

from typing import Any

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


def _hold(page: Any, what: str, *, asks: bool) -> None:
    """Let what is asked of these addresses (`asks`), or the answer, wait until `letGo()`."""
    page.evaluate(_HOLD, [what, asks])


def _see_more(page: Any) -> None:
    """Wait until the stream has shown three later states."""
    for _ in range(3):
        shown = page.text_content("#clock")
        until(page, lambda shown=shown: page.text_content("#clock") != shown)
