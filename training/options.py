"""What the command line asks for: one class of options for each command.

Commands are registered in the files below and nowhere else; the order here is that of help, each
file a group.  Nothing heavy is imported, so that `flatrig --help` answers at once.
"""

# ruff: noqa: I001  (sorted imports would put the groups in another order)

from .describing_options import (
    List as List,
    Analyse as Analyse,
    Solve as Solve,
    Export as Export,
    Fingerprint as Fingerprint,
    Example as Example,
    Docs as Docs,
)
from .simulating_options import (
    Run as Run,
    Report as Report,
    Render as Render,
    Drive as Drive,
    Scenes as Scenes,
)
from .learning_options import (
    MINUTES as MINUTES,
    Compare as Compare,
    Train as Train,
    Plot as Plot,
    Dataset as Dataset,
)
from .maintaining_options import (
    Bench as Bench,
    Accuracy as Accuracy,
    Regress as Regress,
    Lean as Lean,
    Stress as Stress,
    Hands as Hands,
    Reproduce as Reproduce,
)
from .commands import COMMANDS as COMMANDS
from .option_values import check_number as check_number
