"""A page for each environment: actions, observations, reward, ends, scenarios, options, versions.

Everything is read off an environment that is made for the page, so that none can be out of date.
"""

import inspect
import re
from collections.abc import Iterator
from typing import Any

import gymnasium as gym

from ... import envs
from ...envs.rewards import JERKY
from ...feedforward import driven_unit
from ...models import CATALOGUE, HAND_CATALOGUE
from ...models.errors import OptionError, did_you_mean
from ...models.rig.rig import Frame
from .documented import code, field_texts, parameter_texts, table

EXAMPLE = "extended_rotary_crane"
"""Rig that the page of rigs of one's own shows."""

VERSIONS = (
    ("v0", "0.1.0", "the first. Within a version names, order and units of actions and "
     "observations, the reward and the ends stay; new options have defaults that change nothing"),
)  # fmt: skip
"""Every version of the environments, the release that brought it, and what it changed."""

MEANINGS = {
    "position": "measured, from home",
    "rate": "measured",
    "error": "reference - measured",
    "rate_error": "rate of the reference - measured rate",
    "mean_error": "running average of the error over about a second",
    "command": "last command, before any delay, over the limit",
    "left": "share of the episode that is left",
    "tension": "pull of the rope or link",
}
"""What entries of observations are, by the last part of their names."""

ENDS = {
    "time": "the episode has lasted as long as it is to: `truncated`, everything else `terminated`",
    "not finite": "the simulation has left the numbers",
    "slack": "a rope that cannot push has pulled with less than nothing",
    "off the rail": "a trolley has passed an end of its rail",
    "out of reach": "a joint has gone farther from home than any move leads",
    "platform tipped over": "a platform leans so far that its angles fail",
    "dropped": "no finger has touched the object for 50 ms",
    "contact lost": "a finger has not touched the object for 50 ms",
}
"""What reasons mean."""


def environment_ids() -> tuple[str, ...]:
    """Every registered environment."""
    return (*envs.ENVIRONMENTS, envs.OWN, *envs.HAND_ENVIRONMENTS)


def full_id(name: str) -> str:
    """The id for a name that may lack `flatrig/` and the version.

    Raises
    ------
    OptionError
        There is no such environment.
    """
    ids = environment_ids()
    for known in ids:
        if name.lower() in (known.lower(), known[8:].lower(), known[8:-3].lower()):
            return known
    raise OptionError(f"there is no environment {name!r}{did_you_mean(name, ids)}")


def environment_page(name: str) -> str:
    """The page of an environment, in Markdown.

    Raises
    ------
    OptionError
        There is no such environment.
    """
    name = full_id(name)
    hand = name in envs.HAND_ENVIRONMENTS
    full = made(name, sensors="full")
    return "\n".join([
        f"# {name}\n",
        _introduction(name),
        *_actions(name, full, hand),
        *_observations(full, len(made(name).observation_names), hand),
        *_reward(full, hand),
        *_ends(full),
        *_scenarios(full, hand),
        "## Options\n",
        "Those of every environment: [all environments](index.md#options).\n",
        "## Versions\n",
        table(("version", "since", "change"), VERSIONS),
    ])  # fmt: skip


def made(name: str, **options: Any) -> Any:
    """An environment without wrappers; that of rigs of one's own with an example."""
    if name == envs.OWN:
        options["rig"] = EXAMPLE
    return gym.make(name, **options).unwrapped


def _introduction(name: str) -> str:
    if name == envs.OWN:
        what = (
            "Any rig: a `flatrig.models.Rig`, a name of the catalogue, or a TOML file. Names and "
            f"numbers below are those of `{EXAMPLE}`."
        )
        call = f'gym.make("{name}", rig="{EXAMPLE}")'
    else:
        rig = envs.ENVIRONMENTS.get(name) or envs.HAND_ENVIRONMENTS[name]
        build = (CATALOGUE if name in envs.ENVIRONMENTS else HAND_CATALOGUE)[rig]
        said = " ".join((inspect.getdoc(build) or "").split("\n\n")[0].split())
        what = f"{said} In the catalogue: `{rig}`."
        call = f'gym.make("{name}")'
    lines = ["import gymnasium as gym", "import flatrig.envs", "", f"env = {call}"]
    return f"{what}\n\n```python\n" + "\n".join(lines) + "\n```\n"


