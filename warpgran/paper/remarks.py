"""What there is to know of single claims, most of all why one does not hold. Of the run files as they ship."""

from __future__ import annotations

FOOT = (
    "On a dry bed the front ends in a foot of a few grains, at 22 degrees nearly all void (phi down to 0.02),"
    " whose length depends on the form of phi_eq, on the viscosity and on the cells."
)
LATE = (
    "With 0.25 mm cells it is as the paper says. With 1 mm the front is still faster at 0.36 s, and both come"
    " while it stops, at 0.39 to 0.40 s."
)

REMARKS = {
    "f0-oscillates": "Over the paper's precursor layer it takes cells of 0.5 mm.",
    "f1-oscillates-a-little": "It does with cells of 0.5 mm and less; 1 mm is too coarse to show it.",
    "f2-does-not-oscillate": "With the paper's viscosity and 0.5 mm cells it does too, early on (0.18 s).",
    "all-stable-at-22": (
        FOOT
        + " Here (f1) throws a hump of it ahead of the mass, with finer cells (f0) too. (f2) with N = 1 has none at "
        "1.38 s, but one before (0.5 to 0.6 s) with finer cells."
    ),
    "f2-tends-to-f1": "So at the instant of Fig. 2. From 0.3 to 1.2 s the feet of the front differ, by up to 8 %.",
    "viscosity-at-22": "At the worst instants it is far more: the viscosity decides how long the foot of the front is.",
    "viscosity-at-0": (
        FOOT
        + " Without viscosity it is longer, and thicker than 1 mm: the change is not confined to thicknesses below "
        "0.5 mm."
    ),
    "viscosity-on-profiles": (
        "Where h > 1 cm it is 1.7 % at 0 degrees and 1.1 % at 22; the rest is in the foot of the front."
    ),
    "same-front-at-0": (
        "At 5 mm it holds at every resolution; at 1 mm the foot of the front counts, and grows with finer cells."
    ),
    "speeds-at-036": (
        "Near the front the three differ by 1 to 7 mm/s with 1 mm cells; with 0.25 mm clearly (34 to 61 mm/s)."
    ),
    "dense-front-ahead": (
        "It is at the end, and at all times up to 16 degrees but for 0.3 mm. At 22 degrees the loose front is ahead"
        " until 1.3 s, from 0.7 or 0.9 s on with finer cells, by up to 3 cm, wherever between 0.1 and 5 mm the "
        "front is taken, at every resolution and with phi_stat = 0.585. Within the first 0.1 s, left out here, it "
        "is ahead too, by 1 to 2 mm."
    ),
    "same-front-speed": "A matter of degree: the difference grows to 5 to 7 % with cells of 0.25 mm.",
    "stop-times": "Below 1 mm/s the mass is 0.06 to 0.07 s before the paper's instants, below 0.1 mm/s about at them.",
    "full-stop": (
        "The paper does not say where it takes the speed. Over a precursor layer of 0.1 mm with its viscosity the "
        "greatest speed anywhere is below 1 mm/s from 11.1 s on, below 0.01 mm/s from 33 s on; on a dry bed a film "
        "of 1e-7 m and more still moves at 0.6 mm/s at 19 s. Over 0.01 mm the paper's viscosity drives phi beyond 1"
        " at 2.0 s, and the run ends."
    ),
    "no-slow-regime": (
        "With the front at 1 mm every mass has it, for the body of the mass runs into its own foot at 0.9 to 1.0 s."
        " At 5 mm the loose and the incompressible front decelerate at 0.26 to 0.28 of the rate before, between yes"
        " and no, while the dense one does not decelerate at all; with finer cells the incompressible one does not "
        "either."
    ),
    "loose-slow-regime": (
        "At K = 1 it has. At K = 8, with the front at 5 mm, it decelerates on at 0.43 of the rate before, with "
        "finer cells at 0.28, between yes and no; for 1 mm see the claim before."
    ),
    "regime-dilates": (
        "At K = 4.09 the loose front is near zero: +0.01 degrees with the paper's viscosity and 1 mm cells, -0.2 "
        "with finer ones."
    ),
    "psi-at-first": (
        "With 0.5 mm cells and less 8.8 degrees are the most, those of the column at rest. With 1 mm the tip "
        "thinner than 5 mm has more."
    ),
    "psi-at-036": LATE,
    "friction-falls-late": LATE,
    "psi-small-at-22": (
        "Not at 0.06 s, when the moving part of the column has just left its initial packing; from 0.3 s on it is "
        "so in two thirds of the moving solid and more."
    ),
    "contracts-at-024": (
        "In the loose packing. In the dense one the part ahead of x = 3 cm contracts, over half of the length, and "
        "the column behind still dilates, with 8.8 degrees at the wall; no setting changes this."
    ),
    "dilation-grows": (
        "With 0.25 mm cells 10.6 %, as the foot of the front grows; of what is thicker than 5 mm 9.2 % at every "
        "resolution."
    ),
    "dilatancy-on-forces": (
        "At 0 degrees and at the first instants it holds. At 22 degrees and 1.38 s gravity differs more than the "
        "pressure gradient, for it goes with the solid phi h, and that lies elsewhere in the dense mass."
    ),
    "thickness-saturates": "From 4.09 to 8 the change is a quarter of that from 0 to 4.09: at the limit chosen.",
    "fastest-at-K-1": "With 0.5 mm cells and less it holds; with 1 mm only where h > 5 mm.",
    "friction-with-K": "Near the front with 0.25 mm cells; with 1 mm from K = 1 on. At 0.42 s at every resolution.",
    "front-insensitive-to-K": (
        "The position of the front is, to 1 %; the thickness near it changes by 4 % of the greatest."
    ),
    "walls-change-degree": (
        "phi and psi keep their course. mu does not: (4.1) adds mu_w h/w, 0.13 at the rear and next to nothing at "
        "the front."
    ),
    "walls-lower-dilation": "Taken as percent of the dilation; in percent of the volume it is 0.5 at both slopes.",
}
