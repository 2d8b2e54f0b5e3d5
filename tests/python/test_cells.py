"""Elements for pyvista and meshio: every shape, against where VTK and meshio have its nodes."""
import numpy as np
import pytest

import febiodea

X, Y, Z = np.eye(3)
O = np.zeros(3)
HEX = [O, X, X + Y, Y, Z, X + Z, X + Y + Z, Y + Z]
WEDGE = [O, X, Y, Z, X + Z, Y + Z]
TET = [O, X, Y, Z]
PYRAMID = [O, X, X + Y, Y, Z]
TRI, QUAD, LINE = [O, X, Y], [O, X, X + Y, Y], [O, X]

# Nodes beyond the corners as means of corners. FEBio's order: its user manual, "Elements"; VTK's: the documentation of
# vtkQuadraticHexahedron, vtkTriQuadraticHexahedron, vtkQuadraticWedge, ...
HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
HEX_MIDDLE = [tuple(range(8))]
WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
PYRAMID_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)]
TRI_EDGES, QUAD_EDGES = [(0, 1), (1, 2), (2, 0)], [(0, 1), (1, 2), (2, 3), (3, 0)]
SIDES = {"-x": (0, 3, 7, 4), "+x": (1, 2, 6, 5), "-y": (0, 1, 5, 4), "+y": (2, 3, 7, 6), "-z": (0, 1, 2, 3), "+z": (4, 5, 6, 7)}


def thirds(edges):
    return [(a, a, b) if first else (a, b, b) for a, b in edges for first in (True, False)]


FEBIO_HEX27 = [SIDES[s] for s in ("-y", "+x", "+y", "-x", "-z", "+z")] + HEX_MIDDLE
VTK_HEX27 = [SIDES[s] for s in ("-x", "+x", "-y", "+y", "-z", "+z")] + HEX_MIDDLE
FEBIO_TET15 = [(0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3), (0, 1, 2, 3)]
FEBIO_TET20 = thirds([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]) + [(0, 1, 3), (1, 2, 3), (0, 2, 3), (0, 1, 2)]
VTK_TET20 = thirds(TET_EDGES) + [(0, 1, 3), (1, 2, 3), (0, 2, 3), (0, 1, 2)]

# FEBio's type, corners, FEBio's other nodes; VTK's number, VTK's other nodes; meshio's name.
SHAPES = [
    ("hex8", HEX, [], 12, [], "hexahedron"), ("hex20", HEX, HEX_EDGES, 25, HEX_EDGES, "hexahedron20"),
    ("hex27", HEX, HEX_EDGES + FEBIO_HEX27, 29, HEX_EDGES + VTK_HEX27, "hexahedron27"),
    ("penta6", WEDGE, [], 13, [], "wedge"), ("penta15", WEDGE, WEDGE_EDGES, 26, WEDGE_EDGES, "wedge15"),
    ("tet4", TET, [], 10, [], "tetra"), ("tet5", TET, [(0, 1, 2, 3)], 10, [], "tetra"),
    ("tet10", TET, TET_EDGES, 24, TET_EDGES, "tetra10"), ("tet15", TET, TET_EDGES + FEBIO_TET15, 24, TET_EDGES, "tetra10"),
    ("tet20", TET, FEBIO_TET20, 71, VTK_TET20, "VTK_LAGRANGE_TETRAHEDRON"),
    ("pyra5", PYRAMID, [], 14, [], "pyramid"), ("pyra13", PYRAMID, PYRAMID_EDGES, 27, PYRAMID_EDGES, "pyramid13"),
    ("tri3", TRI, [], 5, [], "triangle"), ("tri6", TRI, TRI_EDGES, 22, TRI_EDGES, "triangle6"),
    ("quad4", QUAD, [], 9, [], "quad"), ("quad8", QUAD, QUAD_EDGES, 23, QUAD_EDGES, "quad8"),
    ("quad9", QUAD, QUAD_EDGES + [(0, 1, 2, 3)], 28, QUAD_EDGES + [(0, 1, 2, 3)], "quad9"),
    ("line2", LINE, [], 3, [], "line"), ("line3", LINE, [(0, 1)], 21, [(0, 1)], "line3"),
]


