"""From C++ source to a loaded library, kept between processes in the user's cache folder."""

from __future__ import annotations

import ctypes
import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path

from greybox_torch.errors import UserError

FLAGS = (
    "-O2",
    "-march=native",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-ftree-vectorize",
    "-fPIC",
    "-shared",
    "-std=c++17",
)


ZIG = (sys.executable, "-m", "ziglang", "c++")
"""The compiler that comes as a Python package."""


def compiler() -> tuple[str, ...] | None:
    """How the C++ compiler is called: ``$CXX``, else g++, else clang++, else that of the package ziglang.

    None where there is none of them, or with ``GREYBOX_COMPILER=off``.
    """
    if os.environ.get("GREYBOX_COMPILER", "") == "off":
        return None
    for name in (os.environ.get("CXX", ""), "g++", "clang++"):
        found = shutil.which(name) if name else None
        if found is not None:
            return (found,)
    return ZIG if importlib.util.find_spec("ziglang") is not None else None


def check_compiler(what: str) -> None:
    """Raises UserError, with the line that installs one, where there is no compiler for ``what``, which would take hours without."""
    if compiler() is None:
        off = "; GREYBOX_COMPILER is off" if os.environ.get("GREYBOX_COMPILER", "") == "off" else ""
        raise UserError(
            f"{what} needs a C++ compiler: found neither $CXX nor g++ nor clang++ nor the package ziglang{off}; "
            "expected one of them: pip install 'greybox_torch[compiler]'"
        )


def cache_folder() -> Path:
    """Where compiled steppers are kept: ``$GREYBOX_CACHE``, else the user's cache folder."""
    default = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "greybox_torch"
    return Path(os.environ.get("GREYBOX_CACHE", default))


@lru_cache(maxsize=256)
def library(source: str) -> ctypes.CDLL | None:
    """The library compiled from ``source``, from the cache where it is there; None where no compiler works."""
    program = compiler()
    if program is None:
        return None
    key = hashlib.sha256("\0".join([source, *program, *FLAGS, _processor()]).encode()).hexdigest()[:32]
    file = cache_folder() / f"{key}.so"
    if not file.exists() and not _compile(program, source, file):
        return None
    try:
        return ctypes.CDLL(str(file))
    except OSError:
        file.unlink(missing_ok=True)
        return ctypes.CDLL(str(file)) if _compile(program, source, file) else None


def _compile(program: tuple[str, ...], source: str, file: Path) -> bool:
    """Compile with vector mathematics and threads where they are to be had, plainer where they are not (ziglang has neither)."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=file.parent) as folder:
        text = Path(folder) / "stepper.cpp"
        text.write_text(source)
        made = Path(folder) / "stepper.so"
        for extra in [[]] if program == ZIG else (["-DVECTOR_MATH", "-fopenmp"], ["-fopenmp"], []):
            libraries = ["-lmvec", "-lm"] if "-DVECTOR_MATH" in extra else ["-lm"]
            command = [*program, *FLAGS, *extra, str(text), "-o", str(made), *libraries]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode == 0 and _loads(made):
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
