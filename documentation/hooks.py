"""What the site is made of beside the pages of docs/: pages written from the code, and files elsewhere that the pages link to."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from documentation import gallery
from documentation.linked_files import linked_files, links_within_the_site
from documentation.written import WRITTEN

ROOT = Path(__file__).parents[1]


def on_files(files: Files, config: Any) -> Files:
    """Add what is written, and what stands elsewhere in the repository."""
    for place, write in WRITTEN.items():
        told = files.get_file_from_path(place)
        if told is not None:  # docs/ says there how to get the page
            files.remove(told)
        files.append(File.generated(config, place, content=write()))
    for name, picture in gallery.pictures().items():
        files.append(File.generated(config, f"reference/{name}", content=picture))
    for path in linked_files(Path(config.docs_dir), ROOT):
        place = path.relative_to(ROOT).as_posix()
        files.append(File.generated(config, place, abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Links between docs/ and the rest of the repository lead to the same file on the site."""
    if page.file.abs_src_path is None:
        return markdown
    of_docs = Path(page.file.abs_src_path).is_relative_to(ROOT / "docs")
    return links_within_the_site(markdown, page.file.src_uri, of_docs=of_docs)


def on_page_content(html: str, **_: Any) -> str:
    """Names in docstrings stand without the role that says of what kind they are."""
    return re.sub(r":(?:meth|class|func|attr|mod):(?=<code>)", "", html)
