"""Mistakes in the input: exit status 1 and one line that says how to mend it, on 1 and 2 ranks.

Usage: test_bad_input.py PDXSOLVE [unittest arguments]. All in one process, if the harness of tests/fuzz was built
beside the program; through the program itself every second on 1 rank and every eighth on 2, or else all. Each row of CASES changes a run that is right (which is tested
to be right) in one way, and says what the line on stderr must name. The environment lets Open MPI run (ctest sets it;
by hand: `. scripts/mpi_env.sh`).
"""

import concurrent.futures
import dataclasses
import pathlib
import sys
import tempfile
import unittest

import harness
import program

TIMEOUT = 60  # [s] longer is a hang
HARNESS = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "").resolve().parent / "tests" / "fuzz_harness"
RANKS = (1, 2)
THROUGH = {1: 2, 2: 8}  # by ranks: one of so many goes through the program

PLATE = {
    "-case": "bad_input",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "4,4",
    "-material_young": "1e9",
    "-material_poisson": "0.3333333333333333",
    "-bc_names": "left,right",
    "-bc_left_on": "left",
    "-bc_left_displacement": "0,0",
    "-bc_right_on": "right",
    "-bc_right_traction": "1e5,0",
    "-quiet": "",
}
# The patch covers the inner 2 x 2 cells: sides of 0.5 m, 10 particles along each.
PATCH = PLATE | {"-pd_patches": "0.25,0.25,0.75,0.75", "-pd_spacing": "0.05", "-pd_horizon_ratio": "3.015"}
# The same that cools, evenly, from a side, and as a table says.
HEAT = PATCH | {"-material_expansion": "1e-5", "-thermal_field": "uniform", "-thermal_initial": "300", "-thermal_ambient": "20"}
QUENCH = HEAT | {"-thermal_field": "quench", "-thermal_conductivity": "30", "-thermal_capacity": "900", "-thermal_sides": "left",
                 "-thermal_duration": "1", "-material_density": "4000"}  # fmt: skip
TABLE = HEAT | {"-thermal_field": "file", "-thermal_file": "{dir}/good.heat", "-thermal_duration": "1", "-thermal_ambient": None}
# One around the tip of a crack.
SEED = PLATE | {"-adapt_seed": "tip", "-pd_spacing": "0.0625", "-adapt_expansion_length": "0.2", "-crack_names": "a",
                "-crack_a_points": "0,0.5,0.6,0.5"}
# A block of 10 x 10 x 4 particles in space, thrown to the right.
SOLID = {key: value for key, value in PLATE.items() if not key.startswith("-bc_")} | {
    "-mesh_cells": None,
    "-material_plane": "solid",
    "-material_poisson": "0.25",
    "-material_thickness": "0.4",
    "-material_density": "1000",
    "-pd_patches": "all",
    "-pd_spacing": "0.1",
    "-pd_horizon_ratio": "2",
    "-pd_surface_correction": "volume",
    "-analysis": "explicit",
    "-ts_max_steps": "3",
    "-bc_names": "left",
    "-bc_left_on": "left",
    "-bc_left_velocity": "1,free,0",
}
# Two boxes of points, apart.
BODIES = {key: value for key, value in PLATE.items() if not key.startswith(("-bc_", "-mesh_"))} | {
    "-material_density": "1000",
    "-analysis": "explicit",
    "-ts_max_steps": "3",
    "-mpm_bodies": "one,two",
    "-mpm_spacing": "0.1",
    "-mpm_one_box": "0,0,0.8,0.4",
    "-mpm_one_velocity": "1,0",
    "-mpm_two_box": "1,0,1.8,0.4",
    "-bc_names": "left",
    "-bc_left_of": "one",
    "-bc_left_on": "left",
    "-bc_left_displacement": "0,0",
}
# The first of them with four particles in its middle, the second struck by elements.
MIXED = BODIES | {
    "-material_poisson": "0.33333333333333333",
    "-mesh_lower": "2,0",
    "-mesh_upper": "2.8,0.4",
    "-mesh_cells": "4,2",
    "-pd_patches": "0.2,0,0.6,0.4",
    "-pd_spacing": "0.1",
    "-pd_horizon_ratio": "3",
    "-pd_critical_stretch": "0.01",
}
# The same two in space, the first held at its left, with a block of particles beside the middle.
SPACE = {key: value for key, value in BODIES.items()} | {
    "-material_plane": "solid",
    "-material_poisson": "0.25",
    "-mpm_one_box": "0,0,0,0.8,0.4,0.4",
    "-mpm_one_velocity": "1,0,0",
    "-mpm_two_box": "1,0,0,1.8,0.4,0.4",
    "-bc_left_displacement": "0,0,0",
    "-pd_patches": "0.4,0,0,0.6,0.4,0.2",
    "-pd_spacing": "0.1",
    "-pd_horizon_ratio": "3",
    "-pd_critical_stretch": "0.01",
}
# 10 x 8 particles 0.1 m apart from a file, those of the left column in set 1; moved at the left, pulled at the top.
CLOUD = {key: value for key, value in PLATE.items() if not key.startswith(("-bc_", "-mesh_"))} | {
    "-pd_cloud": "{dir}/good.csv",
    "-pd_horizon": "0.3",
    "-material_density": "1000",
    "-analysis": "explicit",
    "-ts_max_steps": "3",
    "-bc_names": "left,top",
    "-bc_left_set": "1",
    "-bc_left_velocity": "1,free",
    "-bc_top_box": "0,0.7,1,0.8",
    "-bc_top_force": "0,1e5",
}
POINTS = [(0.1 * i + 0.05, 0.1 * j + 0.05) for j in range(8) for i in range(10)]
# The same plate from a file: no box options.
FILE = {key: value for key, value in PLATE.items() if key not in ("-mesh_lower", "-mesh_upper", "-mesh_cells")}

NODES = "$Nodes\n6\n1 0 0 0\n2 0.5 0 0\n3 1 0 0\n4 0 1 0\n5 0.5 1 0\n6 1 1 0\n$EndNodes\n"
GMSH_HEAD = (
    '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 "left"\n1 2 "right"\n2 3 "plate"\n$EndPhysicalNames\n'
)
SIDES = "1 1 2 1 1 4 1\n2 1 2 2 2 3 6\n"
FILES = {
    "right.msh": GMSH_HEAD + NODES + f"$Elements\n4\n{SIDES}3 3 2 3 1 1 2 5 4\n4 3 2 3 1 2 3 6 5\n$EndElements\n",
    "triangles.msh": GMSH_HEAD
    + NODES
    + f"$Elements\n6\n{SIDES}3 2 2 3 1 1 2 5\n4 2 2 3 1 1 5 4\n5 2 2 3 1 2 3 6\n6 2 2 3 1 2 6 5\n$EndElements\n",
    "truncated.msh": GMSH_HEAD + NODES + f"$Elements\n4\n{SIDES}3 3 2 3",
    "no_nodes.msh": GMSH_HEAD,
    # A lower right half that is missing: three squares of the plate, an L.
    "l.msh": GMSH_HEAD
    + "$Nodes\n8\n1 0 0 0\n2 0.5 0 0\n3 0 0.5 0\n4 0.5 0.5 0\n5 1 0.5 0\n6 0 1 0\n7 0.5 1 0\n8 1 1 0\n$EndNodes\n$Elements\n5\n"
    + "1 1 2 1 1 6 1\n2 1 2 2 2 5 8\n3 3 2 3 1 1 2 4 3\n4 3 2 3 1 3 4 7 6\n5 3 2 3 1 4 5 8 7\n$EndElements\n",
    "garbage.msh": "This is a letter, not a mesh.\nIt has two lines.\n",
    "empty.msh": "",
    "no_dash.opts": "-mesh_cells 4,4\nmaterial_young 1e9\n",
    "circle.opts": "-options_file circle.opts\n",
    "short.txt": "# mine\nclay 1GPa 0.3\n",
    "seconds.txt": "clay 1s 0.3 - -\n",
    "word.txt": "clay stiff 0.3 - -\n",
    "blocker": "a regular file\n",
    "good.cracks": "# a crack a line\n0 0.55, 1 0.55\n\n0,0.3,1,0.3 # another\n",
    "word.cracks": "0 0.55 0.3 0.55\n0.7 half 1 0.45\n",
    "odd.cracks": "0 0.55 0.3\n",
    "comment.cracks": "# nothing but words\n\n",
    "outside.cracks": "0 0.55 0.3 0.55\n0 55 30 55\n",
    "good.heat": "# time x y temperature\n0 0 0 300\n1 0 0 300\n0 1 0 300\n1 1 0 20\n",
    "word.heat": "0 0 0 300\n1 0 0 warm\n",
    "short.heat": "0 0 300\n",
    "hole.heat": "0 0 0 300\n1 0 0 300\n0 1 0 300\n",
    "twice.heat": "0 0 0 300\n1 0 0 300\n1 0 0 301\n1 1 0 20\n",
    "good.csv": "x,y,volume,set\n" + "".join(f"{x},{y},0.01,{int(x < 0.1)}\n" for x, y in POINTS),
    "space.csv": "x,y,z,volume\n" + "".join(f"{x},{y},{z},0.001\n" for z in (0, 0.1) for x, y in POINTS),
    "columns.csv": "x,y,mass\n0,0,1\n1,0,1\n",
    "short.csv": "x,y,volume\n0,0,1\n1,0\n",
    "negative.csv": "x,y,volume\n0,0,1\n1,0,-1\n",
    "vast.csv": "x,y,volume\n0,0,1\n1,0,1e300\n",
    "far.csv": "x,y,volume\n1e13,0,1e-6\n1e13,1e-3,1e-6\n",
    "nobody.csv": "x,y,volume\n",
    "twice.csv": "x,y,volume,set\n" + "".join(f"{x},{y},0.01,1\n" for x, y in [*POINTS, POINTS[7]]),
    "cloud.h5": "no HDF5\n",
}


