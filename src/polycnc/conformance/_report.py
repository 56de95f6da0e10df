"""Join rows, claims and reasons into one picture: which rows are tested, not applicable, or open."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path

from polycnc.conformance._claims import (
    NOT_APPLICABLE_FILE,
    read_claims,
    read_not_applicable,
    read_stand_ins,
)
from polycnc.conformance._rows import SYSTEMS, Row, data_folder, read_rows
from polycnc.errors import ConfigurationError, UsageError, did_you_mean


class State(StrEnum):
    """Name what is known about a row."""

    TESTED = "tested"
    NOT_APPLICABLE = "not_applicable"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class Counts:
    """Count the rows of one system (or of all) by state."""

    rows: int
    tested: int
    not_applicable: int
    open: int


@dataclass(frozen=True, slots=True)
class Conformance:
    """Hold every row with the tests that claim it or the reason why it does not apply."""

    by_id: Mapping[str, Row]
    claims: Mapping[str, tuple[str, ...]]
    reasons: Mapping[str, str]
    stand_ins: Mapping[str, str] = field(default_factory=dict)
    """What the tests of a file run against instead of the control, by file."""

    def stand_in(self, row_id: str) -> str:
        """Return what all tests of a row run against instead of the control; "" if one runs against the control."""
        files = [test.partition("::")[0] for test in self.claims.get(row_id, ())]
        return self.stand_ins[files[0]] if files and all(file in self.stand_ins for file in files) else ""

    def state(self, row_id: str) -> State:
        """Return the state of one row."""
        if row_id in self.claims:
            return State.TESTED
        return State.NOT_APPLICABLE if row_id in self.reasons else State.OPEN

    def rows(self, system: str | None = None, state: State | str | None = None) -> tuple[Row, ...]:
        """Return the rows of one system and one state, in manual order; without an argument, of all.

        Raises:
            UsageError: The system or the state is unknown.
        """
        if system is not None and system not in SYSTEMS:
            raise UsageError(
                f"unknown system '{system}'",
                hint=f"{did_you_mean(system, SYSTEMS)}Systems are: {', '.join(SYSTEMS)}",
            )
        if state is not None and state not in tuple(State):
            raise UsageError(f"unknown state '{state}'", hint=f"States are: {', '.join(State)}")
        return tuple(
            row
            for row in self.by_id.values()
            if system in (None, row.system) and state in (None, self.state(row.id))
        )

    def counts(self) -> dict[str, Counts]:
        """Return the counts of each system, in the order of ``SYSTEMS``."""
        return {system: self._count(self.rows(system)) for system in SYSTEMS}

    def total(self) -> Counts:
        """Return the counts of all systems together."""
        return self._count(self.by_id.values())

    def groups(self, system: str) -> dict[str, Counts]:
        """Return the counts of each group of a system's rows, in manual order."""
        members: dict[str, list[Row]] = {}
        for row in self.rows(system):
            members.setdefault(row.group, []).append(row)
        return {group: self._count(rows) for group, rows in members.items()}

    def as_json(self) -> dict[str, dict[str, dict[str, int]]]:
        """Return the counts as plain dictionaries, ready for ``json.dumps``."""
        return {"systems": {system: asdict(counts) for system, counts in self.counts().items()}}

    def _count(self, rows: Iterable[Row]) -> Counts:
        found = Counter(self.state(row.id) for row in rows)
        return Counts(
            rows=found.total(),
            tested=found[State.TESTED],
            not_applicable=found[State.NOT_APPLICABLE],
            open=found[State.OPEN],
        )


def load_conformance(folder: Path | None = None) -> Conformance:
    """Return the picture that the files of a folder give; by default of polycnc's own.

    Raises:
        ConfigurationError: A file is malformed, names an unknown row, or a row is claimed and not applicable.
    """
    folder = data_folder() if folder is None else folder
    rows = read_rows(folder)
    claims = read_claims(folder, rows)
    reasons = read_not_applicable(folder, rows)
    both = [row_id for row_id in claims if row_id in reasons]
    if both:
        raise ConfigurationError(
            f"row '{both[0]}' is claimed by {claims[both[0]][0]} and stated as not applicable",
            hint=f"Remove the mark or the entry in {NOT_APPLICABLE_FILE}.",
        )
    return Conformance(by_id=rows, claims=claims, reasons=reasons, stand_ins=read_stand_ins(folder))


