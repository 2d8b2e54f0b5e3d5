"""Models that tests make of the samples."""
import re


def with_one_trochlea(knee):
    """The knee with one surface of the femur in both contacts of the patella: a layer that several contacts press."""
    sides = ("medial_trochlea", "lateral_trochlea")
    facets = [f for side in sides for f in re.search(f'<Surface name="{side}">\n(.*?)</Surface>', knee, re.S)[1].splitlines()]
    facets = [re.sub('id="\\d+"', f'id="{i}"', f) for i, f in enumerate(facets, 1)]
    both = '<Surface name="trochlea">\n' + "\n".join(facets) + "\n</Surface>\n"
    for side in sides:
        knee = knee.replace(f"<secondary>{side}</secondary>", "<secondary>trochlea</secondary>")
    return knee.replace("<SurfacePair", both + "<SurfacePair", 1)


def disc():
    """A disc with fibres along the load between two rigid plates, of which the upper comes down: a part that gives way."""
    nodes, elements = [], {"disc": [], "lower": [], "upper": []}

    def block(name, low, high, parts):
        first = len(nodes) + 1
        n = [p + 1 for p in parts]
        for k in range(n[2]):
            for j in range(n[1]):
                for i in range(n[0]):
                    nodes.append([low[c] + (high[c] - low[c]) * (i, j, k)[c] / parts[c] for c in range(3)])

        def at(i, j, k):
            return first + i + n[0] * (j + n[1] * k)
        for k in range(parts[2]):
            for j in range(parts[1]):
                for i in range(parts[0]):
                    elements[name].append([at(i + a, j + b, k + c) for c in (0, 1)
                                           for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))])
        cells = [(i, j) for j in range(parts[1]) for i in range(parts[0])]
        top = [[at(i, j, parts[2]), at(i + 1, j, parts[2]), at(i + 1, j + 1, parts[2]), at(i, j + 1, parts[2])] for i, j in cells]
        bottom = [[at(i, j, 0), at(i, j + 1, 0), at(i + 1, j + 1, 0), at(i + 1, j, 0)] for i, j in cells]
        return top, bottom
    top, bottom = block("disc", (0, 0, 0), (4, 4, 2), (4, 4, 2))
    below, _ = block("lower", (-1, -1, -1), (5, 5, 0), (3, 3, 1))
    _, above = block("upper", (-1, -1, 2), (5, 5, 3), (3, 3, 1))
    text = """<?xml version="1.0" encoding="ISO-8859-1"?>
<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>1</time_steps><step_size>1</step_size></Control>
<Material><material id="1" name="disc" type="trans iso Mooney-Rivlin"><c1>1</c1><c2>0</c2><c3>0.5</c3><c4>20</c4><c5>10</c5><lam_max>1.05</lam_max><k>20</k>
<fiber type="vector">0,0,1</fiber></material>
<material id="2" name="lower" type="rigid body"><center_of_mass>2,2,0</center_of_mass></material>
<material id="3" name="upper" type="rigid body"><center_of_mass>2,2,2</center_of_mass></material></Material>
<Mesh><Nodes name="all">
"""
    text += "".join(f'<node id="{i}">{x},{y},{z}</node>\n' for i, (x, y, z) in enumerate(nodes, 1)) + "</Nodes>\n"
    count = 0
    for name, cells in elements.items():
        text += f'<Elements type="hex8" name="{name}">\n'
        for cell in cells:
            count += 1
            text += f'<elem id="{count}">{",".join(map(str, cell))}</elem>\n'
        text += "</Elements>\n"
    for name, facets in (("top", top), ("bottom", bottom), ("below", below), ("above", above)):
        text += f'<Surface name="{name}">\n'
        text += "".join(f'<quad4 id="{i}">{",".join(map(str, f))}</quad4>\n' for i, f in enumerate(facets, 1)) + "</Surface>\n"
    for name, second in (("top", "above"), ("bottom", "below")):
        text += f'<SurfacePair name="{name}"><primary>{name}</primary><secondary>{second}</secondary></SurfacePair>\n'
    text += "</Mesh><MeshDomains>" + "".join(f'<SolidDomain name="{n}" mat="{n}"/>' for n in elements) + "</MeshDomains>\n<Rigid>"
    free = {"lower": "", "upper": "z"}
    for body, moved in free.items():
        dofs = "".join(f"<R{d}_dof>{int(d != moved)}</R{d}_dof>" for d in "xyz") + "<Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>"
        text += f'<rigid_bc name="{body}" type="rigid_fixed"><rb>{body}</rb>{dofs}</rigid_bc>\n'
    text += '<rigid_bc name="press" type="rigid_displacement"><rb>upper</rb><dof>z</dof><value lc="1">-0.05</value></rigid_bc></Rigid>\n<Contact>'
    for name in ("top", "bottom"):
        text += f'<contact name="{name}" type="sliding-elastic" surface_pair="{name}"/>\n'
    return text + """</Contact>
<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData></febio_spec>
"""
