"""Mistakes in scenes that move, judged as test_bad_input.py judges those at rest.

Usage: test_bad_motion.py PDXSOLVE [unittest arguments]; environment as there.
"""

import program
import test_bad_input as mistakes

FILES = {
    "good.csv": "# of a shaker\ntime, factor\n0, 0\n1e-3, 1\n",
    "bare.csv": "0 0\n1e-3 1\n",
    "word.csv": "0, zero\n1e-3, 1\n",
    "second_word.csv": "time, factor\n0, 0\n1e-3, high\n",
    "backwards.csv": "0, 0\n2e-3, 1\n1e-3, 0\n",
    "empty.csv": "# nothing\n",
    "headed.csv": "time, factor\ntime, factor\n0, 0\n",
    "semicolon.csv": "0;0\n1e-3;1\n",
    "comma.csv": "0,,0\n1e-3,1\n",
    "infinite.csv": "0, 0\n1e-3, inf\n",
}
MOVING = mistakes.PLATE | {
    "-material_density": "1000",
    "-analysis": "explicit",
    "-ts_max_steps": "3",
    "-ts_max_time": "1e-3",
}
# The right edge follows a table.
SHAKEN = MOVING | {"-bc_right_history": "table", "-bc_right_history_file": "{dir}/good.csv"}
PATCH = mistakes.PATCH | {key: value for key, value in MOVING.items() if key not in mistakes.PLATE}


def moving(name, pattern, base=MOVING, **change):
    return mistakes.Case(name, {f"-{key}": value for key, value in change.items()}, pattern, base)


def shaken(name, pattern, file):
    return moving(name, pattern, SHAKEN, bc_right_history_file="{dir}/" + file)


