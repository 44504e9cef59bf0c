"""Many independent pieces of work, on this machine or on many: tried again, resumed, same results.

    jobs = Jobs(judge, Processes(2), file=folder / "progress.jsonl", resume=True)
    for result in jobs.results(cases):      # as they come
        print(result.item, result.failure or result.value)
    values = jobs.values(cases)             # or all values, in the order of the items

`jobs` keeps values and shows progress.  Where the work is done is up to a `Backend`: `processes`
of this machine, `on_ray`, or `on_slurm`; `crews` says what these have in common, and `choice` finds
the one that `--on` names.
"""

from .choice import backend_for as backend_for
from .crews import Backend as Backend
from .crews import BackendError as BackendError
from .crews import JobError as JobError
from .jobs import Jobs as Jobs
from .jobs import Result as Result
from .jobs import record as record
from .processes import Processes as Processes
