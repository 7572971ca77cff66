"""What every study.py of a running crack does: runs variants on one rank, prints a table of what the cracks did."""

import case_study
import pdxtools

COLUMNS = ("run", "unknowns", "steps", "start [us]", "branches [us]", "at [mm]", "max speed [m/s]", "of c_R",
           "angle [deg]", "grown tips [mm]", "residual", "time [s]")  # fmt: skip


def line(out, name):
    """A line of the table, or None if there is no run that is done."""
    summary = pdxtools.read_summary(out / name)
    if summary.get("status") != "done":
        return None
    r = summary["results"]

    def of(key, factor=1.0, digits=2):
        return f"{factor * r[key]:.{digits}f}" if key in r else "-"

    branch = ", ".join(f"{1e3 * x:.2f}" for x in r["branch_point"]) if "branch_point" in r else "-"
    grown = ", ".join(f"{1e3 * tip['grown']:.2f}" for tip in r["tips"])
    return [name, summary["unknowns"]["total"], summary["steps"], of("crack_start_time", 1e6), of("branch_time", 1e6),
            branch, of("max_crack_speed", 1.0, 0), of("max_crack_speed_ratio", 1.0, 3), of("crack_angle_degrees", 1.0, 1),
            grown, f"{r['energy_drift_ratio']:.1e}", f"{summary['wall_seconds']['total']:.1f}"]  # fmt: skip


def main(description, case, variants):
    """Variants are options files and what is said after them, by name. Returns the exit status."""
    return case_study.main(description, case, variants, COLUMNS, line)
