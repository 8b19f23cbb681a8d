"""What a device must be able to do, whatever its make. Backends and tests depend on nothing more.

Every method may raise DeviceError; commands raise CommandRefusedError when the device refuses.
"""

from typing import Protocol

from drivers.contract.messages import (
    ArmState,
    ForceSample,
    GripperState,
    Pose,
    StageCommand,
    StageState,
    Wrench,
)


class Device(Protocol):
    """Connect before use; close leaves the device at rest and may be called twice."""

    def connect(self) -> None: ...

    def close(self) -> None: ...


class ForceSensor(Device, Protocol):
    """Streams samples at a fixed rate."""

    @property
    def rate_Hz(self) -> float: ...

    @property
    def noise_std(self) -> Wrench:
        """Standard deviation of one sample's noise [N, N*m]."""

    def read(self, timeout_s: float) -> ForceSample:
        """Return the oldest sample not yet read, waiting for it at most `timeout_s`.

        Raises DeviceTimeoutError when none came in time.
        """


class Stage(Device, Protocol):
    """Moves the shaft along straight lines; a running move can be slowed and stopped."""

    def state(self) -> StageState: ...

    def move_to(self, target: Pose, speed_m_s: float, angular_speed_rad_s: float) -> StageCommand:
        """Start a straight move to `target` (frame M) and return what was accepted.

        Raises CommandRefusedError while a move is running, beyond the travel or above the device's
        own speed limits.
        """

    def slow_to(self, speed_m_s: float, angular_speed_rad_s: float) -> None:
        """Lower the speeds of the running move; if it has just ended, there is nothing to do."""

    def halt(self) -> None:
        """Brake to rest as fast as the stage can."""


class Arm(Device, Protocol):
    """Carries the part between the tray and the place where it is inserted."""

    def state(self) -> ArmState: ...

    def move_to(self, target: Pose, speed_m_s: float) -> None: ...

    def halt(self) -> None: ...


class Gripper(Device, Protocol):
    """Holds the part by vacuum."""

    def state(self) -> GripperState: ...

    def set_valve(self, is_open: bool) -> None:
        """Open the valve to hold a part, close it to let go."""
