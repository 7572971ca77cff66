#!/usr/bin/env python3
"""The command pdxsolve-report from the tree: see pdxtools/report.py, or --help."""

from pdxtools import report

if __name__ == "__main__":
    report.main()
