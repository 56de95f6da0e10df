"""Paths of MTConnect against another XPath; what is too long or deep is refused in bounded time."""

from __future__ import annotations

import contextlib
import random
import time
from urllib.parse import quote

import pytest

from polycnc.cnc import Control
from polycnc.servers.mtconnect import PathError, choose, device_model, tree_of
from polycnc.servers.plant import shape_of
from support.mtconnect import Rig, plain

PATHS = [
    "//DataItem", "//Axes", "//Linear[@name='X']", '//Linear[@name="X"]//DataItem[@type="POSITION"]',
    "//DataItem[@category='CONDITION']", "//DataItem[@category='SAMPLE' and @subType='ACTUAL']",
    "//DataItem[@type='LOAD' or @type='PROGRAM']", "//Rotary | //Path/DataItems/DataItem[@name='block']",
    "//Components/*", "/MTConnectDevices/Devices/Device", "//Device[@name='mill']//Path",
    "//DataItem[not(@subType)]", "//DataItem[contains(@name, 'act')]", "//DataItem[starts-with(@name,'S1')]",
    "//DataItem[(@type='POSITION' or @type='LOAD') and not(@subType='COMMANDED')]",
    "//DataItem[@subType!='ACTUAL']", "//DataItem[@units][@subType='ACTUAL']", "//*//*//DataItem[@type='BLOCK']",
    "//Controller/Components/Path//DataItem[@type='EXECUTION']", "//DataItems//DataItem[@name='Xact']",
]  # fmt: skip
BAD = [
    "", "/", "//", "DataItem", "//DataItem[", "//DataItem[]", "//DataItem[@]", "//DataItem[@type=]", "//a]", "//a|",
    "//DataItem[@type='X]", "//DataItem[1]", "//DataItem/@name", "//DataItem/..", "//DataItem[count(*)=1]", "//a b",
    "//DataItem[@type=POSITION]", "//Nothing", "\0", "//\ud7ff", "//DataItem[last()]", "document('x')",
    "//" + "a" * 2000,
    "//" * 600, "//*" * 300, "//a[" + "(" * 500, "//*[" + "not(" * 200 + "@a" + ")" * 200 + "]",
    "//*" + "[@a]" * 200, "|".join(["//*"] * 200),
]  # fmt: skip


@pytest.mark.parametrize("path", PATHS)
def test_paths_choose_what_another_xpath_chooses(path: str) -> None:
    etree = pytest.importorskip("lxml.etree", reason="pip install lxml")
    rig = Rig("mill5")
    tree = etree.fromstring(rig.get("/probe").document)
    for each in tree.iter():
        each.tag = plain(each.tag)
    found = {
        item.attrib["id"]
        for node in tree.xpath(path)
        for item in node.iter()
        if isinstance(item.tag, str) and item.tag == "DataItem"
    }
    assert found
    assert {item.id for item in choose(path, tree_of([rig.device]))} == found
    rig.observe()
    shown = rig.tree("/current", "path=" + quote(path))
    assert {each.attrib["dataItemId"] for each in shown.iter() if "dataItemId" in each.attrib} == found


@pytest.mark.parametrize("path", BAD, ids=range(len(BAD)))
def test_bad_paths_are_refused(path: str) -> None:
    tree = tree_of([device_model("m", shape_of(Control("mill3").status()), (2, 7))])
    with pytest.raises(PathError):
        choose(path, tree)


def test_the_largest_paths_are_quick() -> None:
    shape = shape_of(Control("mill5").status())
    tree = tree_of([device_model(f"m{k}", shape, (2, 7)) for k in range(40)])
    begin = time.process_time()
    for path in ("//*" * 7, "|".join(["//*//*//*"] * 8), "//*[not(@a)]" * 7, "//*" + "[not(@a)]" * 11):
        assert choose(path, tree)
    assert time.process_time() - begin < 20.0


def test_no_path_raises_anything_else() -> None:
    tree = tree_of([device_model("m", shape_of(Control("mill3").status()), (2, 7))])
    chance = random.Random(7)
    pieces = ["//", "/", "*", "DataItem", "[", "]", "@", "type", "=", "'LOAD'", '"', "and", "or", "not(", "(", ")", "|",
              "contains(", ",", "!=", " ", "9", "m:Axes", "\x00", "é", ".."]  # fmt: skip
    for _ in range(4000):
        path = "".join(chance.choices(pieces, k=chance.randint(1, 14)))
        with contextlib.suppress(PathError):
            choose("//" + path if chance.random() < 0.7 else path, tree)