def _units(env: Any, hand: bool) -> dict[str, str]:
    """Units of drives' positions and of outputs, by name."""
    if hand:
        drives = {name: "m" if ".slide" in name else "rad" for name in env.action_names}
        ways = {f"object.{axis}": "m" for axis in "xyz"}
        return drives | ways | {f"object.turn_{axis}": "rad" for axis in "xyz"}
    rig = env.task.rig
    units = {
        drive.name: "rad" if isinstance(part, Frame) and part.kind == "turning" else "m"
        for drive, part in zip(rig.drives, map(rig.driven, rig.drives), strict=True)
    }
    for output in rig.outputs:
        angle = output.rpartition(".")[2] in ("alpha", "beta", "gamma", "angle")
        units[output] = "N" if output.endswith(".tension") else "rad" if angle else "m"
    return units


def _actions(name: str, env: Any, hand: bool) -> Iterator[str]:
    yield "## Actions\n"
    count = len(env.action_names)
    yield (
        f"`Box(-1, 1, ({count},))`: inputs over their limits, held over a control period of "
        f"{env.task.period:g} s (`rate`). What is beyond a limit is cut off.\n"
    )
    limits = dict(zip(env.task.acting.names, env.task.limits, strict=True))
    if hand:
        units = {drive: "N" if ".slide" in drive else "N m" for drive in limits}
    else:
        units = {drive.name: driven_unit(env.task.rig, drive) for drive in env.task.rig.drives}
    rows = [
        (i, code(action), f"{limits[action]:.4g} {units[action]}")
        for i, action in enumerate(env.action_names)
    ]
    yield table(("entry", "drive", "1 is"), rows)
    if not hand:
        led = made(name, reference="operator")
        yield 'With `reference="operator"` actions are velocities instead:\n'
        units = _units(led, hand)
        speeds = zip(led.action_names, led.task.speeds, strict=True)
        yield table(
            ("entry", "velocity of", "1 is"),
            [
                (i, code(action[:-9]), f"{speed:.4g} {units[action[:-9]]}/s")
                for i, (action, speed) in enumerate(speeds)
            ],
        )


def _observations(env: Any, encoders: int, hand: bool) -> Iterator[str]:
    yield "## Observations\n"
    names, scales = env.observation_names, env.task.observation_scales
    low = env.observation_space.low[0]
    more = "" if hand else ' With `sensors="sway"` they are late and noisy, as measured.'
    yield (
        f"`Box({low:g}, {-low:g}, ({encoders},))` with the drives' encoders, which is the default; "
        f'`({len(names)},)` with `sensors="full"`, which adds the last {len(names) - encoders}.'
        f"{more}\n"
    )
    units = _units(env, hand)
    rows = []
    for i, (name, scale) in enumerate(zip(names, scales, strict=True)):
        owner, _, kind = name.rpartition(".")
        if found := re.fullmatch(r"(.*)\.ahead_([\d.]+)", name):
            owner, kind, meaning = found[1], "ahead", f"reference in {found[2]} s - reference now"
        else:
            meaning = MEANINGS[kind]
        rows.append((i, code(name), meaning, f"{scale:.4g}{_unit(kind, units.get(owner, 'N'))}"))
    yield table(("entry", "name", "what", "1 is"), rows)


def _unit(kind: str, unit: str) -> str:
    if kind in ("command", "left"):
        return ""
    return " N" if kind == "tension" else f" {unit}/s" if kind.startswith("rate") else f" {unit}"


