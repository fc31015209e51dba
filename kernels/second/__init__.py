"""Order 2: second order in space and time, in the variables q = sqrt(phi) h and s = sqrt(phi).

The solid is phi h = s q, the pressure g_c q^2/2, and the equation of motion (2.4) reads

    phi h (d_t v + v d_x v) = -g_c q (d_x q + s d_x bhat) - friction.

Its right side is the drive, which the apparent topography gives as one jump of q at each interface: what pressure and
gravity ask for, X, less what friction takes of it, P. Where friction holds, P = X, the drive is exactly 0. Slopes
within cells, the force within a cell and the force at an interface are all made of that jump, so that what friction
holds in the discrete sense stays as it is, to the last bit, for any thickness, bed and phi.

A step relaxes phi over dt/2 (R), does two stages (E) from a state decoded (D), takes the mean with the state before
them (Heun's method), lets friction stop what is left, and relaxes again over dt/2:

| step | file, kernel | reads | writes |
|---|---|---|---|
| 1 what is recorded (D) | look.look | U0 U1 U2 | h v phi of the runs that are due |
| | ../record.record | U h v phi bhat | h_out v_out phi_out scalars of these |
| 2 time step | ../timestep.time_step | max_speed t times | dt dt_exact |
| 3 half a relaxation (R) | relaxation.relax | U0 U1 U2 dt | U2 v phi_wet |
| 4 a stage (E), see below | | U0 v phi_wet dt | F0 E_l E_r F2 SX SP allowance q |
| 5 update, stop (E7, E8) | update.end_first | U, fluxes, SX SP allowance q dt | W0 W1 W2 v phi_wet |
| 6 the stage again | | W0 v phi_wet dt | F0 E_l E_r F2 SX SP allowance q |
| 7 update, stop, mean, stop, relax (R) | update.end_second | W, fluxes, SX SP allowance q dt, U | U0 U1 U2 max_speed |
| 8 time | ../clock.tick | dt_exact U0 | t steps status active due lo hi |

| stage | file, kernel | reads | writes |
|---|---|---|---|
| unknowns (D), friction (E1) | cells.cells | U0 or W0, v phi_wet | q s c mu |
| drive at interfaces (E2) | drive.drive | q s v mu drop dt | X P share hold unused |
| slopes of the drive (E3) | slopes.slopes | X P unused dt | SX SP allowance |
| values at faces (E4) | faces.faces | q s v c | q_L q_R s_L s_R v_L v_R c_L c_R |
| reconstruction, flux (E5, E6) | flux.flux | X P share hold SX SP, faces, dt | F0 E_l E_r F2 |

Between these ends.py sets ghost cells and the interfaces at the ends. Before the first step update.fastest finds the
fastest wave, which later steps find at their end.

Stable under dt <= cfl dx/max(|v| + sqrt(g_c h)), cfl <= 1/2. No mass is negative and phi keeps its bounds: no more than
half of a cell's mass leaves through a face.

Cells: q [m], v [m/s], s, c = s^(2 (alpha - 1)); phi_wet: phi, 0 in dry cells; mu: effective friction; W: the state
between the stages; SX, SP: slopes of -X and P [m]; allowance: velocity that unused friction may still take [m/s].
Faces: `_L`, `_R` are the left and the right face of a cell.
Interfaces: drop: jump of the total bed [m]; share: of the left cell in the mass of both; hold: bound on the jump that
remains [m]; unused: friction coefficient that X has not used up; F0, F2: fluxes of U0 and U2; E_l, E_r: of U1, less the
pressure of the left and the right side.
"""

ARRAYS = (
    "U0", "U1", "U2", "W0", "W1", "W2", "v", "phi_wet", "q", "s", "c", "mu", "X", "P", "share", "hold", "unused", "SX",
    "SP", "allowance", "q_L", "q_R", "s_L", "s_R", "v_L", "v_R", "c_L", "c_R", "F0", "E_l", "E_r", "F2", "drop", "bhat",
    "h", "phi",
)  # fmt: skip
"""Arrays of cells and of interfaces."""

EMPTY = 3
"""Empty cells that a window has at each end before a step.

Mass moves by one cell a stage, so by two a step. The flux on the far side of the outermost cell that holds mass in the
second stage takes X and P from one interface further, and those take the cells on both sides of it.
"""

FLAGS = " -mllvm=-force-vector-interleave=2"
"""Compile options beside the usual: a loop computes two vectors at a time, one while the other waits (3 % faster)."""
