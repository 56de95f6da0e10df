"""What an editor shows of a program while it is typed: findings, what codes do, an outline."""

from polycnc.editor._codes import Completion, completions, hover
from polycnc.editor._findings import Finding, findings
from polycnc.editor._outline import Symbol, outline
from polycnc.editor._serve import serve_editor

__all__ = ["Completion", "Finding", "Symbol", "completions", "findings", "hover", "outline", "serve_editor"]
