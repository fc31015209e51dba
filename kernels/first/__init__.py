"""Order 1, the scheme of the paper: first order in space and time.

A state U is decoded to h, v, phi; friction is made a part of the bed, the apparent topography; the states at both sides
of an interface are reconstructed over its jump Dz; a Suliciu flux between them updates the state, which is then relaxed
toward phi_eq and smoothed by the artificial viscosity. Numbers in brackets are equations of the paper.

| step | file, kernel | reads | writes |
|---|---|---|---|
| 1 decode | decode.decode | U0 U1 U2 | h v phi_wet mu per_mass celerity |
| | ends.after_decode | phi_wet | its ghosts (periodic ends) |
| 2 dry cells (3.14) | decode.fill | phi_wet mu | phi mu |
| | ends.after_fill | h v phi mu per_mass celerity | their ghosts |
| 3 record | ../record.record | U h v phi bhat | h_out v_out phi_out scalars, where due |
| 4 interfaces (3.8), (3.12) | drive.drive | h v phi mu celerity dbhat | v_f X max_speed max_viscosity |
| 5 time step (3.22) | ../timestep.time_step | max_speed max_viscosity t times | dt dt_exact |
| 6 apparent topography (3.6)-(3.12), reconstruction (B.16)-(B.27) | reconstruction.reconstruct | h v phi mu per_mass v_f X dbhat dt | h_star phi_star Dz iota |
| 7 flux (B.12), (B.13), (B.31), (B.32) | flux.flux | h v phi celerity h_star phi_star Dz | F0 F1_l F1_r F2 |
| 8 update (3.5) | update.update | U0 U1 U2 F0 F1_l F1_r F2 dt | W0 W1 W2 |
| 9 dilatancy (3.15)-(3.18) | relaxation.relax | W0 W1 W2 dt | W2 c |
| | ends.after_relax | W0 W1 W2 c | their ghosts (periodic ends) |
| 10 viscosity (3.20), (3.21) | viscosity.diffuse | W0 W1 W2 c iota dt | U0 U1 U2 |
| 11 time | ../clock.tick | dt_exact U0 | t steps status active due lo hi |

Stable under dt <= cfl dx/max(|v| + sqrt(g_c h)), cfl <= 1/2, and the parabolic limit
dt <= dx^2/(2 max(xi) max(v_f dbhat + |v_f| mu_f dx)) (3.22).

Cells: h, v, phi as in the package; phi_wet: phi, 0 in dry cells; mu: effective friction; per_mass: 1/(phi h) [1/m] and
celerity: sqrt(g_c h) [m/s], 0 in dry cells; W: the state between update and viscosity; c: W2/W0.
Interfaces: v_f: mass-weighted velocity [m/s]; X: slope that pressure and gravity drive; dbhat: jump of the total bed
[m]; Dz: the same with the apparent topography [m]; iota: viscosity (v_f Dz)_+ [m2/s]; h_star, phi_star: the state of
the side that climbs Dz, reconstructed; F0, F2: fluxes of U0 and U2; F1_l, F1_r: of U1 as the cells on the left and on
the right see it.
"""  # noqa: E501

ARRAYS = (
    "U0", "U1", "U2", "W0", "W1", "W2", "h", "v", "phi", "mu", "phi_wet", "c", "per_mass", "celerity",
    "v_f", "X", "Dz", "iota", "bhat", "dbhat", "h_star", "phi_star", "F0", "F1_l", "F1_r", "F2",
)  # fmt: skip
"""Arrays of cells and of interfaces."""

EMPTY = 1
"""Empty cells that a window has at each end before a step: mass moves by one cell a step."""
