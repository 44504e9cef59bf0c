"""Inverse dynamics by stepping through differential-algebraic equations, the sources' way.

The exact solver says what is right; here is every way to get there by integration, what each costs
and where each fails.  Along a prescribed path the equations of a rig are a DAE of index 5 or more;
a *formulation* reduces the index, a *scheme* replaces derivatives by differences::

    rig = models.overhead_crane()
    path = feedforward.rest_to_rest((0, -4), (5, -1), duration=3.0, order=4)
    result = feedforward.integrate(rig, path, step=0.01)      # minimal extension, implicit Euler
    result.motion.inputs, result.motion.positions             # a Motion, at the steps
    result.counters                                           # steps, evaluations, Jacobians, ...
    result.failure                                            # None, or where and why it ended

    truth = feedforward.solve(rig, path, result.motion.times)
    abs(result.motion.inputs - truth.inputs).max()

Every combination of the names in `FORMULATIONS` and `SCHEMES` can be asked for::

    for name in dae.FORMULATIONS:
        if not dae.why_not(rig, name):                        # one line of reason, or nothing
            feedforward.integrate(rig, path, step=0.01, formulation=name, scheme="BDF 3")
    feedforward.integrate(rig, path, step=0.1, scheme="Radau IIA 3", tolerance=1e-6)

    dae.formulation(rig, "projection, minimal").index         # 3
    dae.orders(dae.scheme("Radau IIA 3"), index=3)            # infinite, 3, 2

========================================  =====  ==========================================
formulation                               index  source
========================================  =====  ==========================================
direct                                    5, 7   Y 5.10, 5.102: nothing differentiated
projection                                3, 5   RED, Y 4.33
projection, dependent                     3, 5   ALT, Y 4.50
projection, minimal                       3, 5   GEN, Y 4.23
minimal extension                         3, 5   Y 5.107, any redundant coordinates
minimal extension, dependent              3, 5   Y 5.14, 5.113
minimal extension, minimal                3, 5   Y 5.33
minimal extension, twice                  1, 3   Y 5.25
minimal extension, three times            1      for the 3D Navy crane, whose index is 7
========================================  =====  ==========================================

Indices are those of cranes whose own is 5 or 7.  Where nothing can swing (a load on as many winches
as it has directions) the problem's is 3, and constraints that are left keep it there.

Schemes: implicit Euler (the sources'), BDF 2 to 5, Radau IIA with 2 and 3 stages, the latter with a
tolerance too, and two that oscillate, the midpoint and the trapezoidal rule.

One more scheme is a small immutable object as `Scheme` describes it, made known by `add_scheme` in
any file of this folder or of one's own (`trapezoidal.py` is the shortest example); one more
formulation is an entry of `FORMULATIONS`.  `integrate`, its messages, the bench and its figures
then know it.

What to expect.  The outputs of these rigs are flat, so no scheme integrates anything: it only
differentiates, from index nu the inputs nu - 1 times.  Places are therefore exact whatever the
step once the index is 3, and inputs have the scheme's order of differentiation.  A reference of
`order` q that is exactly what the rig needs has kinks in the inputs at its joins, and there no
scheme has an order above 1: orders are measured along smoother paths.  Each differentiation also
divides rounding errors by the step, so errors of index-3 inputs rise again like 1e-16 / step^2.

Limits.  Between two steps nothing is looked at: one can jump over a place that the rig cannot pass,
which `solve` would refuse, unless it leads off a rail or turns a rope around.  A projection in
minimal coordinates cannot start with a massless pulley straight below its winch; the others creep
away from there, and near it the pulley's place is as uncertain as the equations.
"""

from importlib import import_module
from pkgutil import iter_modules

from .formulation import Formulation
from .integrate import integrate
from .methods import FORMULATIONS, formulation, why_not
from .newton import Counters
from .result import Failure, Integration
from .schemes import SCHEMES, Orders, Scheme, add_scheme, orders, scheme

__all__ = [
    "FORMULATIONS",
    "SCHEMES",
    "Counters",
    "Failure",
    "Formulation",
    "Integration",
    "Orders",
    "Scheme",
    "add_scheme",
    "formulation",
    "integrate",
    "orders",
    "scheme",
    "why_not",
]

# Importing every file here is what makes the schemes and formulations in it known.
for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
