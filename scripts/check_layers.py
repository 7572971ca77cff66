#!/usr/bin/env python3
"""Checks the house: arrows between rooms (scripts/layers.txt), pure headers, the map src/README.md, file lengths.

Reads the #include lines of include/pdx and src. Prints one line `file:line: what is wrong` for each finding and
exits 1 if there is any. `--self-test` runs the checks on small made-up trees instead.
"""

import argparse
import fnmatch
import pathlib
import re
import sys
import tempfile
import unittest

MAX_LINES = 400
HEAVY = re.compile(r"(petsc.*|mpi|hdf5|H5.*)\.h|petsc/.*")
INCLUDE = re.compile(r'\s*#\s*include\s*([<"])([^>"]+)[>"]')
MAP_ROW = re.compile(r"\|\s*`(\w+)/`")


class Layers:
    """The arrows that layers.txt allows."""

    def __init__(self, text):
        self.allowed = {}
        self.pure = []
        for line in text.splitlines():
            line = line.split("#")[0].strip()
            if not line:
                continue
            name, _, entries = line.partition(":")
            if name == "pure":
                self.pure = entries.split()
            else:
                self.allowed[name] = entries.split()

    def allows(self, room, header):
        """May a file of `room` include pdx/`header`?"""
        target = header.split("/")[0]
        entries = self.allowed[room]
        return target == room or "*" in entries or target in entries or header in entries

    def is_pure(self, path, room):
        return any(fnmatch.fnmatch(path.name, entry) if "*" in entry else entry == room for entry in self.pure)

    def reaches(self, room):
        """Rooms that `room` may see, directly or through others."""
        seen = set()
        waiting = [room]
        while waiting:
            for entry in self.allowed.get(waiting.pop(), []):
                for target in self.allowed if entry == "*" else [entry.split("/")[0]]:
                    if target not in seen and not (entry == "*" and target == room):
                        seen.add(target)
                        waiting.append(target)
        return seen

    def cycles(self):
        return sorted(room for room in self.allowed if room in self.reaches(room))


