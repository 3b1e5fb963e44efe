"""The pages of the documentation and the blocks of code in them."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = {
    page.relative_to(ROOT).as_posix(): page for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
}
_BLOCK = re.compile(r"^```(\w+)(?: title=[^\n]*)?\n(.*?)^```$", re.M | re.S)


def blocks(page: str, *languages: str) -> list[tuple[str, str]]:
    """Language and text of the blocks of a page in these languages, in their order."""
    found = _BLOCK.findall(PAGES[page].read_text(encoding="utf-8"))
    return [(language, text) for language, text in found if language in languages]


def pages_with(language: str) -> list[str]:
    return [page for page in PAGES if blocks(page, language)]


def commands(text: str) -> list[str]:
    """The commands of `greybox` in a block of a shell, without comments."""
    lines = (re.sub(r"\s+#.*", "", line) for line in text.splitlines())
    return [line for line in lines if line.startswith("greybox ")]
