"""From C++ source to a loaded library, kept between processes in the user's cache folder."""

from __future__ import annotations

import ctypes
import hashlib
import importlib.util
import os
import shlex
import shutil
import stat
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path

from greybox_torch.codegen.cache import cache_folder, prune, used
from greybox_torch.errors import UserError

FLAGS = (
    "-O1",
    "-march=native",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-ftree-vectorize",
    "-fPIC",
    "-shared",
    "-std=c++17",
)
"""Optimised no further than to -O1: the code is straight, unrolled and vectorised as it is emitted, and runs no faster with -O2, which
takes half as long again to compile. A diagnosis compiles some dozens of programs where none is in the cache."""


COMPILER_SECONDS = 300
"""The largest programs take 10 s, and the package ziglang as much as 50 s the first time."""

ROOM = 1_000_000
"""Bytes that the compiler needs."""

TRIAL = 'extern "C" int works() { return 1; }\n'
"""What a compiler is tried with."""

ZIG = (sys.executable, "-m", "ziglang", "c++")
"""The compiler that comes as a Python package."""


def compiler() -> tuple[str, ...] | None:
    """How the C++ compiler is called: ``$CXX`` (perhaps with options, as in "g++ -m64"), else g++, else clang++, else that of ziglang.

    None where there is none of them, or with ``GREYBOX_COMPILER=off``.
    """
    if os.environ.get("GREYBOX_COMPILER", "") == "off":
        return None
    for words in (_words(os.environ.get("CXX", "")), ["g++"], ["clang++"]):
        found = shutil.which(words[0]) if words else None
        if found is not None:
            return (found, *words[1:])
    return ZIG if importlib.util.find_spec("ziglang") is not None else None


def _words(command: str) -> list[str]:
    try:
        return shlex.split(command)
    except ValueError:  # a quotation mark that is not closed
        return []


def check_compiler(what: str) -> None:
    """Raises UserError where there is no compiler for ``what``, which would take hours without, or one that does not work."""
    program = compiler()
    if program is not None and library(TRIAL) is None:
        raise UserError(
            f"{what} needs a C++ compiler: `{shlex.join(program)}` makes no library that can be loaded; "
            "expected one that works, named by $CXX"
        )
    if program is None:
        off = "; GREYBOX_COMPILER is off" if os.environ.get("GREYBOX_COMPILER", "") == "off" else ""
        raise UserError(
            f"{what} needs a C++ compiler: found neither $CXX nor g++ nor clang++ nor the package ziglang{off}; "
            "expected one of them: pip install 'greybox_torch[compiler]'"
        )


@lru_cache(maxsize=256)
def library(source: str) -> ctypes.CDLL | None:
    """The library compiled from ``source``, from the cache where it is there; None where no compiler works."""
    program = compiler()
    if program is None:
        return None
    folder = cache_folder()
    _check_own(folder)
    key = hashlib.sha256("\0".join([source, *program, *FLAGS, _processor()]).encode()).hexdigest()[:32]
    file = folder / f"{key}.so"
    if _is_own(file):
        used(file)
    elif not _compiled(program, source, file):
        return None
    try:
        return ctypes.CDLL(str(file))
    except OSError:
        file.unlink(missing_ok=True)
        return ctypes.CDLL(str(file)) if _compiled(program, source, file) else None


def _check_own(folder: Path) -> None:
    """Makes the cache folder, for this user alone. Raises UserError where others could put a library there, which would then be run."""
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    except OSError as error:
        raise UserError(_no_room(folder, error.strerror or str(error))) from error
    if not _is_own(folder):
        raise UserError(
            f"{folder}: compiled code is kept there, and other users may write to it; "
            "expected a folder of your own, named by $GREYBOX_CACHE"
        )


def _is_own(path: Path) -> bool:
    """Whether it is there, belongs to this user or to the system, and not everybody may write to it."""
    try:
        found = path.stat()
    except OSError:
        return False
    return os.name != "posix" or (found.st_uid in (os.getuid(), 0) and not found.st_mode & stat.S_IWOTH)


def _compiled(program: tuple[str, ...], source: str, file: Path) -> bool:
    """Whether ``file`` has been made. Raises UserError where there is no room for it."""
    try:
        made = _compile(program, source, file)
    except OSError as error:
        raise UserError(_no_room(file.parent, error.strerror or str(error))) from error
    if not made and shutil.disk_usage(file.parent).free < ROOM:
        raise UserError(_no_room(file.parent, "the disk is full"))
    _prune_once(file.parent)
    return made


def _no_room(folder: Path, why: str) -> str:
    return f"{folder}: compiled code cannot be kept there: {why}; expected a folder with some room, named by $GREYBOX_CACHE"


@lru_cache(maxsize=8)
def _prune_once(folder: Path) -> None:
    """Once a process that compiles something: listing the folder takes as long as a tenth of a compilation."""
    prune(folder)


def _compile(program: tuple[str, ...], source: str, file: Path) -> bool:
    """Compile with vector mathematics and threads where they are to be had, plainer where they are not (ziglang has neither)."""
    with tempfile.TemporaryDirectory(dir=file.parent) as folder:
        text = Path(folder) / "stepper.cpp"
        text.write_text(source)
        made = Path(folder) / "stepper.so"
        for extra in [[]] if program == ZIG else (["-DVECTOR_MATH", "-fopenmp"], ["-fopenmp"], []):
            libraries = ["-lmvec", "-lm"] if "-DVECTOR_MATH" in extra else ["-lm"]
            command = [*program, *FLAGS, *extra, str(text), "-o", str(made), *libraries]
            try:
                done = subprocess.run(
                    command, capture_output=True, check=False, timeout=COMPILER_SECONDS, stdin=subprocess.DEVNULL
                )
            except subprocess.TimeoutExpired:
                raise UserError(
                    f"the C++ compiler `{shlex.join(program)}` did not end within {COMPILER_SECONDS} s; "
                    "expected one that works, named by $CXX"
                ) from None
            except OSError:  # named as a program, and of another system
                return False
            if done.returncode == 0 and _loads(made):
                made.chmod(0o700)
                made.replace(file)
                return True
    return False


def _loads(file: Path) -> bool:
    try:
        ctypes.CDLL(str(file))
    except OSError:
        return False
    return True


@lru_cache(maxsize=1)
def _processor() -> str:
    """What the machine code depends on, since a home folder may be shared between machines."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return "unknown"
    return next((line for line in lines if line.startswith(("flags", "Features"))), "unknown")
