"""Elements as other programs of Python take them."""
import numpy

# VTK's number of a type: meshio's name of it.
_MESHIO = {3: "line", 5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron", 13: "wedge", 14: "pyramid", 21: "line3",
           22: "triangle6", 23: "quad8", 24: "tetra10", 25: "hexahedron20", 26: "wedge15", 27: "pyramid13", 28: "quad9",
           29: "hexahedron27", 34: "triangle7", 69: "VTK_LAGRANGE_TRIANGLE", 71: "VTK_LAGRANGE_TETRAHEDRON"}
_WEDGE = 13  # meshio's linear wedge alone has another order of nodes than VTK's


def cell_blocks(self):
    """The same as meshio takes them: a list of (name of the type, (cells, nodes) array), in meshio's order of nodes; a new
    block where the type changes."""
    cells, types = self.cells, self.cell_types
    blocks, place = [], 0
    for run in numpy.split(types, numpy.flatnonzero(numpy.diff(types)) + 1):
        if len(run) == 0:
            continue
        width = int(cells[place]) + 1
        nodes = cells[place:place + len(run) * width].reshape(len(run), width)[:, 1:]
        place += len(run) * width
        kind = int(run[0])
        blocks.append((_MESHIO[kind], nodes[:, [0, 2, 1, 3, 5, 4]] if kind == _WEDGE else nodes))
    return blocks
