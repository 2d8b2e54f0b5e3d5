"""Types of the module febiodea. What each is, with shapes and units, is in its docstring: help(febiodea.State)."""
from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Final, NamedTuple, overload

import numpy
import numpy.typing

Array = numpy.typing.NDArray[Any]
Path = str | PathLike[str]
Vector = Sequence[float] | Array
Poses = dict[str, Any] | Array | State

__version__: str

def read_feb(path: Path) -> Model: ...
def recognise(model: Model | Path, settings: Settings | Path | None = None, **keywords: Any) -> Recognition: ...
def analyse(recognition: Recognition, states: str | float | Sequence[float] | None = None, *,
            times_from: Path | None = None, progress: Callable[[Progress], object] | None = None) -> Result: ...
def prepare(recognition: Recognition) -> Prepared: ...
def read_xplt(path: Path, *, partial: bool = False) -> PlotFile: ...
@overload
def picture(source: Result | PlotFile | Sequence[Result | PlotFile], path: None = None, *,
            labels: str | Sequence[str] | None = None, format: str | None = None,
            field: str = "contact pressure", surface: str = "", states: str | float | Sequence[float] = "last", smooth: bool = False,
            unrolled: bool = False, width: float | None = None, dpi: float = 200.0) -> bytes: ...
@overload
def picture(source: Result | PlotFile | Sequence[Result | PlotFile], path: Path, *,
            labels: str | Sequence[str] | None = None, format: str | None = None,
            field: str = "contact pressure", surface: str = "", states: str | float | Sequence[float] = "last", smooth: bool = False,
            unrolled: bool = False, width: float | None = None, dpi: float = 200.0) -> None: ...
def plot(source: Result | PlotFile, axes: Any = None, *, field: str = "contact pressure", surface: str = "",
         state: str | float = "last", smooth: bool = False, unrolled: bool = False) -> Any: ...
def distribution(values: Sequence[float] | Array, areas: Sequence[float] | Array, above: float = 0.0) -> dict[str, float]: ...
def percentile(values: Sequence[float] | Array, weights: Sequence[float] | Array, fraction: float) -> float: ...
def pattern_difference(a: Sequence[float] | Array, b: Sequence[float] | Array, areas: Sequence[float] | Array,
                       above: float = 0.0) -> dict[str, float]: ...
def read_study(path: Path, subjects: Any = None) -> StudyResults: ...
def settings_help() -> str: ...
def schema(name: str) -> dict[str, Any]: ...

class Finding(str):
    code: str
    severity: str
    place: str | None
    contact: str | None
    surface: str | None
    body: str | None
    time: float | None
    values: dict[str, Any]

class Settings:
    file: str | None
    keywords: dict[str, Any]
    def __init__(self, file: Path | None = None, **keywords: Any) -> None: ...
    def as_dict(self) -> dict[str, Any]: ...

class Model:
    files: Final[list[str]]
    version: Final[str]
    units: Final[str]
    points: Final[Array]
    node_ids: Final[Array]
    cells: Final[Array]
    cell_types: Final[Array]
    cell_blocks: Final[list[tuple[str, Array]]]
    surfaces: Final[list[str]]
    materials: Final[list[str]]

class Recognition:
    model: Final[Model]
    bodies: Final[list[str]]
    contacts: Final[list[str]]
    solvable: Final[bool]
    faults: Final[list[InputError]]
    findings: Final[list[Finding]]
    settings: Final[dict[str, Any]]
    times: Final[list[float]]
    def info(self) -> dict[str, Any]: ...

class Result:
    recognition: Final[Recognition]
    states: Final[list[State]]
    solved: Final[bool]
    findings: Final[list[Finding]]
    def to_dict(self) -> dict[str, Any]: ...
    def to_json(self) -> str: ...
    def facets_csv(self) -> str: ...
    def table(self) -> list[dict[str, Any]]: ...
    def to_pandas(self) -> Any: ...
    def write_xplt(self, path: Path, *, compress: bool = False, overwrite: bool = False) -> None: ...
    def write_vtu(self, folder: Path) -> None: ...
    def report(self, path: Path) -> None: ...
    def to_xarray(self) -> Any: ...
    def to_meshio(self, state: int = -1) -> Any: ...
    def to_pyvista(self, state: int = -1) -> Any: ...
    @overload
    def __getitem__(self, key: int) -> State: ...
    @overload
    def __getitem__(self, key: str) -> Contact: ...
    def _repr_html_(self) -> str: ...

