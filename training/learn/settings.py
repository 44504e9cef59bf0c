"""How a policy learns, and the scenarios on which it is judged meanwhile."""

from dataclasses import dataclass

VALIDATION_SEED = 2001_2016
"""Seed of the scenarios on which policies are judged during training."""
VALIDATION_SCENARIOS = 50
"""Number of these scenarios."""


@dataclass(frozen=True)
class Settings:
    """How a policy learns; one set of numbers for all rigs."""

    hidden: tuple[int, ...] = (64, 64)
    """Widths of the hidden layers, of actor and critic alike."""
    reach: float = 0.12
    """How far the largest residual can push the load against the feedback [m]."""
    fraction: float = 0.0
    """Largest residual as a share of the inputs' limits; if 0, what follows from `reach`."""
    time_constants: tuple[float, ...] = (0.1, 0.4, 1.5, 5.0)
    """Time constants of the filters in the policy's memory [s]."""
    smoothing: float = 0.5
    """Share of the way to its aim that the policy's action goes in one control period."""
    every: int = 5
    """Control periods from one decision to the next."""
    timestep: float = 5e-3
    """Time step of the simulation in training [s]; policies are judged with the environment's."""
    imitation: float = 0.5
    """Share of the budget in which the policy learns from the teacher, before PPO."""
    lessons: int = 40
    """Updates whose advice of the teacher is remembered."""
    decisions: int = 64
    """Decisions in each simulation between two updates."""
    batch: int = 512
    """Samples for one gradient."""
    epochs: int = 5
    """Passes of PPO over the samples of one update."""
    gradients: int = 200
    """Gradients of one update of imitation."""
    imitation_rate: float = 1e-3
    """Learning rate of imitation."""
    learning_rate: float = 3e-4
    """Learning rate of PPO at its start; it falls linearly to a tenth."""
    discount: float = 0.97
    """Discount of the return for one decision."""
    trace: float = 0.95
    """lambda of the generalised advantage estimate."""
    divergence: float = 0.03
    """PPO ends an update early where the policy has changed by 1.5 times this divergence."""
    sharpness: float = 2.0
    """Distance at which the reward is 0, in tracking errors of feedforward + PD."""
    deviation: float = 0.2
    """Standard deviation of the exploration at the start, as a share of the residual."""
