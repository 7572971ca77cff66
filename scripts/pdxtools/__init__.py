"""Reads what runs of pdxsolve leave on disk: fields, curves, probes, checkpoints, and what a run says of itself.

    import pdxtools
    time, blocks = pdxtools.read_step("out/case")        # the last step of fields.h5; a number for another
    blocks["particles"]["damage"], blocks["mesh"].points # arrays; blocks["mesh"].units["stress"] is "Pa"
    pdxtools.read_history("out/case")["work"]            # a column of history.csv
    pdxtools.read_summary("out/case")["results"]
Pictures are in `pdxtools.draw`, the page of a run in `pdxtools.report`; both need matplotlib, reading does not.
"""

from ._modules import use_a_python_that_has_them

use_a_python_that_has_them()

from .checkpoint import Checkpoint, read_checkpoint  # noqa: E402  (another python3 may have to go on)
from .fields import (CELL_USES, PARTICLE_KINDS, TENSOR, Block, NotThere, fields_path, read_step, step_at,  # noqa: E402
                     step_count, step_times)  # fmt: skip
from .records import (Option, read_citations, read_crack_paths, read_curve, read_history, read_options,  # noqa: E402
                      read_probe, read_probes, read_summary, read_units)  # fmt: skip

__version__ = "0.3.0"  # of CMakeLists.txt, as a test asserts; pyproject.toml asks for it here
__all__ = ["CELL_USES", "PARTICLE_KINDS", "TENSOR", "Block", "Checkpoint", "NotThere", "Option", "fields_path",
           "read_checkpoint", "read_citations", "read_crack_paths", "read_curve", "read_history", "read_options",
           "read_probe", "read_probes", "read_step", "read_summary", "read_units", "step_at", "step_count",
           "step_times"]  # fmt: skip