@dataclasses.dataclass(frozen=True)
class Case:
    """A run that must be refused: `change` of `base` (None takes an option away), and what the line must match."""

    name: str
    change: dict
    pattern: str
    base: dict = dataclasses.field(default_factory=lambda: PLATE)

    def arguments(self, directory):
        options = {"-output_dir": "{dir}/out"} | self.base | self.change
        return [word.replace("{dir}", directory) for word in program.words_of(options)]


def on(base):
    """A function that makes a case on `base`; its keyword `mesh_cells` is option `-mesh_cells`."""
    return lambda name, pattern, **change: Case(name, {f"-{key}": value for key, value in change.items()}, pattern, base)


plate, patch, solid, points, mixed, space = map(on, (PLATE, PATCH, SOLID, BODIES, MIXED, SPACE))
heat, quench, table = map(on, (HEAT, QUENCH, TABLE))


def cloud(name, pattern, **change):
    """A case on particles from a file."""
    return Case(name, {f"-{key}": value for key, value in change.items()}, pattern, CLOUD)


def from_file(name, pattern, file):
    """A case on the plate read from a file."""
    return Case(name, {"-mesh_file": file}, pattern, FILE)


def crack(name, pattern, points, **change):
    """A case on the plate with one crack."""
    return plate(name, pattern, crack_names="a", crack_a_points=points, **change)


def seed(name, pattern, **change):
    """A case on the plate with patches at the tip of a crack."""
    return Case(name, {f"-{key}": value for key, value in change.items()}, pattern, SEED)


PARTICLES = {"pd_patches": "0.25,0.25,0.75,0.75", "pd_spacing": "0.05", "pd_horizon_ratio": "3.015"}


def region(name, pattern, **change):
    """A case on the plate with one region."""
    return Case(name, {f"-{key}": value for key, value in change.items()}, pattern, PLATE | {"-region_names": "r", "-region_r_box": "0,0,0.5,1"})


