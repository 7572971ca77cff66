"""The benchmarks of statics: elements eliminated or kept, patches that relocate, ranks, elements alone."""
import statistics
import tempfile

from bench_fracture import ASSEMBLED, INCREMENTS, NOTCH_MESH, dcb, growing, median, scene
from bench_machine import Bench

OFF = ["-static_condense", "off"]
CONDENSED = ["-static_condense", "on"]  # where auto would not, for few solves
NOTCH_LOADS = 10  # of double_notch: nothing breaks
CELLS = ["-mesh_cells"]
COLUMNS = ("solve_condense", "layout_change", "solve_recover", "solve_load")  # events of PETSc's log


def plate(name, extra=()):
    return scene(f"plate_static/{name}") + ["-output_fields", "false", *extra]


class StaticBench(Bench):
    increments = INCREMENTS

    def statics(self):
        """All of it; `statics_growth`, `statics_notch`, `statics_relocation`, `statics_ranks` and `statics_elements` one by one."""
        self.statics_growth()
        self.statics_notch()
        self.statics_relocation()
        self.statics_ranks()
        self.statics_elements()

    def statics_growth(self):
        """Elements eliminated once per layout against elements kept as unknowns, and against particles only."""
        count = self.increments
        scenes = {name: dcb(name, count) for name in ("pd_only", "snail", "row1", "row3")}
        scenes |= {f"{name} kept": dcb(name, count) + OFF for name in ("snail", "row1", "row3")}
        for cells in ("180,90", "360,180"):
            fine = dcb("row1", count) + [*CELLS, cells]
            scenes |= {f"row1, {cells} elements": fine, f"row1, {cells} elements kept": fine + OFF}
        runs = self.rounds_of(scenes)
        cost = {name: median(run["busy_share"] * growing(run)[0] for run in of) for name, of in runs.items()}
        unknowns = {name: of[0]["unknowns"]["total"] for name, of in runs.items()}
        goals = {"snail": 18, "row1": 12, "row3": 5, "row1, 180,90 elements": 2.5, "row1, 360,180 elements": 3.5}
        rows = []
        for name, goal in goals.items():
            one, other = runs[name][0], runs[f"{name} kept"][0]
            against, gain = cost["pd_only"] / cost[name], cost[f"{name} kept"] / cost[name]
            ratio = unknowns["pd_only"] / unknowns[name]
            fine = "elements" in name
            self.results[f"statics {name}"] = {
                "condensed": cost[name], "kept": cost[f"{name} kept"], "particles": cost["pd_only"], "gain": gain,
                "speed_up": against, "over_unknowns": against / ratio, "told": one["results"]["static_condense"],
                "same_bonds": one["bonds_broken"] == other["bonds_broken"]}
            rows.append([f"dcb {name}", f"{1e3 * cost[f'{name} kept']:.1f}", f"{1e3 * cost[name]:.1f}",
                         f"**{gain:.2f}**" + (f" (goal {goal})" if fine else ""), f"{1e3 * cost['pd_only']:.1f}",
                         "" if fine else f"**{against:.1f}** (goal {goal})", "" if fine else f"{against / ratio:.2f} (goal 1.4)",
                         f"{one['bonds_broken']} / {other['bonds_broken']}", one["results"]["static_condense"]])
        self.table(f"Elements eliminated once per layout: per solve while the crack grows, {count} increments, one core",
                   ["scene", "elements kept [ms]", "eliminated [ms]", "times faster", "particles only [ms]",
                    "over particles only", "over the ratio of unknowns", "bonds broken", "told"], rows)

    def statics_notch(self):
        """double_notch, solve after solve of one layout."""
        coupled = scene("double_notch/coupled") + ["-pd_spacing", repr(NOTCH_MESH / 6)]
        sides = {"on": coupled + CONDENSED, "off": coupled + OFF, "pd_only": scene("double_notch/pd_only")}
        runs = self.rounds_of(sides | {f"{name} first": of for name, of in sides.items()} |
                              {name: [*of, "-load_steps", str(NOTCH_LOADS)] for name, of in sides.items()})
        cost = {name: median((all_["wall_seconds"]["solve"] - first["wall_seconds"]["solve"]) / (NOTCH_LOADS - 1)
                             for all_, first in zip(runs[name], runs[f"{name} first"])) for name in sides}
        ratio = runs["pd_only"][0]["unknowns"]["total"] / runs["on"][0]["unknowns"]["total"]
        against = cost["pd_only"] / cost["on"]
        self.results["statics double_notch"] = {**cost, "speed_up": against, "over_unknowns": against / ratio}
        self.table(f"double_notch, {NOTCH_LOADS} loads, per solve after the first, one core",
                   ["elements kept [ms]", "eliminated [ms]", "times faster", "particles only [ms]", "over particles only",
                    "over the ratio of unknowns"],
                   [[f"{1e3 * cost['off']:.2f}", f"{1e3 * cost['on']:.2f}", f"**{cost['off'] / cost['on']:.2f}**",
                     f"{1e3 * cost['pd_only']:.2f}", f"**{against:.1f}**", f"**{against / ratio:.2f}** (goal 1.4)"]])

    def statics_relocation(self):
        """dcb case 4, all increments, against particles only; and what a column of relocation costs, as the log has it."""
        whole, parts, logged = {"snail": [], "kept": [], "pd_only": []}, {name: [] for name in COLUMNS}, None
        scenes = {"snail": scene("dcb/snail"), "kept": scene("dcb/snail") + OFF, "pd_only": scene("dcb/pd_only")}
        for _ in range(self.rounds):
            for name, arguments in scenes.items():
                with tempfile.TemporaryDirectory() as directory:
                    log = f"{directory}/log.txt"
                    run = self.run(arguments + (["-log_view", f":{log}"] if name == "snail" else []))
                    whole[name].append(run["wall_seconds"]["total"] - run["wall_seconds"]["output"])
                    if name == "snail":
                        logged = run
                        for event, (calls, seconds) in events(log).items():
                            parts[event].append(run["busy_share"] * seconds / calls)
        seconds = {name: statistics.median(of) for name, of in whole.items()}
        of = {event: statistics.median(spent) for event, spent in parts.items() if spent}
        against = seconds["pd_only"] / seconds["snail"]
        self.results["statics relocation"] = {**seconds, "speed_up": against, "per_call": of}
        self.table("dcb case 4 (the patch relocates), 200 increments whole, one core",
                   ["elements kept [s]", "eliminated [s]", "particles only [s]", "over particles only", "relocations",
                    "S formed anew [ms]", "a relocation in all [ms]", "displacements of elements worked out [ms]",
                    "a solve [ms] (goal: S anew at most one)"],
                   [[f"{seconds['kept']:.2f}", f"{seconds['snail']:.2f}", f"{seconds['pd_only']:.1f}",
                     f"**{against:.1f}** (goal 15)", logged["relocations"],
                     *(f"{1e3 * of[event]:.1f}" if event in of else "-" for event in COLUMNS)]])

    def statics_ranks(self):
        """Two ranks over one, wall time of the solves."""
        goals = {"plate_static, fine": (plate("fine"), 1.8), "dcb row 3, growing": (dcb("row3", self.increments), 1.5)}
        seconds = {(name, ranks): [] for name in goals for ranks in (1, 2)}
        for _ in range(self.rounds):
            for name, ranks in seconds:
                seconds[name, ranks].append(self.run(goals[name][0], ranks, wall=True)["wall_seconds"]["solve"])
        rows = []
        for name, (_, goal) in goals.items():
            one, two = (statistics.median(seconds[name, ranks]) for ranks in (1, 2))
            self.results[f"statics ranks {name}"] = {"one": one, "two": two, "ratio": one / two}
            rows.append([name, f"{one:.3f}", f"{two:.3f}", f"**{one / two:.2f}** (goal {goal})"])
        self.table("Statics, two ranks over one, wall time of all solves", ["scene", "1 rank [s]", "2 ranks [s]", "ratio"], rows)

    def statics_elements(self):
        """Elements alone: default solver against CG and BoomerAMG on the assembled matrix."""
        rows = []
        for cells in ("100,100", "400,400"):
            arguments = plate("fe_only", [*CELLS, cells])
            other = [*ASSEMBLED, "-ksp_type", "cg", "-pc_type", "hypre"]
            both = self.interleave({"default": (arguments, 1), "assembled": (arguments + other, 1)})
            mine, theirs = both["default"], both["assembled"]
            ratio = theirs["solve"] / mine["solve"]
            self.results[f"statics elements {cells}"] = {**both, "ratio": ratio}
            rows.append([cells.replace(",", " x "), mine["unknowns"], f"{theirs['solve']:.3f} ({theirs['iterations']} it.)",
                         f"{mine['solve']:.3f} ({mine['iterations']} it.)", f"**{ratio:.2f}** (goal 2)"])
        self.table("Elements alone, small strain: default solver against assembled CG + BoomerAMG, one core",
                   ["elements", "unknowns", "assembled [s]", "default [s]", "ratio"], rows)


def events(log):
    """Calls and seconds of COLUMNS in PETSc's table."""
    found = {}
    with open(log, encoding="utf-8") as lines:
        for line in lines:
            words = line.split()
            if words and words[0] in COLUMNS and len(words) > 3 and words[1].isdigit():
                found[words[0]] = int(words[1]), float(words[3])
    return found
