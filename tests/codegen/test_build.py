"""Compilers that hang, write junk or are called with options, and a cache that others may write to."""

from __future__ import annotations

import errno
import os
import time
from pathlib import Path

import pytest

from greybox_torch.codegen import build, cache
from greybox_torch.errors import UserError

WORKS = build.TRIAL
pytestmark = pytest.mark.skipif(build.compiler() is None, reason="no C++ compiler")


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, and nothing kept from other tests."""
    monkeypatch.setenv("GREYBOX_CACHE", str(tmp_path / "cache"))
    build.library.cache_clear()
    return tmp_path / "cache"


@pytest.fixture
def called(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A script that stands for a compiler."""
    script = tmp_path / "my compiler"
    monkeypatch.setenv("CXX", f"'{script}'")
    return script


def write(script: Path, text: str) -> None:
    script.write_text(text)
    script.chmod(0o700)


def test_a_compiler_with_options(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CXX", "g++ -m64 '-DA=1 2'")
    assert build.compiler() is not None and build.compiler()[1:] == ("-m64", "-DA=1 2")  # type: ignore[index]
    loaded = build.library(WORKS)
    assert loaded is not None and loaded.works() == 1


def test_a_command_that_cannot_be_taken_apart_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CXX", "'never closed")
    assert build.compiler() is not None


def test_a_compiler_that_hangs(called: Path, own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(called, "#!/bin/sh\nexec sleep 1000\n")
    monkeypatch.setattr(build, "COMPILER_SECONDS", 0.3)
    with pytest.raises(
        UserError, match=r"my compiler'` did not end within 0.3 s; expected one that works, named by \$CXX"
    ):
        build.library(WORKS)
    assert list(own_cache.iterdir()) == []


@pytest.mark.parametrize(
    "script",
    [
        "#!/bin/sh\nexit 3\n",
        '#!/bin/sh\nwhile [ "$1" ]; do [ "$1" = -o ] && echo junk > "$2"; shift; done\n',
        "\x7fELF of elsewhere",
    ],
)
def test_a_compiler_that_does_not_work(called: Path, own_cache: Path, script: str) -> None:
    write(called, script)
    with pytest.raises(
        UserError, match=r"a diagnosis needs a C\+\+ compiler: .*my compiler'` makes no library that can be loaded"
    ):
        build.check_compiler("a diagnosis")
    assert list(own_cache.iterdir()) == []


def test_what_others_may_write_is_not_loaded(own_cache: Path) -> None:
    assert build.library(WORKS) is not None
    (file,) = own_cache.iterdir()
    assert own_cache.stat().st_mode & 0o777 == 0o700 and file.stat().st_mode & 0o077 == 0
    file.unlink()  # a loaded library must not change in place
    file.write_bytes(b"somebody else's")
    file.chmod(0o777)
    build.library.cache_clear()
    loaded = build.library(WORKS)  # made anew
    assert loaded is not None and loaded.works() == 1
    own_cache.chmod(0o777)
    build.library.cache_clear()
    with pytest.raises(
        UserError, match=r"other users may write to it; expected a folder of your own, named by \$GREYBOX_CACHE"
    ):
        build.library(WORKS)


def test_what_was_not_used_for_longest_is_thrown_out(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own_cache.mkdir(mode=0o700)
    now = time.time()
    for name, days in (("new", 0.0), ("used", 1.0), ("old", 2.0), ("ancient", 100.0)):
        file = own_cache / f"{name}.so"
        file.write_bytes(bytes(400_000))
        os.utime(file, (now - 86400 * days,) * 2)
    left, working = own_cache / "tmpleft", own_cache / "tmpnow"
    for folder in (left, working):
        folder.mkdir()
    os.utime(left, (now - 86400,) * 2)
    cache.prune(own_cache)
    assert {file.stem for file in own_cache.glob("*.so")} == {"new", "used", "old"}
    assert working.is_dir() and not left.exists()
    monkeypatch.setenv("GREYBOX_CACHE_MB", "1")
    cache.prune(own_cache)
    assert {file.stem for file in own_cache.glob("*.so")} == {"new", "used"}


def test_what_is_loaded_counts_as_used(own_cache: Path) -> None:
    assert build.library(WORKS) is not None
    (file,) = own_cache.glob("*.so")
    os.utime(file, (1e9, 1e9))
    build.library.cache_clear()
    assert build.library(WORKS) is not None
    assert time.time() - file.stat().st_mtime < 100


def test_a_disk_without_room(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*arguments: object, **options: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(build.tempfile, "TemporaryDirectory", full)
    with pytest.raises(
        UserError, match="compiled code cannot be kept there: No space left on device; expected a folder"
    ):
        build.library(WORKS)
