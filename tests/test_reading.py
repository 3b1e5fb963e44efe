"""What can stand in the place of a file, and is answered at once and with one message."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from greybox_torch.errors import UserError
from greybox_torch.reading import check_file, read_bytes, read_toml


def test_reads(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    assert read_bytes(tmp_path / "a", "a file") == b"abc"
    assert check_file(tmp_path / "a", "a file") == 3
    (tmp_path / "link").symlink_to(tmp_path / "a")
    assert read_bytes(tmp_path / "link", "a file") == b"abc"


def test_what_is_no_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "dangling").symlink_to("nowhere")
    (tmp_path / "file").touch()
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(str(tmp_path / "socket"))
    for name, found in [
        ("pipe", "pipe: is a pipe; expected a card, in a regular file"),
        ("loop", "cannot be read: Too many levels of symbolic links"),
        ("dangling", "no such file; expected a card"),
        ("socket", "cannot be read"),
        ("file/inside", "cannot be read: Not a directory"),
        ("", "cannot be read: Is a directory"),
        ("x" * 5000, "cannot be read: File name too long"),
        ("a\0b", "cannot be the name of a file"),
        ("/dev/zero", "is a device"),
        ("/dev/null", "is a device"),
    ]:
        with pytest.raises(UserError) as error:
            read_bytes(tmp_path / name, "a card")
        assert found in str(error.value)
        assert "\0" not in str(error.value)
        assert len(str(error.value)) < 500
    listener.close()


def test_more_than_is_read(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"x" * 101)
    with pytest.raises(UserError, match="has more than 0 MiB"):
        read_bytes(tmp_path / "a", "a file", most=100)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a = " + b"[" * 20000, "nested too deeply"),
        (b"a = " + b"{a=" * 5000, "nested too deeply"),
        (b"a = " + b"9" * 5000, "not valid TOML: Exceeds the limit"),
        (b"a = 1\nb = \xff", r"a.toml, line 2: not UTF-8 text; expected a card, saved as UTF-8"),
        ("a = 1".encode("utf-16"), "not UTF-8 text but UTF-16; expected a card, saved as UTF-8"),
        (rb'a = "C:\data"', r"Unescaped .* in a string .*; write paths with / in the place of "),
        (rb'a = "C:\Users"', r"write paths with / in the place of "),
        (b"a = 1\na = 2\n", "not valid TOML: Cannot overwrite"),
        (b"a = 1\r\n  name = run02  \r\nb = 2\n", "not valid TOML: Invalid value .at line 2, column 10.: name = run02"),
        (b"[a]\n[a]\n", r"Cannot declare .* \(at line 2, column 3\): \[a\]$"),
        (
            b"[experiment]\n[experiment]\n",
            r"line 2, column 12\): \[experiment\]; expected double brackets, \[\[experiment\]\], for every",
        ),
        (b"a\0 = 1", "not valid TOML"),
    ],
)
def test_toml(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "a.toml").write_bytes(content)
    with pytest.raises(UserError, match=message):
        read_toml(tmp_path / "a.toml", "a card")
