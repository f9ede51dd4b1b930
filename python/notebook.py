"""Makes docs/generated/python.ipynb of docs/python.md: one text, two forms.

    python python/notebook.py
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, NOTEBOOK = DOCS / "python.md", DOCS / "generated/python.ipynb"

BLOCK = re.compile(r"^```python\n(.*?)^```\n", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\((?![a-z]+:|#)")


def blocks(page: str) -> list[str]:
    """The code of a page, in order."""
    return BLOCK.findall(page)


def notebook(page: str) -> dict[str, Any]:
    """The page as a notebook without outputs."""
    cells: list[dict[str, Any]] = []
    for n, part in enumerate(BLOCK.split(page)):
        source = part.strip("\n").splitlines(keepends=True)
        if not source:
            continue
        cell: dict[str, Any] = {"id": f"part-{n}", "metadata": {}, "source": source}
        if n % 2 == 1:
            cell |= {"cell_type": "code", "execution_count": None, "outputs": []}
        else:
            # Its links are those of the page, which lies a folder above.
            source[:] = [LINK.sub("](../", line) for line in source]
            cell |= {"cell_type": "markdown"}
        cells.append(dict(sorted(cell.items())))
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {
        "cells": cells,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def text(page: str) -> str:
    """The notebook's file."""
    return json.dumps(notebook(page), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    NOTEBOOK.write_text(text(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    print(NOTEBOOK)
