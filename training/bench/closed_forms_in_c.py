"""Closed forms of two cranes' inverse dynamics in C: what a program can hardly fall below.

Written by hand from the equations of a load on a rope, with lambda the tension over the length:

    lambda = m (z'' + g) / -z,   s = (x, y) - z (x'', y'') / (z'' + g)

is where the trolley has to be (Y 4.105 to 4.122), and its two derivatives follow by the quotient
rule.  The drives carry the trolley's inertia, the girder's, the winch's, and the rope's pull.
"""

import ctypes
from typing import Any

import numpy as np

from ...feedforward.solving.compiling import library
from ...models import Rig
from ...models.types import Array

OVERHEAD = """
#include <math.h>
static void place(const double *x, const double *z, double g, double *s)
{
    /* s = x - z x''/(z'' + g) and two derivatives, from derivatives 0 to 4 of x and z */
    const double b = 1.0/(z[2] + g), a0 = x[2]*b;
    const double a1 = (x[3] - a0*z[3])*b, a2 = (x[4] - 2.0*a1*z[3] - a0*z[4])*b;
    s[0] = x[0] - z[0]*a0;
    s[1] = x[1] - z[1]*a0 - z[0]*a1;
    s[2] = x[2] - z[2]*a0 - 2.0*z[1]*a1 - z[0]*a2;
}
static double winch(double square, double half_rate, double half_turn, double lambda,
    double inertia, double radius)
{
    /* torque for a rope's acceleration, from its length squared and that's derivatives */
    const double length = sqrt(square), rate = half_rate/length;
    return inertia/radius*((half_turn - rate*rate)/length) - radius*lambda*length;
}
int closed_batch(int samples, const double *derivatives, const double *p, double *inputs)
{
    const double m = p[0], trolley = p[1], inertia = p[2], radius = p[3], g = p[4];
    for (int i = 0; i < samples; ++i) {
        const double *d = derivatives + 10*i;
        const double x[5] = {d[0], d[2], d[4], d[6], d[8]}, z[5] = {d[1], d[3], d[5], d[7], d[9]};
        double s[3];
        place(x, z, g, s);
        const double lambda = m*(z[2] + g)/-z[0];
        const double u0 = x[0] - s[0], u1 = x[1] - s[1], u2 = x[2] - s[2];
        inputs[2*i] = trolley*s[2] - lambda*u0;
        inputs[2*i + 1] = winch(u0*u0 + z[0]*z[0], u0*u1 + z[0]*z[1],
            u1*u1 + z[1]*z[1] + u0*u2 + z[0]*z[2], lambda, inertia, radius);
    }
    return samples;
}
"""
ROTARY = (
    OVERHEAD[: OVERHEAD.index("int closed_batch")]
    + """
int closed_batch(int samples, const double *derivatives, const double *p, double *inputs)
{
    const double m = p[0], trolley = p[1], inertia = p[2], radius = p[3], g = p[4], bridge = p[5];
    for (int i = 0; i < samples; ++i) {
        const double *d = derivatives + 15*i;
        const double x[5] = {d[0], d[3], d[6], d[9], d[12]};
        const double y[5] = {d[1], d[4], d[7], d[10], d[13]};
        const double z[5] = {d[2], d[5], d[8], d[11], d[14]};
        double a[3], b[3];
        place(x, z, g, a);
        place(y, z, g, b);
        const double lambda = m*(z[2] + g)/-z[0];
        const double u0 = x[0] - a[0], u1 = x[1] - a[1], u2 = x[2] - a[2];
        const double v0 = y[0] - b[0], v1 = y[1] - b[1], v2 = y[2] - b[2];
        const double out = sqrt(a[0]*a[0] + b[0]*b[0]), c = a[0]/out, s = b[0]/out;
        const double along = c*a[1] + s*b[1], turn = (c*b[1] - s*a[1])/out;
        const double force_x = trolley*a[2] - lambda*u0, force_y = trolley*b[2] - lambda*v0;
        const double spin = (c*b[2] - s*a[2] - 2.0*along*turn)/out;
        inputs[3*i] = bridge*spin + out*(c*force_y - s*force_x);
        inputs[3*i + 1] = c*force_x + s*force_y;
        inputs[3*i + 2] = winch(u0*u0 + v0*v0 + z[0]*z[0], u0*u1 + v0*v1 + z[0]*z[1],
            u1*u1 + v1*v1 + z[1]*z[1] + u0*u2 + v0*v2 + z[0]*z[2], lambda, inertia, radius);
    }
    return samples;
}
"""
)
FORMS = {"overhead_crane": OVERHEAD, "rotary_crane": ROTARY}
"""By the names of cranes whose load hangs from the trolley, at a height of 0."""


class ClosedForm:
    """The closed form of a crane, compiled; inputs from derivatives of the outputs."""

    def __init__(self, rig: Rig) -> None:
        self._run: Any = library(f"closed_{rig.name}", FORMS[rig.name])["closed_batch"]
        self._run.argtypes = [ctypes.c_int, *[ctypes.c_void_p] * 3]
        (rope,) = rig.ropes
        numbers = [rig.loads[0].mass, rig.trolleys[0].mass, rope.winch_inertia, rope.drum_radius]
        numbers += [rig.gravity, *(frame.along for frame in rig.frames)]
        self._numbers = np.array(numbers)
        self._inputs = len(rig.drives)

    def __call__(self, derivatives: Array) -> Array:
        """Inputs (N, inputs) from derivatives (N, 5, outputs)."""
        inputs = np.empty((len(derivatives), self._inputs))
        places = derivatives.ctypes.data, self._numbers.ctypes.data, inputs.ctypes.data
        self._run(len(inputs), *places)
        return inputs
