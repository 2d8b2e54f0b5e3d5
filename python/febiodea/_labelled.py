"""Results as xarray, meshio and pyvista have them. None of them is needed for anything else."""
import numpy

from ._errors import usage_fault

_AXES = ["x", "y", "z"]
_QUANTITIES = {"p99": "pressure", "mean": "pressure", "peak": "pressure", "area": "area", "pressure": "pressure",
               "joint_space": "length", "overlap": "length", "thickness": "length", "shortening": "length"}


def _needed(name, method):
    import importlib
    try:
        return importlib.import_module(name)
    except ImportError as missing:
        raise ImportError(f"{method} needs {name}, which is not installed") from missing


def _put(variables, name, dims, values, units=None):
    variables[name] = (dims, numpy.asarray(values), {"units": units} if units else {})


def _stacked(states, values):
    """Per state the values of all surfaces, one behind the other: (states, values) or (states, values, 3)."""
    return numpy.stack([numpy.concatenate(values(state)) for state in states])


def result_to_xarray(self):
    """The states as an xarray.Dataset, with dims state, contact, node, facet, body and axis. Needs xarray.

    p99, mean, area, peak and each other number of table(): (state, contact), under its name there. pressure, strain,
    shortening, thickness: (state, node), of both surfaces of all contacts, one behind the other; node_contact, node_surface
    and node_id say whose. facet_pressure, joint_space, overlap, facet_strain, facet_area: (state, facet), facet_contact and
    facet_surface. translation (state, body, axis) and rotation_matrix (state, body, axis, axis_of_body): the pose. Units in
    the attributes, where the model names them. Raises ImportError.
    """
    xarray = _needed("xarray", "to_xarray")
    units = self.to_dict()["unit_names"] or {}
    states = self.states
    sides = lambda state: [(c, side) for c in state.contacts for side in (c.source, c.target)]  # noqa: E731
    variables, coordinates = {}, {}
    contacts = [contact.name for contact in states[0].contacts] if states else []
    rows = self.table()
    for name in rows[0] if rows else ():
        values = [row[name] for row in rows]
        if name in ("time", "step", "outcome", "contact") or isinstance(values[0], str):
            continue
        plain = name.removeprefix("headline_")
        plain = plain if plain in ("p99", "mean", "area", "peak") else name
        _put(variables, plain, ("state", "contact"), numpy.reshape(values, (len(states), len(contacts))), units.get(_QUANTITIES.get(plain)))
    if states:
        ids = self.recognition.model.node_ids
        for name, attribute in (("pressure", "pressure"), ("strain", "strain"), ("shortening", "shortening"), ("thickness", "thickness")):
            _put(variables, name, ("state", "node"), _stacked(states, lambda s, a=attribute: [getattr(side.nodes, a) for _, side in sides(s)]),
                 units.get(_QUANTITIES.get(name)))
        for name, attribute in (("facet_pressure", "pressure"), ("joint_space", "joint_space"), ("overlap", "overlap"), ("facet_strain", "strain"), ("facet_area", "area")):
            _put(variables, name, ("state", "facet"), _stacked(states, lambda s, a=attribute: [getattr(side.facets, a) for _, side in sides(s)]),
                 units.get({"facet_pressure": "pressure", "facet_area": "area"}.get(name, _QUANTITIES.get(name))))
        first = sides(states[0])
        for dim, of in (("node", lambda side: len(side.nodes)), ("facet", lambda side: len(side.facets))):
            coordinates[f"{dim}_contact"] = (dim, numpy.concatenate([[c.name] * of(side) for c, side in first]))
            coordinates[f"{dim}_surface"] = (dim, numpy.concatenate([[side.surface] * of(side) for _, side in first]))
        coordinates["node_id"] = ("node", numpy.concatenate([ids[side.nodes.index] for _, side in first]))
        coordinates["point"] = (("node", "axis"), numpy.concatenate([side.nodes.point for _, side in first]), {"units": units["length"]} if "length" in units else {})
        bodies = list(states[0].poses)
        poses = numpy.array([[state.poses[body] for body in bodies] for state in states])
        _put(variables, "translation", ("state", "body", "axis"), poses[..., :3, 3], units.get("length"))
        _put(variables, "rotation_matrix", ("state", "body", "axis", "axis_of_body"), poses[..., :3, :3])
        coordinates |= {"body": bodies, "axis": _AXES, "axis_of_body": _AXES}
    coordinates |= {"contact": contacts, "time": ("state", [s.time for s in states]), "step": ("state", [s.step for s in states]),
                    "outcome": ("state", [s.outcome for s in states]), "solved": ("state", [s.solved for s in states])}
    return xarray.Dataset(variables, coordinates, {"program": "FEBioDEA", "model": self.recognition.model.files[0], "units": self.recognition.model.units})


