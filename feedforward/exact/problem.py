"""One rig's inverse dynamics: its equations and all that follows from them, made once.

    problem = problem_of(models.overhead_crane())
    problem.equations, problem.servo        # what holds, and what a reference prescribes
    problem.analysis.index                  # 5
    problem.steps                           # the order in which the unknowns are solved for

`solve`, `check`, the planners and the DAE formulations take it from here and hand it down.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

from ...models.rig.rig import Rig, require_rig
from .assembly import assemble
from .equations import Equations
from .redundancy import refuse_redundant
from .servo import Servo, servo_constraints
from .steps import Step, plan
from .structure import Analysis, analyse_equations


@dataclass(frozen=True, eq=False)
class Problem:
    """The inverse dynamics of a rig; each part is made when it is first used.

    Raises
    ------
    RigError
        When a part is used that the rig does not have, see `analyse`.
    """

    rig: Rig

    def __reduce__(self) -> tuple[Callable[[Rig], "Problem"], tuple[Rig]]:
        """A copy is the one object of the rig."""
        return problem_of, (self.rig,)

    @cached_property
    def equations(self) -> Equations:
        """Equations of motion and constraints."""
        return assemble(self.rig)

    @cached_property
    def servo(self) -> Servo:
        """What a reference prescribes."""
        return servo_constraints(self.equations)

    @cached_property
    def analysis(self) -> Analysis:
        """Structure of the equations with the servo constraints."""
        refuse_redundant(self.equations)
        return analyse_equations(self.equations, self.servo)

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The steps that determine every unknown."""
        return plan(self.analysis)

    @cached_property
    def order(self) -> int:
        """Derivatives of a reference to use: those that are needed, and the outputs' own two."""
        return max(self.analysis.reference_order, 2)


def problem_of(rig: Rig) -> Problem:
    """The inverse dynamics of a rig; one object for each rig.

    Raises
    ------
    RigError
        It is no rig.
    """
    return kept_problem(require_rig(rig))


@lru_cache(maxsize=256)
def kept_problem(rig: Rig) -> Problem:
    """`problem_of` what is a rig for certain."""
    return Problem(rig)


def equations_of(rig: Rig) -> Equations:
    """The equations of motion of a rig; made once for each rig.

    Raises
    ------
    RigError
        It is no rig.
    """
    return problem_of(rig).equations


def analyse(rig: Rig) -> Analysis:
    """Structure of the equations of a rig whose outputs are prescribed.

    Raises
    ------
    RigError
        The equations are structurally singular: some unknown is determined by no
        equation, or the outputs contradict each other.
    """
    return problem_of(rig).analysis