CASES = [
    # --- steps
    moving("no end", r"-ts_max_time\b.*missing", ts_max_time=None, ts_max_steps=None),
    moving("end before the start", r"-ts_max_time\b.*-1.*above 0", ts_max_time="-1"),
    moving("no step", r"-ts_max_steps\b.*0.*at least 1", ts_max_steps="0"),
    moving("step without length", r"-ts_dt\b.*0.*above 0", ts_dt="0"),
    moving("step above the limit", r"-ts_dt\b.*0\.001.*stable limit.*-ts_allow_unstable", ts_dt="1e-3"),
    moving("safety above 1", r"-ts_safety\b.*1\.1", ts_safety="1.1"),
    moving("parts of steps with elements beside particles alone", r"-ts_subcycle\b.*50.*no elements", PATCH, ts_subcycle="50"),
    moving("more parts of steps than save anything", r"-ts_subcycle\b.*50.*at most", PATCH, ts_subcycle="50",
           mesh_cells="16,16", pd_patches="0.375,0.375,0.625,0.625"),
    moving("parts of steps without particles", r"-ts_subcycle\b.*2.*at most 1", ts_subcycle="2"),
    moving("parts of steps and rollers", r"-ts_subcycle\b.*rollers.*-bc_left", PATCH, ts_subcycle="2",
           bc_left_displacement=None, bc_left_roller="1,0"),
    moving("parts of implicit steps", r"-ts_subcycle\b.*-analysis explicit", analysis="implicit", ts_dt="1e-5",
           ts_subcycle="2"),
    moving("start elsewhere", r"-ts_init_time\b.*0", ts_init_time="1e-5"),
    moving("scheme of implicit steps", r"-ts_type\b.*alpha2.*central_difference", ts_type="alpha2"),
    moving("misspelt option of TS", r"-ts_max_tme\b.*-ts_max_time\b", ts_max_tme="1"),
    moving("unknown analysis", r"-analysis\b.*dynamic.*static.*explicit.*implicit", analysis="dynamic"),
    moving("implicit without a step", r"-ts_dt\b.*missing", analysis="implicit"),
    moving("no mass", r"-material_density\b.*missing", material_density=None),
    moving("restart in implicit steps", r"-restart\b.*-analysis explicit", analysis="implicit", ts_dt="1e-5",
           restart="checkpoint.h5"),
    moving("restart from nothing", r"nowhere\.h5.*no such file", restart="nowhere.h5"),
    moving("load steps in time", r"-load_steps\b.*-analysis static", load_steps="3"),
    moving("interface scheme in time", r"-couple_scheme interface\b.*energy or ghost", PATCH,
           couple_scheme="interface"),
    # --- histories and conditions
    moving("unknown history", r"-bc_right_history\b.*pulse.*gaussian", bc_right_history="pulse"),
    moving("ramp without width", r"-bc_right_history ramp\b.*-bc_right_history_width", bc_right_history="ramp"),
    moving("width of a step", r"-bc_right_history_width\b.*no meaning.*step", bc_right_history="step",
           bc_right_history_width="1e-3"),
    moving("table without a file", r"-bc_right_history_file\b", bc_right_history="table"),
    moving("points and a file", r"-bc_right_history_file and -bc_right_history_points\b", bc_right_history="table",
           bc_right_history_points="0:0,1:1", bc_right_history_file="{dir}/good.csv"),
    moving("a point without a factor", r"-bc_right_history_points is \"1e-3\" in item 2\b.*a factor", bc_right_history_points="0:0,1e-3"),
    moving("points backwards", r"-bc_right_history_points: time 0\.001 is before 0\.002\b", bc_right_history_points="0:0,2ms:1,1ms:0"),
    moving("points of a step", r"-bc_right_history_points\b.*no meaning.*step", bc_right_history="step",
           bc_right_history_points="0:0,1:1"),
    moving("history in equilibrium", r"-bc_right_history\b.*-analysis explicit", analysis=None, ts_max_time=None,
           ts_max_steps=None, bc_right_history="step"),
    moving("history of an initial velocity", r"-bc_right_history\b.*-bc_right_initial_velocity\b.*once",
           bc_right_traction=None, bc_right_initial_velocity="1,0", bc_right_history="step"),
    moving("held twice", r"-bc_left_velocity\b.*-bc_left_displacement\b", bc_left_velocity="1,0"),
    shaken("table that is not there", r"nowhere\.csv.*no such file", "nowhere.csv"),
    shaken("word in the first row of a table", r"word\.csv, line 1: .zero. is not a number", "word.csv"),
    shaken("word in a later row of a table", r"second_word\.csv, line 3: .high. is not a number", "second_word.csv"),
    shaken("table that goes back", r"backwards\.csv, line 3\b.*before", "backwards.csv"),
    shaken("table of comments", r"empty\.csv.*no line", "empty.csv"),
    shaken("table parted by semicolons", r"semicolon\.csv, line 1\b.*factor", "semicolon.csv"),
    shaken("table with two headers", r"headed\.csv, line 2: .time. is not a number", "headed.csv"),
    shaken("table with a comma too many", r"comma\.csv, line 1: has 3 items.*factor", "comma.csv"),
    shaken("table without end", r"infinite\.csv, line 2: .inf. is not a finite number", "infinite.csv"),
    # --- bonds and output
    moving("zone without failure beside the body", r"-pd_no_fail\b.*5,5,6,6.*\(0, 0\) to \(1, 1\)", PATCH,
           material_toughness="5", pd_no_fail="5,5,6,6"),
    moving("times of output without output", r"-output_times\b.*-output_fields", output_times="1e-5"),
    moving("time of output at the start", r"-output_times\b.*0.*above 0", output_times="0,1e-5", output_fields=""),
    moving("time of output in equilibrium", r"-output_times\b.*-analysis", analysis=None, ts_max_time=None,
           ts_max_steps=None, output_times="1e-5", output_fields=""),
]

GOOD = [
    mistakes.Case("moving plate", {}, "", MOVING),
    mistakes.Case("moving plate with a patch", {}, "", PATCH),
    mistakes.Case("table with a comment and a header", {}, "", SHAKEN),
    mistakes.Case("table without a header", {"-bc_right_history_file": "{dir}/bare.csv"}, "", SHAKEN),
    mistakes.Case("implicit steps", {"-analysis": "implicit", "-ts_dt": "1e-5"}, "", MOVING),
]


class InMotion(mistakes.ThroughTheProgram):
    """The same tests, of these cases."""

    CASES, GOOD = CASES, GOOD


if __name__ == "__main__":
    mistakes.FILES |= FILES
    program.main()
