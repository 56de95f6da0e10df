"""Drive the operator page of a served machine as people do, and look what the machine does then."""

from __future__ import annotations

import re
import signal
from pathlib import Path
from typing import Any

import httpx

KEYS = Path(__file__).parents[2] / "docs" / "how-to" / "operate-the-page.md"
_DROP = """files => {
  const data = new DataTransfer();
  for (const [name, text] of files) data.items.add(new File([text], name));
  document.querySelector('#page-programs').dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true }));
}"""
_SCENARIO = (
    '[[step]]\nname = "slow"\ndo = "set_overrides"\nwith = { feed = 0.35 }\nat_s = 0.1\nfor_s = 900.0\n'
)


def operate(page: Any, served: Any) -> None:
    """Do everything, one after the other."""
    operate_by_hand(page, served)
    operate_programs(page, served)
    operate_the_scenario(page, served)
    operate_the_pages(page, served)
    operate_the_others(page, served)
    operate_a_channel(page, served)
    read_the_keys(page)
    lose_the_connection(page, served)


def position(served: Any) -> float:
    """Return where X is."""
    found: float = served.status()["axes"]["X"]["machine"]
    return found


def choose(page: Any, mode: str) -> None:
    """Select a mode by its key."""
    page.click(f"[data-mode={mode}]")
    page.wait_for_selector(f"[data-mode={mode}][aria-pressed=true]")


def operate_by_hand(page: Any, served: Any) -> None:
    """Turn the handwheel, go one step, hold a jog key of the page by the keyboard, put blocks in and recall them."""
    choose(page, "handle")
    begin = position(served)
    page.select_option("#size", "0.1")
    page.focus("#wheel")
    for key in ("ArrowUp", "PageUp", "ArrowLeft", "ArrowLeft"):
        page.keyboard.press(key)
    until(page, lambda: abs(position(served) - begin - 0.9) < 1e-6)
    page.hover("#wheel")
    page.mouse.wheel(0, -100)
    until(page, lambda: abs(position(served) - begin - 1.0) < 1e-6)
    choose(page, "inc")
    page.focus("[data-jog=X][data-way='-1']")
    page.keyboard.press("Space")
    until(page, lambda: abs(position(served) - begin - 0.9) < 1e-6)
    choose(page, "jog")
    page.focus("[data-jog=X][data-way='1']")
    page.keyboard.down("Enter")
    until(page, lambda: position(served) > begin + 1.0)
    page.keyboard.up("Enter")
    until(page, lambda: served.status()["axes"]["X"]["manual"] == "none")
    page.click("#zero")
    until(page, lambda: page.text_content("#X-relative") == "0.000")
    choose(page, "mdi")
    before = position(served)
    page.keyboard.press("Alt+m")
    page.keyboard.type("G91")
    page.keyboard.press("Shift+Enter")
    page.keyboard.type("G1 X-2.5 Z1.5 F3000")
    page.keyboard.press("Enter")
    until(page, lambda: abs(position(served) - before + 2.5) < 1e-6)
    until(page, lambda: page.input_value("#mdi") == "")
    page.keyboard.press("ArrowUp")
    assert page.input_value("#mdi") == "G91\nG1 X-2.5 Z1.5 F3000"
    page.reload()
    page.wait_for_selector("body:not(.lost)")
    assert page.locator("#history option").count() == 2
    page.keyboard.press("Alt+x")
    page.wait_for_selector("#stop[aria-pressed=true]")
    page.keyboard.press("Alt+x")  # pressed again it stays pressed
    page.keyboard.press("Alt+r")
    until(page, lambda: served.status()["emergency"] == "on")
    page.click("#stop")
    page.wait_for_selector("#stop[aria-pressed=false]")
    page.keyboard.press("Alt+r")


