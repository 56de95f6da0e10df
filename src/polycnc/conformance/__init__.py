"""What polycnc promises, row by row: every statement of the systems' manuals and whether a test asserts it.

The rows, the claims and the rows stated as not applicable are text files (``conformance/`` in the repository,
package data when installed); this package reads them, joins them and counts.
"""

from polycnc.conformance._claims import (
    asserts_something,
    claims_text,
    invalid_claim,
    read_claims,
    read_not_applicable,
)
from polycnc.conformance._report import (
    Conformance,
    Counts,
    State,
    load_conformance,
    reference_page,
    row_listing,
    summary_table,
)
from polycnc.conformance._rows import SYSTEMS, Row, data_folder, read_rows

__all__ = [
    "SYSTEMS",
    "Conformance",
    "Counts",
    "Row",
    "State",
    "asserts_something",
    "claims_text",
    "data_folder",
    "invalid_claim",
    "load_conformance",
    "read_claims",
    "read_not_applicable",
    "read_rows",
    "reference_page",
    "row_listing",
    "summary_table",
]
