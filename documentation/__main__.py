"""`python -m documentation settings` prints a page that is written from the code, for readers who do not build the site."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import PurePosixPath

from documentation.written import WRITTEN


def main(asked: Sequence[str]) -> int:
    """Prints the pages that are asked for by name; the exit code is 2 where there is no such page."""
    pages = {PurePosixPath(place).stem: write for place, write in WRITTEN.items()}
    if not asked or not set(asked) <= set(pages):
        print(
            f"python -m documentation: found {' '.join(asked) or 'no page'}, expected of {', '.join(pages)}",
            file=sys.stderr,
        )
        return 2
    for name in asked:
        print(pages[name]())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
