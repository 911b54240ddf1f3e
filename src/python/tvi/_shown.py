"""How systems and runs show themselves: as lines of text, and as a table in a notebook."""

from __future__ import annotations

import html
from typing import Any


def as_text(title: str, rows: dict[str, Any]) -> str:
    """A title and a line for each row whose value is not None."""
    shown = {name: value for name, value in rows.items() if value is not None}
    width = max(map(len, shown))
    return "\n".join([f"<{title}", *(f"  {name:{width}}  {value}" for name, value in shown.items())]) + ">"


def as_html(title: str, rows: dict[str, Any]) -> str:
    """The same as a table of HTML."""
    shown = "".join(f"<tr><th style=\"text-align: left\">{html.escape(name)}</th>"
                    f"<td style=\"text-align: left\">{html.escape(str(value))}</td></tr>"
                    for name, value in rows.items() if value is not None)
    return f"<table><caption>{html.escape(title)}</caption>{shown}</table>"
