"""What the keys of the run file are called in figures."""

from __future__ import annotations

from typing import Any, NamedTuple


class Parameter(NamedTuple):
    """How a key of the run file is called in a figure."""

    words: str
    symbol: str
    unit: str = ""
    factor: float = 1.0  # from the unit of the run file

    @property
    def label(self) -> str:
        """Words, symbol and unit."""
        return f"{self.words} {self.symbol} ({self.unit.strip() or '-'})" if self.symbol else self.words

    def value(self, value: Any) -> str:
        """Symbol, value and unit."""
        value = self.factor * value if isinstance(value, float) else value
        return f"{self.symbol or self.words} = {shown(value)}{self.unit}"


PARAMETERS = {
    "rheology.mu1": Parameter("friction at rest", r"$\mu_1$"),
    "rheology.mu2": Parameter("friction in fast flow", r"$\mu_2$"),
    "rheology.I0": Parameter("inertial number", "$I_0$"),
    "rheology.grain_diameter": Parameter("grain diameter", "$d$", " mm", 1e3),
    "rheology.K": Parameter("dilation coefficient", "$K$"),
    "rheology.K_tilde": Parameter("slope of equilibrium", r"$\tilde{K}$"),
    "rheology.phi_stat": Parameter("fraction at rest", r"$\varphi_\mathrm{stat}$"),
    "rheology.phi_eq": Parameter("law of equilibrium", r"$\varphi_\mathrm{eq}$"),
    "rheology.phi_eq_N": Parameter("exponent of f2", "$N$"),
    "rheology.mu_wall": Parameter("friction at the walls", r"$\mu_\mathrm{w}$"),
    "rheology.channel_width": Parameter("channel width", "$W$", " m"),
    "slope.angle": Parameter("slope angle", r"$\theta$", "°"),
    "slope.gravity": Parameter("gravity", "$g$", " m/s²"),
    "column.height": Parameter("column height", "$h_0$", " m"),
    "column.length": Parameter("column length", r"$\ell_0$", " m"),
    "column.phi": Parameter("initial fraction", r"$\varphi_0$"),
    "column.start": Parameter("column start", "$x_0$", " m"),
    "grid.left": Parameter("left end of grid", r"$x_\mathrm{left}$", " m"),
    "grid.right": Parameter("right end of grid", r"$x_\mathrm{right}$", " m"),
    "grid.cells": Parameter("number of cells", "$n$"),
    "scheme.alpha": Parameter("exponent", r"$\alpha$"),
    "scheme.lambda": Parameter("weight", r"$\lambda$"),
    "scheme.cfl": Parameter("Courant number", "$C$"),
    "scheme.h_min": Parameter("least thickness", r"$h_\mathrm{min}$", " mm", 1e3),
    "scheme.h_bed": Parameter("bed layer", r"$h_\mathrm{bed}$", " mm", 1e3),
    "scheme.h_front": Parameter("front thickness", r"$h_\mathrm{front}$", " mm", 1e3),
    "time.rest_speed": Parameter("speed at rest", r"$v_\mathrm{rest}$", " mm/s", 1e3),
    "scheme.relaxation": Parameter("relaxation", ""),
    "scheme.viscosity": Parameter("viscosity", ""),
    "scheme.left": Parameter("left boundary", ""),
    "scheme.right": Parameter("right boundary", ""),
    "scheme.window": Parameter("window", ""),
    "time.step_limit": Parameter("step limit", ""),
    "time.stop_at_rest": Parameter("stop at rest", ""),
    "time.end": Parameter("end", r"$t_\mathrm{end}$", " s"),
}


def named(key: str) -> Parameter:
    """What a key of the run file is called; a key without a name of its own is called by the key."""
    return PARAMETERS.get(key, Parameter(key, ""))


def shown(value: Any) -> str:
    """One value of a parameter, short."""
    return f"${value:.4g}$" if isinstance(value, float) else str(value)
