"""What is said of an argument by a name that a public function or class does not have: the name that is meant, and those that there are."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from functools import wraps
from importlib import import_module
from typing import ParamSpec, TypeVar

from greybox_torch.errors import ArgumentError, Kind, did_you_mean

MOST = 20
"""Names that a message lists at most."""

_UNEXPECTED = re.compile(r"(\w+)(?:\.__init__)?\(\) got an unexpected keyword argument '(\w+)'")
_SETTINGS: list[type] = []
"""Classes of settings, one of which may have the field that another is asked for."""

_Given = ParamSpec("_Given")
_Returned = TypeVar("_Returned")
_Class = TypeVar("_Class", bound=type)


def keyword_advice(error: BaseException) -> str:
    """What to go on with in a message about an error that code of a user raised, where it gave a public class such a name."""
    found = _UNEXPECTED.search(str(error)) if isinstance(error, TypeError) else None
    package = import_module(__name__.partition(".")[0])  # its public names are loaded on first use
    if found is None or found[1] not in package.__all__:
        return ""
    function, name = getattr(package, found[1]), found[2]
    if not isinstance(function, type):
        return ""  # a function of the user's own may have the name
    return f"{_meant(name, function)}; {_taken(function)}"


def names_checked(function: Callable[_Given, _Returned]) -> Callable[_Given, _Returned]:
    """The function, which says as an ArgumentError that it takes no argument of a name, with the near name, or that one is missing: of a
    TypeError of Python's no message is made.
    """

    @wraps(function)
    def called(*args: _Given.args, **kwargs: _Given.kwargs) -> _Returned:
        _check(function, function, kwargs)
        _check_none_missing(function, args, kwargs)
        return function(*args, **kwargs)

    return called


def fields_checked(settings: _Class) -> _Class:
    """The class, made to say the same of fields that it does not have."""
    made: Callable[..., None] = settings.__init__

    @wraps(made)
    def init(self: object, *args: object, **kwargs: object) -> None:
        _check(made, settings, kwargs)
        made(self, *args, **kwargs)

    settings.__init__ = init
    _SETTINGS.append(settings)
    return settings


def _check(function: Callable[..., object], called: Callable[..., object], given: dict[str, object]) -> None:
    known = inspect.signature(function).parameters
    if any(one.kind is inspect.Parameter.VAR_KEYWORD for one in known.values()):
        return
    for name, value in given.items():
        if name not in known:
            problem = f"{called.__name__}() takes no argument of this name{_meant(name, called)}; {_taken(called)}"
            raise ArgumentError(name, value, problem)


def _check_none_missing(function: Callable[..., object], args: tuple[object, ...], given: dict[str, object]) -> None:
    known = inspect.signature(function)
    try:
        there = known.bind_partial(*args, **given).arguments
    except TypeError:
        return  # more by position than it takes: Python says so
    variable = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    needed = [n for n, p in known.parameters.items() if n != "self" and p.default is p.empty and p.kind not in variable]
    for name in needed:
        if name not in there:
            problem = f"{function.__name__}() needs it, as in {function.__name__}({', '.join(needed)})"
            raise ArgumentError(name, Kind("nothing"), problem)


def _names(function: Callable[..., object]) -> list[str]:
    return [name for name in inspect.signature(function).parameters if name != "self"]


def _meant(name: str, function: Callable[..., object]) -> str:
    own = _names(function)
    elsewhere = {f: one.__name__ for one in _SETTINGS if function in _SETTINGS for f in _names(one) if f not in own}
    nearest = did_you_mean(name, [*own, *elsewhere])
    of_other = next((f"{one}({f}=…)" for f, one in elsewhere.items() if nearest == did_you_mean(f, [f])), "")
    return f" (did you mean {of_other}?)" if of_other else nearest


def _taken(function: Callable[..., object]) -> str:
    names = _names(function)
    return f"it takes {', '.join(names)}" if len(names) <= MOST else f"it takes {len(names)} others, which help() lists"