_DIMS = {("nodal", "node"): "point", ("surface", "item"): "facet", ("domain", "item"): "element", ("surface", "region"): "surface",
         ("domain", "region"): "domain"}


def _places(fields):
    """Per dim of a region's items: where each region begins, in the order of the file, and how many there are."""
    lengths = {}
    for field in fields:
        dim = _DIMS.get((field.group, field.format))
        if dim:
            lengths.setdefault(dim, {}).setdefault(field.region, len(numpy.atleast_1d(field.values)))
    return lengths


def plot_file_to_xarray(self):
    """The states as an xarray.Dataset, with dims state, point (of all nodes), facet, surface, element and domain. Needs xarray.

    Fields keep their names. Those of facets and elements have all surfaces or domains one behind the other, as facet_surface and
    element_domain say, and NaN where one has no such field; numbers of a whole surface or domain are (state, surface) or
    (state, domain). Vectors have a last dim axis, symmetric tensors component: xx yy zz xy yz xz. Left out: fields that have
    values at each element's nodes, and of edges. Raises ImportError.
    """
    xarray = _needed("xarray", "to_xarray")
    variables, coordinates = {}, {"time": ("state", [s.time for s in self.states])}
    fields = self.states[0].fields if self.states else []
    lengths = _places(fields)
    for state, values in enumerate(self.states):
        for field in values.fields:
            dim = _DIMS.get((field.group, field.format))
            if not dim or field.region not in lengths.get(dim, {}):
                continue
            of = numpy.atleast_1d(field.values)
            name = field.name if variables.get(field.name, [(0, dim)])[0][1] == dim else f"{field.name} of {dim}s"
            if name not in variables:
                last = {1: (), 2: {3: ("axis",), 6: ("component",)}.get(of.shape[-1], (f"value of {name}",))}.get(of.ndim, (f"row of {name}", f"column of {name}"))
                whole = numpy.full((len(self.states), sum(lengths[dim].values()), *of.shape[1:]), numpy.nan)
                variables[name] = (("state", dim, *last), whole, {"units": field.units} if field.units else {})
            begin = 0
            for region, length in lengths[dim].items():
                if region == field.region and len(of) == length:
                    variables[name][1][state, begin:begin + length] = of
                begin += length
    for dim, regions in lengths.items():
        if dim in ("surface", "domain"):
            coordinates[dim] = list(regions)
        elif dim != "point":
            coordinates[f"{dim}_{ {'facet': 'surface', 'element': 'domain'}[dim] }"] = (dim, numpy.repeat(list(regions), list(regions.values())))
    if "point" in lengths:
        coordinates["node_id"] = ("point", self.states[0].node_ids)
    used = {dim for dims, *_ in variables.values() for dim in dims}
    coordinates |= {dim: labels for dim, labels in (("axis", _AXES), ("component", ["xx", "yy", "zz", "xy", "yz", "xz"])) if dim in used}
    return xarray.Dataset(variables, coordinates, {"program": self.software, "file": self.path, "units": self.units})


def _chosen(self, state):
    try:
        return self.states[state]
    except (IndexError, TypeError):
        raise usage_fault("state", f"found {state!r}", f"expected the index of one of {len(self.states)} states") from None


def _of_result(self, state):
    """The mesh, and what a state has at its points; 0 beside the contacts."""
    chosen, model = _chosen(self, state), self.recognition.model
    points = {"displacement": chosen.displacements}
    for contact in chosen.contacts:
        for side in (contact.source, contact.target):
            for name, values in (("contact pressure", side.nodes.pressure), ("contact strain", side.nodes.strain)):
                points.setdefault(name, numpy.zeros(len(model.points)))[side.nodes.index] = values
    return model, points, {}


