"""Whether a hand's kinematics are holonomic, flat or Liouvillian, decided from ranks.

    print(classify(models.ball_on_plate(spin=False)))
    table([models.ball_on_plate(), ...])             # K's table 2.1 with the reasons

The distribution D of the admissible velocities grows by Lie brackets, D0 = D, D(k+1) = Dk +
[Dk, Dk]; what the codistribution's derived flag loses, I(k) = n - dim Dk, is what D gains
(K definition 14).  Since the vector fields are linear with constant matrices
(`kinematics.Rolling`), brackets are commutators and the ranks are those of matrices at random
states, of which the largest counts.  n is the dimension that D reaches in the end: the integrable
constraints are gone.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from ...models.hand.hand import Finger, Hand, Plate, Tip
from ...models.types import Array
from .kinematics import Rolling

Answer = Literal["yes", "no", "?"]

STATES = 3
"""Random states at which ranks are taken: one might lie where a rank is smaller by chance."""
RANK_TOLERANCE = 1e-9
"""Singular values below this share of the largest count as zero; rounding leaves some 1e-15."""


@dataclass(frozen=True)
class Classification:
    """A row of K's table 2.1 with its reasons."""

    hand: str
    """Name of the hand."""
    dimension: int
    """Dimension n of the states that can be reached."""
    inputs: int
    """Number m of the generalized velocities."""
    constraints: int
    """Number of velocity constraints on the states before any is integrated."""
    growth: tuple[int, ...]
    """Dimensions of D0, D1, ... until they stay."""
    holonomic: bool
    """Whether all constraints can be integrated."""
    flat: Answer
    """Whether the kinematics are flat."""
    liouvillian: Answer
    """Whether they are Liouvillian."""
    reasons: tuple[str, str, str]
    """Reasons for holonomy, flatness and the Liouvillian property, in this order."""

    @property
    def derived_flag(self) -> tuple[int, ...]:
        """Dimensions of the derived flag I0, I1, ... of the codistribution."""
        return tuple(self.dimension - size for size in self.growth)

    def __str__(self) -> str:
        answers = ("yes" if self.holonomic else "no", self.flat, self.liouvillian)
        words = ("holonomic", "flat", "Liouvillian")
        lines = [
            f"  {word:<12}{answer:<4}{reason}"
            for word, answer, reason in zip(words, answers, self.reasons, strict=True)
        ]
        head = f"{self.hand}: {self.dimension} states, {self.inputs} inputs, derived flag"
        return "\n".join([f"{head} {self.derived_flag}", *lines])


def _rank(vectors: Array) -> int:
    """Rank of vectors (count, size)."""
    return int(np.linalg.matrix_rank(vectors, tol=RANK_TOLERANCE * max(np.abs(vectors).max(), 1)))


def random_state(rolling: Rolling, random: np.random.Generator) -> Array:
    """A state with any orientation and contacts; a planar hand's stays in the plane."""
    hand = rolling.hand
    if hand.planar:
        rotation = Rotation.from_rotvec([0.0, random.uniform(-3, 3), 0.0]).as_matrix()
    else:
        rotation = Rotation.random(rng=random).as_matrix()
    directions = {}
    for finger in _with_tips(hand):
        direction = random.standard_normal(3) * ((1, 0, 1) if hand.planar else (1, 1, 1))
        directions[f"e.{finger.name}"] = direction / np.linalg.norm(direction)
    return rolling.state(rotation, random.standard_normal(3), **directions)


def _with_tips(hand: Hand) -> list[Finger]:
    """Fingers whose contact moves over a round tip."""
    return [finger for finger in hand.fingers if isinstance(finger.surface, Tip)]


def _independent(matrices: Array) -> Array:
    """Orthonormal matrices that span what the given ones (count, size, size) do."""
    _, sizes, right = np.linalg.svd(matrices.reshape(len(matrices), -1), full_matrices=False)
    basis = right[sizes > RANK_TOLERANCE * sizes[0]]
    return np.asarray(basis.reshape(-1, *matrices.shape[1:]))


def growth(rolling: Rolling, seed: int = 0) -> tuple[int, ...]:
    """Dimensions of D0, D1, ... at random states, up to the one that stays."""
    random = np.random.default_rng(seed)
    states = [random_state(rolling, random) for _ in range(STATES)]
    fields = _independent(rolling.generators)
    sizes = [max(_rank(fields @ state) for state in states)]
    while True:
        products = np.einsum("aij,bjk->abik", fields, fields)
        brackets = (products - products.swapaxes(0, 1)).reshape(-1, *fields.shape[1:])
        wider = _independent(np.concatenate((fields, brackets)))
        if len(wider) == len(fields):
            return tuple(sizes)
        fields = wider
        sizes.append(max(_rank(fields @ state) for state in states))
        if sizes[-1] == sizes[-2]:
            sizes.pop()  # more fields, the same directions


