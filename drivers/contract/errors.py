"""The errors of Tenon: one small tree, so that a caller catches what it can handle."""


class TenonError(Exception):
    """Root of every error that Tenon raises on purpose."""


class ConfigurationError(TenonError):
    """A configuration cannot be used; the text names file, key, value and what is valid."""


class DeviceError(TenonError):
    """A device failed or answered something it should not."""


class DeviceTimeoutError(DeviceError):
    """A device did not answer before the deadline."""


class CommandRefusedError(DeviceError):
    """A device refused a command; nothing moved because of it."""


class LogError(TenonError):
    """A log cannot be written or read."""


class PolicyError(TenonError):
    """A trained policy cannot be written, read or exported; the text names file and cause."""


class TrainingError(TenonError):
    """A training cannot be stored or taken up again."""


class SafetyError(TenonError):
    """The safety supervisor does not allow what was asked for."""


class TareRefusedError(TenonError):
    """The force bias was not taken, because the sensor may be loaded."""