def _of_file(self, state):
    """The mesh, and what a state has at its points and elements: fields of surfaces as nodal averages, 0 beside the surfaces; of
    elements NaN where a domain has none."""
    chosen = _chosen(self, state)
    points, elements = {}, {}
    begins = dict(zip(chosen.domains, numpy.cumsum([0, *chosen.domain_sizes]).tolist()))
    for field in chosen.fields:
        kind = (field.group, field.format)
        if kind == ("nodal", "node"):
            points[field.name] = field.values
        elif kind == ("surface", "item") and field.type == "float":
            surface = chosen.surface(field.region)
            value_at = {tuple(point): value for point, value in zip(surface.points.tolist(), surface.nodal(field.name).tolist())}
            rows = numpy.unique(surface.facets[surface.facets >= 0])
            points.setdefault(field.name, numpy.zeros(len(chosen.points)))[rows] = [value_at[tuple(point)] for point in chosen.points[rows].tolist()]
        elif kind == ("domain", "item"):
            of, begin = numpy.asarray(field.values), begins[field.region]
            whole = elements.setdefault(field.name, numpy.full((len(chosen.cell_types), *of.shape[1:]), numpy.nan))
            whole[begin:begin + len(of)] = of
    return chosen, points, elements


def _meshio(mesh, points, elements):
    meshio = _needed("meshio", "to_meshio")
    blocks = mesh.cell_blocks
    ends = numpy.cumsum([len(cells) for _, cells in blocks])[:-1]
    return meshio.Mesh(mesh.points, blocks, point_data=points, cell_data={name: numpy.split(values, ends) for name, values in elements.items()})


def _pyvista(mesh, points, elements):
    grid = _needed("pyvista", "to_pyvista").UnstructuredGrid(mesh.cells, mesh.cell_types, mesh.points)
    for name, values in points.items():
        grid.point_data[name] = values
    for name, values in elements.items():
        grid.cell_data[name] = values
    return grid


def result_to_meshio(self, state=-1):
    """The mesh with displacement, contact pressure and contact strain at its points, in one state, as a meshio.Mesh: its points are
    those of the reference. state: an index. Needs meshio. Raises UsageError, ImportError."""
    return _meshio(*_of_result(self, state))


def result_to_pyvista(self, state=-1):
    """The same as to_meshio, as a pyvista.UnstructuredGrid. Needs pyvista. Raises UsageError, ImportError."""
    return _pyvista(*_of_result(self, state))


def plot_file_to_meshio(self, state=-1):
    """The mesh with the fields of one state, as a meshio.Mesh: those of surfaces as averages at the nodes. Its points are those of the
    reference. state: an index. Needs meshio. Raises UsageError, ImportError."""
    return _meshio(*_of_file(self, state))


def plot_file_to_pyvista(self, state=-1):
    """The same as to_meshio, as a pyvista.UnstructuredGrid. Needs pyvista. Raises UsageError, ImportError."""
    return _pyvista(*_of_file(self, state))


def study_to_xarray(self):
    """The numbers of all cases as an xarray.Dataset, with dims case, state and contact: each number of table() under its name there, p99,
    mean, area and peak without `headline_`; NaN where a case has none. Factors and the model are coordinates of case. Needs
    xarray. Raises ImportError."""
    xarray = _needed("xarray", "to_xarray")
    rows = self.table()
    cases, states, contacts = ({row[name]: None for row in rows if row[name] is not None} for name in ("case_id", "state", "contact"))
    place = [{key: n for n, key in enumerate(keys)} for keys in (cases, sorted(states), contacts)]
    factors = [factor.name for factor in self.factors]
    of_case = {name: ("case", [None] * len(cases)) for name in ["model", *factors]}
    variables = {}
    names = [name for name in (rows[0] if rows else ()) if name not in ("case_id", "state", "contact", "contact_id", *of_case)
             and any(isinstance(row[name], (int, float)) for row in rows) and not any(isinstance(row[name], str) for row in rows)]
    for name in names:
        plain = name.removeprefix("headline_")
        variables[plain if plain in ("p99", "mean", "area", "peak") else name] = (("case", "state", "contact"), numpy.full([len(p) for p in place], numpy.nan))
    for row in rows:
        case = place[0][row["case_id"]]
        for name, (_, values) in of_case.items():
            values[case] = row[name]
        if row["state"] is None or row["contact"] is None:
            continue
        at = case, place[1][row["state"]], place[2][row["contact"]]
        for name, (_, whole) in zip(names, variables.values()):
            whole[at] = numpy.nan if row[name] is None else row[name]
    return xarray.Dataset(variables, {**of_case, "case": list(cases), "state": sorted(states), "contact": list(contacts)}, {"program": f"FEBioDEA {self.version}", "file": self.path})
