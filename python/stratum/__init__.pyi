# Types of stratum; tests/python/stub_test.py compares them with the module.
from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Path = Union[str, PathLike[str]]
_Point = Sequence[float]
_Box = ArrayLike
_Progress = Callable[[float], Any]
_Corners = tuple[tuple[float, float, float], tuple[float, float, float]]

__version__: str
features: tuple[str, ...]
bead_dtype: np.dtype[np.void]
run_dtype: np.dtype[np.void]
arc_dtype: np.dtype[np.void]
timing_dtype: np.dtype[np.void]
travel_dtype: np.dtype[np.void]
flow_dtype: np.dtype[np.void]

class InputError(RuntimeError): ...
class UsageError(ValueError): ...
class OutputError(OSError): ...

class Block(NamedTuple):
    values: NDArray[np.float32]
    origin: tuple[float, float, float]
    voxel_size: float

class Hits(NamedTuple):
    t: NDArray[np.float64]
    hit: NDArray[np.bool_]
    positions: NDArray[np.float64]
    normals: NDArray[np.float64]
    attributes: dict[str, NDArray[Any]]

class Mesh(NamedTuple):
    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    colors: NDArray[np.uint8] | None

class Toolpath:
    @property
    def beads(self) -> NDArray[np.void]: ...
    @property
    def runs(self) -> NDArray[np.void]: ...
    @property
    def arcs(self) -> NDArray[np.void]: ...
    @property
    def timing(self) -> NDArray[np.void] | None: ...
    @property
    def travels(self) -> NDArray[np.void] | None: ...
    @property
    def flow(self) -> NDArray[np.void] | None: ...
    @property
    def objects(self) -> list[str]: ...
    @property
    def slicer(self) -> str: ...
    @property
    def firmware(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def filament_diameter(self) -> float: ...
    @property
    def layer_height(self) -> float: ...
    @property
    def layer_count(self) -> int: ...
    @property
    def belt_angle(self) -> float: ...
    @property
    def extrusion_rule(self) -> str: ...
    @property
    def cut_short(self) -> str: ...
    @property
    def filament_mm(self) -> float: ...
    @property
    def prime_mm(self) -> float: ...
    @property
    def primed_mm(self) -> float: ...
    @property
    def extruded_mm3(self) -> float: ...
    @property
    def warnings(self) -> list[dict[str, Any]]: ...
    @property
    def stated(self) -> dict[str, Any]: ...
    @property
    def times(self) -> dict[str, Any] | None: ...
    @property
    def source(self) -> str: ...
    def bead_layers(self) -> NDArray[np.uint32]: ...
    def bead_features(self) -> NDArray[np.uint8]: ...
    def bead_tools(self) -> NDArray[np.uint8]: ...
    def bead_objects(self) -> NDArray[np.uint16]: ...
    def bead_lines(self) -> NDArray[np.uint32]: ...
    def bead_lengths(self) -> NDArray[np.float64]: ...
    def bead_volumes(self) -> NDArray[np.float64]: ...
    def summary(self) -> str: ...
    def select(
        self, *, layers: str | None = ..., features: str | Sequence[str] | None = ...,
        objects: str | Sequence[str] | None = ..., tools: int | Sequence[int] | None = ...,
    ) -> NDArray[np.uint32]: ...
    def replace(
        self, *, beads: NDArray[np.void] | None = ..., runs: NDArray[np.void] | None = ...,
        arcs: NDArray[np.void] | None = ..., objects: Sequence[str] | None = ...,
    ) -> Toolpath: ...
    def __len__(self) -> int: ...
    def __getstate__(self) -> bytes: ...
    def __setstate__(self, state: bytes) -> None: ...

class LevelSet:
    @staticmethod
    def read(path: _Path, grid: str = ..., attributes: Sequence[str] = ...) -> LevelSet: ...
    def write(
        self, path: _Path, *, precision: Literal["float", "half"] | None = ...,
        compression: Literal["blosc", "zip", "none"] | None = ..., overwrite: bool | None = ...,
    ) -> None: ...
    def mesh(self, *, mesh_error: float = ..., outside_only: bool = ...) -> Mesh: ...
    def dense(self, box: _Box | None = ...) -> Block: ...
    def sample(self, points: ArrayLike, *, progress: _Progress | None = ...) -> NDArray[np.float32]: ...
    def attribute(self, name: str, points: ArrayLike) -> NDArray[Any]: ...
    @property
    def attributes(self) -> list[str]: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def background(self) -> float: ...
    @property
    def active_voxels(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    @property
    def bounds(self) -> _Corners: ...
    @property
    def transform(self) -> NDArray[np.float64]: ...
    @property
    def metadata(self) -> dict[str, Any]: ...

class PrintField:
    def __init__(
        self, toolpath: Toolpath, *, voxel_size: float | None = ..., voxels_per_layer: int | None = ...,
        tolerance: float | None = ..., memory_budget: str | None = ..., half_width: float | None = ...,
        layers: str | None = ..., features: str | Sequence[str] | None = ...,
        objects: str | Sequence[str] | None = ..., tools: int | Sequence[int] | None = ...,
    ) -> None: ...
    def distance(self, points: ArrayLike, *, progress: _Progress | None = ...) -> NDArray[np.float64]: ...
    def attribute(self, name: str, points: ArrayLike) -> NDArray[Any]: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def reach(self) -> float: ...

class Intersector:
    def __init__(
        self, source: PrintField | LevelSet | _Path, attributes: Sequence[str] = ..., *,
        smooth_normals: bool | None = ..., brick_values: Literal["int16", "float"] | None = ...,
        grid: str | None = ...,
    ) -> None: ...
    def trace(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float = ..., t_max: float = ...,
        progress: _Progress | None = ...,
    ) -> Hits: ...
    def occluded(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float = ..., t_max: float = ...,
        progress: _Progress | None = ...,
    ) -> NDArray[np.bool_]: ...
    @property
    def bounds(self) -> _Corners: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def surface_offset(self) -> float: ...
    @property
    def bytes(self) -> int: ...

class Picture:
    @property
    def linear(self) -> NDArray[np.float32]: ...
    @property
    def alpha(self) -> NDArray[np.float32]: ...
    @property
    def srgb(self) -> NDArray[np.uint8]: ...
    @property
    def layers(self) -> dict[str, NDArray[np.float32]]: ...
    @property
    def exposure(self) -> float: ...
    @property
    def metadata(self) -> dict[str, str]: ...
    @property
    def rays(self) -> int: ...
    @property
    def samples_per_pixel(self) -> float: ...
    @property
    def camera(self) -> dict[str, Any]: ...
    def write(self, path: _Path, *, overwrite: bool = ...) -> None: ...

def read(
    source: _Path | bytes | bytearray, *, timed: bool | None = ..., travels: bool | None = ..., progress: _Progress | None = ...,
    plate: int | None = ..., filament_diameter: float | Sequence[float] | None = ...,
    filament_colors: str | Sequence[str] | None = ..., tool_offsets: str | None = ...,
    layer_height: float | None = ..., belt: float | None = ..., planar: bool | None = ...,
    e_mode: Literal["auto", "absolute", "relative"] | None = ...,
    firmware: Literal["auto", "marlin", "klipper", "reprap"] | None = ...,
    planner: Literal[
        "auto", "jerk", "slicer-jerk", "plan-jerk", "junction-deviation", "corner-velocity", "marlin-jerk", "reprap-jerk",
        "programmed", "bambu-jerk"
    ] | None = ...,
    printer: str | PathLike[str] | None = ..., beads: Literal["capsule", "grooves", "settled"] | None = ...,
    section: str | None = ..., flow: float | None = ..., flow_lag: float | None = ...,
    pressure_advance: float | None = ..., sag: float | None = ..., crown: float | None = ..., strings: bool | None = ...,
) -> Toolpath: ...
def make_toolpath(
    beads: NDArray[np.void], runs: NDArray[np.void], arcs: NDArray[np.void] | None = ...,
    objects: Sequence[str] | None = ..., *, filament_diameter: float = ..., layer_height: float = ...,
) -> Toolpath: ...
def voxelize(
    toolpath: Toolpath, *, progress: _Progress | None = ..., voxel_size: float | None = ...,
    voxels_per_layer: int | None = ..., tolerance: float | None = ..., memory_budget: str | None = ...,
    half_width: float | None = ..., layers: str | None = ..., features: str | Sequence[str] | None = ...,
    objects: str | Sequence[str] | None = ..., tools: int | Sequence[int] | None = ...,
    interior: Literal["keep", "cull"] | None = ..., interior_distance: bool | None = ...,
    grids: str | Sequence[str] | None = ..., unit: Literal["mm", "cm", "m"] | None = ...,
    up: Literal["z", "y"] | None = ..., origin: Literal["bed", "center", "min"] | None = ...,
) -> LevelSet: ...
def report(
    toolpath: Toolpath, *, progress: _Progress | None = ..., density: float | None = ..., price: float | None = ...,
    voxel_size: float | None = ..., voxels_per_layer: int | None = ..., tolerance: float | None = ...,
    memory_budget: str | None = ..., half_width: float | None = ..., layers: str | None = ...,
    features: str | Sequence[str] | None = ..., objects: str | Sequence[str] | None = ...,
    tools: int | Sequence[int] | None = ..., interior: Literal["keep", "cull"] | None = ...,
    interior_distance: bool | None = ..., grids: str | Sequence[str] | None = ...,
    unit: Literal["mm", "cm", "m"] | None = ..., up: Literal["z", "y"] | None = ...,
    origin: Literal["bed", "center", "min"] | None = ...,
) -> dict[str, Any]: ...
def compare(
    toolpath: Toolpath, model: _Path, *, progress: _Progress | None = ..., at: Literal["fit", "bed"] | None = ...,
    voxel_size: float | None = ..., voxels_per_layer: int | None = ..., tolerance: float | None = ...,
    memory_budget: str | None = ..., half_width: float | None = ..., layers: str | None = ...,
    features: str | Sequence[str] | None = ..., objects: str | Sequence[str] | None = ...,
    tools: int | Sequence[int] | None = ...,
) -> dict[str, Any]: ...
def voxelize_block(
    toolpath: Toolpath, box: _Box | None = ..., *, progress: _Progress | None = ..., voxel_size: float | None = ...,
    voxels_per_layer: int | None = ..., tolerance: float | None = ..., memory_budget: str | None = ...,
    half_width: float | None = ..., layers: str | None = ..., features: str | Sequence[str] | None = ...,
    objects: str | Sequence[str] | None = ..., tools: int | Sequence[int] | None = ...,
) -> Block: ...
def write_vdb(
    toolpath: Toolpath, path: _Path, *, progress: _Progress | None = ..., voxel_size: float | None = ...,
    voxels_per_layer: int | None = ..., tolerance: float | None = ..., memory_budget: str | None = ...,
    half_width: float | None = ..., layers: str | None = ..., features: str | Sequence[str] | None = ...,
    objects: str | Sequence[str] | None = ..., tools: int | Sequence[int] | None = ...,
    interior: Literal["keep", "cull"] | None = ..., interior_distance: bool | None = ...,
    grids: str | Sequence[str] | None = ..., unit: Literal["mm", "cm", "m"] | None = ...,
    up: Literal["z", "y"] | None = ..., origin: Literal["bed", "center", "min"] | None = ...,
    precision: Literal["float", "half"] | None = ..., compression: Literal["blosc", "zip", "none"] | None = ...,
    overwrite: bool | None = ...,
) -> None: ...
def render(
    source: Toolpath | _Path, *, progress: _Progress | None = ..., size: tuple[int, int] | None = ...,
    spp: int | None = ..., noise: float | None = ..., seconds: float | None = ..., seed: int | None = ...,
    crop: tuple[int, int, int, int] | None = ..., aov: str | Sequence[str] | None = ..., denoise: bool | None = ...,
    exposure: float | None = ..., legend: bool | None = ...,
    view: Literal["iso", "front", "back", "left", "right", "top", "bottom"] | None = ..., eye: _Point | None = ...,
    look_at: _Point | None = ..., up: _Point | None = ..., fov: float | None = ..., f_number: float | None = ...,
    aperture: float | None = ..., focus: float | _Point | None = ..., frame: Literal["part", "all"] | None = ...,
    zoom: float | None = ..., integrator: str | None = ..., bounces: int | None = ...,
    exact_translucency: bool | None = ...,
    phong: Sequence[float] | None = ..., ao_distance: float | None = ...,
    brdf: str | PathLike[str] | None = ..., color: str | Sequence[str] | None = ..., color_by: str | None = ...,
    color_range: tuple[float, float] | None = ...,
    normals: Literal["geometric", "smooth"] | None = ..., env: str | PathLike[str] | None = ...,
    env_rotation: float | None = ..., env_exposure: float | None = ..., lights: str | Sequence[str] | None = ...,
    bed: bool | None = ..., bed_surface: Literal["paper", "pei", "grid"] | None = ...,
    background: Literal["scene", "none"] | None = ...,
    march: Literal["auto", "brick", "sphere", "vdb"] | None = ...,
    brick_values: Literal["int16", "float"] | None = ..., brick_cache: str | None = ...,
    clip: Sequence[float] | None = ..., grid: str | None = ..., file_up: Literal["z", "y"] | None = ...,
    printed: str | None = ..., plate: int | None = ..., filament_diameter: float | Sequence[float] | None = ...,
    filament_colors: str | Sequence[str] | None = ..., tool_offsets: str | None = ...,
    layer_height: float | None = ..., belt: float | None = ..., planar: bool | None = ...,
    e_mode: Literal["auto", "absolute", "relative"] | None = ...,
    firmware: Literal["auto", "marlin", "klipper", "reprap"] | None = ...,
    planner: Literal[
        "auto", "jerk", "slicer-jerk", "plan-jerk", "junction-deviation", "corner-velocity", "marlin-jerk", "reprap-jerk",
        "programmed", "bambu-jerk"
    ] | None = ...,
    printer: str | PathLike[str] | None = ..., beads: Literal["capsule", "grooves", "settled"] | None = ...,
    section: str | None = ..., flow: float | None = ..., flow_lag: float | None = ...,
    pressure_advance: float | None = ..., sag: float | None = ..., crown: float | None = ..., strings: bool | None = ...,
    voxel_size: float | Literal["auto"] | None = ..., voxels_per_layer: int | None = ...,
    tolerance: float | None = ..., memory_budget: str | None = ..., half_width: float | None = ...,
    layers: str | None = ..., features: str | Sequence[str] | None = ..., objects: str | Sequence[str] | None = ...,
    tools: int | Sequence[int] | None = ...,
) -> Picture: ...
def set_threads(count: int | None) -> None: ...
def threads() -> int: ...
