"""Warp and its devices: starting Warp quietly, finding and listing devices."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import warp as wp

from warpgran.errors import WarpgranError


class DeviceError(WarpgranError, ValueError):
    """A device that does not exist; the message lists those that do."""


def start_quietly() -> None:
    """Start Warp without its banner, its compile messages, and its warning about a missing CUDA driver.

    For a program of its own; within another one see `quietly`.
    """
    wp.config.log_level = wp.LOG_WARNING
    if _has_driver():
        wp.init()
    else:
        with _stderr_closed():
            wp.init()


@contextmanager
def quietly() -> Iterator[None]:
    """Warp without its messages, started if need be; what they were to a program that uses Warp itself comes back."""
    level = wp.config.log_level
    start_quietly()
    try:
        yield
    finally:
        wp.config.log_level = level


def find_device(name: str) -> str:
    """Warp's name of an existing device.

    Args:
        name: "cpu", "cuda" or "cuda:N".

    Raises:
        DeviceError: It does not exist, or its driver is too old.
    """
    try:
        if name.startswith("cuda") and not wp.is_cuda_available():
            raise ValueError  # before Warp asks a driver that is not there, which complains on standard error
        found = wp.get_device(name)
    except (RuntimeError, ValueError):
        there = ", ".join(str(device) for device in wp.get_devices())
        raise DeviceError(f"device: {name!r} is not on this machine; there is: {there}{_of_the_driver()}") from None
    if found.is_cuda and not wp.is_conditional_graph_supported():
        raise DeviceError(f"device: {name!r} has a driver without loops in graphs; allowed: one for CUDA 12.4 or later")
    return str(found)


def find_devices(names: str) -> tuple[str, ...]:
    """Warp's names of existing devices, each of which computes in a thread of its own.

    Args:
        names: One, or several of a kind, separated by commas: "cuda:0,cuda:1". The cpu may be named more than once.

    Raises:
        DeviceError: One does not exist, has too old a driver, or is of another kind than the others.
    """
    found = tuple(find_device(name.strip()) for name in names.split(","))
    if len({name.partition(":")[0] for name in found}) > 1:
        raise DeviceError(f"device: {names!r} is of two kinds; allowed: several of one, as cuda:0,cuda:1")
    if found[0] != "cpu" and len(set(found)) < len(found):
        raise DeviceError(f"device: {names!r} names a GPU twice; allowed: each once, since a block fills it")
    return found


def _of_the_driver() -> str:
    """What to add to the message where there is an NVIDIA driver but no GPU."""
    driver = wp.get_cuda_driver_version()
    if driver is None or wp.get_cuda_device_count():
        return ""
    return f" (the NVIDIA driver is for CUDA {driver[0]}.{driver[1]}; see docs/gpu.md for what Warp needs)"


def devices() -> list[tuple[str, str, float]]:
    """Alias, name and memory [GiB; 0 if not known] of every device."""
    return [(str(d), d.name, d.total_memory / 2**30 if d.is_cuda else _ram()) for d in wp.get_devices()]


def memory_of(device: str) -> float:
    """Bytes of memory of a device; of the machine for the cpu."""
    found = wp.get_device(device)
    return float(found.total_memory) if found.is_cuda else _ram() * 2**30


def free_memory_of(device: str) -> float:
    """Bytes of free memory of a device, 0 if not known."""
    found = wp.get_device(device)
    return float(found.free_memory) if found.is_cuda else _ram("SC_AVPHYS_PAGES") * 2**30


def _ram(pages: str = "SC_PHYS_PAGES") -> float:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf(pages) / 2**30
    except (AttributeError, ValueError, OSError):
        return 0.0


def _has_driver() -> bool:
    """Whether there is an NVIDIA driver, found as Warp finds it; `ctypes.util.find_library` would start a process."""
    try:
        ctypes.CDLL("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")
    except OSError:
        return False
    return True


@contextmanager
def _stderr_closed() -> Iterator[None]:
    """Drop what native code writes to standard error."""
    sys.stderr.flush()
    kept = os.dup(2)
    try:
        with open(os.devnull, "wb") as null:
            os.dup2(null.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
