"""Exceptions of the package."""

from __future__ import annotations


class CrepitusError(Exception):
    """What this package raises, where a built-in exception does not say it."""


class SceneError(CrepitusError, ValueError):
    """A scene that cannot be read. Its text is that of the command line tool.

    Attributes:
        file: The scene's file; ``<dict>`` or ``<toml>`` without one.
        line: The line in it, from 1; ``None`` if it is not at one place.
        key: The key, such as ``solver.step_s``; empty for the whole scene.
        message: What is wrong, and what is allowed.
    """

    def __init__(
        self,
        text: str,
        file: str = "",
        line: int | None = None,
        key: str = "",
        message: str = "",
    ) -> None:
        super().__init__(text, file, line, key, message)
        self.file = file
        self.line = line
        self.key = key
        self.message = message or text

    def __str__(self) -> str:
        return str(self.args[0])


class RunError(CrepitusError, RuntimeError):
    """A run or a study that failed: the solver diverged."""


class Refusal(CrepitusError, ValueError):
    """Measurements that do not tell; its text says what they show instead, and what to record."""


class DeviceError(CrepitusError, RuntimeError):
    """A device that cannot be used, has refused, or has stopped by itself."""
