"""n worlds of a MuJoCo model in mujoco_warp, whose arrays are torch tensors; extra `warp`."""

import copy
from typing import Any

import mujoco
import torch
import warp

from ...models.errors import OptionError
from ...models.types import Array

# Before mujoco_warp starts it: else it tells of every kernel that it loads.
warp.config.log_level = max(warp.config.log_level, warp.LOG_WARNING)

import mujoco_warp  # noqa: E402


class WarpPhysics:
    """n worlds of a model; tensors are live, on the device, and in single precision.

    Parameters
    ----------
    model
        The bare physics.
    num
        Number of worlds n.
    rest
        Joints at first, (nq,).
    substeps
        Time steps in a control period.
    device
        As Warp calls it; None for a GPU where there is one.

    Raises
    ------
    OptionError
        There is no such device.
    """

    def __init__(
        self, model: mujoco.MjModel, num: int, rest: Array, substeps: int, device: str | None
    ) -> None:
        self._device = warp.get_device(_known(device))
        self.device = torch.device(warp.device_to_torch(self._device))
        """The device, as torch calls it."""
        self.model = copy.copy(model)
        # A state that is not finite shows by itself; mujoco_warp refuses the flag.
        self.model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        data = mujoco.MjData(self.model)
        data.qpos[:] = rest
        mujoco.mj_forward(self.model, data)
        with warp.ScopedDevice(self._device):
            self._on_device = mujoco_warp.put_model(self.model)
            self.data = mujoco_warp.put_data(self.model, data, nworld=num)
        self._substeps = substeps
        self._graph: Any = None
        self.qpos, self.qvel = self.tensor("qpos"), self.tensor("qvel")
        """Joint positions and velocities, (n, nq) and (n, nv)."""
        self.ctrl, self.warmstart = self.tensor("ctrl"), self.tensor("qacc_warmstart")
        """Inputs (n, nu), and where constraints are solved from (n, nv)."""

    def tensor(self, name: str) -> torch.Tensor:
        """An array of mujoco_warp's data."""
        return warp.to_torch(getattr(self.data, name))  # type: ignore[no-any-return]

    def hold(self) -> None:
        """Hold `ctrl` over one control period: recorded once, and then played at one launch."""
        with self._stream():
            if self._graph is not None:
                warp.capture_launch(self._graph)
                return
            self._period()  # compiles and loads kernels
            with warp.ScopedCapture(self._device) as capture:
                self._period()
            self._graph = capture.graph

    def forward(self) -> None:
        """Bring what follows from the state up to date."""
        with self._stream():
            mujoco_warp.forward(self._on_device, self.data)

    def _period(self) -> None:
        for _ in range(self._substeps):
            mujoco_warp.step(self._on_device, self.data)
        mujoco_warp.forward(self._on_device, self.data)

    def _stream(self) -> Any:
        """Let Warp work in order with torch, and on the device."""
        if not self._device.is_cuda:
            return warp.ScopedDevice(self._device)
        return warp.ScopedStream(warp.stream_from_torch(self.device))


def _known(device: str | None) -> str | None:
    """The name of a device, if there is one of that name."""
    names = [one.alias for one in warp.get_devices()]
    wanted = "cuda:0" if device == "cuda" else device
    if wanted is not None and wanted not in names:
        raise OptionError(f"there is no device {device!r}, only {', '.join(names)}")
    return wanted
