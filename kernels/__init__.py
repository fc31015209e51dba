"""The scheme as Warp kernels: the page to start from. Imports nothing but warp.

Model, for h [m], v [m/s] and the solid volume fraction phi on a plane at the angle theta (Bouchut et al., "Dilatancy in
dry granular flows with a compressible mu(I) rheology"; numbers in brackets are its equations):

    (3.1)  d_t(phi h)       + d_x(phi h v)                      = 0
    (3.2)  d_t(phi h v)     + d_x(phi h v^2 + g_c phi h^2/2)    = -g_c phi h d_x bhat - mu g_c phi h sgn(v)
    (3.3)  d_t(phi^alpha h) + d_x(phi^alpha h v)                = -(alpha - 1) phi^alpha h gamma tan(psi)

    mu = max(0, mu(I) + tan(psi)) + mu_w h/width  (2.13), (2.14), (4.1)      tan(psi) = K (phi - phi_eq(I))  (2.8)
    gamma = 5|v|/(2 h_e)  (2.15)      I = gamma d/sqrt(phi g_c h_e)  (2.10), (2.11)      h_e = max(h, h_min)

with g_c = g cos(theta), bhat = b - x tan(theta), and the state U0 = phi h [m], U1 = phi h v [m2/s], U2 = phi^alpha h
[m]. Two schemes solve it; their pages have the steps, in order, and what their arrays hold:

    first/          order 1, the scheme of the paper
    second/         order 2

What both share:

    laws.py         phi_eq(I) by name, powers of phi, friction
    record.py       series and snapshots of the runs that are due
    timestep.py     dt of each run
    clock.py        time of each run, its window, the end of the loop
    means.py        from finer cells to coarser ones
    ranges.py       which cells a thread visits
    lanes.py        what the lanes of a block find together
    ghosts.py       periodic ends
    precision.py    types, parameters of a run, compile options, variants
    stages.py       a scheme as lists of launches
    build.py        the stages of a variant: start reading the code here

Indices. A block holds many runs, each with its own time, dt and grid. An array of cells or of interfaces is flat; the
run `run` owns a row of it, whose cell 0 is the element p.row (p = params[run]):

     MARGIN elements | cell 0 | cell 1 | ... | cell n-1 | ghost | padding up to a multiple of BLOCK |
               ghost |        |        |     |          |       |
                     0        1        2    n-1         n             interface i, between the cells i-1 and i, is
                     ^ p.row                            ^ p.row + n   stored at the element of cell i

`i` is an element, `left` the one before it. A thread walks a range of elements of the run's window, lo to hi, which
holds all its mass with some empty cells at each end; both are multiples of BLOCK, so that the vector loops leave no
rest and the bits do not depend on the window. Outside it every array holds what a dry cell has.

Arguments of a kernel come in three groups: inputs; per run (params, lo, hi, active, ...); outputs, of which some are
changed in place. Each is the array of that name, so that a name means the same in every kernel: see solve/state.py.
`chunks` is the number of ranges that a window is cut into. A kernel of cells is launched over chunks * lanes threads a
run, a kernel of runs over one, see stages.py. Nothing allocates, and no run waits for another.

Names. `thread` and `run` are numbers, `t` a time, `p` the parameters of a run, p_l, p_r pressures. `_l`, `_r` are the
sides of an interface, `_star` is reconstructed or intermediate, `per_x` is 1/x. `c` is phi^(alpha - 1), `C` the
Lagrangian speed of the Suliciu solver, `D` is v_l - v_r. `num/den` and `top/bottom` are the inertial number and phi_eq
as fractions, since divisions bound the cost of a step and what is needed together shares one; a function `..._by_one`
is the same with a single division.
"""

if __name__ != "warpgran.kernels":
    raise ImportError(f"import this package as warpgran.kernels, not as {__name__}")
