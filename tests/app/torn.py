"""Small scenes that are torn apart in 400 explicit steps, and what of two such runs is to be the same."""

import h5py

# A notched plate of 80 x 40 particles, torn apart in 400 steps.
TORN = {
    "-case": "torn",
    "-analysis": "explicit",
    "-mesh_lower": "0,0",
    "-mesh_upper": "0.08,0.04",
    "-pd_patches": "all",
    "-pd_spacing": "0.001",
    "-pd_horizon_ratio": "3",
    "-material_young": "1e9",
    "-material_density": "1000",
    "-pd_critical_stretch": "0.01",
    "-crack_names": "notch",
    "-crack_notch_points": "0,0.02,0.03,0.02",
    "-bc_names": "top,bottom",
    "-bc_top_on": "top",
    "-bc_top_traction": "0,12e6",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_displacement": "free,0",
    "-ts_max_steps": "400",
    "-output_history": "",
    "-quiet": "",
}
# The same pulled gently at both edges: a crack that runs and branches, before and after half of the time.
RUNNING = TORN | {
    "-case": "running",
    "-bc_top_traction": "0,2e6",
    "-bc_bottom_displacement": None,
    "-bc_bottom_traction": "0,-2e6",
}
# Elements with a crack that runs into a patch of 16 x 12 particles; bonds break inside and where the patch ends.
COUPLED = TORN | {
    "-case": "coupled",
    "-mesh_upper": "1,0.5",
    "-mesh_cells": "20,10",
    "-pd_patches": "0.4,0.1,0.8,0.4",
    "-pd_spacing": "0.025",
    "-crack_notch_points": "0,0.275,0.55,0.275",
    "-bc_bottom_velocity": "free,-2",
    "-bc_bottom_displacement": None,
    "-pd_critical_stretch": "0.004",
}
# The same with a patch like an L, in whose leg the crack ends.
SHAPED = COUPLED | {"-case": "shaped", "-pd_patches": "0.4,0.1,0.8,0.25,0.4,0.25,0.6,0.4"}
TABLES = ("displacement", "velocity", "acceleration", "held_force")


def checkpoint(directory):
    """The tables of a checkpoint and its named numbers."""
    with h5py.File(directory / "checkpoint.h5") as file:
        tables = {name: file[name][()] for name in file}
    names = bytes(tables.pop("number_names")[:, 0]).decode().split()
    tables.pop("scene"), tables.pop("options")
    numbers = dict(zip(names, tables.pop("numbers")[:, 0]))
    return tables, numbers


def results(run):
    """All but what is counted from where a run began, and what only runs that may change their layout tell."""
    kept = {name: value for name, value in run.summary["results"].items() if not name.startswith(("pd_tiles", "mpm_cells"))}
    kept.pop("energy_converted", None)
    kept.pop("layout_seconds", None)
    return kept, run.summary["bonds_broken"], run.summary["steps"]

# The double cantilever beam up to six tenths of its load, whose crack grows by far within loads.
BEAM = {
    "-options_file": "cases/dcb/smoke.opts",
    "-bc_top_displacement": "0,0.9e-6",
    "-bc_bottom_displacement": "0,-0.9e-6",
    "-load_steps": "6",
    "-output_fields": "false",
    "-output_history": "",
    "-quiet": "",
}
