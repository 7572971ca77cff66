#!/usr/bin/env python3
"""The command pdxsolve-plot from the tree: see pdxtools/plot.py, or --help."""

from pdxtools import plot

if __name__ == "__main__":
    plot.main()