class State:
    time: Final[float]
    step: Final[int]
    outcome: Final[str]
    solved: Final[bool]
    message: Final[str]
    iterations: Final[int]
    poses: Final[dict[str, Array]]
    reactions: Final[dict[str, tuple[Array, Array]]]
    displacements: Final[Array]
    inside: Final[list[dict[str, Any]]]
    statistics: Final[dict[str, Any]]
    layers: Final[list[dict[str, Any]]]
    parts: Final[list[Part]]
    def part(self, name: str = "") -> Part: ...
    contacts: Final[list[Contact]]
    def contact(self, name: str = "") -> Contact: ...
    def __getitem__(self, name: str) -> Contact: ...
    def _repr_html_(self) -> str: ...

class Part:
    name: Final[str]
    index: Final[Array]
    displacements: Final[Array]
    element: Final[Array]
    stress: Final[Array]
    strain: Final[Array]
    statistics: Final[dict[str, Any]]

class Contact:
    name: Final[str]
    source: Final[Side]
    target: Final[Side]
    springs: Final[Springs]
    facets: Final[Facets]
    nodes: Final[Nodes]
    headline: Final[Headline]
    compartments: Final[list[Compartment]]
    force: Final[Array]
    moment: Final[Array]
    center_of_pressure: Final[Array]
    statistics: Final[dict[str, Any]]
    def _repr_html_(self) -> str: ...

class Side:
    body: Final[str]
    surface: Final[str]
    facets: Final[Facets]
    nodes: Final[Nodes]
    force: Final[Array]

class Springs:
    pressure: Final[Array]
    area: Final[Array]
    strain: Final[Array]
    strain_source: Final[Array]
    strain_target: Final[Array]
    overlap: Final[Array]
    gap: Final[Array]
    coverage: Final[Array]
    foot: Final[Array]
    direction: Final[Array]
    end: Final[Array]
    thickness_source: Final[Array]
    thickness_target: Final[Array]
    too_deep: Final[Array]
    def __len__(self) -> int: ...

class Facets:
    pressure: Final[Array]
    joint_space: Final[Array]
    overlap: Final[Array]
    strain: Final[Array]
    bone_max_shear_stress: Final[Array | None]
    bone_first_principal_strain: Final[Array | None]
    bone_third_principal_strain: Final[Array | None]
    surface_max_shear_stress: Final[Array | None]
    surface_first_principal_strain: Final[Array | None]
    surface_third_principal_strain: Final[Array | None]
    area: Final[Array]
    center: Final[Array]
    nodes: Final[Array]
    def __len__(self) -> int: ...

class Nodes:
    index: Final[Array]
    point: Final[Array]
    triangles: Final[Array]
    area: Final[Array]
    pressure: Final[Array]
    thickness: Final[Array]
    shortening: Final[Array]
    strain: Final[Array]
    def __len__(self) -> int: ...

class Compartment:
    name: Final[str]
    headline: Final[Headline]
    force: Final[Array]
    center_of_pressure: Final[Array]

class Headline(NamedTuple):
    p99: float
    mean: float
    area: float
    peak: float
    above: float

class Study:
    def __init__(self, models: Path | Sequence[Path] = (), vary: dict[str, str] | Sequence[tuple[str | None, str]] = (), *,
                 cases: Any = None, sample: tuple[str, int] | tuple[str, int, int] | None = None,
                 states: str | float | Sequence[float] | None = None, settings: Settings | Path | None = None,
                 **keywords: Any) -> None: ...
    def __len__(self) -> int: ...
    factors: Final[list[str]]
    models: Final[list[str]]
    def case(self, number: int) -> dict[str, str]: ...
    def run(self, path: Path, client: Any = None, workers: int | None = None, keep: str | Sequence[str] = (),
            again: str | None = None, *, overwrite: bool = False, shard: str | None = None,
            progress: Callable[[Progress], object] | None = None) -> StudyResults: ...
    def _repr_html_(self) -> str: ...

class StudyResults:
    def __init__(self, path: Path, subjects: Any = None) -> None: ...
    path: Final[str]
    version: Final[str]
    options: Final[list[str]]
    inputs: Final[list[tuple[str, str]]]
    models: Final[list[str]]
    factors: Final[list[Factor]]
    planned: Final[int]
    shard: Final[tuple[int, int]]
    counts: Final[dict[str, int]]
    def table(self, name: str = "results") -> list[dict[str, Any]]: ...
    def to_pandas(self, name: str = "results") -> Any: ...
    def to_xarray(self) -> Any: ...
    def _repr_html_(self) -> str: ...
    def parts(self) -> Any: ...
    def failed(self) -> list[dict[str, Any]]: ...
    def state(self, case: int, state: int | None = None) -> StudyState: ...
    def fields(self, case: int, state: int | None = None, contact: str | None = None) -> Array: ...
    def surface(self, case: int, contact: str | None = None) -> StudySurface: ...
    def outputs(self, number: str = "p99", place: str | None = None, state: int | str = "largest") -> tuple[Array, Array]: ...
    def influence(self, number: str = "p99", place: str | None = None, state: int | str = "largest") -> dict[str, Any]: ...
    def groups(self, column: str, number: str = "p99", place: str | None = None, state: int | str = "largest") -> dict[str, Any]: ...
    def pairs(self, column: str, number: str = "p99", place: str | None = None, state: int | str = "largest", *,
              by: str | None = None) -> dict[str, Any]: ...
    def report(self, path: Path, *, group: str | None = None, pair: str | None = None, pair_by: str | None = None,
               regions: str | int | None = None,
               up: Sequence[float] | None = None, anterior: Sequence[float] | None = None, axis: Sequence[float] | None = None,
               center: Sequence[float] | None = None, dose_above: float | None = None, cycles_per_year: float | None = None,
               years: float | None = None, cycle_seconds: float | None = None) -> list[str]: ...

