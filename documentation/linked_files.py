"""Files outside of docs/ that its pages link to: they become part of the site, at the same place as in the repository."""

from __future__ import annotations

import re
from pathlib import Path

_LINK = re.compile(r"(\]\()([^)\s#]+)((?:#[^)\s]*)?\))")
_ELSEWHERE = re.compile(r"[a-z]+:|/|#")


def links(markdown: str) -> list[str]:
    """Targets of the relative links and images of a page, without anchors."""
    return [target for _, target, _ in _LINK.findall(markdown) if not _ELSEWHERE.match(target)]


def linked_files(docs: Path, root: Path) -> list[Path]:
    """Files below ``root`` and outside ``docs`` that pages link to, and those that these link to in turn.

    Raises:
        FileNotFoundError: a link leads to nothing, or to a folder.
    """
    waiting = sorted(docs.rglob("*.md"))
    found: dict[Path, None] = {}
    while waiting:
        page = waiting.pop()
        for target in links(page.read_text(encoding="utf-8")):
            path = (page.parent / target).resolve()
            if path.is_relative_to(docs.resolve()) or path in found:
                continue
            if not path.is_file() or not path.is_relative_to(root.resolve()):
                raise FileNotFoundError(f"{page}: the link {target} leads to no file of the repository")
            found[path] = None
            if path.suffix == ".md":
                waiting.append(path)
    return sorted(found)


def links_within_the_site(markdown: str, place: str, *, of_docs: bool) -> str:
    """The page at ``place`` with links that hold on the site, which has docs/ for its root.

    Those out of docs/ become one folder shorter, those into docs/ from elsewhere lose that folder.
    """
    up = "../" * place.count("/")
    was, then = ("../" + up, up) if of_docs else (up + "docs/", up)
    return _LINK.sub(
        lambda m: m[1] + (then + m[2].removeprefix(was) if m[2].startswith(was) else m[2]) + m[3], markdown
    )
