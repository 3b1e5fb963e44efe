"""A first model file after a pattern."""

from __future__ import annotations

import keyword
import re
from pathlib import Path

from greybox_torch.errors import ArgumentError, did_you_mean

PATTERNS = {
    "motor": "a motor and its load as one inertia, speed measured",
    "pendulum": "a driven pendulum, angle measured",
    "two_mass": "a motor and a load on a flexible shaft, motor speed measured",
    "tank": "a tank with an outlet, level measured",
    "thermal": "a heated body, temperature measured",
}
"""The patterns by name, with what each is."""

_TEMPLATES = Path(__file__).parent / "templates"


def class_name(name: str) -> str:
    """The class for a file called ``name``: "my_motor" gives MyMotor.

    Raises ArgumentError where that is no name in Python.
    """
    stem = name.removesuffix(".py")
    made = "".join(word[:1].upper() + word[1:] for word in re.split(r"[_\-]+", stem))
    if not made.isidentifier() or keyword.iskeyword(made):
        raise ArgumentError(
            "name", name, "expected letters, digits, hyphens and underscores, beginning with a letter, such as my_motor"
        )
    return made


def model_text(name: str, like: str, file: str) -> str:
    """The text of a model file with the class ``name`` after the pattern ``like``; ``file`` is what its own text calls the file.

    Raises ArgumentError for an unknown pattern.
    """
    if like not in PATTERNS:
        raise ArgumentError("like", like, f"expected one of {', '.join(PATTERNS)}{did_you_mean(str(like), PATTERNS)}")
    text = (_TEMPLATES / f"{like}.py.txt").read_text(encoding="utf-8")
    return text.replace("{{ name }}", name).replace("{{ file }}", file)
