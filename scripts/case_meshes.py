"""Meshes of four-node cells for the cases that are no rectangle, or finer in one place, written as Gmsh 2.2 text.

A mesh is {place: number} and a list of cells; `write` finds its sides by where they are.
"""

import math

SIDES = ("left", "right", "bottom", "top", "hole")


def graded(fine, step, half, ratio):
    """Places from -half to half: equal steps up to `fine` either way, then each longer by `ratio`, nearly."""
    count = round(fine / step)
    lengths, reach = [], fine
    while reach < half - 1e-9:
        lengths.append(step * ratio ** (len(lengths) + 1))
        reach += lengths[-1]
    scale = (half - fine) / sum(lengths) if lengths else 1.0
    places = [step * k for k in range(count + 1)]
    for length in lengths:
        places.append(places[-1] + scale * length)
    places = [float(f"{place:.6g}") for place in places]
    return [-place for place in places[:0:-1]] + places


class Mesh:
    def __init__(self):
        self.numbers, self.cells = {}, []

    def node(self, x, y):
        place = (float(f"{x:.7g}") + 0.0, float(f"{y:.7g}") + 0.0)
        return self.numbers.setdefault(place, len(self.numbers) + 1)

    def cell(self, *places):
        self.cells.append([self.node(*place) for place in places])

    def rectangle(self, xs, ys, leave_out=lambda x, y: False):
        """A cell between neighbouring lines, but where its middle is to be left out."""
        for x0, x1 in zip(xs, xs[1:]):
            for y0, y1 in zip(ys, ys[1:]):
                if not leave_out(0.5 * (x0 + x1), 0.5 * (y0 + y1)):
                    self.cell((x0, y0), (x1, y0), (x1, y1), (x0, y1))

    def ring(self, radius, places, layers, ratio):
        """Cells between the circle around the origin and a square whose sides have nodes at these places: layers that
        become thicker by `ratio` away from the circle."""
        half = places[-1]
        border = [(x, -half) for x in places[:-1]] + [(half, y) for y in places[:-1]]
        border += [(-x, half) for x in places[:-1]] + [(-half, -y) for y in places[:-1]]
        depth = [(ratio**k - 1) / (ratio**layers - 1) if ratio != 1 else k / layers for k in range(layers + 1)]

        def at(way, share):
            x, y = way
            start = radius / math.hypot(x, y)
            return (x * (start + share * (1 - start)), y * (start + share * (1 - start)))

        for a, b in zip(border, border[1:] + border[:1]):
            for inner, outer in zip(depth, depth[1:]):
                self.cell(at(a, inner), at(a, outer), at(b, outer), at(b, inner))

    def borders(self, radius):
        """Sides of cells that no other cell has, with the name of where they are."""
        once = {}
        for cell in self.cells:
            for side in zip(cell, cell[1:] + cell[:1]):
                key = frozenset(side)
                if once.pop(key, None) is None:
                    once[key] = side
        places = {number: place for place, number in self.numbers.items()}
        lower = [min(place[d] for place in self.numbers) for d in (0, 1)]
        upper = [max(place[d] for place in self.numbers) for d in (0, 1)]
        size = upper[0] - lower[0]
        for a, b in once.values():
            x, y = (0.5 * (places[a][d] + places[b][d]) for d in (0, 1))
            gaps = [x - lower[0], upper[0] - x, y - lower[1], upper[1] - y]
            nearest = min(range(4), key=gaps.__getitem__)
            if gaps[nearest] < 1e-6 * size:
                yield SIDES[nearest], a, b
            else:
                assert radius and math.hypot(x, y) < radius * (1 + 1e-6), (x, y)
                yield "hole", a, b

    def write(self, path, radius=None):
        lines = list(self.borders(radius))
        names = [name for name in SIDES if any(line[0] == name for line in lines)]
        with open(path, "w", encoding="ascii") as file:
            print("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames", len(names) + 1, sep="\n", file=file)
            for number, name in enumerate(names, 1):
                print(1, number, f'"{name}"', file=file)
            print('2 1 "plate"\n$EndPhysicalNames\n$Nodes', len(self.numbers), sep="\n", file=file)
            for (x, y), number in self.numbers.items():
                print(number, f"{x:.7g}", f"{y:.7g}", 0, file=file)
            print("$EndNodes\n$Elements", len(lines) + len(self.cells), sep="\n", file=file)
            for number, (name, a, b) in enumerate(lines, 1):
                print(number, 1, 2, names.index(name) + 1, names.index(name) + 1, a, b, file=file)
            for number, cell in enumerate(self.cells, len(lines) + 1):
                print(number, 3, 2, 1, 1, *cell, file=file)
            print("$EndElements", file=file)
