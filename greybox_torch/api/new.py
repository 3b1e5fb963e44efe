"""A first model file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from sysconfig import get_path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.drafted_file import DraftedFile
from greybox_torch.drafting.pattern import PATTERNS, class_name, model_text
from greybox_torch.errors import ArgumentError, Kind
from greybox_torch.keywords import names_checked
from greybox_torch.report import notebook

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class NewModel(DraftedFile):
    """``text`` is the file, which belongs to ``path``; ``name`` the class in it, after the pattern ``like``."""

    name: str
    like: str
    text: str
    path: Path

    @property
    def reference(self) -> str:
        """How cards and commands name the model: "my_motor.py:MyMotor"."""
        return f"{self.path}:{self.name}"

    def __repr__(self) -> str:
        return f"<model {self.reference}: {PATTERNS[self.like]}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {"schema": "greybox-new/1", "file": str(self.path), "class": self.name, "like": self.like}

    def show(self, console: Console) -> None:
        console.print(Text(f"{self.reference}: {PATTERNS[self.like]}"), soft_wrap=True)

    def plot(self) -> Figure:
        """Which part of the model moves which output."""
        from greybox_torch.api.check import check

        return check(self.model_class()).plot()

    def model_class(self) -> Any:
        """The class, made from the text."""
        made: dict[str, Any] = {"__name__": f"greybox_new_{self.name}"}
        exec(compile(self.text, str(self.path), "exec"), made)
        return made[self.name]

    def _repr_html_(self) -> str:
        return notebook.page(repr(self)[1:-1], notebook.verbatim(self.text))


@names_checked
def new(name: str, *, like: str = "motor", path: str | PathLike[str] | None = None) -> NewModel:
    """Draft a commented model file to change into one's own; :meth:`NewModel.save` writes it.

    Args:
        name: of the file, such as "my_motor"; the class in it is called MyMotor.
        like: the machine that is most like yours: "motor", "pendulum", "two_mass", "tank" or "thermal".
        path: of the file; by default its name with .py, in the current folder.

    Raises:
        UserError: a name that Python cannot use or has already, or an unknown pattern.

    Examples:
        >>> new("my_tank", like="tank").name
        'MyTank'
    """
    if not isinstance(name, str):
        raise ArgumentError("name", Kind.of(name), "expected text, such as my_motor")
    made = class_name(name)
    place = Path(path) if path is not None else Path(f"{name.removesuffix('.py')}.py")
    if place.suffix != ".py":
        raise ArgumentError("path", str(place), "expected a file that ends in .py", option="out")
    if taken := _taken(place):
        raise ArgumentError("name", place.stem, f"{taken}; expected another name, such as my_{place.stem}")
    return NewModel(made, like, model_text(made, like, place.name), place)


def _taken(place: Path) -> str:
    """What else is called as the file, which Python would then take for it in that folder; "" where nothing is."""
    name = place.stem
    try:
        found = find_spec(name) if name.isidentifier() else None
    except (ImportError, ValueError):
        return ""
    if found is None or (found.origin is None and not _installed(found.submodule_search_locations or ())):
        return ""
    own = found.origin is not None and Path(found.origin).parent == place.absolute().parent
    return "" if own else f"is the name of an installed module, which {place.name} would hide"


def _installed(folders: Iterable[str]) -> bool:
    """Whether a package without a file of its own is; any folder beside the user's files is such a package as well."""
    places = {Path(get_path(kind)) for kind in ("purelib", "platlib", "stdlib")}
    return any(Path(folder).parent in places for folder in folders)