def points_of(corners, others):
    return np.array(list(corners) + [np.mean([corners[k] for k in other], axis=0) for other in others])


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """Two elements of each shape, the second one along x."""
    nodes, elements, domains = [], [], []
    number = element = 0
    for name, corners, others, *_ in SHAPES:
        points = points_of(corners, others)
        lines = []
        for shift in (0, 10):
            ids = []
            for x, y, z in points + shift * X:
                number += 1
                ids.append(number)
                nodes.append(f'<node id="{number}">{x:.17g},{y:.17g},{z:.17g}</node>')
            element += 1
            lines.append(f'<elem id="{element}">{",".join(map(str, ids))}</elem>')
        elements.append(f'<Elements type="{name}" name="all_{name}">{"".join(lines)}</Elements>')
        kind = "Shell" if name[:3] in ("tri", "qua") else "Beam" if name[:4] == "line" else "Solid"
        domains.append(f'<{kind}Domain name="all_{name}" mat="m"/>')
    path = tmp_path_factory.mktemp("shapes") / "shapes.feb"
    path.write_text(f"""<?xml version="1.0"?><febio_spec version="4.0"><Module type="solid"/>
<Material><material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material></Material>
<Mesh><Nodes name="n">{"".join(nodes)}</Nodes>{"".join(elements)}</Mesh><MeshDomains>{"".join(domains)}</MeshDomains>
</febio_spec>""")
    return febiodea.read_feb(path)


def in_order(cells):
    """Each cell's nodes of pyvista's flat array."""
    place, all_cells = 0, []
    while place < len(cells):
        all_cells.append(cells[place + 1:place + 1 + cells[place]])
        place += 1 + cells[place]
    assert place == len(cells)
    return all_cells


def test_every_shape_has_vtks_nodes(model):
    cells = in_order(model.cells)
    assert list(model.cell_types) == [shape[3] for shape in SHAPES for _ in range(2)] and len(cells) == len(model.cell_types)
    assert (model.cells.dtype, model.cell_types.dtype) == (np.int64, np.uint8)
    for k, (name, corners, _, _, others, _) in enumerate(SHAPES):
        for copy in range(2):
            expected = points_of(corners, others) + 10 * copy * X
            if name in ("penta6", "penta15"):  # the normal of VTK's nodes 0, 1, 2 points out of the wedge
                turned = [corners[i] for i in (0, 2, 1, 3, 5, 4)]
                expected = points_of(turned, others) + 10 * copy * X
                assert np.cross(expected[1] - expected[0], expected[2] - expected[0]) @ (expected[3] - expected[0]) < 0
            np.testing.assert_allclose(model.points[cells[2 * k + copy]], expected, atol=1e-15, err_msg=name)


def test_blocks_for_meshio(model):
    blocks = model.cell_blocks
    names = [shape[5] for shape in SHAPES]
    merged = [name for k, name in enumerate(names) if k == 0 or names[k - 1] != name]
    assert [name for name, _ in blocks] == merged  # neighbours of one type are one block
    vtk = {name: cells for name, cells in zip(names, in_order(model.cells)[::2])}
    for name, nodes in blocks:
        assert nodes.ndim == 2
        if name == "wedge":  # meshio's documentation: as Gmsh, unlike VTK
            first = model.points[nodes[0]]
            np.testing.assert_allclose(first, points_of(WEDGE, []), atol=1e-15)
        elif name not in ("tetra", "tetra10"):
            np.testing.assert_array_equal(nodes[0], vtk[name])
    assert sum(len(nodes) for _, nodes in blocks) == len(model.cell_types)


def test_blocks_of_a_plot_file_and_its_surfaces(hip_result, tmp_path):
    hip_result.write_xplt(tmp_path / "hip.xplt")
    state = febiodea.read_xplt(tmp_path / "hip.xplt").states[-1]
    assert [(name, nodes.tolist()) for name, nodes in state.cell_blocks] == \
        [(name, nodes.tolist()) for name, nodes in hip_result.recognition.model.cell_blocks]
    surface = state.surface("femoral_articulating")
    ((name, nodes),) = surface.cell_blocks
    assert name == "quad"
    np.testing.assert_array_equal(nodes, surface.facets)


def test_cells_of_a_model_are_whole(models):
    model = models("hip/hip_walking.feb")
    assert len(in_order(model.cells)) == len(model.cell_types) and set(model.cell_types) <= {5, 9, 10, 12, 13}
