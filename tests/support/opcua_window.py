"""The window of opcua-client (FreeOpcUa), as its user works it, without a screen; each answer is a line of JSON.

It opens every node in the tree from `Machines` down, and looks at attributes and references of each; then it subscribes
to the override and to alarms by the client that the window has, and writes.
"""

from __future__ import annotations

import json
import os
import sys
import time
import urllib.request
from typing import Any

os.environ["QT_QPA_PLATFORM"] = "offscreen"

from asyncua import ua
from PyQt5.QtCore import QItemSelectionModel
from PyQt5.QtWidgets import QApplication
from uaclient import mainwindow

CHANNEL = "ns=1;s=machine/CncChannelList/Channel1"


class Seen:
    """What the server has told."""

    def __init__(self) -> None:
        self.values: list[Any] = []
        self.events: list[Any] = []

    def datachange_notification(self, _node: Any, value: Any, _data: Any) -> None:
        self.values.append(value)

    def event_notification(self, event: Any) -> None:
        self.events.append([event.Message.Text, event.Severity])


def say(name: str, value: Any) -> None:
    print(json.dumps([name, value]), flush=True)


def until(done: Any) -> bool:
    end = time.monotonic() + 60.0
    while not done() and time.monotonic() < end:
        QApplication.processEvents()
    return bool(done())


def order(page: str, *, on: bool) -> None:
    asked = json.dumps({"command": "emergency_stop", "on": on}).encode()
    url = f"{page}/api/machines/machine/commands"
    urllib.request.urlopen(urllib.request.Request(url, asked, {"Content-Type": "application/json"})).close()


def opened(window: Any, errors: list[str]) -> dict[str, int]:
    """Open the tree below the folder of machines; return how many nodes, attributes and references are shown."""
    view, model = window.ui.treeView, window.tree_ui.model
    seen = {"nodes": 0, "attributes": 0, "references": 0}
    waiting = [model.index(0, 0)]
    while waiting:
        index = waiting.pop()
        view.expand(index)
        QApplication.processEvents()
        view.selectionModel().setCurrentIndex(index, QItemSelectionModel.ClearAndSelect)
        QApplication.processEvents()
        seen["nodes"] += 1
        seen["attributes"] += window.attrs_ui.model.rowCount()
        seen["references"] += window.refs_ui.model.rowCount()
        below = [model.index(row, 0, index) for row in range(model.rowCount(index))]
        names = {str(each.data()): each for each in below}
        path = {"Root": ["Objects"], "Objects": ["Machines"]}.get(str(index.data()))
        waiting += [each for name, each in names.items() if path is None or name in path]
    assert not errors, errors
    return seen


def main(url: str, page: str) -> None:
    _application = QApplication([])
    errors: list[str] = []
    mainwindow.Window.show_error = lambda _, text: errors.append(str(text))
    window = mainwindow.Window()
    window.ui.addrComboBox.setCurrentText(url)
    window.connect()
    say("errors", errors)
    shown = opened(window, errors)
    say("shown", all(count > 40 for count in shown.values()))
    client, seen = window.uaclient, Seen()
    client.subscribe_datachange(client.get_node(f"{CHANNEL}/ActOverride"), seen)
    client.subscribe_events(client.get_node("i=2253"), seen)
    command = client.get_node(f"{CHANNEL}/CmdOverride")
    command.write_value(63.0)
    try:
        command.write_value(630.0)
    except ua.UaStatusCodeError as error:
        say("too much", type(error).__name__)
    say("changed", until(lambda: 63.0 in seen.values))
    order(page, on=True)
    until(lambda: seen.events)
    say("event", seen.events[:1])
    order(page, on=False)
    window.disconnect()


if __name__ == "__main__":
    main(*sys.argv[1:])