def summary_table(conformance: Conformance) -> str:
    """Return the counts per system as a plain-text table."""
    lines = [f"{'system':<8}{'rows':>7}{'tested':>9}{'not applicable':>17}{'open':>7}"]
    for name, counts in [*conformance.counts().items(), ("total", conformance.total())]:
        lines.append(
            f"{name:<8}{counts.rows:>7}{counts.tested:>9}{counts.not_applicable:>17}{counts.open:>7}"
        )
    return "\n".join(lines)


def row_listing(conformance: Conformance, system: str, state: State | str) -> str:
    """Return a system's rows of one state, grouped: id and name, and the tests or the reason below.

    Raises:
        UsageError: The system or the state is unknown.
    """
    lines: list[str] = []
    group = ""
    for row in conformance.rows(system, state):
        if row.group != group:
            group = row.group
            lines += ["", group] if lines else [group]
        lines.append(f"  {row.id}  {row.name}")
        lines += [f"      {test}" for test in conformance.claims.get(row.id, ())]
        if row.id in conformance.reasons:
            lines.append(f"      {conformance.reasons[row.id]}")
    return "\n".join(lines) if lines else f"{SYSTEMS[system]}: no row is {State(state).replace('_', ' ')}."


def reference_page(conformance: Conformance) -> str:
    """Return the Markdown page that shows the counts per system and group, and every reason."""
    head = "| | rows | tested | not applicable | open |\n| --- | ---: | ---: | ---: | ---: |"
    parts = [
        "# Conformance",
        "<!-- Written by scripts/reference from conformance/; edit those files, not this page. -->",
        "Each row is one statement of a system's manual. A row is *tested* when a test claims it and\n"
        "asserts its behaviour, *not applicable* when a reason says why not, and *open* otherwise.\n"
        "`polycnc conformance` prints the same counts, `polycnc conformance SYSTEM` the open rows.",
        head,
    ]
    counted = [(SYSTEMS[system], counts) for system, counts in conformance.counts().items()]
    parts[-1] += "".join(_markdown_line(name, counts) for name, counts in counted)
    parts[-1] += _markdown_line("**All**", conformance.total())
    for system, title in SYSTEMS.items():
        parts += [f"## {title}", f"Rows: `conformance/{system}.tsv`."]
        groups = conformance.groups(system)
        parts.append(head + "".join(_markdown_line(name, counts) for name, counts in groups.items()))
        parts += _on_stand_ins(conformance, system)
        parts += _reasons(conformance, system)
    return "\n\n".join(parts) + "\n"


def _markdown_line(name: str, counts: Counts) -> str:
    name = name.replace("|", "\\|")
    return f"\n| {name} | {counts.rows} | {counts.tested} | {counts.not_applicable} | {counts.open} |"


def _on_stand_ins(conformance: Conformance, system: str) -> list[str]:
    by_what: dict[str, list[str]] = {}
    for row in conformance.rows(system, State.TESTED):
        if what := conformance.stand_in(row.id):
            by_what.setdefault(what, []).append(f"`{row.id}`")
    if not by_what:
        return []
    lines = [f"- {what} {len(ids)} rows: {', '.join(ids)}" for what, ids in by_what.items()]
    return ["Tested on a stand-in of the control alone:", "\n".join(lines)]


def _reasons(conformance: Conformance, system: str) -> list[str]:
    rows = conformance.rows(system, State.NOT_APPLICABLE)
    if not rows:
        return []
    return ["Not applicable:", "\n".join(f"- `{row.id}`: {conformance.reasons[row.id]}" for row in rows)]