def operate_programs(page: Any, served: Any) -> None:
    """See errors where they are, drop one file and several, compare, take one away, delete one."""
    page.keyboard.press("Alt+p")
    page.fill("#new", "O0045")
    page.fill("#text", "O0045\nG1 X4 F60\nG1 X5 Y\nM30\n")
    page.wait_for_selector("cnc-editor.open p:has-text('has no number')")
    assert page.locator("cnc-editor b.wrong").all_inner_texts() == ["3"]
    page.click("#errors button:has-text('line 3')")
    assert page.evaluate("document.querySelector('#text').selectionStart") == len("O0045\nG1 X4 F60\nG1 X5 ")
    page.evaluate(_DROP, [["O0045.nc", "O0045\nG1 X4 F60\nM30\n"]])
    page.wait_for_selector("#errors .well")
    page.click("#save")
    page.wait_for_selector("#names option[value=O0045]", state="attached")
    until(page, lambda: page.input_value("#names") == "O0045")
    page.fill("#text", "O0045\nG1 X6 F60\nM30\n")
    page.click("#compare")
    page.wait_for_selector("#differences .new")
    assert page.locator("#differences :is(.gone, .new)").all_text_contents() == [
        "    2       − G1 X4 F60",
        "          2 + G1 X6 F60",
    ]
    with page.expect_download() as taken:
        page.click("#download")
    assert taken.value.suggested_filename == "O0045.nc"
    assert Path(taken.value.path()).read_text("ascii").split() == ["O0045", "G1", "X4", "F60", "M30"]
    page.evaluate(_DROP, [["O0045.nc", "O0045\nM30\n"], ["O0046.nc", "O0046\nM30\n"]])
    page.wait_for_selector("#said:has-text('Left out: O0045.nc')")
    assert "X4" in served.http.get("/programs/O0045").text
    page.wait_for_selector("#names option[value=O0046]", state="attached")
    page.select_option("#names", "O0046")
    page.click("#remove")
    page.click("#remove:has-text('Delete O0046?')")
    page.wait_for_selector("#names option[value=O0046]", state="detached")


def operate_the_scenario(page: Any, served: Any) -> None:
    """Be refused a scenario with its place, follow one, and end it."""
    before = served.status()["overrides"]["feed"]
    page.click("#tab-scenario")
    page.fill("#scenario-text", _SCENARIO.replace("at_s", "at"))
    page.click("#scenario-put")
    page.wait_for_selector("#page-scenario cnc-editor.open b.wrong:has-text('5')")
    assert served.status()["overrides"]["feed"] == before
    page.fill("#scenario-text", _SCENARIO)
    page.click("#scenario-put")
    page.wait_for_selector("#page-scenario tr:has(th:has-text('slow')) td:has-text('on')")
    until(page, lambda: served.status()["overrides"]["feed"] == 0.35)
    page.click("#scenario-stop")
    until(page, lambda: served.status()["overrides"]["feed"] == before)
    page.wait_for_selector("#scenario-start:enabled")


def read_the_keys(page: Any) -> None:
    """Find in the list of keys what the documentation says, and leave the emergency stop within reach."""
    page.keyboard.press("?")
    rows = page.locator("#shortcuts tr").all()
    shown = [tuple(cell.text_content() for cell in row.locator("th, td").all()) for row in rows]
    told = re.findall(r"^[|] `([^`]+)` [|] (.+?) [|]$", KEYS.read_text("utf-8"), re.MULTILINE)
    assert told == shown
    stop = page.locator("#stop").bounding_box()
    assert (
        page.evaluate("([x, y]) => document.elementFromPoint(x, y).id", [stop["x"] + 5, stop["y"] + 5])
        == "stop"
    )
    page.keyboard.press("Escape")
    page.wait_for_selector("#shortcuts", state="hidden")
    page.select_option("#theme", "dark")
    dark = page.evaluate("getComputedStyle(document.body).backgroundColor")
    page.select_option("#theme", "light")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") != dark
    page.evaluate("document.activeElement.blur()")
    reached = []
    for _ in range(20):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.id"))
    assert {"far", "stop", "cycle_start", "feed_hold"} <= set(reached)


def lose_the_connection(page: Any, served: Any) -> None:
    """Hold a jog key while the server stops answering: numbers turn grey, the key is let go, and it comes back."""
    choose(page, "jog")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.down("ArrowRight")
    until(page, lambda: served.status()["axes"]["X"]["manual"] == "jog")
    served.process.send_signal(signal.SIGSTOP)
    try:
        page.wait_for_selector("body.lost")
        assert page.evaluate("getComputedStyle(document.querySelector('main')).opacity") < "0.5"
    finally:
        served.process.send_signal(signal.SIGCONT)
    page.wait_for_selector("body:not(.lost)")
    until(page, lambda: served.status()["axes"]["X"]["manual"] == "none")  # though the arrow is still down
    page.keyboard.up("ArrowRight")


