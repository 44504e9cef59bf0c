"""The back end for Ray: a cluster that runs already, or one that is begun on this machine.

    flatrig stress --on ray                                  # begun here, for this run only
    RAY_ADDRESS=10.0.0.1:6379 flatrig stress --on ray        # a cluster that runs there

Whoever reaches Ray's ports can run what he likes as its user, unless it asks for a token, which by
itself it does not.  One that is begun here has a token of its own, and listens on the loopback
address only.  `ray.init(_node_ip_address="127.0.0.1")` does not do: Ray replaces that by the
machine's address, and then listens on every interface.  It leaves the loopback address in place
where it takes itself for unable to make clusters, as on Windows and macOS, and a variable says so
on Linux, too.
"""

import os
import secrets
import socket
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from ..provenance import sources
from ..watchdog import quiet
from .crews import BackendError, Item, Lost, Value, Work, opened, work_off

LOOPBACK = "127.0.0.1"
LOOPBACKS = (LOOPBACK, "localhost", "::1")
"""What Ray would replace by the machine's address, also in the address of a cluster."""
ADDRESS = "RAY_ADDRESS"
"""Variable of Ray's own with the address of a cluster."""
LOOPBACK_ONLY = {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0", "RAY_USAGE_STATS_ENABLED": "0"}
"""What keeps Ray on the loopback address, and from reporting to its makers."""
STORE = 256 * 2**20
"""Memory for items and values on their way, where Ray is begun here [bytes]."""
PATIENCE = 5.0
"""How long an address may take to answer [s]."""
GREETING = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes((0, 0, 0, 4, 0, 0, 0, 0, 0))
"""How a client of gRPC begins: the preface and an empty frame of settings (RFC 9113, 3.4), which
is answered by such a frame."""
CHECKS = 1.0
"""Time between two looks at an interruption from the keyboard [s]."""


@dataclass(frozen=True)
class Ray:
    """Back end for Ray (extra `ray`)."""

    count: int = 1
    """Number of items side by side where Ray is begun here; a cluster does as many as it can."""
    begin: Callable[[], None] | None = None
    """Function that every process calls first."""
    cores: int = 1
    """Cores for each item."""

    def __call__(
        self, function: Callable[[Item], Value], items: Mapping[int, Item], retries: int
    ) -> Iterator[tuple[int, Value | Exception]]:
        """Work on the items.

        Raises
        ------
        BackendError
            Ray does not answer, cannot be begun, or its machines have another flatrig.
        """
        if items:
            work = Work(function, self.begin, sources())
            with closing(_Cluster(work, items, self.count, self.cores)) as crew:
                yield from work_off(crew, items, retries)


class _Cluster:
    """Ray's processes, each of which works on one item at a time."""

    def __init__(
        self, work: Work[Any, Any], items: Mapping[int, Any], count: int, cores: int
    ) -> None:
        address = os.environ.get(ADDRESS, "")
        _set_variables(address)
        import ray

        self._ray, self._items, self._cores = ray, items, cores
        self._running: dict[Any, int] = {}
        self._ours = not ray.is_initialized()
        if self._ours:
            _connect(address) if address else _begin(count * cores)
            _keep_quiet()
        # Ray's own repetitions would run a suspect beside others.
        self._sealed = ray.remote(num_cpus=cores, max_retries=0)(Work.sealed)
        self._work = ray.put(work)

    def take(self, waiting: deque[int]) -> list[int]:
        slots = int(self._ray.cluster_resources().get("CPU", 0.0)) // self._cores
        if not slots:
            raise BackendError(f"no machine of Ray's has {self._cores} cores for an item")
        room = min(slots - len(self._running), len(waiting))
        taken = [waiting.popleft() for _ in range(room)]
        for number in taken:
            self._running[self._sealed.remote(self._work, self._items[number])] = number
        return taken

    def wait(self) -> list[tuple[int, Any]]:
        done: list[Any] = []
        while not done:
            running = list(self._running)
            done, _ = self._ray.wait(running, num_returns=1, timeout=CHECKS)
        more, _ = self._ray.wait(running, num_returns=len(running), timeout=0.0)
        return [(self._running.pop(entry), self._ending(entry)) for entry in {*done, *more}]

    def _ending(self, entry: Any) -> Any:
        errors = self._ray.exceptions
        try:
            return opened(self._ray.get(entry))
        except errors.RayTaskError as error:  # the function itself lets no exception out
            reason = str(error.cause or error).splitlines()[0]
            raise BackendError(
                f"a machine of Ray's cannot run flatrig: {reason}; install the same version there"
            ) from None
        except errors.RayError:
            return Lost()

    def close(self) -> None:
        for entry in self._running:
            self._ray.cancel(entry, force=True)
        if self._ours:
            self._ray.shutdown()


def _set_variables(address: str) -> None:
    """What Ray reads as it is loaded."""
    if not address or _parts(address)[0] in LOOPBACKS:
        os.environ.update(LOOPBACK_ONLY)
    if not address and "RAY_AUTH_MODE" not in os.environ:
        os.environ["RAY_AUTH_MODE"] = "token"
        os.environ["RAY_AUTH_TOKEN"] = secrets.token_hex(32)


def _connect(address: str) -> None:
    """Connect to a cluster that runs."""
    import ray

    _must_answer(address)
    try:
        with quiet():
            ray.init(address=address, **_silent())
    except Exception as error:
        raise BackendError(
            f"Ray does not let us in at {ADDRESS}={address}: {_first_line(error)}; it may have "
            "another version, or another RAY_AUTH_TOKEN"
        ) from None


def _must_answer(address: str) -> None:
    """Refuse an address where no Ray is, at which Ray itself would look for minutes."""
    host, port = _parts(address)
    if not port.isdecimal() or os.environ.get("RAY_USE_TLS", "0") != "0":
        return  # "auto", or something that cannot be asked like this
    try:
        with socket.create_connection((host, int(port)), PATIENCE) as asked:
            asked.sendall(GREETING)
            answer = asked.recv(9)
    except (OSError, OverflowError) as error:
        raise BackendError(
            f"nothing answers at {ADDRESS}={address} ({error}); begin Ray there, or unset {ADDRESS}"
        ) from None
    if answer[3:4] != GREETING[-6:-5]:  # the frame's type
        raise BackendError(f"what listens at {ADDRESS}={address} is no Ray; another has that port")


def _parts(address: str) -> tuple[str, str]:
    """Host and port of an address, the latter "" if there is none."""
    host, _, port = address.rpartition("/")[2].rpartition(":")
    return host.strip("[]"), port


def _begin(cores: int) -> None:
    """Begin Ray on this machine, for nobody else."""
    import ray

    try:
        ray.init(
            address="local", num_cpus=cores, include_dashboard=False, object_store_memory=STORE,
            _node_ip_address=LOOPBACK, **_silent(),
        )  # fmt: skip
    except Exception as error:
        raise BackendError(f"Ray cannot be begun here: {_first_line(error)}") from None
    addresses = {node["NodeManagerAddress"] for node in ray.nodes()}
    if addresses != {LOOPBACK}:
        ray.shutdown()
        raise BackendError(
            f"Ray would listen at {', '.join(addresses)}, open to others, as it was loaded before; "
            + "set " + " ".join(f"{name}={value}" for name, value in LOOPBACK_ONLY.items())
        )  # fmt: skip


def _keep_quiet() -> None:
    """Keep what Ray says about processes that have ended off stdout, which is for results."""
    from ray._private import worker  # no option and no public function does it

    worker.print_to_stdstream = lambda *_, **__: None


def _silent() -> dict[str, Any]:
    return {"log_to_driver": False, "logging_level": "ERROR"}


def _first_line(error: Exception) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]
