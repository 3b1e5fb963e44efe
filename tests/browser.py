"""A browser without a window, for tests of pages that run scripts."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

BROWSER = next(
    (path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None
)
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine")


def after_scripts(page: Path, folder: Path, *options: str) -> tuple[str, str]:
    """The title of a page once its scripts have run, in which they say what they found, and all of it; the console has to stay empty.

    Args:
        folder: for the browser's profile.
    """
    headless = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", *options]
    run = subprocess.run(
        [str(BROWSER), *headless, f"--user-data-dir={folder / 'profile'}", "--dump-dom", page.as_uri()],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert "CONSOLE" not in run.stderr, run.stderr
    title = re.search(r"<title>(.*?)</title>", run.stdout)
    assert title is not None
    return title[1], run.stdout