def operate_the_pages(page: Any, served: Any) -> None:
    """Set an offset, teach one, watch and set a variable, find a parameter, keep and restore, set a breakpoint."""
    page.click("#tab-offsets")
    page.fill("[aria-label='G55 Y']", "-12.5")
    page.press("[aria-label='G55 Y']", "Enter")
    until(page, lambda: served.http.get("/offsets").json().get("G55", {}).get("Y") == -12.5)
    page.fill("[aria-label='G55 X']", "much")
    page.press("[aria-label='G55 X']", "Enter")
    page.wait_for_selector("[aria-label='G55 X'].refused")
    page.click("#teach-G56")
    until(page, lambda: "X" in served.http.get("/offsets").json().get("G56", {}))
    axes = served.status()["axes"]
    served.http.put("/offsets/EXT", json={"values": {"X": 1.25}})
    until(page, lambda: page.input_value("[aria-label='EXT X']") == "1.25")
    page.click("#teach-G57-X")
    until(page, lambda: served.http.get("/offsets").json().get("G57") is not None)
    assert abs(served.http.get("/offsets").json()["G57"]["X"] - axes["X"]["machine"] + 1.25) < 1e-6
    served.http.put("/offsets/EXT", json={"values": {"X": 0.0}})
    page.click("#tab-tools")
    page.fill("#new-tool", "7")
    page.click("#add-tool")
    page.click("#touch-7")
    until(page, lambda: served.http.get("/tools").json()["7"]["length_mm"] == axes["Z"]["work"] == 1.5)
    page.click("#remove-tool-7")
    until(page, lambda: "7" not in served.http.get("/tools").json())
    page.click("#tab-variables")
    page.fill("#watched-variables", "#500,#501")
    page.press("#watched-variables", "Enter")
    page.fill("[aria-label='#501']", "7.25")
    page.press("[aria-label='#501']", "Enter")
    until(page, lambda: served.http.get("/variables/501").json()["value"] == 7.25)
    page.click("#tab-parameters")
    page.fill("#filter", "1320")
    page.wait_for_selector("[aria-label='1320 X']")
    page.click("#tab-tools")
    page.click("#tab-alarms")
    page.wait_for_selector("#page-alarms td:has-text('EMERGENCY'), #page-alarms td:has-text('mergency')")
    page.click("#tab-snapshots")
    page.click("#keep")
    page.click("#restore-snapshot")
    until(page, lambda: served.http.get("/snapshots").json()[0]["name"] == "snapshot")
    page.click("#tab-run")
    page.click("#lines li:nth-child(2)")
    page.click("#breakpoint")
    page.wait_for_selector("#lines li:nth-child(2).breakpoint")
    page.click("#breakpoint")
    page.wait_for_selector("#lines li:nth-child(2):not(.breakpoint)")
    page.select_option("#rate", "5")
    until(page, lambda: served.http.get("/clock").json()["rate"] == 5.0)
    page.select_option("#rate", "1")
    page.click("#far")
    page.wait_for_selector("#keys", state="hidden")
    assert page.locator("#X-work").bounding_box()["height"] > 30
    page.click("#far")
    operate_the_lease(page, served)
    page.click("#tab-run")
    for name in ("Top", "Front", "Side", "3-D"):
        page.click(f"#views button:has-text('{name}')")