class House:
    """The files of include/pdx and src, by room, and what they include."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.rooms = {}
        self.includes = {}
        for top in (self.root / "include" / "pdx", self.root / "src"):
            for path in sorted(p for p in top.rglob("*") if p.suffix in (".hpp", ".cpp")):
                room = path.relative_to(top).parts[0]
                self.rooms[path] = "" if room == path.name else room
                self.includes[path] = self._read(path)

    @staticmethod
    def _read(path):
        found = []
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                found.append((number, match.group(1), match.group(2)))
        return found

    def resolve(self, path, mark, name):
        """The file of ours that an include line names, or None for a foreign header."""
        if name.startswith("pdx/"):
            return self.root / "include" / name
        beside = (path.parent / name).resolve()
        return beside if mark == '"' and beside in self.includes else None

    def header_name(self, target):
        """room/name.hpp of one of our files, wherever it lies."""
        for top in (self.root / "include" / "pdx", self.root / "src"):
            if target.is_relative_to(top):
                return target.relative_to(top).as_posix()
        return target.name

    def heavy_route(self, path, route=()):
        """The chain of files from `path` to a PETSc, MPI or HDF5 header, or None."""
        for _, mark, name in self.includes.get(path, []):
            if HEAVY.fullmatch(name):
                return route + (name,)
            target = self.resolve(path, mark, name)
            if target and self.header_name(target) not in route:
                longer = self.heavy_route(target, route + (self.header_name(target),))
                if longer:
                    return longer
        return None


def arrow_findings(house, layers):
    """Forbidden arrows, unknown rooms, and rooms that include each other."""
    arrows = {}
    for path, room in house.rooms.items():
        place = path.relative_to(house.root)
        if room not in layers.allowed:
            yield f"{place}:1: room '{room}' is not in scripts/layers.txt"
            continue
        for number, mark, name in house.includes[path]:
            target = house.resolve(path, mark, name)
            if not target:
                continue
            header = house.header_name(target)
            arrows.setdefault((room, header.split("/")[0]), f"{place}:{number}")
            if not layers.allows(room, header):
                yield f"{place}:{number}: {room} may not include {header}"
    for (room, target), place in sorted(arrows.items()):
        if room < target and (target, room) in arrows:
            yield f"{place}: {room} and {target} include each other (also {arrows[target, room]})"


def pure_findings(house, layers):
    """Headers that must compile without PETSc, MPI and HDF5, and do not."""
    for path, room in house.rooms.items():
        if layers.is_pure(path, room):
            route = house.heavy_route(path)
            if route:
                yield f"{path.relative_to(house.root)}:1: must stay pure, but reaches {' -> '.join(route)}"


def map_findings(house):
    """Rooms that src/README.md forgets, and rooms it names that are not there."""
    path = house.root / "src" / "README.md"
    rows = {}
    if path.is_file():
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = MAP_ROW.match(line)
            if match:
                rows[match.group(1)] = number
    rooms = set(house.rooms.values()) - {""}
    for room in sorted(rooms - rows.keys()):
        yield f"src/README.md:1: the map does not name room '{room}'"
    for room in sorted(rows.keys() - rooms):
        yield f"src/README.md:{rows[room]}: the map names room '{room}', which does not exist"


def length_findings(house):
    for path in house.rooms:
        lines = len(path.read_text(encoding="utf-8").splitlines())
        if lines > MAX_LINES:
            yield f"{path.relative_to(house.root)}:{MAX_LINES + 1}: {lines} lines, more than {MAX_LINES}"


def findings(root):
    """Everything that is wrong with the tree at `root`, as printable lines."""
    house = House(pathlib.Path(root).resolve())
    layers = Layers((house.root / "scripts" / "layers.txt").read_text(encoding="utf-8"))
    found = [f"scripts/layers.txt:1: room '{room}' can reach itself" for room in layers.cycles()]
    found += arrow_findings(house, layers)
    found += pure_findings(house, layers)
    found += map_findings(house)
    found += length_findings(house)
    return found


class SelfTest(unittest.TestCase):
    """Each check finds its own fault in a made-up tree, and nothing in a right one."""

    GOOD = {
        "scripts/layers.txt": "base:\ngeom: base/tensor.hpp  # only this one\npd: base geom\napp: *\npure: geom *_kernel.hpp\n",
        "src/README.md": "| room |\n| `base/` | x |\n| `geom/` | x |\n| `pd/` | x |\n| `app/` | x |\n",
        "include/pdx/base/tensor.hpp": "#include <array>\n",
        "include/pdx/base/petsc.hpp": "#include <petscsnes.h>\n",
        "include/pdx/geom/box.hpp": '#include "pdx/base/tensor.hpp"\n',
        "include/pdx/pd/arm_kernel.hpp": '#include "pdx/geom/box.hpp"\n',
        "src/pd/patch.cpp": '#include "pdx/base/petsc.hpp"\n#include "pdx/pd/arm_kernel.hpp"\n',
        "src/app/main.cpp": '#include "pdx/pd/arm_kernel.hpp"\n',
    }

    def found(self, **changes):
        """Findings in the good tree after changes, whose keys spell paths with __ for /, and _DOT_ for the dot."""
        files = dict(self.GOOD)
        files.update({key.replace("__", "/").replace("_DOT_", "."): text for key, text in changes.items()})
        with tempfile.TemporaryDirectory() as root:
            for name, text in files.items():
                path = pathlib.Path(root) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return findings(root)

    def test_right_tree_is_quiet(self):
        self.assertEqual(self.found(), [])

    def test_forbidden_arrow_is_named_with_its_line(self):
        found = self.found(src__base__x_DOT_cpp='#include <array>\n#include "pdx/geom/box.hpp"\n')
        self.assertIn("src/base/x.cpp:2: base may not include geom/box.hpp", found)

    def test_single_header_allowance_is_not_a_room(self):
        found = self.found(src__geom__x_DOT_cpp='#include "pdx/base/petsc.hpp"\n')
        self.assertIn("src/geom/x.cpp:1: geom may not include base/petsc.hpp", found)

    def test_two_way_pair_is_found_even_if_each_arrow_is_allowed(self):
        found = self.found(
            include__pdx__pd__y_DOT_hpp='#include "pdx/app/x.hpp"\n',
            include__pdx__app__x_DOT_hpp="",
            scripts__layers_DOT_txt="base:\ngeom: base\npd: base geom app\napp: *\n",
        )
        self.assertTrue(any("app and pd include each other" in line for line in found), found)
        self.assertTrue(any("can reach itself" in line for line in found), found)

    def test_private_header_is_followed(self):
        found = self.found(src__geom__x_DOT_cpp='#include "../pd/p.hpp"\n', src__pd__p_DOT_hpp="")
        self.assertIn("src/geom/x.cpp:1: geom may not include pd/p.hpp", found)

    def test_pure_header_may_not_reach_petsc_through_ours(self):
        found = self.found(include__pdx__pd__b_kernel_DOT_hpp='#include "pdx/base/petsc.hpp"\n')
        self.assertEqual(len(found), 1)
        self.assertIn("base/petsc.hpp -> petscsnes.h", found[0])

    def test_unknown_room_is_found(self):
        found = self.found(src__shed__x_DOT_cpp="")
        self.assertIn("src/shed/x.cpp:1: room 'shed' is not in scripts/layers.txt", found)
        self.assertIn("src/README.md:1: the map does not name room 'shed'", found)

    def test_map_may_not_promise_rooms(self):
        found = self.found(src__README_DOT_md=self.GOOD["src/README.md"] + "| `attic/` | x |\n")
        self.assertEqual(found, ["src/README.md:6: the map names room 'attic', which does not exist"])

    def test_long_file_is_found(self):
        found = self.found(src__base__x_DOT_cpp="\n" * (MAX_LINES + 1))
        self.assertEqual(found, [f"src/base/x.cpp:401: 401 lines, more than {MAX_LINES}"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--self-test", action="store_true", help="check the checker")
    parser.add_argument("root", nargs="?", default=pathlib.Path(__file__).resolve().parent.parent)
    arguments = parser.parse_args()
    if arguments.self_test:
        suite = unittest.defaultTestLoader.loadTestsFromTestCase(SelfTest)
        sys.exit(not unittest.TextTestRunner(verbosity=0).run(suite).wasSuccessful())
    found = findings(arguments.root)
    for line in found:
        print(line)
    if found:
        sys.exit(1)
    print("layers: every arrow, the map and the lengths are right")


if __name__ == "__main__":
    main()
