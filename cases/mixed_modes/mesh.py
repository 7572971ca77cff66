#!/usr/bin/env python3
"""Writes plate.msh: 400 x 400 mm, squares of 1 mm around the crack in the middle, longer cells further out.

usage: mesh.py
"""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import case_meshes


def main():
    mesh = case_meshes.Mesh()
    lines = case_meshes.graded(0.014, 0.001, 0.2, 1.4)
    mesh.rectangle(lines, lines)
    mesh.write(HERE / "plate.msh")


if __name__ == "__main__":
    main()
