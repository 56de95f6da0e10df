"""Describe machines for an agent of others, without serving them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.servers.mtconnect import VERSIONS, Header, devices_document, model_of, time_text
from polycnc.servers.process import KINDS, MachineWanted
from polycnc.servers.setup._plan import Flags, check_version, plan_of


def describe_devices(
    file: Path | None, kinds: Mapping[str, str | Path | None], *, name: str, axes: int, version: str
) -> bytes:
    """Return a Devices.xml of the machines of a file, or of one machine of a kind.

    Raises:
        UsageError: It is not said which machine, it cannot be made, or has no control.
    """
    check_version(version)
    wanted: Sequence[MachineWanted] = plan_of(Flags(file, kinds, axes=axes, doors="shdr")).machines
    if file is None:
        wanted = [replace(each, machinery=replace(each.machinery, name=name)) for each in wanted]
    models, now = [], ""
    for each in wanted:
        made = KINDS[each.kind](each.machinery)
        try:
            if made.find_control is None:
                raise UsageError(
                    f"machine {each.machinery.name} has no control that MTConnect could describe",
                    hint="Describe plain, fanuc and bosch machines.",
                )
            control = made.find_control()
            models.append(model_of(each.machinery.name, control, VERSIONS[version]))
            now = time_text(control.status())
        finally:
            made.end()
    return devices_document(models, Header(VERSIONS[version], 1, now, now))