CASES = [
    # --- rollers, springs, turns, pins, formulas
    plate("a roller without a direction", r"-bc_left_roller is 0,0: must be a direction", bc_left_displacement=None, bc_left_roller="0,0"),
    plate("a roller that is moved", r"-bc_left_roller and -bc_left_displacement hold the same", bc_left_roller="1,1"),
    plate("rollers that meet what moves", r"-bc_roll_roller holds what another condition moves", bc_names="left,right,roll",
          bc_left_displacement="1e-3,1e-3", bc_roll_on="bottom", bc_roll_roller="1,1"),
    plate("springs nowhere", r"-bc_s_spring stands on a side.*-bc_s_on", bc_names="left,right,s", bc_s_spring="1e9"),
    patch("face mass of two densities", r"-couple_face_mass hands over mass of one density.*-region_s_density", analysis="explicit",
          material_density="1000", ts_max_steps="2", couple_face_mass="", region_names="s", region_s_box="0,0,0.5,0.5", region_s_density="400"),
    plate("springs of no stiffness", r"-bc_s_spring has 1 value that is 0", bc_names="left,right,s", bc_s_on="top", bc_s_spring="0"),
    plate("springs that pull", r"-bc_s_spring\b.*at least 0", bc_names="left,right,s", bc_s_on="top", bc_s_spring="-1"),
    plate("springs at a crack", r"-bc_s_spring: a crack cuts elements at that side", bc_names="left,right,s", bc_s_on="top", bc_s_spring="1e9",
          crack_names="a", crack_a_points="0.6,1,0.6,0.6"),
    plate("a direction of no springs", r"-bc_left_spring_along\b.*-bc_left_spring", bc_left_spring_along="1,1"),
    patch("a roller without a matrix", r"-bc_left_roller needs a matrix\b.*-pd_operator", bc_left_displacement=None, bc_left_roller="1,1",
          pd_operator="matrix_free"),
    plate("a turn about nowhere", r"-bc_left_turn needs a centre: give -bc_left_centre", bc_left_displacement=None, bc_left_turn="1"),
    plate("a centre of nothing", r"-bc_left_centre\b.*-bc_left_turn", bc_left_centre="0,0"),
    plate("an angle in metres", r"-bc_left_turn\b.*rad", bc_left_displacement=None, bc_left_turn="1mm", bc_left_centre="0,0"),
    plate("a pin with a velocity in statics", r"-bc_p_velocity acts in time", bc_names="left,right,p", bc_p_pin="0.1", bc_p_at="2,2", bc_p_velocity="1,0"),
    points("a pin nowhere", r"-bc_p_pin needs a place: give -bc_p_at", bc_names="left,p", bc_p_pin="0.1"),
    points("a pin in the body", r"-bc_p_pin begins 0\.1 m deep in the body", bc_names="left,p", bc_p_pin="0.1", bc_p_at="0.4,0.2"),
    points("a pin that holds", r"-bc_p_pin pushes, and moves by", bc_names="left,p", bc_p_pin="0.1", bc_p_at="0,3", bc_p_body="0,1"),
    points("a pin on one grid", r"-bc_p_pin is of -mpm_formulation total", bc_names="left,p", bc_p_pin="0.1", bc_p_at="0,3",
           mpm_formulation="updated"),
    cloud("springs of a cloud", r"-bc_left_spring stands on a side.*-pd_cloud has none", bc_left_velocity=None, bc_left_spring="1e9"),
    plate("a history in statics", r"-bc_right_history is a factor in time, and in statics loads grow evenly", bc_right_history_points="0:0,1:1"),
    solid("a formula that ends early", r'-bc_left_history_expression is "sin\(2\*t": at character 8, its end: a bracket is not closed',
          bc_left_history_expression="sin(2*t"),
    solid("a formula of an unknown", r'-bc_left_history_expression is "2\*x": at character 3 \("x"\): "x" is unknown',
          bc_left_history_expression="2*x"),
    solid("a formula that is no number", r"-bc_left_history_expression is .* no number at t = 0 s", bc_left_history_expression="1/t"),
    solid("a formula of nothing", r"-bc_left_history_expression\b", bc_left_history="step", bc_left_history_expression="t"),
    # --- regions and materials by name
    region("region without a shape", r"-region_r: a region needs one shape.*-region_r_box", region_r_box=None),
    region("region of two shapes", r"-region_r: a region needs one shape", region_r_polygon="0,0,1,0,1,1"),
    region("region upside down", r"-region_r_box is 1,0,0,1\b.*x0 < x1", region_r_box="1,0,0,1"),
    region("region of two corners", r"-region_r_polygon\b.*three corners", region_r_box=None, region_r_polygon="0,0,1,0"),
    region("surface without a mesh", r"-region_r_surface\b.*-mesh_file", region_r_box=None, region_r_surface="plate"),
    Case("surface that a mesh has not", {"-mesh_file": "{dir}/right.msh", "-region_names": "r", "-region_r_surface": "plat"},
         r"-region_r_surface plat: -mesh_file .*no physical surface \"plat\": it has plate", FILE),
    region("region that is not listed", r"-region_q_young is no option of pdxsolve: q is not in -region_names", region_q_young="1e9"),
    region("region listed twice", r"-region_names lists r twice", region_names="r,r"),
    region("region called rest", r"-region_names lists rest\b.*another name", region_names="r,rest", region_rest_box="0,0,1,1"),
    region("soft as nothing", r"-region_r_young\b.*above 0", region_r_young="0"),
    region("toughness of a region without particles", r"-region_r_toughness\b.*-pd_patches", region_r_toughness="3"),
    region("a ratio that bonds do not have", r"-region_r_poisson is 0\.2\b.*0\.333", region_r_poisson="0.2", **PARTICLES),
    region("tough and unbreakable", r"-region_r_toughness\b.*-region_r_no_fail", region_r_toughness="3", region_r_no_fail="", **PARTICLES),
    region("a stretch of one material", r"-pd_critical_stretch\b.*-region_NAME_toughness", pd_critical_stretch="1e-3", **PARTICLES),
    region("J of two materials", r"-post_j_domain: within 0\.3 m of the tip at \(0\.5, 0\.5\) lie .*one material", post_j_domain="0.1,0.3",
           region_r_young="2e9", crack_names="c", crack_c_points="0,0.5,0.5,0.5"),
    region("J of two materials in a patch", r"-post_j_contours: within .*one material", post_j_contours="0.15,0.2", region_r_young="2e9",
           crack_names="c", crack_c_points="0,0.5,0.5,0.5", **PARTICLES),
    region("a region that crosses itself", r"-region_r_polygon crosses itself: its sides from \(0, 0\) and from \(1, 0\)", region_r_box=None,
           region_r_polygon="0,0,1,1,1,0,0,1"),
    region("a region of no thickness", r"-region_r_thickness\b.*above 0", region_r_thickness="0"),
    region("region without a density", r"-material_density is missing", analysis="explicit", ts_max_steps="2"),
    region("an interface to nowhere", r"-interface_i_between: there is no region q: there are r and rest", interface_names="i",
           interface_i_between="r,q", interface_i_toughness="1", **PARTICLES),
    region("an interface of one", r"-interface_i_between must name two regions", interface_names="i", interface_i_between="r",
           interface_i_toughness="1", **PARTICLES),
    region("an interface without a toughness", r"-interface_i_toughness is missing", interface_names="i", interface_i_between="r,rest",
           **PARTICLES),
    region("two interfaces of a pair", r"-interface_j_between\b.*-interface_i_between", interface_names="i,j", interface_i_between="r,rest",
           interface_i_toughness="1", interface_j_between="rest,r", interface_j_toughness="2", **PARTICLES),
    plate("an interface without regions", r"-interface_names\b.*-region_names", interface_names="i", interface_i_between="a,b"),
    points("regions of points", r"-region_names\b.*-mpm_NAME_young", region_names="r", region_r_box="0,0,1,1"),
    cloud("regions of a cloud", r"-region_names: a -pd_cloud is of one material", region_names="r", region_r_box="0,0,1,1"),
    plate("a material that is not there", r"-material is gold: there are .*alumina.*did you mean", material_young=None, material="gold"),
    region("a region's material that is not there", r"-region_r_material is alumna: .*did you mean alumina\?", region_r_material="alumna"),
    plate("a file of materials that is not there", r"-material_file.*nowhere\.txt: there is no such file", material_file="nowhere.txt"),
    plate("a short line of materials", r"-material_file .*short\.txt, line 2: .*here are 3 words", material_file="{dir}/short.txt"),
    plate("a modulus in seconds", r"-material_file .*seconds\.txt, line 1: .*Pa", material_file="{dir}/seconds.txt"),
    plate("a word for a modulus", r"-material_file .*word\.txt, line 1: .*no Young's modulus", material_file="{dir}/word.txt"),
    # --- names
    plate("misspelt option", r"-mesh_cels\b.*-mesh_cells\b", mesh_cels="4,4"),
    plate("misspelt option in place of a needed one", r"-material_young\b", material_young=None, material_yuong="1e9"),
    plate("misspelt prefix", r"-msh_cells\b.*-mesh_cells\b", msh_cells="4,4"),
    plate("option without a room", r"-young\b", young="1e9"),
    plate("option of a condition that is not listed", r"-bc_top_traction\b", bc_top_traction="1,0"),
    plate("misspelt option of a condition", r"-bc_right_tracton\b.*-bc_right_traction\b", bc_right_tracton="1,0"),
    # --- words from a list
    plate("misspelt plane", r"-material_plane\b.*stres\b.*stress", material_plane="stres"),
    plate("unknown kinematics", r"-kinematics\b.*small.*finite.*mixed", kinematics="huge"),
    patch("unknown micromodulus", r"-pd_micromodulus\b.*uniform.*conical", pd_micromodulus="cubic"),
    patch("unknown calibration", r"-pd_calibration\b.*one of (continuum, lattice|lattice, continuum)",
          pd_calibration="none"),
    patch("unknown surface correction", r"-pd_surface_correction\b.*auto.*none.*volume", pd_surface_correction="area"),
    patch("exact surface correction of few bonds", r"-pd_surface_correction\b.*ratio of 3 to 6",
          pd_surface_correction="exact", pd_horizon_ratio="2", pd_calibration="continuum"),
    patch("unknown operator", r"-pd_operator\b.*auto.*matrix_free.*assembled", pd_operator="dense"),
    patch("unknown coupling", r"-couple_scheme\b.*energy.*ghost.*interface", couple_scheme="nonsense"),
    plate("neither true nor false", r"-output_fields\b.*perhaps.*true.*false", output_fields="perhaps"),
    plate("neither true nor false in history", r"-output_history\b.*2.*true.*false", output_history="2"),
    plate("unknown partitioner", r"partitioner.*nonsense", petscpartitioner_type="nonsense"),
    plate("unknown linear solver", r"nonsense", ksp_type="nonsense"),
    plate("preconditioner once", r"-ksp_type preonly\b.*-pc_type lu", ksp_type="preonly"),
    patch("symmetric method on an unsymmetric tangent", r"-ksp_type cg\b.*-couple_scheme interface\b.*gmres",
          ksp_type="cg", couple_scheme="interface"),
    patch("particles coarser than elements", r"-pd_spacing\b.*0\.5.*at most the 0\.25 m of the elements",
          pd_patches="0.25,0.25,0.75,0.75", pd_spacing="0.5"),
    plate("body force where nothing is", r"-bc_right_box\b.*nothing", bc_right_traction=None, bc_right_on=None,
          bc_right_body="0,1", bc_right_box="5,5,6,6"),
    # --- numbers
    plate("Young's modulus below zero", r"-material_young\b.*-1(e\+?0?9|0{9})\b.*above 0", material_young="-1e9"),
    plate("Young's modulus zero", r"-material_young\b.*above 0", material_young="0"),
    plate("Young's modulus not a number", r"-material_young\b.*\bnan", material_young="nan"),
    plate("Young's modulus infinite", r"-material_young\b.*\binf", material_young="inf"),
    plate("Young's modulus a word", r"-material_young\b.*steel.*number", material_young="steel"),
    plate("Young's modulus with a length", r"-material_young is \"70mm\": \"mm\" is of the wrong kind: a value in Pa", material_young="70mm"),
    plate("Young's modulus with no unit there is", r"-material_young is \"70gpa\": must be a number, its unit", material_young="70gpa"),
    plate("a ratio with a unit", r"-material_poisson is \"0\.3mm\": .* a number without a unit", material_poisson="0.3mm"),
    plate("a count with a unit", r"-load_steps is \"3mm\": must be a whole number", load_steps="3mm"),
    plate("a displacement with a unit of time", r"-bc_left_displacement is \"1us\": \"us\" is of the wrong kind", bc_left_displacement="0,1us"),
    plate("units behind some numbers only", r"-mesh_upper has 1m with a unit and 2 without", mesh_upper="1m,2"),
    plate("a required option misspelt", r"-material_yung is no option of pdxsolve: did you mean -material_young\?", material_young=None, material_yung="1e9"),
    plate("a condition's option misspelt", r"-bc_left_displacment is no option of pdxsolve: did you mean -bc_left_displacement\?",
          bc_left_displacement=None, bc_left_displacment="0,0"),
    plate("a condition that is not listed", r"-bc_right_on is no option of pdxsolve: right is not in -bc_names \(left\): add it", bc_names="left"),
    plate("no list of conditions", r"-bc_left_displacement is no option of pdxsolve: left is not in -bc_names, which is not given", bc_names=None),
    plate("a crack that is not listed", r"-crack_a_points is no option of pdxsolve: a is not in -crack_names", crack_a_points="0,0.5,0.5,0.5"),
    plate("a warning that is an error", r"^error: -ts_max_time acts in time .*\(-warnings_are_errors\)$", ts_max_time="1", warnings_are_errors=""),
    plate("Young's modulus without a value", r"-material_young\b", material_young=""),
    plate("no Young's modulus", r"-material_young\b", material_young=None),
    plate("incompressible", r"-material_poisson\b.*0\.5", material_poisson="0.5"),
    plate("Poisson's ratio below -1", r"-material_poisson\b.*-1\.5", material_poisson="-1.5"),
    plate("thickness zero", r"-material_thickness\b.*above 0", material_thickness="0"),
    plate("load steps zero", r"-load_steps\b.*0.*at least 1", load_steps="0"),
    plate("load steps not whole", r"-load_steps\b.*2\.5.*whole", load_steps="2.5"),
    # --- mesh
    plate("no mesh at all", r"-mesh_cells\b", mesh_lower=None, mesh_upper=None, mesh_cells=None),
    plate("zero cells", r"-mesh_cells\b.*0", mesh_cells="0,4"),
    plate("negative cells", r"-mesh_cells\b.*-4", mesh_cells="4,-4"),
    plate("one number of cells", r"-mesh_cells\b.*2", mesh_cells="4"),
    plate("cells not whole", r"-mesh_cells\b.*4\.5.*whole", mesh_cells="4.5,4"),
    plate("more cells than can be counted", r"-mesh_cells\b", mesh_cells="100000,100000"),
    plate("lower above upper", r"-mesh_(lower|upper)\b", mesh_lower="2,0"),
    plate("box without height", r"-mesh_(lower|upper)\b", mesh_upper="1,0"),
    plate("corner not a number", r"-mesh_upper\b.*nan", mesh_upper="nan,1"),
    plate("corner with three coordinates", r"-mesh_lower\b.*3.*2", mesh_lower="0,0,0"),
    from_file("missing mesh file", r"nowhere\.msh", "{dir}/nowhere.msh"),
    from_file("mesh file is a directory", r"-mesh_file\b|\{dir\}", "{dir}"),
    from_file("truncated mesh file", r"truncated\.msh", "{dir}/truncated.msh"),
    from_file("mesh file that ends after its header", r"no_nodes\.msh", "{dir}/no_nodes.msh"),
    from_file("triangles", r"triangles\.msh.*(four|quad)", "{dir}/triangles.msh"),
    from_file("text instead of a mesh", r"garbage\.msh", "{dir}/garbage.msh"),
    from_file("empty mesh file", r"empty\.msh", "{dir}/empty.msh"),
    # --- patches
    patch("patch outside the mesh", r"-pd_patches\b.*(outside|inside|mesh)", pd_patches="2,2,3,3"),
    patch("patch half outside the mesh", r"-pd_patches\b.*(outside|inside|mesh)", pd_patches="0.5,0.25,1.5,0.75"),
    patch("patch that cuts elements", r"-pd_patches\b.*(element|cell|edge)", pd_patches="0.3,0.25,0.75,0.75"),
    Case("patch that reaches out of an L", {"-mesh_file": "{dir}/l.msh", "-pd_patches": "0,0,1,1", "-pd_spacing": "0.05"},
         r"-pd_patches: patch 1\b.*where there are no elements: only 75 %.*several boxes", FILE),
    patch("patch without width", r"-pd_patches\b", pd_patches="0.25,0.25,0.25,0.75"),
    patch("patch inside out", r"-pd_patches\b", pd_patches="0.75,0.75,0.25,0.25"),
    patch("three numbers for a patch", r"-pd_patches\b.*3", pd_patches="0.25,0.25,0.75"),
    patch("patch with a word in it", r"-pd_patches\b.*\bsome\b", pd_patches="some"),
    patch("touching patches of two spacings", r"-pd_patches\b.*1 and 2 touch.*0\.05 and 0\.025\b.*one spacing",
          pd_patches="0.25,0.25,0.5,0.75,0.5,0.25,0.75,0.75", pd_spacing="0.05,0.025"),
    patch("overlapping patches of two spacings", r"-pd_patches\b.*2 and 3 touch.*0\.05 and 0\.025\b.*one spacing",
          pd_patches="0,0,0.25,0.25,0.5,0.25,1,0.75,0.75,0.5,1,1", pd_spacing="0.05,0.05,0.025"),
    patch("touching patches half a spacing apart", r"-pd_patches\b.*1 and 2 touch.*5 by 2\.5 spacings.*0\.05 fits both",
          pd_patches="0,0.25,0.5,0.75,0.5,0.5,1,1", pd_spacing="0.1"),
    patch("second box of an L that cuts elements", r"-pd_patches\b.*patch 2\b.*element.*0\.5,0\.25,0\.75,0\.5",
          pd_patches="0.25,0.25,0.5,0.75,0.5,0.25,0.8,0.5"),
    patch("second box of an L outside the mesh", r"-pd_patches\b.*patch 2\b.*leaves the mesh",
          pd_patches="0.5,0.25,0.75,0.75,0.75,0.25,1.25,0.5"),
    patch("ghosts around an L", r"-couple_scheme ghost\b.*boxes apart.*1, 2 of -pd_patches.*energy",
          pd_patches="0.25,0.25,0.5,0.75,0.5,0.25,0.75,0.5", couple_scheme="ghost"),
    patch("patch without a spacing", r"-pd_spacing\b", pd_spacing=None),
    patch("negative spacing", r"-pd_spacing\b.*above 0", pd_spacing="-0.05"),
    patch("zero spacing", r"-pd_spacing\b.*above 0", pd_spacing="0"),
    patch("spacing not a number", r"-pd_spacing\b.*nan", pd_spacing="nan"),
    patch("spacing that does not divide the side", r"-pd_spacing\b.*0\.06\b.*0\.0625\b", pd_spacing="0.06"),
    patch("two spacings for one patch", r"-pd_spacing\b.*2", pd_spacing="0.05,0.05"),
    patch("horizon below the spacing", r"-pd_horizon_ratio\b.*0\.5.*1", pd_horizon_ratio="0.5"),
    patch("horizon beyond the bond word", r"horizon", pd_horizon_ratio="1000"),
    patch("Poisson's ratio that bonds cannot have", r"-material_poisson\b.*0\.2\b.*(1/3|0\.333)",
          material_poisson="0.2"),
    patch("Poisson's ratio near the one of bonds", r"-material_poisson is 0\.33\b.*0\.333333", material_poisson="0.33"),
    patch("plane strain at 1/3 with bonds", r"-material_poisson\b.*(1/4|0\.25)", material_plane="strain"),
    patch("all peridynamic at a wrong Poisson's ratio", r"-material_poisson\b.*(1/3|0\.333)", pd_patches="all",
          material_poisson="0.2"),
    # --- boundary conditions
    plate("unknown boundary", r"-bc_left_on\b.*lefft.*\bleft\b.*\bright\b|-bc_left_on\b.*lefft.*\bright\b.*\bleft\b",
          bc_left_on="lefft"),
    plate("condition that prescribes nothing", r"-bc_right_", bc_right_traction=None),
    plate("condition listed but not described", r"-bc_top_", bc_names="left,right,top"),
    plate("condition listed twice", r"-bc_names\b.*left", bc_names="left,left,right"),
    plate("condition without a place", r"-bc_right_(on|box)\b", bc_right_on=None),
    plate("box that selects nothing", r"-bc_left_box\b", bc_left_on=None, bc_left_box="2,2,3,3"),
    plate("box of three numbers", r"-bc_left_box\b.*3.*4", bc_left_on=None, bc_left_box="0,0,1"),
    plate("traction not a number", r"-bc_right_traction\b.*nan", bc_right_traction="nan,0"),
    plate("traction of one component", r"-bc_right_traction\b.*2", bc_right_traction="1e5"),
    plate("displacement of three components", r"-bc_left_displacement\b.*3.*2", bc_left_displacement="0,0,0"),
    plate("misspelt free", r"-bc_left_displacement\b.*fre\b.*free", bc_left_displacement="0,fre"),
    plate("point force outside the mesh", r"-bc_right_at\b", bc_right_on=None, bc_right_traction=None,
          bc_right_force="1,0", bc_right_at="2,2"),
    plate("point force without a point", r"-bc_right_at\b", bc_right_on=None, bc_right_traction=None,
          bc_right_force="1,0"),
    plate("place without a point force", r"-bc_right_at\b.*-bc_right_force\b", bc_right_at="0.5,0.5"),
    plate("body force on a boundary", r"-bc_right_on\b.*body.*-bc_right_box\b", bc_right_traction=None,
          bc_right_body="1,0"),
    plate("a point that is to be held", r"-bc_right_at is the place of a point force\b.*-bc_right_box", bc_right_traction=None,
          bc_right_on=None, bc_right_displacement="0,0", bc_right_at="0.5,0.5"),
    plate("point force on a boundary", r"-bc_right_on\b.*-bc_right_at\b", bc_right_traction=None,
          bc_right_force="1,0", bc_right_at="0.5,0.5"),
    plate("no condition at all", r"-bc_names\b|-bc_\w*displacement", bc_names=None, bc_left_on=None,
          bc_left_displacement=None, bc_right_on=None, bc_right_traction=None),
    plate("plate that nothing holds", r"displacement|held|support", bc_names="right", bc_left_on=None,
          bc_left_displacement=None),
    plate("plate that can slide", r"slide|move|rigid|held|support", bc_left_displacement="0,free"),
    plate("plate that can rotate", r"rotat|turn|rigid|held|support", bc_left_on=None,
          bc_left_box="-0.1,-0.1,0.1,0.1"),
    # --- cracks
    plate("crack without points", r"-crack_a_points\b", crack_names="a"),
    crack("crack that is not listed", r"-crack_b_points\b", "0,0.55,0.5,0.55", crack_b_points="0,0.2,0.5,0.2"),
    plate("crack listed twice", r"-crack_names\b.*\ba\b", crack_names="a,a", crack_a_points="0,0.55,0.5,0.55"),
    crack("crack of one point", r"-crack_a_points\b.*2", "0,0.55"),
    crack("crack of two and a half points", r"-crack_a_points\b.*5", "0,0.55,0.5,0.55,0.7"),
    crack("crack with a word in it", r"-crack_a_points\b.*half", "0,half,0.5,0.55"),
    crack("crack with nan in it", r"-crack_a_points\b.*nan", "0,nan,0.5,0.55"),
    crack("crack without length", r"crack 1\b.*\(0\.5, 0\.55\).*twice", "0.5,0.55,0.5,0.55"),
    crack("crack that turns back", r"crack 1\b.*turns back", "0,0.55,0.5,0.55,0.2,0.55"),
    crack("crack that crosses itself", r"crack 1\b.*meet", "0,0.55,0.5,0.55,0.5,0.7,0.3,0.7,0.3,0.2"),
    crack("crack in a ring", r"crack 1\b.*meet", "0.2,0.2,0.7,0.2,0.7,0.7,0.2,0.7,0.2,0.2"),
    crack("crack outside the body", r"crack 1\b.*\(0, 55\).*body.*\(1, 1\)", "0,55,50,55"),
    plate("a crack twice", r"cracks 1 and 2 run along each other",
          crack_names="a,b", crack_a_points="0,0.52,0.5,0.52", crack_b_points="0.5,0.52,0,0.52"),
    plate("cracks that overlap", r"cracks 1 and 2 run along each other",
          crack_names="a,b", crack_a_points="0,0.52,0.5,0.52", crack_b_points="0.4,0.52,0.9,0.52"),
    plate("cracks that cross beside a patch", r"several cracks cut touches a patch at \(0\.\d+, 0\.\d+\).*one row",
          crack_names="a,b", crack_a_points="0,0.53,1,0.53", crack_b_points="0.53,0,0.53,1",
          pd_patches="0.75,0.25,1,0.75", pd_spacing="0.05"),
    plate("a part cut off, far from the origin", r"a part of the body, from \(100\.5, 200\) to \(101, 201\) m",
          mesh_lower="100,200", mesh_upper="101,201", crack_names="a", crack_a_points="100.55,199,100.55,202"),
    plate("missing crack file", r"-crack_file\b.*nowhere\.cracks", crack_file="{dir}/nowhere.cracks"),
    plate("crack file is a directory", r"-crack_file\b", crack_file="{dir}"),
    plate("crack file with a word in it", r"word\.cracks, line 2: .half. is not a number", crack_file="{dir}/word.cracks"),
    plate("crack file with an odd number", r"odd\.cracks.*line 1\b.*3", crack_file="{dir}/odd.cracks"),
    plate("crack file of comments", r"comment\.cracks.*no crack", crack_file="{dir}/comment.cracks"),
    plate("crack of a file outside the body", r"crack 2\b.*body", crack_file="{dir}/outside.cracks"),
    crack("unknown quadrature", r"-xfem_quadrature\b.*gauss.*polygons.*grid", "0,0.55,1,0.55", xfem_quadrature="gauss"),
    crack("share of support below zero", r"-xfem_least_share\b.*-0\.1.*0", "0,0.55,1,0.55", xfem_least_share="-0.1"),
    crack("share of support above a half", r"-xfem_least_share\b.*0\.6.*0\.5", "0,0.55,1,0.55", xfem_least_share="0.6"),
    # --- toughness, breaking, load path
    patch("toughness zero", r"-material_toughness\b.*above 0", material_toughness="0"),
    patch("toughness below zero", r"-material_toughness\b.*above 0", material_toughness="-5"),
    patch("toughness not a number", r"-material_toughness\b.*nan", material_toughness="nan"),
    patch("toughness a word", r"-material_toughness\b.*glass", material_toughness="glass"),
    patch("critical stretch zero", r"-pd_critical_stretch\b.*above 0", pd_critical_stretch="0"),
    patch("toughness twice", r"-material_toughness\b.*-pd_critical_stretch\b", material_toughness="5",
          pd_critical_stretch="0.01"),
    patch("unknown toughness", r"-pd_toughness\b.*papers.*lattice.*continuum", pd_toughness="papers"),
    patch("box of three numbers that must not fail", r"-pd_no_fail\b.*3.*four", pd_no_fail="0,0,1"),
    patch("box inside out that must not fail", r"-pd_no_fail\b.*x0 < x1", pd_no_fail="1,0,0,1"),
    patch("box of words that must not fail", r"-pd_no_fail\b.*left", pd_no_fail="left"),
    patch("unknown release", r"-pd_release\b.*best.*all.*worst", pd_release="best"),
    patch("release of nothing", r"-pd_release_share\b.*0", pd_release_share="0"),
    patch("release of more than all", r"-pd_release_share\b.*1\.5.*1", pd_release_share="1.5"),
    patch("scatter below zero", r"-pd_scatter\b.*-0\.1.*0", pd_scatter="-0.1"),
    patch("scatter of all", r"-pd_scatter\b.*1\b.*0\.9", pd_scatter="1"),
    patch("a draw of nothing", r"-pd_scatter_seed\b.*-pd_scatter\b", pd_scatter_seed="2"),
    patch("scatter where nothing breaks", r"-pd_scatter\b.*-material_toughness", pd_scatter="0.1"),
    plate("halvings below zero", r"-load_halvings\b.*-1.*0", load_halvings="-1"),
    plate("too many halvings", r"-load_halvings\b.*31.*30", load_halvings="31"),
    plate("unknown condensation", r"-static_condense\b.*auto.*on.*off", static_condense="always"),
    patch("condensation of finite strain", r"-static_condense on\b.*small strain.*auto", static_condense="on", kinematics="finite"),
    plate("no pass", r"-load_passes\b.*0.*at least 1", load_passes="0"),
    plate("broken share zero", r"-load_broken_share\b.*0", load_broken_share="0"),
    plate("broken share above all", r"-load_broken_share\b.*2", load_broken_share="2"),
    # --- heat
    heat("unknown temperatures", r"-thermal_field\b.*cold.*none, uniform, quench, file", thermal_field="cold"),
    heat("no expansion", r"-material_expansion\b.*missing.*1/K", material_expansion=None),
    heat("expansion zero", r"-material_expansion\b.*above 0", material_expansion="0"),
    heat("expansion of a length", r"-material_expansion\b.*mm.*1/K", material_expansion="1mm"),
    heat("no temperature at first", r"-thermal_initial\b.*missing", thermal_initial=None),
    heat("no temperature at last", r"-thermal_ambient\b.*missing", thermal_ambient=None),
    heat("expansion without temperatures", r"-material_expansion\b.*-thermal_field", thermal_field=None,
         thermal_initial=None, thermal_ambient=None),
    heat("temperature without a field", r"-thermal_initial\b.*-thermal_field", thermal_field=None),
    heat("duration of even heat", r"-thermal_duration\b.*quench or file", thermal_duration="1"),
    heat("heat in time", r"-thermal_field\b.*-analysis static", analysis="explicit", material_density="1000",
         ts_max_steps="1"),
    heat("heat in slow time", r"-thermal_field\b.*-analysis static", analysis="implicit", material_density="1000",
         ts_max_steps="1", ts_dt="1"),
    heat("heat at finite strain", r"-thermal_field\b.*-kinematics small or mixed", kinematics="finite"),
    heat("heat and J", r"-thermal_field\b.*-post_j", post_j_contours="0.2", post_j_centre="0.5,0.5"),
    heat("heat in regions", r"-thermal_field\b.*-region_names", region_names="a", region_a_box="0,0,1,0.5", region_a_young="2e9"),
    heat("heat in patches that hand back", r"-thermal_field\b.*-adapt relocate", adapt="relocate",
         material_toughness="5"),
    quench("quench without sides", r"-thermal_sides\b.*missing.*left,bottom", thermal_sides=None),
    quench("quench of an unknown side", r"-thermal_sides\b.*north.*left, right, bottom, top", thermal_sides="north"),
    quench("quench without a conductivity", r"-thermal_conductivity\b.*missing", thermal_conductivity=None),
    quench("quench without a capacity", r"-thermal_capacity\b.*missing", thermal_capacity=None),
    quench("quench without a density", r"-material_density\b.*missing", material_density=None),
    quench("quench without a time", r"-thermal_duration\b.*missing", thermal_duration=None),
    quench("transfer below zero", r"-thermal_transfer\b.*above 0", thermal_transfer="-1"),
    quench("unknown pace", r"-thermal_pace\b.*fast.*even, square", thermal_pace="fast"),
    quench("quench of a mesh from a file", r"quench\b.*rectangle.*-mesh_file", mesh_file="{dir}/right.msh",
           mesh_lower=None, mesh_upper=None, mesh_cells=None, pd_patches=None, pd_spacing=None, pd_horizon_ratio=None),
    quench("quench with a table", r"-thermal_file\b.*-thermal_field file", thermal_file="{dir}/good.heat"),
    table("no table", r"-thermal_file\b.*missing", thermal_file=None),
    table("table that is not there", r"-thermal_file\b.*nowhere\.heat", thermal_file="{dir}/nowhere.heat"),
    table("table with a word", r"word\.heat, line 2: .warm. is not a number", thermal_file="{dir}/word.heat"),
    table("table with a short line", r"short\.heat, line 1.*3 items.*temperature", thermal_file="{dir}/short.heat"),
    table("table with a hole", r"hole\.heat.*3 points.*grid of 4", thermal_file="{dir}/hole.heat"),
    table("table with a point twice", r"twice\.heat.*no point at.*another twice", thermal_file="{dir}/twice.heat"),
    table("empty table", r"comment\.cracks.*no line", thermal_file="{dir}/comment.cracks"),
    table("table and a medium", r"-thermal_ambient\b.*quench or uniform", thermal_ambient="20"),
    # --- how cracks are followed
    patch("unknown tracker", r"-adapt_tracker\b.*eyes.*sides, laplacian", adapt="relocate", adapt_tracker="eyes"),
    patch("tracker of patches that hand nothing back", r"-adapt_tracker\b.*-adapt relocate", adapt="expand",
          adapt_tracker="laplacian"),
    patch("tracker of patches that stay", r"-adapt_tracker\b.*-adapt relocate", adapt_tracker="sides"),
    # --- patches at the tips of cracks
    seed("unknown seed", r"-adapt_seed\b.*crack.*none, tip", adapt_seed="crack"),
    seed("seeds beside patches", r"-adapt_seed tip\b.*-pd_patches", pd_patches="0.25,0.25,0.75,0.75"),
    seed("seeds beside particles everywhere", r"-adapt_seed tip\b.*-pd_patches", pd_patches="all"),
    seed("seeds without a crack", r"-adapt_seed tip\b.*-crack_names", crack_names=None, crack_a_points=None),
    seed("seeds of a crack through the body", r"-adapt_seed tip\b.*no crack ends inside", crack_a_points="0,0.5,1,0.5"),
    seed("seeds of a crack outside", r"crack 1\b.*no part of it is in the body", crack_a_points="2,2,3,3"),
    seed("seeds of two spacings", r"-pd_spacing\b.*2 values.*one", pd_spacing="0.05,0.025"),
    seed("2.5 spacings in an element at a tip", r"-pd_spacing is 0\.1\b.*0\.25 and 0\.25 m.*tip \(0\.6, 0\.5\) of crack 1\b.*"
         r"nearest that fits is 0\.08333333333", pd_spacing="0.1"),
    seed("a spacing above the elements at a tip", r"-pd_spacing is 0\.4\b.*nearest that fits is 0\.25", pd_spacing="0.4"),
    seed("a spacing that fits one side of elements", r"-pd_spacing is 0\.04\b.*0\.25 and 0\.2 m.*fits is 0\.05",
         mesh_cells="4,5", pd_spacing="0.04"),
    seed("no spacing divides elements at tips", r"-pd_spacing is missing\b.*0\.0192308.*0\.0769231 to 0\.111111 m", mesh_cells="9,13", pd_spacing=None),
    seed("seeds of particles beyond number", r"-pd_spacing is 1e-09\b.*more than", pd_spacing="1e-9"),
    seed("seeds at another Poisson's ratio", r"-material_poisson is 0\.2\b", material_poisson="0.2", pd_spacing=None),
    seed("seeds with a length of moving patches", r"-adapt_critical_length\b.*-adapt expand", adapt_critical_length="0.1"),
    cloud("seeds in a cloud", r"-adapt_seed tip\b.*-pd_cloud", adapt_seed="tip", crack_names="a",
          crack_a_points="0,0.5,0.5,0.5"),
    solid("seeds in space", r"-material_plane solid\b.*-pd_patches all", adapt_seed="tip", pd_patches=None,
          crack_names="a", crack_a_points="0,0.5,0.5,0.5"),
    # --- J and output
    patch("contour without size", r"-post_j_contours\b.*above 0", post_j_contours="0.2,0"),
    patch("contour of a word", r"-post_j_contours\b.*big", post_j_contours="big"),
    patch("centre of one number", r"-post_j_centre\b.*2", post_j_centre="0.5", post_j_contours="0.2"),
    patch("contour through a bond of the tip", r"-post_j_contours\b.*0\.2\b.*within a bond.*above", post_j_contours="0.2",
          crack_names="a", crack_a_points="0,0.5,0.5,0.5"),
    patch("contour wider than the patch", r"J contour.*largest side", post_j_contours="0.9", crack_names="a",
          crack_a_points="0,0.5,0.5,0.5"),
    patch("contours with every tip in elements", r"-post_j_contours\b.*no crack's tip", post_j_contours="0.2",
          crack_names="a", crack_a_points="0,0.5,0.125,0.5"),
    patch("energy release across the border of a patch", r"-post_energy_release\b.*across the border",
          post_energy_release="true", crack_names="a", crack_a_points="0,0.5,0.27,0.5"),
    plate("ring of one number", r"-post_j_domain\b.*2", post_j_domain="0.2"),
    plate("ring inside out", r"-post_j_domain\b.*inner.*outer", post_j_domain="0.3,0.2"),
    plate("ring around two tips", r"-post_j_domain\b.*holds the tip at .*0\.2\d* m at most", post_j_domain="0.1,0.25", crack_names="c",
          crack_c_points="0.4,0.52,0.6,0.52"),
    plate("modes of nowhere", r"-post_modes\b.*-post_j_domain.*-post_j_contours", post_modes="true"),
    plate("modes in time", r"-post_modes\b.*-analysis static", post_modes="true", post_j_domain="0.1,0.2",
          analysis="explicit", ts_max_time="1", material_density="1", crack_names="a", crack_a_points="0,0.5,0.5,0.5"),
    patch("energy release of a crack that grows", r"-post_energy_release\b.*toughness", post_energy_release="true",
          material_toughness="5", crack_names="a", crack_a_points="0,0.5,0.5,0.5"),
    plate("neither true nor false for energy release", r"-post_energy_release\b.*maybe", post_energy_release="maybe"),
    plate("neither true nor false for precracks", r"-post_precrack_as_damage\b.*maybe", post_precrack_as_damage="maybe"),
    plate("unknown format of fields", r"-output_format\b.*hdf.*xdmf, vtkhdf", output_format="hdf", output_fields=""),
    plate("a format without fields", r"-output_format vtkhdf\b.*-output_fields", output_format="vtkhdf"),
    plate("output interval zero", r"-output_interval\b.*0.*at least 1", output_interval="0"),
    plate("output interval not whole", r"-output_interval\b.*1\.5.*whole", output_interval="1.5"),
    # --- points beside particles in space
    space("a plane patch in space", r"-pd_patches has 4 numbers\b.*six", pd_patches="0.2,0,0.6,0.4"),
    space("a box in space upside down", r"-pd_patches is 0\.6,0,0,0\.2\b.*lower corner", pd_patches="0.6,0,0,0.2,0.4,0.4"),
    space("a box that cuts cells in space", r"-pd_patches\b.*\(0\.3, 0, 0\).*whole cells\b.*0\.2 m", pd_patches="0.3,0,0,0.6,0.4,0.4"),
    space("a box in two bodies in space", r"-pd_patches\b.*whole cells of one body", pd_patches="0.6,0,0,1.2,0.4,0.4"),
    space("particles at a held side in space", r"-pd_patches: the cell of one at \(0, 0, 0\) is held", pd_patches="0,0,0,0.2,0.4,0.4"),
    space("particles finer than points in space", r"-pd_patches: the cell of one\b.*-pd_spacing", pd_spacing="0.05"),
    space("triggers and points farther apart in space", r"-pd_spacing is 0\.05\b.*that of the points, 0\.1 for one", pd_patches=None,
          pd_spacing="0.05", adapt="expand", adapt_trigger="stretch", pd_critical_stretch="0.01"),
    space("particles of another material in space", r"-pd_patches: the cell of one\b.*-material_young", mpm_one_young="2e9"),
    space("particles in a round border in space", r"-pd_patches: the cell of one\b.*not full of points", mpm_one_box=None,
          mpm_one_sphere="0.2,0.2,0.2,0.2", bc_names=None, bc_left_of=None, bc_left_on=None, bc_left_displacement=None,
          pd_patches="0,0,0,0.4,0.4,0.4"),
    space("a handshake in space", r"-material_plane solid\b.*-mpm_coupling handshake", mpm_coupling="handshake"),
    space("handing back in space", r"-material_plane solid\b.*-adapt_hand_back", adapt="expand", adapt_trigger="stretch",
          adapt_hand_back="10"),
    space("relocation in space", r"-material_plane solid\b.*-adapt expand", adapt="relocate"),
    space("mass for a face in space", r"-material_plane solid\b.*-couple_face_mass", couple_face_mass="1"),
    space("a crack in points in space", r"-material_plane solid\b.*-crack_names", crack_names="a", crack_a_points="0,0.2,0.4,0.2"),
    space("implicit steps of particles in space", r"-material_plane solid\b.*-analysis explicit", analysis="implicit",
          contact="none", ts_dt="1e-6"),
    space("a grid made anew beside particles in space", r"-material_plane solid\b.*-mpm_formulation total",
          mpm_formulation="updated"),
    space("elements in space", r"-material_plane solid\b.*no elements", mesh_lower="2,0", mesh_upper="2.8,0.4", mesh_cells="4,2"),
    space("scattered strength in space", r"-material_plane solid\b.*-pd_scatter", pd_scatter="0.05"),
    space("all of points as particles in space", r"-pd_patches all\b.*boxes", pd_patches="all"),
    # --- solids
    solid("solid of elements", r"-material_plane solid\b.*-pd_patches all", pd_patches=None, pd_spacing=None,
          mesh_cells="4,4"),
    solid("solid in part of particles", r"-material_plane solid\b.*-pd_patches all", mesh_cells="4,4",
          pd_patches="0.25,0.25,0.75,0.75", pd_spacing="0.05"),
    solid("exact surface correction of few bonds in space", r"-pd_surface_correction\b.*ratio of 3 to 6",
          pd_surface_correction="exact", pd_horizon_ratio="2", pd_calibration="continuum"),
    solid("solid in equilibrium", r"-material_plane solid\b.*-analysis explicit", analysis=None,
          bc_left_velocity=None, bc_left_displacement="0,0"),
    solid("solid in implicit steps", r"-material_plane solid\b.*-analysis explicit", analysis="implicit"),
    solid("solid without a depth", r"-material_thickness\b.*depth", material_thickness=None),
    solid("solid of a depth that does not fit", r"-pd_spacing\b.*1, 1, 0\.37.*no spacing|-pd_spacing\b.*0\.37.*fits is",
          material_thickness="0.37"),
    solid("spacing that does not fit a solid", r"-pd_spacing\b.*0\.15\b.*solid.*fits is 0\.2", pd_spacing="0.15"),
    solid("solid at 1/3", r"-material_poisson\b.*0\.25 in three dimensions", material_poisson="0.3333333333333333"),
    solid("solid held in a layer", r"-material_plane solid\b.*-bc_left_layer\b.*_rows", bc_left_layer=""),
    solid("solid under a point force", r"-material_plane solid\b.*-bc_left_force\b", bc_left_force="1,0",
          bc_left_at="0,0"),
    solid("J in a solid", r"-material_plane solid\b.*-post_j", post_j_contours="0.2", post_j_centre="0.5,0.5"),
    solid("solid with a tangent", r"-material_plane solid\b.*-pd_operator\b", pd_operator="assembled"),
    solid("side that a solid has not", r"-bc_left_on\b.*lefft.*left.*front", bc_left_on="lefft"),
    solid("box beside a solid", r"-bc_left_box\b.*no particle", bc_left_box="5,5,6,6"),
    solid("four components", r"-bc_left_velocity\b.*4.*2 or 3", bc_left_velocity="1,0,0,0"),
    solid("traction of four components", r"-bc_left_traction\b.*4 values.*2", bc_left_traction="1,0,0,0"),
    patch("side of a solid in the plane", r"-bc_left_on\b.*front.*\bleft\b", bc_left_on="front"),
    # --- clouds
    cloud("cloud that is not there", r"-pd_cloud\b.*nowhere\.csv.*no such file", pd_cloud="{dir}/nowhere.csv"),
    cloud("cloud without a name", r"-pd_cloud\b", pd_cloud=""),
    cloud("cloud of volumes that are no numbers together", r"-pd_cloud\b.*volumes from 1 to 1e\+300", pd_cloud="{dir}/vast.csv"),
    cloud("cloud beyond rounding", r"-pd_cloud\b.*particle 1 is at \(1e\+13, 0\).*too far", pd_cloud="{dir}/far.csv"),
    cloud("cloud of another kind", r"-pd_cloud\b.*good\.cracks.*\.csv", pd_cloud="{dir}/good.cracks"),
    cloud("cloud that is no HDF5", r"-pd_cloud\b.*cloud\.h5.*HDF5", pd_cloud="{dir}/cloud.h5"),
    cloud("cloud with other columns", r"-pd_cloud\b.*columns\.csv.*x,y,mass.*x,y,volume\[,set\]",
          pd_cloud="{dir}/columns.csv"),
    cloud("cloud in space read in the plane", r"-pd_cloud\b.*x,y,z,volume.*x,y,volume\[,set\]",
          pd_cloud="{dir}/space.csv"),
    cloud("cloud with a short line", r"-pd_cloud\b.*short\.csv, line 3: .*1,0.*3 numbers", pd_cloud="{dir}/short.csv"),
    cloud("cloud with a negative volume", r"-pd_cloud\b.*particle 2\b.*-1.*above 0", pd_cloud="{dir}/negative.csv"),
    cloud("cloud of nobody", r"-pd_cloud\b.*nobody\.csv.*none", pd_cloud="{dir}/nobody.csv"),
    cloud("cloud with a particle twice", r"-pd_cloud\b.*numbers \d+ and \d+ are in one place.*take one", pd_cloud="{dir}/twice.csv"),
    cloud("cloud without a horizon", r"-pd_horizon is missing\b", pd_horizon=None),
    cloud("horizon of nothing", r"-pd_horizon is 0\b.*above 0", pd_horizon="0"),
    cloud("horizon without neighbours", r"-pd_cloud\b.*horizon of 0\.04", pd_horizon="0.04"),
    patch("horizon of a cloud in a patch", r"-pd_horizon\b.*-pd_cloud\b.*-pd_horizon_ratio", pd_horizon="0.2"),
    cloud("set that no particle has", r"-bc_left_set\b.*7\b.*no particle has it", bc_left_set="7"),
    cloud("box beside the cloud", r"-bc_top_box\b.*no particle lies there", bc_top_box="5,5,6,6"),
    cloud("set that is not in the box", r"-bc_top_box\b.*no particle of the set 1\b", bc_top_set="1",
          bc_top_box="0.5,0.5,1,1"),
    patch("set without a cloud", r"-bc_left_set\b.*-pd_cloud\b.*-bc_left_box", bc_left_set="1"),
    cloud("side of a cloud", r"-bc_left_on\b.*left\b.*no sides.*-bc_left_set", bc_left_on="left"),
    cloud("traction on a cloud", r"-bc_top_traction\b.*-bc_top_force\b", bc_top_traction="1,0"),
    cloud("force on no part of a cloud", r"-bc_top_force\b.*no place", bc_top_box=None),
    cloud("point force on a cloud", r"-bc_top_at\b.*-bc_top_box\b", bc_top_at="0,0"),
    cloud("rows of a cloud", r"-bc_left_rows\b.*-bc_left_set\b", bc_left_rows="2"),
    cloud("cloud beside elements", r"-mesh_cells\b.*-pd_cloud\b.*drop", mesh_cells="4,4"),
    cloud("cloud beside a patch", r"-pd_patches\b.*-pd_cloud\b.*drop", pd_patches="all"),
    cloud("horizon ratio of a cloud", r"-pd_horizon_ratio\b.*-pd_cloud\b.*drop", pd_horizon_ratio="3"),
    cloud("cloud in equilibrium", r"-pd_cloud\b.*-analysis explicit", analysis=None),
    cloud("cloud in implicit steps", r"-pd_cloud\b.*-analysis explicit", analysis="implicit", ts_dt="1e-5"),
    cloud("toughness of a lattice for a cloud", r"-pd_toughness lattice\b.*continuum", pd_toughness="lattice"),
    cloud("calibration of a lattice for a cloud", r"-pd_calibration lattice\b.*continuum", pd_calibration="lattice"),
    cloud("surface correction of a cloud", r"-pd_surface_correction\b.*lattices", pd_surface_correction="volume"),
    cloud("cloud at 1/4 in plane stress", r"-material_poisson\b.*0\.25", material_poisson="0.25"),
    cloud("depth of a cloud in space", r"-material_thickness\b.*volumes", material_plane="solid",
          material_poisson="0.25", material_thickness="1", pd_cloud="{dir}/space.csv"),
    cloud("crack outside a cloud", r"crack 1\b.*no part of it is in the body", crack_names="a",
          crack_a_points="5,5,6,6"),
    # --- material points
    points("points without a spacing", r"-mpm_spacing is missing\b.*-mpm_one_spacing", mpm_spacing=None),
    points("points without a density", r"-mpm_one_density is missing\b.*-material_density", material_density=None),
    points("body without a shape", r"-mpm_two: .*one shape.*-mpm_two_box", mpm_two_box=None),
    points("body of two shapes", r"-mpm_two: .*one shape.*-mpm_two_box and -mpm_two_disc", mpm_two_disc="0,0,1"),
    points("box upside down", r"-mpm_two_box\b.*lower corner", mpm_two_box="1.8,0,1,0.4"),
    points("box that a spacing does not fit", r"-mpm_one: the side along x is 0\.8\b.*nearest.*0\.2666666667", mpm_one_spacing="0.3"),
    points("disc without a radius", r"-mpm_two_disc\b.*above 0", mpm_two_box=None, mpm_two_disc="3,3,0"),
    points("disc too small for a point", r"body two: no point lies", mpm_two_box=None, mpm_two_disc="3,3,0.01"),
    points("bodies that overlap", r"one\b.*two\b.*overlap|overlap.*one\b.*two\b", mpm_two_box="0.6,0,1.4,0.4"),
    points("a body wholly inside another", r"bodies \w+ and \w+ overlap\b.*lies in", mpm_two_box="0.3,0.1,0.5,0.3"),
    points("a body wholly inside another on one grid", r"bodies \w+ and \w+ overlap\b.*lies in", mpm_two_box="0.3,0.1,0.5,0.3",
           mpm_formulation="updated"),
    points("two bodies of one name", r"-mpm_bodies lists one twice", mpm_bodies="one,one"),
    points("sphere in the plane", r"-mpm_two_sphere\b.*-mpm_two_disc|-mpm_two_sphere.*_disc", mpm_two_box=None,
           mpm_two_sphere="3,3,0,1"),
    points("mesh of points that is not there", r"-mpm_two_mesh nowhere\.msh: there is no such file", mpm_two_box=None,
           mpm_two_mesh="nowhere.msh"),
    points("region that a mesh has not", r"-mpm_two_mesh .*no physical surface \"plat\"", mpm_two_box=None,
           mpm_two_mesh="{dir}/right.msh", mpm_two_region="plat"),
    points("region without a mesh", r"-mpm_two_region\b.*-mpm_two_mesh", mpm_two_region="plate"),
    points("polygon of two corners", r"-mpm_two_polygon\b.*three corners", mpm_two_box=None, mpm_two_polygon="1,0,2,0"),
    points("polygon of points that crosses itself", r"-mpm_two_polygon crosses itself: its sides from \(1, 0\) and from \(2, 0\)",
           mpm_two_box=None, mpm_two_polygon="1,0,2,1,2,0,1,1"),
    points("elements beside points in space", r"-mesh_cells is of elements\b.*in space.*drop it", material_plane="solid",
           mpm_one_box="0,0,0,0.4,0.4,0.4", mpm_two_box="1,0,0,1.4,0.4,0.4", mesh_cells="4,4", mesh_lower="0,0",
           mesh_upper="1,1", mpm_one_velocity="1,0,0"),
    points("condition on a body that is not there", r"-bc_left_of is three\b.*bodies are one, two", bc_left_of="three"),
    points("bodies in equilibrium that rub", r"-analysis static knows no friction\b.*-contact_friction", analysis=None, ts_max_steps=None,
           contact_friction="0.1"),
    points("a body moved along three axes of the plane", r"-mpm_two_translation\b", mpm_two_translation="1,0,0"),
    points("bodies moved onto each other", r"one\b.*two\b.*overlap|overlap.*one\b.*two\b", mpm_two_translation="-0.4,0"),
    points("points that fly in equilibrium", r"-mpm_one_velocity: nothing moves by itself", analysis=None, ts_max_steps=None,
           contact="none"),
    points("a grid made anew in equilibrium", r"-mpm_formulation updated\b.*-analysis explicit", analysis=None, ts_max_steps=None,
           contact="none", mpm_formulation="updated"),
    points("points in equilibrium in space", r"-analysis static has material points in the plane only", analysis=None,
           ts_max_steps=None, contact="none", material_plane="solid", mpm_one_box="0,0,0,1,1,1", mpm_two_box="2,0,0,3,1,1", mpm_one_velocity=None),
    points("points that are all particles", r"-pd_patches all\b.*give the boxes", pd_patches="all", pd_spacing="0.1",
           material_poisson="0.33333333333333333"),
    points("toughness of points alone", r"-material_toughness\b.*-pd_patches or a mesh", material_toughness="5"),
    # --- points beside elements and particles
    mixed("small strains of bodies that turn", r"-kinematics small\b.*finite", kinematics="small"),
    mixed("friction in implicit steps", r"-analysis implicit knows no friction\b.*-analysis explicit", analysis="implicit",
          ts_dt="1e-6", contact_friction="0.1"),
    mixed("another coupling", r"-couple_scheme energy", couple_scheme="ghost"),
    mixed("a handshake on a grid made anew", r"-mpm_formulation total", mpm_formulation="updated", mpm_coupling="handshake"),
    mixed("mass for a face that a handshake has not", r"-couple_face_mass\b.*energy", mpm_coupling="handshake", couple_face_mass="1"),
    mixed("a handshake in equilibrium", r"-mpm_coupling handshake\b.*-analysis explicit", mpm_coupling="handshake",
          analysis="implicit", ts_dt="1e-6", contact="none"),
    points("a handshake of points alone", r"-mpm_coupling\b.*points only", mpm_coupling="handshake"),
    patch("mass for a face at rest", r"-couple_face_mass\b.*-analysis explicit", couple_face_mass="1"),
    mixed("handing back what nothing made", r"-adapt_hand_back\b.*-adapt_trigger", adapt="expand", adapt_hand_back="100"),
    mixed("a body by the name of elements", r"-mpm_bodies: mesh\b.*another name", mpm_bodies="mesh,two",
          mpm_mesh_box="0,0,0.8,0.4", mpm_one_box=None, mpm_one_velocity=None, bc_left_of="two"),
    mixed("a body wholly inside elements", r"bodies two and mesh overlap\b.*lies in mesh", mpm_two_box="2.2,0.1,2.4,0.3"),
    mixed("elements wholly inside a body", r"bodies two and mesh overlap\b", mpm_two_box="1,-1,4,1", mpm_two_spacing="0.2"),
    mixed("a patch that cuts cells of points", r"-pd_patches: patch 1\b.*cuts elements", pd_patches="0.1,0,0.5,0.4"),
    mixed("a patch in another material", r"-pd_patches\b.*one is of another\s+material", mpm_one_young="2e9"),
    mixed("a crack in points", r"crack runs through material points of two\b.*-adapt_trigger connection", crack_names="a",
          crack_a_points="1.1,0.2,1.5,0.2"),
    mixed("a side within cells", r"-bc_left_on is right\b.*one lies within cells", mpm_one_box="0,0,0.7,0.4", bc_left_on="right",
          pd_patches="0.2,0,0.4,0.4"),
    mixed("a word that is no trigger", r"-adapt_trigger has \"bend\"\B.*connection", adapt="expand", adapt_trigger="bend"),
    mixed("a trigger without conversion", r"-adapt_trigger\b.*-adapt expand", adapt_trigger="stretch"),
    mixed("a trigger where patches hand back", r"-adapt relocate\b.*-adapt expand", adapt="relocate", adapt_trigger="stretch"),
    mixed("a stress trigger without a strength", r"-adapt_stress is missing", adapt="expand", adapt_trigger="stress"),
    mixed("a strength without its trigger", r"-adapt_stress\b.*-adapt_trigger stress", adapt="expand", adapt_stress="1e6"),
    mixed("a share without its trigger", r"-adapt_stretch\b.*-adapt_trigger stretch", adapt="expand", adapt_stretch="0.5"),
    mixed("a margin without a trigger", r"-adapt_margin\b.*-adapt_trigger", adapt="expand", adapt_margin="3"),
    points("triggers without a spacing", r"-pd_spacing is missing", adapt="expand", adapt_trigger="stretch",
           pd_critical_stretch="0.01", material_poisson="0.33333333333333333"),
    points("triggers and a spacing that divides no cell", r"-pd_spacing is 0\.03\b.*0\.2 and 0\.2 m\b.*nearest that fits is 0\.02857",
           adapt="expand", adapt_trigger="stretch", pd_spacing="0.03", pd_critical_stretch="0.01",
           material_poisson="0.33333333333333333"),
    points("a hole that takes all", r"-mpm_two_hole: nothing of two is left", mpm_two_hole="1.4,0.2,3"),
    points("a second hole without a radius", r"-mpm_two_hole has 5 numbers\b.*x,y,radius", mpm_two_hole="1.4,0.2,0.1,1.2,0.2"),
    points("viscosity of implicit steps", r"-mpm_bulk_viscosity\b.*-analysis explicit", analysis="implicit", contact="none",
           mpm_bulk_viscosity="0.06"),
    points("implicit steps on a grid made anew", r"-mpm_formulation updated\b.*-analysis explicit", analysis="implicit",
           mpm_formulation="updated"),
    points("contact on one grid", r"-contact_friction\b.*-mpm_formulation total", mpm_formulation="updated",
           contact_friction="0.1"),
    points("contact of a skin on one grid", r"-contact_skin\b.*-mpm_formulation total", mpm_formulation="updated", contact_skin="sites"),
    points("viscosity on a grid made anew", r"-mpm_bulk_viscosity\b.*-mpm_formulation total", mpm_formulation="updated",
           mpm_bulk_viscosity="0.06"),
    points("traction on a grid made anew", r"-bc_left_traction\b.*-bc_left_body", mpm_formulation="updated", bc_left_traction="1,0"),
    points("jump on a grid made anew", r"-bc_left_displacement is 0\.1 at once\b.*-bc_left_velocity", mpm_formulation="updated",
           bc_left_on="left", bc_left_displacement="0.1,0"),
    points("bodies far apart on one grid", r"-mpm_bodies: .*too far apart.*-mpm_formulation total", mpm_formulation="updated",
           mpm_two_box="1e5,1e5,100000.8,100000.4"),
    points("shape of a kept grid", r"-mpm_shape\b.*-mpm_formulation updated", mpm_shape="gimp"),
    points("cells at rest on a grid made anew", r"-mpm_skip_rest\b.*-mpm_formulation total", mpm_formulation="updated", mpm_skip_rest="0"),
    points("shape that is not there", r"-mpm_shape\b.*splin.*bspline", mpm_formulation="updated", mpm_shape="splin"),
    points("negative viscosity", r"-mpm_bulk_viscosity\b.*-0\.1\b", mpm_bulk_viscosity="-0.1"),
    points("point force on points", r"-bc_left_force\b.*-bc_left_body", bc_left_force="1,0", bc_left_at="0,0"),
    points("side that points have not", r"-bc_left_on\b.*lefft.*left.*top", bc_left_on="lefft"),
    points("held side within a cell", r"-bc_left_on is right\b.*within a cell.*whole number", mpm_one_box="0,0,0.7,0.4",
           bc_left_on="right"),
    points("box beside points", r"-bc_left_box\b.*no node", bc_left_on=None, bc_left_box="7,7,8,8"),
    points("stiffness without contact", r"-contact_stiffness\b.*-contact none", contact="none", contact_stiffness="1e9"),
    points("points of a file off their lattice", r"-mpm_two_file\b.*point 1\b.*0\.07 m", mpm_two_box=None, mpm_two_file="{dir}/good.csv",
           mpm_two_spacing="0.07"),
    plate("spacing of points that are not there", r"-mpm_spacing\b.*-mpm_bodies", mpm_spacing="0.1"),
    plate("contact of points that are not there", r"-contact\b.*-mpm_bodies", contact="penalty"),
    # --- files
    plate("missing options file", r"nowhere\.opts", options_file="{dir}/nowhere.opts"),
    plate("options file that names itself", r"circle\.opts.*circle", options_file="{dir}/circle.opts"),
    plate("options file with a line without a dash", r"no_dash\.opts|material_young", options_file="{dir}/no_dash.opts",
          material_young=None),
    plate("output directory below a regular file", r"blocker", output_dir="{dir}/blocker/out"),
    plate("output directory is a regular file", r"blocker", output_dir="{dir}/blocker"),
]

