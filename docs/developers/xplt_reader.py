"""A small reader of FEBio's plot files for the figures of this folder: last state, uncompressed. Standard library only."""
import struct


def sub(a, b): return tuple(x - y for x, y in zip(a, b))
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def cross(a, b): return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


CORNERS = {3: 3, 6: 3, 7: 3, 4: 4, 8: 4, 9: 4}


class PlotFile:
    def __init__(self, path):
        with open(path, "rb") as f:
            self.data = f.read()
        top = list(self.chunks((4, len(self.data))))
        self.path, self.root, self.mesh, self.state = path, top[0][1], top[1][1], top[-1][1]
        b, e = self.child(self.mesh, 0x01041000, 0x01041200)
        self.reference = [struct.unpack_from("<i3f", self.data, o)[1:] for o in range(b, e, 16)]
        u = self.values(0x01023000, 0x02020300, "displacement", 0)
        self.nodes = [tuple(x + u[3 * i + k] for k, x in enumerate(p)) for i, p in enumerate(self.reference)]

    def chunks(self, span):
        at = span[0]
        while at < span[1]:
            ident, size = struct.unpack_from("<II", self.data, at)
            yield ident, (at + 8, at + 8 + size)
            at += 8 + size

    def child(self, span, *path):
        for wanted in path:
            span = next(s for i, s in self.chunks(span) if i == wanted)
        return span

    def ints(self, span):
        return struct.unpack_from("<%di" % ((span[1] - span[0]) // 4), self.data, span[0])

    def place(self, dictionary, section, name, region):
        """Where the values of a variable are in `data`."""
        names = []
        for _, item in self.chunks(self.child(self.root, 0x01020000, dictionary)):
            b, e = self.child(item, 0x01020004)
            names.append(self.data[b:e].split(b"\0")[0].decode())
        for _, variable in self.chunks(self.child(self.state, 0x02020000, section)):
            b, _ = self.child(variable, 0x02020002)
            if struct.unpack_from("<I", self.data, b)[0] == names.index(name) + 1:
                for ident, (b, e) in self.chunks(self.child(variable, 0x02020003)):
                    if ident == region:
                        return b, e
        raise SystemExit("%s: no %s in region %d" % (self.path, name, region))

    def values(self, dictionary, section, name, region):
        b, e = self.place(dictionary, section, name, region)
        return struct.unpack_from("<%df" % ((e - b) // 4), self.data, b)

    def surface(self, name, field="contact pressure"):
        """Corner nodes of the facets and the field's value per facet."""
        for region, (_, span) in enumerate(self.chunks(self.child(self.mesh, 0x01043000)), 1):
            b, e = self.child(span, 0x01043101, 0x01043104)
            if self.data[b + 4:e].decode() != name:
                continue
            facets = []
            for _, (b, e) in self.chunks(self.child(span, 0x01043200)):
                ints = struct.unpack_from("<%di" % ((e - b) // 4), self.data, b)
                facets.append(ints[2:2 + CORNERS[ints[1]]])
            return facets, self.values(0x01025000, 0x02020500, field, region)
        raise SystemExit("%s: no surface %s" % (self.path, name))