def _reward(env: Any, hand: bool) -> Iterator[str]:
    near = env.task.reward_distance
    outputs = "the object's pose, its turn times its radius," if hand else "the outputs"
    yield "## Reward\n"
    yield (
        f"`1 / (1 + (d / D)^2) / (1 + |du|^2 / S^2)` from 0 to 1: d is the distance of {outputs} "
        f"from the reference, D = {near:.4g} m, du the change of the action in a period, "
        f"S = {JERKY:g}. Angles count times a lever. The last step of an episode that ends early "
        "has 0.\n"
    )


def _ends(env: Any) -> Iterator[str]:
    yield "## Ends\n"
    plan = env.task.planner.fixed
    if plan is not None:
        seconds = plan.steps * env.task.period
        yield f"An episode of the default move has {plan.steps} steps, {seconds:g} s.\n"
    reasons = [reason for reason in env.reasons if reason]
    rows = []
    for i, reason in enumerate(reasons, start=1):
        low, above, high = reason.partition(" above ")
        risen = f"the {low} has risen above its {high}"
        rows.append((i, code(reason), risen if above else ENDS[reason]))
    yield table(('`info["reason"]`', "", "when"), rows)


def _scenarios(env: Any, hand: bool) -> Iterator[str]:
    yield "## Scenarios\n"
    scenario = f"envs.{'HandScenario' if hand else 'Scenario'}(...)"
    yield (
        "How a plant differs from its description, drawn at each reset from ranges. Below are "
        'those of `disturbances="standard"`; without it nothing differs. One plant is prescribed '
        f'by `env.reset(options={{"scenario": {scenario}}})`.\n'
    )
    kind = envs.HandDisturbances if hand else envs.Disturbances
    ranges: Any = kind.standard(env.task.hand if hand else env.task.rig)
    neutral = ranges.scenario_type()
    rows = []
    for name, text in field_texts(ranges.scenario_type).items():
        rows.append((code(name), _range(ranges, name, getattr(neutral, name)), text))
    yield table(("number", "standard", "meaning"), rows)


def _range(ranges: Any, name: str, neutral: object) -> str:
    """What a number of a scenario is drawn from, "-" if it is always neutral."""
    drawn = getattr(ranges, name, None)
    if isinstance(drawn, tuple) and drawn != (neutral, neutral):
        ends = " to ".join(f"{end:.4g}" for end in drawn)
        return f"{ends} in any direction" if isinstance(neutral, tuple) else ends
    whose, _, kind = name.partition("_")
    circle = kind in ("direction", "phase") and any(getattr(ranges, whose, ()))
    return "whole circle" if circle else "-"


def environments_page() -> str:
    """The page of all environments: a table, and the options that they share."""
    rows = []
    for name in environment_ids():
        env = made(name)
        count = len(env.action_names), len(env.observation_names)
        short = name.removeprefix("flatrig/")
        rows.append((f"[{name}]({short}.md)", *count, f"{env.task.period:g}"))
    heads = ("environment", "actions", "entries of an observation", "period [s]")
    return "\n".join([
        "# Environments\n",
        "`gym.make(ID, ...)` makes one, `gym.make_vec(ID, num_envs=64, ...)` a vector of them, "
        "once `flatrig.envs` is imported. Each page is made from the code; "
        "`flatrig docs ID` prints it.\n",
        table(heads, rows),
        "## Options\n",
        "### Of cranes\n",
        _options(envs.CraneTask),
        "### Of hands\n",
        _options(envs.HandTask),
        "### Of both\n",
        "`render_mode` is \"rgb_array\" or \"human\"; `width`, `height` and `camera` say what a "
        "picture shows. Vectors have `num_envs` and `autoreset_mode`.\n",
    ])  # fmt: skip


def _options(task: Any) -> str:
    """A table of a task's options."""
    parameters = inspect.signature(task).parameters
    texts = parameter_texts(task)
    return table(
        ("option", "default", "meaning"),
        [
            (code(name), code(repr(parameters[name].default)), text)
            for name, text in texts.items()
            if name != "num"
        ],
    )
