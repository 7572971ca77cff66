"""Inputs that are right, one scene of each kind, small enough for many runs a second."""

import pathlib
import sys

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "app"))
import gmsh_files

MATERIAL = "-material_young 1e9\n-quiet\n"
HELD = "-bc_names left,right\n-bc_left_on left\n-bc_left_displacement 0,0\n-bc_right_on right\n-bc_right_traction 1e5,0\n"
BOX = "-mesh_lower 0,0\n-mesh_upper 1,1\n-mesh_cells 4,4\n"
PATCH = "-pd_patches 0.25,0.25,0.75,0.75\n-pd_spacing 0.0625\n-pd_horizon_ratio 2\n"
MOVING = "-analysis explicit\n-material_density 1000\n-ts_max_steps 4\n"
CLOUD = MATERIAL + MOVING + "-pd_horizon 0.3\n-bc_names left\n-bc_left_box -0.05,-0.05,0.05,1\n-bc_left_velocity 1,free\n"

# Two bodies of points that touch, one of them from a file; the second with four particles, and a mesh of elements that strikes it.
POINTS = MATERIAL + MOVING + "-mpm_bodies one,two\n-mpm_spacing 0.1\n-mpm_one_file {dir}/points.csv\n-mpm_one_velocity 1,0\n-mpm_two_box 0.8,0,1.6,0.4\n"
FRICTION = "-contact_friction 0.3\n-mpm_bulk_viscosity 0.06\n-probe_names p\n-probe_p_at 1.2,0.2\n-probe_p_field displacement,stress\n"
MIXED = POINTS + FRICTION + "-mesh_lower 1.6,0\n-mesh_upper 2.4,0.4\n-mesh_cells 4,2\n-pd_patches 1,0,1.4,0.4\n-pd_spacing 0.1\n-pd_horizon_ratio 3\n-pd_critical_stretch 0.01\n"
CONVERTED = "-adapt expand\n-adapt_trigger stretch,damage\n-adapt_stretch 1e-6\n-adapt_margin 1\n"

# Options of each scene; {dir} is where the files of FILES are.
SCENES = {
    "plate": BOX + MATERIAL + HELD,
    "patch": BOX + MATERIAL + HELD + PATCH + "# a crack\n-crack_names a\n-crack_a_points 0,0.5,0.5,0.5\n-pd_critical_stretch 1\n",
    "motion": BOX + MATERIAL + HELD + PATCH + MOVING + "-bc_right_history table\n-bc_right_history_file {dir}/history.csv\n",
    "cracks": BOX + MATERIAL + HELD + PATCH + "-crack_file {dir}/cracks.txt\n",
    "regions": BOX + MATERIAL + HELD + PATCH + "-material_file {dir}/materials.txt\n-region_names a,b\n-region_a_polygon 0.1,0.1,0.9,0.2,0.5,0.9\n"
    "-region_a_material clay\n-region_b_box 0.5,0,1,1\n-region_b_no_fail\n-interface_names i\n-interface_i_between a,rest\n-interface_i_toughness 1\n",
    "cloud_csv": CLOUD + "-pd_cloud {dir}/cloud.csv\n",
    "cloud_h5": CLOUD + "-pd_cloud {dir}/cloud.h5\n",
    "points": POINTS + FRICTION,
    "points_updated": POINTS + "-mpm_formulation updated\n-mpm_shape gimp\n-mpm_order usl\n-mpm_pic 0.1\n",
    "mixed": MIXED + CONVERTED,
    "relocated": BOX + MATERIAL + HELD + PATCH + MOVING + "-adapt relocate\n-adapt_every 1\n-pd_critical_stretch 1e-7\n",
    "restart_mixed": MIXED.replace("steps 4", "steps 8") + CONVERTED + "-restart {dir}/mixed.h5\n",
    "restart": BOX + MATERIAL + HELD + PATCH + MOVING.replace("steps 4", "steps 8") + "-restart {dir}/checkpoint.h5\n",
} | {
    f"gmsh_{version}_{kind}": f"-mesh_file {{dir}}/{version}_{kind}.msh\n" + MATERIAL + HELD
    for version in ("2.2", "4.1")
    for kind in ("text", "binary")
}
# What makes the checkpoints of `restart` and `restart_mixed`, by the names of their files.
BEFORE = {
    "checkpoint.h5": BOX + MATERIAL + HELD + PATCH + MOVING + "-checkpoint_interval 4\n",
    "mixed.h5": MIXED + CONVERTED + "-checkpoint_interval 4\n",
}


def cloud_points():
    """(position, volume, set) of 10 x 8 particles 0.1 m apart."""
    x, y = numpy.meshgrid(0.1 * numpy.arange(10), 0.1 * numpy.arange(8))
    position = numpy.column_stack([x.ravel(), y.ravel()])
    return position, numpy.full(len(position), 0.01), (position[:, 0] > 0.05).astype(int)


def write_files(directory):
    """Writes what the scenes read, but for the checkpoints; {scene: name of its file}."""
    position, volume, sets = cloud_points()
    rows = [f"{x:.17g},{y:.17g},{v:.17g},{s}" for (x, y), v, s in zip(position, volume, sets)]
    (directory / "cloud.csv").write_text("x,y,volume,set\n" + "\n".join(rows) + "\n")
    with h5py.File(directory / "cloud.h5", "w") as file:
        file["position"], file["volume"], file["set"] = position, volume, sets
    (directory / "history.csv").write_text("time,value\n0,0\n1e-4,1\n2e-4,0.5\n1,0.5\n")
    sites = [(0.05 + 0.1 * i, 0.05 + 0.1 * j) for j in range(4) for i in range(8)]
    (directory / "points.csv").write_text("x,y,volume\n" + "".join(f"{x:.17g},{y:.17g},0.01\n" for x, y in sites))
    (directory / "materials.txt").write_text("# mine\nclay 2GPa 0.3 1800kg/m^3 5\nwax 10MPa 0.4 - -\n")
    (directory / "cracks.txt").write_text("# cracks\n0,0.5 0.4,0.5\n0.6,0.55,0.7,0.55\n")
    for version in ("2.2", "4.1"):
        for kind in ("text", "binary"):
            gmsh_files.Square(4).write(directory / f"{version}_{kind}.msh", version, kind == "binary")
    return {
        "motion": "history.csv",
        "cracks": "cracks.txt",
        "regions": "materials.txt",
        "cloud_csv": "cloud.csv",
        "cloud_h5": "cloud.h5",
        "restart": "checkpoint.h5",
        "points": "points.csv",
        "restart_mixed": "mixed.h5",
    } | {scene: scene.removeprefix("gmsh_") + ".msh" for scene in SCENES if scene.startswith("gmsh_")}
