"""Write the documentation pages and type stubs that are generated; run by scripts/reference, compared by a test."""

import runpy
from collections.abc import Callable
from functools import partial
from pathlib import Path

from polycnc import conformance
from polycnc.machine import machine_file_reference

REPOSITORY = Path(__file__).resolve().parents[1]


def conformance_page() -> str:
    """Return the page that shows which rows of the manuals are tested."""
    return conformance.reference_page(conformance.load_conformance(REPOSITORY / "conformance"))


def life_of_a_block_page() -> str:
    """Return the page that follows one block through the code, with its numbers."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_life_of_a_block.py"))["page"]
    return page()


def apci_functions_page() -> str:
    """Return the page of the APCI function library."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_apci_functions.py"))["page"]
    return page()


def apci_system_file_page() -> str:
    """Return the page of the keys of an APCI system file."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_apci_system_file.py"))["page"]
    return page()


def fanuc_page(name: str) -> str:
    """Return one of the pages of the FANUC Power Mate."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_fanuc_pages.py"))[name]
    return page()


def focas_page() -> str:
    """Return the page of the FOCAS server."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_focas_pages.py"))["page"]
    return page()


def imc_page(name: str) -> str:
    """Return one of the pages of the iMC card."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_imc_pages.py"))[name]
    return page()


def grbl_page() -> str:
    """Return the page of the door for senders."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_grbl_page.py"))["page"]
    return page()


def data_items_page() -> str:
    """Return the page of the data items that plants read."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_data_items_page.py"))["page"]
    return page()


def post_events_page() -> str:
    """Return the page of the post-processor's events."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_post_events.py"))["page"]
    return page()


def bosch_ncs_page() -> str:
    """Return the page of the NCS coupling."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_bosch_ncs.py"))["page"]
    return page()


def control_page() -> str:
    """Return the page of the control as a library."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_control_page.py"))["page"]
    return page()


def cpl_page() -> str:
    """Return the page of CPL."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_cpl_page.py"))["page"]
    return page()


def dialects_page() -> str:
    """Return the page of the dialects, its tables written anew."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_dialect_page.py"))["page"]
    return page()


def c_library_page() -> str:
    """Return the page of the C libraries."""
    page: Callable[[], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_c_library_page.py"))["page"]
    return page()


def stub(module: str, kind: str = "stub") -> str:
    """Return the type stub of a module that reads structures from a header, or functions from rows."""
    made: Callable[[str], str] = runpy.run_path(str(REPOSITORY / "scripts" / "_stubs.py"))[kind]
    return made(module)


STUBS = {
    f"src/{module.replace('.', '/')}.pyi": partial(stub, module)
    for module in (
        "polycnc.controllers.apci.board._declared",
        "polycnc.controllers.fanuc.library._structs",
        "polycnc.controllers.imc.library._declared",
    )
}
STUBS["src/polycnc/controllers/imc/library/_motion.pyi"] = partial(
    stub, "polycnc.controllers.imc.library._motion", "functions_stub"
)

PAGES: dict[str, Callable[[], str]] = {
    "docs/explanation/life-of-a-block.md": life_of_a_block_page,
    "docs/reference/apci-functions.md": apci_functions_page,
    "docs/reference/apci-system-file.md": apci_system_file_page,
    "docs/reference/bosch-ncs.md": bosch_ncs_page,
    "docs/reference/c-libraries.md": c_library_page,
    "docs/reference/conformance.md": conformance_page,
    "docs/reference/control.md": control_page,
    "docs/reference/cpl.md": cpl_page,
    "docs/reference/data-items.md": data_items_page,
    "docs/reference/dialects.md": dialects_page,
    "docs/reference/fanuc-functions.md": partial(fanuc_page, "functions_page"),
    "docs/reference/fanuc-parameters.md": partial(fanuc_page, "parameters_page"),
    "docs/reference/focas-protocol.md": focas_page,
    "docs/reference/grbl-sender.md": grbl_page,
    "docs/reference/imc-axes.md": partial(imc_page, "axis_page"),
    "docs/reference/imc-functions.md": partial(imc_page, "functions_page"),
    "docs/reference/imc-parameters.md": partial(imc_page, "parameters_page"),
    "docs/reference/machine-file.md": machine_file_reference,
    "docs/reference/post-events.md": post_events_page,
    **STUBS,
}
"""Every generated file: its path in the repository, and what returns its text."""

if __name__ == "__main__":
    for path, text in PAGES.items():
        (REPOSITORY / path).write_text(text(), encoding="utf-8")
        print(f"wrote {path}")