def operate_the_others(page: Any, served: Any) -> None:
    """See and press the screen of a Bosch control, run a task of a board, and come back."""
    page.click("#tab-signals")
    page.wait_for_selector("#page-signals [aria-label='D0']")
    page.fill("[aria-label='D0']", "77")
    page.press("[aria-label='D0']", "Enter")
    until(page, lambda: served.http.get("/signals/D0").json()["value"] == 77)
    page.select_option("#machine", "pnc")
    page.click("#tab-screen")
    page.wait_for_selector("#screen[alt*='WHICH HAND?']")
    until(page, lambda: page.evaluate("document.querySelector('#screen').naturalWidth") > 600)
    pnc = str(served.http.base_url).replace("/machine/", "/pnc/")
    page.click("#key-SOFTKEY2:has-text('RIGHT HAND')")
    until(page, lambda: httpx.get(f"{pnc}variables/%23K%25").json()["value"] == 2)
    page.select_option("#machine", "board")
    page.wait_for_selector("#keys", state="hidden")
    page.fill("#source", "BEGIN WHILE TRUE DO CI7 := CI7 + 1 END.")
    page.select_option("#task", "2")
    page.click("#load-task")
    page.click("#start-2")
    page.wait_for_selector("#page-tasks tr:has(#start-2) td:has-text('running')")
    page.click("#stop-2")
    page.wait_for_selector("#page-tasks tr:has(#start-2) td:has-text('stopped')")
    page.select_option("#machine", "machine")
    page.wait_for_selector("#keys", state="visible")


def operate_a_channel(page: Any, served: Any) -> None:
    """Choose the second channel of a machine: it is shown, and what is commanded is commanded of it alone."""
    page.select_option("#machine", "two")
    page.wait_for_selector("#channel option:has-text('2: Z · ready')", state="attached")
    page.select_option("#channel", "1")
    page.wait_for_selector("cnc-axes tr.other:has-text('X')")
    assert page.locator("[data-jog]").all_text_contents() == ["Z+", "Z−"]
    two = str(served.http.base_url).replace("/machine/", "/two/")

    def channels() -> Any:
        return httpx.get(f"{two}status").json()["channels"]

    choose(page, "mdi")
    page.fill("#mdi", "G91 G1 Z-1.5 F3000")
    page.click("#enter")
    until(page, lambda: page.text_content("#Z-machine") == "-1.500")
    page.wait_for_selector("#run[data-state=completed]")
    page.click("#marks summary")
    page.click("#mark_3")
    page.click("#block_delete")
    until(page, lambda: channels()[1]["switches"]["block_delete"] == [1, 3])
    page.click("#mark_1")
    until(page, lambda: channels()[1]["switches"]["block_delete"] == [3])
    assert [each["mode"] for each in channels()] == ["auto", "mdi"]
    assert channels()[0]["switches"]["block_delete"] == []
    page.click("#marks summary")
    page.click("#block_delete")
    until(page, lambda: channels()[1]["switches"]["block_delete"] == [])
    page.select_option("#channel", "0")
    page.wait_for_selector("[data-mode=auto][aria-pressed=true]")
    page.select_option("#machine", "machine")
    page.wait_for_selector("#channel", state="hidden")


def operate_the_lease(page: Any, served: Any) -> None:
    """Command alone, be taken over by another client, see who commands, and get it back when it ends."""
    page.click("#tab-connections")
    page.fill("#operator", "Zoë")
    page.press("#operator", "Enter")
    page.wait_for_selector("#page-connections td:has-text('127.0.0.1')")
    doors = {each["door"]: each for each in served.http.get("/connections").json()}
    assert f"127.0.0.1:{served.focas_port}" == doors["focas"]["address"]
    assert len(doors["focas"]["clients"]) == 1
    assert len(doors["http"]["clients"]) >= 2
    page.click("#lease")
    until(page, lambda: served.http.get("/lease").json()["holder"] == "Zoë")
    assert served.command("reset").status_code == 409
    page.click("#reset")
    other = {"operator": "Zoë", "key": "another-key-1", "take": True}  # two people of one name
    assert served.http.post("/lease", json=other).status_code == 200
    page.wait_for_selector("body.watching #lease:has-text('Zoë commands')")
    other = {"operator": "Ann", "key": "another-key-1", "take": True}
    assert served.http.post("/lease", json=other).status_code == 200
    page.wait_for_selector("body.watching #lease:has-text('Ann commands')")
    page.click("#cycle_start")
    page.wait_for_selector("#said:has-text('Ann commands this machine')")
    assert served.http.delete("/lease", headers={"polycnc-key": "another-key-1"}).status_code == 204
    page.wait_for_selector("body:not(.watching) #lease:has-text('Command alone')")


def until(page: Any, holds: Any) -> None:
    """Wait until something holds."""
    for _ in range(3000):
        if holds():
            return
        page.wait_for_timeout(20)
    raise AssertionError("it does not come")
