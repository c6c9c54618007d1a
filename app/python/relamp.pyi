"""Relighting from photographs: solve a capture, edit its lights, render frames as NumPy arrays."""

from os import PathLike
from typing import Any, Callable, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray

Path = Union[str, "PathLike[str]"]
Look = dict[str, Any]
"""The edits document of docs/interface.md 3."""
Progress = Optional[Callable[[str, float], Any]]
"""Called with a label and a fraction about ten times a second; False stops the work."""
Floats = NDArray[numpy.float32]

__version__: str

class Error(RuntimeError):
    """Bad input or a failed file: the message names file and field."""

class Cancelled(RuntimeError):
    """A progress function returned False."""

class Frame:
    """A rendered frame. Arrays are read-only views of its memory, rows from the top, linear Rec.709."""

    @property
    def beauty(self) -> Floats: ...
    @property
    def alpha(self) -> Floats: ...
    @property
    def world(self) -> Floats: ...
    @property
    def lights(self) -> dict[str, Floats]: ...
    @property
    def albedo(self) -> Floats: ...
    @property
    def normal(self) -> Floats: ...
    @property
    def position(self) -> Floats: ...
    @property
    def depth(self) -> Floats: ...

class Shot:
    """What a solve found, with the edits of a look."""

    look: Look
    @property
    def folder(self) -> PathLike[str]: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def views(self) -> list[str]: ...
    @property
    def origin(self) -> tuple[float, float, float]: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def normals(self) -> Floats: ...
    @property
    def triangles(self) -> NDArray[numpy.uint32]: ...
    @property
    def albedo(self) -> Floats: ...
    @property
    def confidence(self) -> Floats: ...
    def render(
        self,
        camera: int = 0,
        *,
        pose: Optional[ArrayLike] = None,
        look: Optional[Look] = None,
        state: Optional[str] = None,
        samples: int = 8,
        seed: int = 1,
        denoise: bool = True,
        threads: int = 0,
        progress: Progress = None,
    ) -> Frame: ...
    def export(
        self,
        folder: Path,
        *,
        look: Optional[Look] = None,
        state: Optional[str] = None,
        overwrite: bool = False,
        progress: Progress = None,
    ) -> None: ...
    def save(self, folder: Optional[Path] = None, *, overwrite: bool = False) -> None: ...

def open(shot: Path, *, progress: Progress = None) -> Shot: ...
def solve(
    capture: Path,
    output: Path,
    *,
    quality: str = "standard",
    mode: str = "near-field",
    texture: Optional[int] = None,
    states: dict[str, str] = {},
    state_environments: dict[str, str] = {},
    files: dict[str, Any] = {},
    gauge: dict[str, Any] = {},
    references: dict[str, list[Any]] = {},
    time_budget: float = 0.0,
    seed: int = 1,
    threads: int = 0,
    overwrite: bool = False,
    progress: Progress = None,
) -> Shot: ...