GOOD = [
    Case("plate", {}, "", PLATE),
    Case("plate with a patch", {}, "", PATCH),
    Case("plate that is quenched", {"-thermal_transfer": "1e4W/m^2/K"}, "", QUENCH),
    Case("plate with temperatures of a table", {}, "", TABLE),
    Case("plate with units", {"-mesh_lower": "0mm,0", "-mesh_upper": "100cm,1e3mm", "-material_young": "1GPa",
                              "-material_thickness": "1m", "-bc_right_traction": "0.1MPa,0kPa", "-warnings_are_errors": ""}, "", PLATE),
    Case("a box that holds one node of a side", {"-bc_right_displacement": "free,0", "-bc_right_traction": None,
                                                 "-bc_right_box": "0.9,0.45,1.1,0.55", "-bc_left_displacement": "0,1e-3"}, "", PLATE),
    Case("plate at the default Poisson's ratio", {"-material_poisson": None}, "", PLATE),
    Case("patch in plane strain, default ratio", {"-material_poisson": None, "-material_plane": "strain"}, "", PATCH),
    Case("plate from a file", {"-mesh_file": "{dir}/right.msh"}, "", FILE),
    Case("cracks from a file and by name",
         {"-crack_file": "{dir}/good.cracks", "-crack_names": "a", "-crack_a_points": "0,0.1,1,0.1"}, "", PLATE),
    Case("a toughness in the patch", {"-material_toughness": "5"}, "", PATCH),
    Case("a patch at the tip of a crack", {}, "", SEED),
    Case("a block in space", {}, "", SOLID),
    Case("a block in space with two components", {"-bc_left_velocity": "1,0,free", "-bc_left_traction": "1,0"}, "", SOLID),
    Case("a block in space on its front", {"-bc_left_on": "front", "-bc_left_traction": "1,0,3"}, "", SOLID),
    Case("a cloud", {}, "", CLOUD),
    Case("a cloud in space", {"-pd_cloud": "{dir}/space.csv", "-material_plane": "solid", "-material_poisson": "0.25",
                              "-bc_left_set": None, "-bc_left_box": "0,0,0.1,1", "-bc_left_velocity": "1,free,0",
                              "-bc_top_force": "0,1e5,3"}, "", CLOUD),
    Case("two bodies of points", {}, "", BODIES),
    Case("points beside elements and particles", {}, "", MIXED),
    Case("points that may become particles", {"-adapt": "expand", "-adapt_trigger": "connection,stretch"}, "", MIXED),
    Case("points beside particles in space", {}, "", SPACE),
    Case("bodies of points in touch", {"-mpm_two_box": "0.8,0,1.6,0.4"}, "", BODIES),
    Case("traction and displacement on one boundary", {"-bc_left_traction": "0,1e5"}, "", PLATE),
]


