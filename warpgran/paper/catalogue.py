"""All pictures and claims, in the order of the paper."""

from __future__ import annotations

from collections.abc import Sequence

from warpgran.errors import OptionError
from warpgran.paper import (
    claims_coefficients,
    claims_dilatancy,
    claims_forces,
    claims_motion,
    claims_regime,
    claims_scheme,
    figures_coefficients,
    figures_packing,
    figures_scheme,
)
from warpgran.paper.claim import Claim
from warpgran.paper.picture import Picture

PICTURES: tuple[Picture, ...] = (*figures_scheme.PICTURES, *figures_packing.PICTURES, *figures_coefficients.PICTURES)
CLAIMS: tuple[Claim, ...] = (
    *claims_scheme.CLAIMS, *claims_motion.CLAIMS, *claims_regime.CLAIMS, *claims_dilatancy.CLAIMS,
    *claims_forces.CLAIMS, *claims_coefficients.CLAIMS,
)  # fmt: skip


def chosen(names: Sequence[str]) -> tuple[tuple[Picture, ...], tuple[Claim, ...]]:
    """The pictures of these names and the claims that they show; all if no name is given.

    Raises:
        OptionError: With all the names that there are, if one is not among them.
    """
    known = [picture.name for picture in PICTURES]
    unknown = [name for name in names if name not in known]
    if unknown:
        raise OptionError(f"{', '.join(unknown)}: no such figure; allowed: {', '.join(known)}")
    if not names:
        return PICTURES, CLAIMS
    pictures = tuple(picture for picture in PICTURES if picture.name in names)
    return pictures, tuple(claim for claim in CLAIMS if set(claim.figures) & set(names))
