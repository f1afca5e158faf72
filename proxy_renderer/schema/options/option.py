# SPDX-License-Identifier: Apache-2.0
"""A row of the table of options, and its property in Blender."""

from dataclasses import dataclass, field
from typing import Any, TypeVar

from ..limits import NUMBERS

T = TypeVar("T")

HEADINGS = {
    "task": "",
    "shots": "shots that share a look: each scene, through each camera, at each frame, and one set of values for all",
    "moments": "moments: a look at each of several frames, and keyframes from one to the next",
    "effort": "effort",
    "picture": "a reference image",
    "reach": "what may change",
    "engine": "engine",
    "render": "render",
}
"""Groups of options, in the order of the help, and their titles."""


@dataclass(frozen=True)
class Panel:
    """An option as a property in Blender."""

    title: str  # its label
    description: str  # its tooltip
    bounds: tuple[int, int] | None = None  # least and greatest number there, if not those of the option
    length: int = 0  # most characters of a text; 0 for any number
    default: str = ""  # of a text
    live: bool = False  # whether a text counts with every letter that is typed
    suggestions: tuple[str, ...] = ()  # texts to choose from; others can be typed
    path: bool = False  # whether a text is the path of a file
    preferences: bool = False  # whether it stands in the add-on's preferences, and not in the scene


@dataclass(frozen=True)
class Option:
    """A row of the table."""

    name: str  # in Python and in a manifest; on a command line with hyphens
    # its type is the option's. A bool that is True is turned off by --no-NAME; a tuple can be given several times
    default: int | str | bool | tuple[str, ...]
    help: str  # for the command line and the documents; the default of a number is added to it
    heading: str  # its group, a key of `HEADINGS`
    unit: str = "N"  # what a value is called in the help: N, NAME, DIR
    bounds: tuple[int, int] | None = None  # least and greatest number
    choices: tuple[str, ...] = ()  # all texts that there are; empty for any
    manifest: tuple[str, ...] = ("options",)  # tables of a manifest for it: "options", "scene", "shots"
    blender: bool = True  # whether Blender's side takes it on its command line
    panel: Panel | None = None  # how it looks in Blender; None if it is not there

    @property
    def flag(self) -> str:
        """Its name on a command line."""
        return f"--{'no-' if self.default is True else ''}{self.name.replace('_', '-')}"

    @property
    def command_default(self) -> Any:
        """Its value where a command line does not name it: None for a number that the effort decides."""
        if self.name in NUMBERS:
            return None
        return list(self.default) if isinstance(self.default, tuple) else self.default

    def text(self, default: Any) -> str:
        """Its help, with the default of a number; None for the effort's."""
        if type(self.default) is not int:
            return self.help
        shown = "the effort's" if default is None else default
        return f"{self.help} (default: {shown})"


def option(default: T, help: str, heading: str, **facts: Any) -> T:
    """A field of `Options` that is a row of the table."""
    return field(default=default, metadata={"option": Option("", default, help, heading, **facts)})  # type: ignore[arg-type]
