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