def _states_before(rolling: Rolling) -> int:
    """Dimension of the states before constraints are integrated."""
    pose, contact = (3, 1) if rolling.hand.planar else (6, 2)
    tips = [finger.surface for finger in rolling.hand.fingers if isinstance(finger.surface, Tip)]
    return pose + contact * len(rolling.hand.fingers) + sum(len(tip.axes) for tip in tips)


def _flat(rolling: Rolling, sizes: tuple[int, ...]) -> tuple[Answer, str]:
    """Flatness from the growth of D, without the inputs that only move the centre (as K)."""
    linear = rolling.generators[:, :-1, :-1]
    trivial = sizes[0] - _rank(linear.reshape(len(linear), -1))
    sizes = tuple(size - trivial for size in sizes)
    n, inputs = sizes[-1], sizes[0]
    if len(sizes) == 1:
        return "yes", "holonomic: the inputs are the rates of as many coordinates"
    if inputs == 2:
        flag, chain = tuple(n - size for size in sizes), tuple(range(n - 2, -1, -1))
        if flag == chain:
            return "yes", f"two inputs and derived flag {flag} as in K's theorem 1"
        return "no", f"two inputs, derived flag {flag} instead of {chain} (K theorem 1)"
    if n <= inputs + 2:
        return "yes", f"{n} states are at most two more than {inputs} inputs (K remark 11)"
    return "?", f"{n} states exceed {inputs} inputs by {n - inputs}: no criterion is known"


def _liouvillian(rolling: Rolling, flat: Answer) -> tuple[Answer, str]:
    """Whether the rest follows by quadratures from outputs that can be chosen freely.

    Rotations and contact directions in space do not commute and must be outputs; all else has
    rates that do not depend on itself.  Where the rotation has two free rates only, the direction
    of its first column is the output and the turn about it an integral (K proposition 7).
    """
    if flat == "yes":
        return "yes", "flat: no integral is needed"
    state = random_state(rolling, np.random.default_rng(1))
    velocities = rolling.generators @ state
    m = _rank(velocities)
    rows = {name: velocities[:, place] for name, place in rolling.blocks.items()}
    turning = np.concatenate([rows[name] for name in ("r0", "r1", "r2")], axis=1)
    outputs = [turning if _rank(turning) == 3 else rows["r0"]]
    tips = _with_tips(rolling.hand)
    outputs += [rows[f"e.{finger.name}"] for finger in tips]
    freedoms = min(_rank(turning), 3) + 2 * len(tips)
    if _rank(np.concatenate(outputs, axis=1)) < freedoms:
        return "?", "the contacts on the tips cannot be chosen freely beside the orientation"
    whole = _rank(turning) == 3
    chosen = ["orientation" if whole else "two of the RPY angles"]
    chosen += ["contact points on the object"] if tips else []
    chosen += ["free motion of the centre"] if m > freedoms else []
    integrals = [] if whole else ["the third RPY angle"]
    plates = len(tips) < len(rolling.hand.fingers)
    integrals += ["contact points on plates"] if plates else []
    integrals += ["turns of the tips"] if any(f"q.{finger.name}" in rows for finger in tips) else []
    return "yes", f"outputs: {', '.join(chosen)}; integrals: {', '.join(integrals)}"


def _in_radii(finger: Finger, radius: float) -> Finger:
    """The finger with its tip's radius measured by that of the object."""
    if isinstance(finger.surface, Plate):
        return finger
    return replace(finger, surface=replace(finger.surface, radius=finger.surface.radius / radius))


def classify(hand: Hand) -> Classification:
    """Holonomy, flatness and the Liouvillian property of a hand's kinematics (K table 2.1).

    Raises
    ------
    RigError
        See `Rolling`.
    """
    # Lengths in radii of the object, so that no size makes a rank small.
    fingers = tuple(_in_radii(finger, hand.held.radius) for finger in hand.fingers)
    rolling = Rolling.of(replace(hand, held=replace(hand.held, radius=1.0), fingers=fingers))
    sizes = growth(rolling)
    n, m, before = sizes[-1], sizes[0], _states_before(rolling)
    flat, why_flat = _flat(rolling, sizes)
    liouvillian, why_liouvillian = _liouvillian(rolling, flat)
    remaining = n - m
    whole = f"{before - n} of {before - m} rolling constraints integrate"
    why = whole if remaining == 0 else f"{whole}, {remaining} do not"
    return Classification(
        hand.name if hand.spin else f"{hand.name} without spin",
        n, m, before - m, sizes, remaining == 0, flat, liouvillian,
        (why, why_flat, why_liouvillian),
    )  # fmt: skip


def table(hands: Iterable[Hand]) -> str:
    """K's table 2.1 for hands, one line each."""
    lines = [f"{'hand':<32}{'fingers':>8}{'n':>4}{'m':>4}  holonomic  flat  Liouvillian  flag"]
    for hand in hands:
        row = classify(hand)
        lines.append(
            f"{row.hand:<32}{len(hand.fingers):>8}{row.dimension:>4}{row.inputs:>4}  "
            f"{'yes' if row.holonomic else 'no':<9}  {row.flat:<4}  {row.liouvillian:<11}  "
            f"{row.derived_flag}"
        )
    return "\n".join(lines)
