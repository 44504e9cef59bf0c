"""Tables of what the schemes do: `python -m flatrig.feedforward.integrators`."""

from ...models.squeezer import mechanism as data
from ..multibody import angles_of_squeezer, assemble, rotary_crane
from .conditioning import table
from .energy_momentum import EnergyMomentum
from .measured import conservation, squeezer_explicit, squeezer_limit, work_precision
from .midpoint import Midpoint
from .reduced import ReducedEnergyMomentum
from .variational import Variational


def main() -> None:
    """Print conservation, conditioning, the squeezer's angle, and work against precision."""
    print("Free rotary crane, 1 s: greatest relative change of energy and angular momentum")
    for place in (1.5, 2.5):
        print(f"  trolley at {place} m")
        for row in conservation(place, (100, 1000)):
            print(
                f"    {row.scheme:24}{row.step:8.0e} s{row.energy:10.1e}{row.momentum:10.1e}"
                f"{row.iterations:8} iterations {row.failure}"
            )

    print("Condition of the iteration matrix, free rotary crane: as printed, and scaled")
    system, start = assemble(rotary_crane())
    for condition in table(system, start.q, start.v, (1e-2, 1e-3, 1e-4, 1e-5)):
        print(
            f"    {condition.scheme:24}{condition.step:8.0e} s{condition.unknowns:4} unknowns"
            f"{condition.printed:10.1e}{condition.scaled:10.1e}"
        )

    print("Squeezer, beta at 0.03 s [rad], and its distance from the published value")
    looser, explicit = (
        float(angles_of_squeezer(squeezer_explicit(tolerance).q)[-1, 0])
        for tolerance in (1e-12, 1e-13)
    )
    limits = {"index 1, DOP853, tolerance 1e-13": (explicit, abs(explicit - looser))}
    for scheme in (Midpoint(), EnergyMomentum(), ReducedEnergyMomentum(), Variational()):
        limit, uncertainty = squeezer_limit(scheme)
        limits[f"{scheme.name}, extrapolated"] = float(limit[0]), float(uncertainty[0])
    for name, (beta, uncertain_by) in limits.items():
        print(f"    {name:38}{beta:.13f}{beta - data.PUBLISHED[0]:10.1e}  (+-{uncertain_by:.0e})")

    print("Squeezer: error of beta [rad], factorisations, seconds")
    for work in work_precision(explicit, (100, 300, 1000), (1e-4, 1e-6, 1e-8, 1e-10)):
        print(
            f"    {work.method:24}{work.setting:>8}{work.error:10.1e}"
            f"{work.factorisations:8}{work.seconds:8.2f}"
        )


if __name__ == "__main__":
    main()
