"""FMUs for co-simulation, of FMI 2.0 and 3.0: sources, and a binary for this platform."""

from __future__ import annotations

import hashlib
import io
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

from greybox_torch.errors import UserError
from greybox_torch.exporting.c_delays import delay_places
from greybox_torch.exporting.c_source import c_files, comment
from greybox_torch.exporting.exported import ExportedModel
from greybox_torch.exporting.fill import filled
from greybox_torch.exporting.fmi_description import build_description, description_2, description_3
from greybox_torch.exporting.fmi_variables import FmiVariable, fmi_variables

_FLAGS = ["-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden"]
_SUFFIXES = {"linux": "so", "darwin": "dylib", "win32": "dll"}
_DATE = (1980, 1, 1, 0, 0, 0)
"""Of every member, so that the same model gives the same file."""


def fmu_files(model: ExportedModel) -> dict[str, bytes]:
    """The contents by file name: NAME_fmi2.fmu and NAME_fmi3.fmu.

    Raises:
        UserError: there is no C compiler, or a platform whose name FMI does not know.
    """
    variables = fmi_variables(model)
    return {f"{model.identifier}_fmi{edition}.fmu": _fmu(model, variables, edition) for edition in (2, 3)}


def _fmu(model: ExportedModel, variables: list[FmiVariable], edition: int) -> bytes:
    common = {name: text for name, text in c_files(model).items() if name != "example.c"}
    token = _token(model, common, edition)
    places = _places(model, variables, token)
    sources = {
        **common,
        "instance.h": filled("instance.h", places),
        f"fmi{edition}.c": filled(f"fmi{edition}.c", places),
    }
    compiled = [name for name in sources if name.endswith(".c")]
    members: dict[str, bytes] = {f"sources/{name}": text.encode() for name, text in sources.items()}
    if edition == 2:
        members["modelDescription.xml"] = description_2(model, variables, token, compiled)
    else:
        members["modelDescription.xml"] = description_3(model, variables, token)
        members["sources/buildDescription.xml"] = build_description(model, compiled)
    suffix = _SUFFIXES.get(sys.platform, "so")
    members[f"binaries/{_platform(edition)}/{model.identifier}.{suffix}"] = _compiled(sources, compiled)
    return _zipped(members)


def _places(model: ExportedModel, variables: list[FmiVariable], token: str) -> dict[str, object]:
    reals = [k for k, p in enumerate(model.parameters) if not p.is_switch]
    switches = [k for k, p in enumerate(model.parameters) if p.is_switch]
    return {
        **delay_places(model),
        "name": model.identifier,
        "NAME": model.identifier.upper(),
        "TITLE": comment(model.title),
        "TOKEN": token,
        "NX": len(model.states),
        "NU": len(model.inputs),
        "NY": len(model.outputs),
        "REALS": len(reals),
        "SWITCHES": len(switches),
        "RATE_COUNT": sum(v.kind == "rate" for v in variables),
        "ROOM_U": max(len(model.inputs) + len(model.delays), 1),
        "ROOM_P": max(len(model.parameters), 1),
        "REAL_INDICES": ", ".join(map(str, reals)) or "0",
        "SWITCH_INDICES": ", ".join(map(str, switches)) or "0",
        "TIME_REFERENCE": len(variables),
    }


def _token(model: ExportedModel, sources: Mapping[str, str], edition: int) -> str:
    """What says that description and binary belong together: in the form of a GUID, from what they are made of."""
    digest = hashlib.sha256(repr((edition, model.title, sorted(sources.items()))).encode()).hexdigest()
    return "{" + "-".join((digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])) + "}"


def _platform(edition: int) -> str:
    """The folder of binaries for this machine, as the edition of FMI calls it."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
    system = {"linux": "linux", "darwin": "darwin", "win32": "windows"}.get(sys.platform)
    if system is None:
        raise UserError(f"this machine ({sys.platform}) has no name in FMI; expected Linux, macOS or Windows")
    if edition == 3:
        return f"{machine}-{system}"
    return {"linux": "linux64", "darwin": "darwin64", "windows": "win64"}[system]


def _compiled(sources: Mapping[str, str], compiled: list[str]) -> bytes:
    program = shutil.which(os.environ.get("CC", "gcc")) or shutil.which("cc") or shutil.which("clang")
    if program is None:
        raise UserError("no C compiler is here to make the FMU's binary; expected gcc, cc or clang, or $CC")
    with tempfile.TemporaryDirectory() as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        command = [program, *_FLAGS, *compiled, "-lm", "-o", "binary"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise UserError(
                f"{program} cannot compile the FMU: {done.stderr.strip()[:500]}; expected a C compiler for C99"
            )
        return (Path(folder) / "binary").read_bytes()


def _zipped(members: Mapping[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name, _DATE), content, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
