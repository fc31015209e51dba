"""What there is to know of single claims: why one does not hold. Of the run files as they ship."""

from __future__ import annotations

REMARKS: dict[str, str] = {}
