"""Pages for a browser: JavaScript modules that pages share, libraries as npm brings them, and one file out of all."""

from polycnc.web._page import Page
from polycnc.web._served import served_files, served_text
from polycnc.web._table import html_table
from polycnc.web._vendor import libraries

__all__ = ["Page", "html_table", "libraries", "served_files", "served_text"]
