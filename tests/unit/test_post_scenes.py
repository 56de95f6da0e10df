"""What macros make of their lines, written down in `tests/golden/post/scenes/NAME.txt` under each case.

The cases go through every element, operator, function, branch, format and section, at the ends of what each takes
and one beyond. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from support.post_cases import rows_of
from support.post_scenes import RECORDED, lines_of, played

_MARKS = (
    "string.literal string.dquote string.squote order.written code.output code.star code.minus code.search_key "
    "code.modal_state word.expand word.reserved word.function_var macro.line_is_block block.empty"
)
SCENES = {
    "elements": f"{_MARKS} string.special_chars string.order_default macro.elements section.nc_macro word.TOOLCHANGE "
    "word.T seq.suppress seq.output seq.option2 seq.conflict block.sequence_number order.sort word.OUTPUTORDER "
    "sec.nc_code sec.g_code sec.m_code expr.assign init.key init.xyz init.value expr.case expr.undefined",
    "orders": "string.order_default string.squote order.written order.sort word.OUTPUTORDER word.STARTOFLINE "
    "word.ENDOFLINE expr.string_value sec.nc_code sec.parameter block.sequence_number block.empty string.dquote "
    "macro.line_is_block expr.case op.assign expr.undefined",
    "modes": "code.output code.star code.minus code.modal_state code.search_key code.combined init.key init.xyz "
    "init.value concept.machining_origin sec.g_code sec.m_code sec.function_var word.function_var word.X word.Y "
    "word.Z word.F word.T expr.assign concept.multi_path if.statement seq.output expr.undefined block.empty "
    "macro.tool_change",
    "formats": "word.function_var sec.function_var sec.parameter sec.nc_code block.sequence_number word.X word.Y "
    "word.Z word.F word.T seq.output seq.option2 seq.suppress concept.machining_origin init.xyz order.sort "
    "expr.undefined block.empty",
    "expressions": "expr.assign expr.newvar expr.undefined expr.case expr.number op.assign op.plus op.minus op.mul "
    "op.div word.reserved init.value fn.SQRT fn.DABS seq.output if.operands block.empty if.condition",
    "functions": "fn.SIN fn.COS fn.TAN fn.ASIN fn.ACOS fn.ATAN fn.DEG fn.RAD fn.SQRT fn.EXP fn.LOG10 fn.LOG fn.DABS "
    "fn.DMS fn.ADMS expr.case expr.assign expr.undefined init.value if.operands op.plus op.minus op.mul op.div "
    "seq.output",
    "conditions": "cond.equal cond.not_equal cond.less_or_equal cond.greater_or_equal cond.less cond.greater "
    "cond.tolerance logic.and logic.or logic.limit if.condition if.operands if.statement if.else_if if.else if.endif "
    "expr.undefined expr.case seq.output",
    "branches": "if.statement if.else_if if.else if.endif if.nesting if.condition expr.case string.literal "
    "cond.equal block.empty seq.output expr.undefined",
    "refusals": "string.special_chars string.dquote string.squote code.output code.star code.minus code.search_key "
    "code.combined word.expand word.reserved word.function_var seq.suppress seq.output expr.assign op.assign "
    "expr.number expr.string_value word.STARTOFLINE word.ENDOFLINE op.plus op.minus op.mul op.div init.key init.value "
    "if.statement if.else_if if.else if.endif if.nesting if.condition if.operands logic.limit logic.and logic.or "
    "sec.parameter macro.elements section.nc_macro macro.line_is_block expr.case sec.g_code",
    "files": "file.output_control_file section.nc_macro sec.nc_code sec.g_code sec.m_code sec.parameter "
    "sec.function_var code.search_key macro.line_is_block order.sort concept.machining_origin init.xyz string.literal "
    "block.empty",
    "programs": f"{_MARKS} string.special_chars file.output_control_file section.nc_macro word.TOOLCHANGE word.T "
    "word.F word.X word.Y word.Z word.STARTOFLINE word.ENDOFLINE expr.string_value seq.output seq.option2 "
    "block.sequence_number init.key init.xyz init.value macro.tool_change concept.multi_path "
    "concept.machining_origin sec.nc_code sec.g_code sec.m_code sec.parameter sec.function_var expr.newvar "
    "if.statement op.div",
}


def shown_in(name: str) -> dict[str, int]:
    """Return the rows of the statements that a scene uses; one of refusals shows no more than it says."""
    rows = rows_of(*lines_of(name))
    if "post.code.search_key" in rows:  # texts, orders and groups are those of the control file
        rows += ["post.sec.nc_code", "post.sec.g_code", "post.sec.m_code"]
    return {} if name == "refusals" else dict.fromkeys(rows, 0)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(
            name, marks=pytest.mark.covers(*{**{f"post.{row}": 0 for row in rows.split()}, **shown_in(name)})
        )
        for name, rows in SCENES.items()
    ],
)
def test_macros_write_what_is_written_down(name: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    file, found = RECORDED / f"{name}.txt", played(name, tmp_path)
    if request.config.getoption("update_goldens"):
        file.write_text(found, encoding="utf-8")
    assert found.splitlines() == file.read_text(encoding="utf-8").splitlines()
