#!/usr/bin/env python3
"""A model with twice the elements through its cartilage, for the tables of docs/layer_law.md, section 8. Standard library only.

    docs/developers/inside_finer.py MODEL.feb FINER.feb PENALTY     every hex8 becomes two, one above the other: halved along the edges from its
                                                         first four nodes to its last four, which must cross the layer

PENALTY replaces the contact's. FEBio multiplies it by the area over the volume of the facet's element (auto_penalty): half of it
for elements of half the height is the same contact."""
import sys
import xml.etree.ElementTree as tree


def numbers(text, kind=int):
    return [kind(x) for x in text.split(",")]


def main():
    model, finer, penalty = sys.argv[1:4]
    document = tree.parse(model)
    root = document.getroot()
    mesh = root.find("Mesh")
    places = {int(n.get("id")): numbers(n.text, float) for n in mesh.iter("node")}
    shells = {n for part in mesh.findall("Elements") if part.get("type") == "quad4" for e in part for n in numbers(e.text)}
    last_node = max(places)
    last_element = max(int(e.get("id")) for part in mesh.findall("Elements") for e in part)
    nodes, middle = mesh.findall("Nodes")[-1], {}

    def between(a, b):
        key = (min(a, b), max(a, b))
        if key not in middle:
            middle[key] = last_node + len(middle) + 1
            node = tree.SubElement(nodes, "node", {"id": str(middle[key])})
            node.text = ",".join(repr((x + y) / 2) for x, y in zip(places[a], places[b]))
            node.tail = "\n"
        return middle[key]

    for part in mesh.findall("Elements"):
        if part.get("type") != "hex8":
            continue
        bonded, upper = 0, []
        for element in part:
            low, high = numbers(element.text)[:4], numbers(element.text)[4:]
            bonded += shells.issuperset(low) or shells.issuperset(high)
            halves = [between(a, b) for a, b in zip(low, high)]
            element.text = ",".join(map(str, low + halves))
            last_element += 1
            other = tree.Element("elem", {"id": str(last_element)})
            other.text, other.tail = ",".join(map(str, halves + high)), "\n"
            upper.append(other)
        if bonded == 0:
            raise SystemExit(f"{model}: no element of \"{part.get('name')}\" has its first or last four nodes on a rigid shell, "
                             "expected elements that are numbered through the layer")
        part.extend(upper)
    for value in root.iter("penalty"):
        value.text = penalty
    document.write(finer, encoding="ISO-8859-1", xml_declaration=True)


main()