def write_files(directory):
    for name, text in FILES.items():
        (pathlib.Path(directory) / name).write_text(text, encoding="utf-8")


def lines_of(said, directory):
    return [line.replace(str(directory), "{dir}") for line in said.splitlines() if line.strip()]


def run(case, ranks):
    """Runs the program in a directory of its own: (exit status or None for a hang, stdout, lines of stderr)."""
    with tempfile.TemporaryDirectory() as directory:
        write_files(directory)
        command = program.launcher(ranks) + [program.PROGRAM] + case.arguments(directory)
        status, out, err = program.finish(command, directory, TIMEOUT, program.NO_WAIT)
    return status, out, lines_of(err, directory)


def run_all(cases, run=run, ranks=RANKS):
    """Runs every case on every number of ranks, nine at a time (they mostly wait to start and to stop); yields (case, ranks, result of run)."""
    jobs = [(case, count) for case in cases for count in ranks]
    with concurrent.futures.ThreadPoolExecutor(max_workers=9) as pool:
        for job, result in zip(jobs, pool.map(lambda job: run(*job), jobs)):
            yield *job, result


def run_together(cases, ranks):
    """Runs every case in one process; yields as run_all does."""
    with tempfile.TemporaryDirectory() as name:
        write_files(name)
        outcomes = harness.run(HARNESS, [case.arguments(name) for case in cases], ranks, pathlib.Path(name), TIMEOUT)
        for outcome, case in zip(outcomes, cases):  # the outcomes first: their end is looked at too
            errors = [f"error: {outcome.message}"] if outcome.status else []
            yield case, ranks, (outcome.status, "", lines_of("\n".join([outcome.said, *errors]), name))


def run_each(cases):
    """Runs every case on every number of ranks; yields as run_all does."""
    for ranks in RANKS:
        if HARNESS.exists():
            yield from run_together(cases, ranks)
        yield from run_all(cases[:: THROUGH[ranks] if HARNESS.exists() else 1], ranks=(ranks,))


class ThroughTheProgram(unittest.TestCase):
    """Every failure is reported, not only the first."""

    CASES, GOOD = CASES, GOOD

    def test_runs_that_are_right_succeed(self):
        for case, ranks, (status, _, lines) in run_each(self.GOOD):
            with self.subTest(case=case.name, ranks=ranks):
                self.assertEqual((status, lines), (0, []))

    def test_mistakes_end_with_status_1_and_one_line(self):
        for case, ranks, (status, out, lines) in run_each(self.CASES):
            with self.subTest(case=case.name, ranks=ranks):
                self.assertIsNotNone(status, f"still running after {TIMEOUT} s; stderr: {lines}")
                self.assertEqual(status, 1, f"stderr: {lines}")
                self.assertEqual(len(lines), 1, f"stderr: {lines}")
                self.assertNotIn("PETSC ERROR", out + lines[0])
                self.assertRegex(lines[0], case.pattern)


if __name__ == "__main__":
    program.main()