class StudyState(NamedTuple):
    case: int
    state: int
    time: float
    outcome: str
    message: str
    iterations: int
    residual_force: float
    residual_moment: float
    contacts: dict[str, dict[str, Any]]
    bodies: dict[str, dict[str, Array]]

class StudySurface(NamedTuple):
    name: str
    vertices: Array
    triangles: Array

class Factor(NamedTuple):
    name: str
    option: str
    text: str
    spread: str | None
    a: float | None
    b: float | None

class Prepared:
    recognition: Final[Recognition]
    bodies: Final[list[str]]
    contacts: Final[list[str]]
    def press(self, pose: Poses | None = None) -> Pressed: ...
    def solve(self, body: str | None = None, force: Vector | None = None, moment: Vector | None = None,
              about: Vector | str | None = None, rotate: Any = None, move: Any = None,
              placements: Any = None, rotate_about: dict[str, Any] | None = None, free: dict[str, Any] | None = None,
              start: State | Poses | None = None, progress: Callable[[Progress], object] | None = None) -> State: ...

class Pressed:
    def contact(self, name: str = "") -> PressedContact: ...
    contacts: Final[list[PressedContact]]
    on_body: Final[dict[str, tuple[Array, Array]]]
    poses: Final[dict[str, Array]]

class PressedContact:
    name: Final[str]
    springs: Final[Springs]
    force: Final[Array]
    moment: Final[Array]
    force_on_source: Final[Array]
    moment_on_source: Final[Array]
    derivative: Final[Array]
    stiffness: Final[Array]
    normal_force: Final[float]
    headline: Final[Headline]

class PlotFile:
    path: Final[str]
    software: Final[str]
    units: Final[str]
    compressed: Final[bool]
    truncated: Final[bool]
    states: Final[list[PlotState]]
    def state(self, time: float) -> PlotState: ...
    def to_xarray(self) -> Any: ...
    def to_meshio(self, state: int = -1) -> Any: ...
    def to_pyvista(self, state: int = -1) -> Any: ...

class PlotState:
    time: Final[float]
    points: Final[Array]
    node_ids: Final[Array]
    cells: Final[Array]
    cell_types: Final[Array]
    cell_blocks: Final[list[tuple[str, Array]]]
    domains: Final[list[str]]
    domain_sizes: Final[list[int]]
    surfaces: Final[list[str]]
    node_sets: Final[dict[str, Array]]
    fields: Final[list[PlotField]]
    def surface(self, name: str) -> PlotSurface: ...
    def nodal(self, field: str) -> Array: ...

class PlotSurface:
    name: Final[str]
    facets: Final[Array]
    cells: Final[Array]
    cell_types: Final[Array]
    cell_blocks: Final[list[tuple[str, Array]]]
    points: Final[Array]
    triangles: Final[Array]
    facet_areas: Final[Array]
    nodal_areas: Final[Array]
    fields: Final[list[PlotField]]
    def facet(self, field: str) -> Array: ...
    def nodal(self, field: str) -> Array: ...
    def headline(self, field: str = "contact pressure") -> Headline: ...
    def distribution(self, field: str = "contact pressure", above: float = 0.0, nodal: bool = True) -> dict[str, float]: ...
    def resultant(self, field: str = "contact pressure") -> Array: ...
    def center_of_pressure(self, field: str = "contact pressure") -> Array: ...
    def carry_from(self, other: PlotSurface, values: Sequence[float] | Array) -> Array: ...

class PlotField:
    name: Final[str]
    group: Final[str]
    type: Final[str]
    format: Final[str]
    units: Final[str]
    region: Final[str]
    values: Final[Array]

class Progress:
    stage: Final[str]
    state: Final[int]
    states: Final[int]
    iterations: Final[int]
    residual: Final[float]
    outcome: Final[str]
    time: Final[float]

class Error(Exception):
    place: str
    found: str
    expected: str
    remedy: tuple[str, ...]
    others: tuple[Error, ...]

class InputError(Error, ValueError): ...

class UsageError(Error, ValueError): ...

class WriteError(Error): ...
