"""Meshes of the unit square for the tests beside this file, as Gmsh writes them."""

import struct

GROUPS = {"right": 1, "left": 2, "top": 3, "bottom": 4}  # physical curves
CURVES = {"left": [1], "right": [2], "bottom": [3], "top": [4], "seam": [5]}  # elementary ones, by another number


class Square:
    """n x n cells of the unit square. Nodes on y = 0.5 are doubled where `parted(x)` says so; `upper` other cells are
    above it if given (only with all nodes doubled)."""

    def __init__(self, n, parted=None, upper=None):
        self.points, self.cells, self.lines = [], [], []
        half = n // 2
        below = self.block(n, half, 0.0, 0.5)
        if parted is None:
            above = self.block(n, n - half, 0.5, 1.0, below[-1])
        else:
            m = upper or n
            shared = None if upper else [None if parted(i / n) else v for i, v in enumerate(below[-1])]
            above = self.block(m, m // 2, 0.5, 1.0, shared)
        for rows in (below, above):
            for a, b in zip(rows, rows[1:]):
                self.lines += [("left", b[0], a[0]), ("right", a[-1], b[-1])]
        self.lines += [("bottom", *pair) for pair in zip(below[0], below[0][1:])]
        self.lines += [("top", *pair) for pair in zip(above[-1], above[-1][1:])]

    def block(self, n, rows, y0, y1, first=None):
        """Adds n x rows cells; the first row of nodes may be there already, None where it is not."""
        nodes = []
        for j in range(rows + 1):
            row = list(first) if j == 0 and first else [None] * (n + 1)
            for i in range(n + 1):
                if row[i] is None:
                    self.points.append((i / n, y0 + (y1 - y0) * j / rows))
                    row[i] = len(self.points)
            nodes.append(row)
        for a, b in zip(nodes, nodes[1:]):
            self.cells += [(a[i], a[i + 1], b[i + 1], b[i]) for i in range(n)]
        return nodes

    def write(self, path, version="2.2", binary=False):
        path.write_bytes(self.bytes(version, binary))
        return str(path)

    def bytes(self, version="2.2", binary=False):
        w = Writer(binary)
        w.data += b"$MeshFormat\n%s %d 8\n" % (version.encode(), binary)
        if binary:
            w.small(1)
            w.data += b"\n"
        w.data += b"$EndMeshFormat\n$PhysicalNames\n%d\n" % (len(GROUPS) + 1)
        for name, group in GROUPS.items():
            w.data += b'1 %d "%s"\n' % (group, name.encode())
        w.data += b'2 1 "plate"\n$EndPhysicalNames\n'
        (self.list if version == "2.2" else self.blocks)(w)
        return w.data

    def list(self, w):
        w.data += b"$Nodes\n%d\n" % len(self.points)
        for k, (x, y) in enumerate(self.points):
            w.small(k + 1)
            w.real(x, y, 0.0)
            w.line()
        w.data += b"\n$EndNodes\n$Elements\n%d\n" % (len(self.lines) + len(self.cells))
        elements = [(1, GROUPS[name], CURVES[name][0], ends) for name, *ends in self.lines]
        elements += [(3, 1, 1, cell) for cell in self.cells]
        for k, (kind, group, entity, nodes) in enumerate(elements):
            w.small(*((kind, 1, 2, k + 1) if w.binary else (k + 1, kind, 2)), group, entity, *nodes)
            w.line()
        w.data += b"\n$EndElements\n"

    def blocks(self, w):
        names = [name for name in CURVES if name in GROUPS]
        w.data += b"$Entities\n"
        w.large(0, len(names), 1, 0)
        w.line()
        for name in names:
            w.small(CURVES[name][0])
            w.real(0, 0, 0, 1, 1, 0)
            w.large(1)
            w.small(GROUPS[name])
            w.large(0)
            w.line()
        w.small(1)
        w.real(0, 0, 0, 1, 1, 0)
        w.large(1)
        w.small(1)
        w.large(0)
        w.data += b"\n$EndEntities\n$Nodes\n"
        count = len(self.points)
        w.large(1, count, 1, count)
        w.small(2, 1, 0)
        w.large(count)
        w.line()
        for k in range(count):
            w.large(k + 1)
            w.line()
        for x, y in self.points:
            w.real(x, y, 0.0)
            w.line()
        w.data += b"\n$EndNodes\n$Elements\n"
        total = len(self.lines) + len(self.cells)
        w.large(len(names) + 1, total, 1, total)
        number = 0
        for name in [*names, None]:
            elements = [ends for other, *ends in self.lines if other == name] if name else self.cells
            w.small(*((1, CURVES[name][0], 1) if name else (2, 1, 3)))
            w.large(len(elements))
            w.line()
            for nodes in elements:
                number += 1
                w.large(number, *nodes)
                w.line()
        w.data += b"\n$EndElements\n"


class Writer:
    def __init__(self, binary):
        self.binary, self.data = binary, b""

    def put(self, form, values):
        self.data += struct.pack(f"<{len(values)}{form}", *values) if self.binary else b" ".join(
            b"%.17g" % value for value in values
        ) + b" "

    def small(self, *values):
        self.put("i", values)

    def large(self, *values):
        self.put("q", values)

    def real(self, *values):
        self.put("d", values)

    def line(self):
        self.data += b"" if self.binary else b"\n"
