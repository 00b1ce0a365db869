"""Windows, as a study asks for them: a size, the whole record, or a policy."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from estimators import (
    AdaptiveWindow,
    ConstantStdWindow,
    KnownCoherence,
    MeasuredCoherence,
    ModelledCoherence,
    WrapSafeWindow,
)
from estimators.range_coherence import RangeCoherence
from estimators.window_policies import SquareWindow
from sim import SEDIMENTS
from studies.quantity import Metres
from studies.section import Section, complaint, suggestion

POLICIES: Mapping[str, tuple[type[SquareWindow], tuple[str, ...]]] = {
    "constant-std": (ConstantStdWindow, ("std",)),
    "adaptive": (AdaptiveWindow, ("kappa",)),
    "wrap-safe": (WrapSafeWindow, ("kappa", "max_wrap_probability")),
}
"""Class of each policy, and the keys that it must have."""

SHARED = ("policy", "smallest", "largest", "coherence", "sediment", "first_window", "smoothing")


class PolicySection(Section):
    """A window whose size varies with range.

    Parameters
    ----------
    policy
        "constant-std", "adaptive" (paper B) or "wrap-safe".
    std
        Standard deviation of the depth [m], for "constant-std".
    kappa
        Side of the window over that of the depth, for "adaptive" and "wrap-safe".
    max_wrap_probability
        Largest wrap-error probability, for "wrap-safe".
    smallest, largest
        Limits of its rows, odd.
    coherence
        The coherence, 0 to 1; where neither this nor `sediment` is given, it is measured.
    sediment
        The sediment whose coherence the sonar equation gives, a name of `sim.SEDIMENTS`.
    first_window, smoothing
        [rows, samples] and length [m] over which the coherence is measured.
    """

    policy: Literal["constant-std", "adaptive", "wrap-safe"]
    std: Metres | None = None
    kappa: float | None = None
    max_wrap_probability: float | None = None
    smallest: int = 3
    largest: int = 61
    coherence: Annotated[float, Field(ge=0, le=1)] | None = None
    sediment: str | None = None
    first_window: tuple[int, int] = (9, 9)
    smoothing: Metres = 1.0

    @model_validator(mode="after")
    def _can_be(self) -> Self:
        needed = POLICIES[self.policy][1]
        for key in needed:
            if getattr(self, key) is None:
                raise ValueError(f"{key} is missing; policy {self.policy!r} must have it")
        for key in self.model_fields_set:
            if key not in (*SHARED, *needed):
                raise ValueError(f"{key} is given; policy {self.policy!r} must have {' and '.join(needed)} alone")
        if self.coherence is not None and self.sediment is not None:
            raise ValueError("coherence and sediment are both given; it must be one of them, or none to measure it")
        if self.sediment is not None and self.sediment not in SEDIMENTS:
            raise ValueError(f"sediment is {self.sediment!r}; it must be {suggestion(self.sediment, SEDIMENTS)}")
        self.window()
        return self

    def window(self) -> SquareWindow:
        """As the estimators know it."""
        make, needed = POLICIES[self.policy]
        options = {key: getattr(self, key) for key in (*needed, "smallest", "largest")}
        return make(**options, coherence=self._coherence())

    def _coherence(self) -> RangeCoherence:
        if self.coherence is not None:
            return KnownCoherence(self.coherence)
        if self.sediment is not None:
            return ModelledCoherence(self.sediment)
        return MeasuredCoherence(*self.first_window, smoothing=self.smoothing)


def _window(value: Any) -> Any:
    if isinstance(value, Mapping):
        try:
            return PolicySection.model_validate(value)
        except ValidationError as error:
            raise ValueError(complaint(error, PolicySection)) from None
    pair = isinstance(value, list | tuple) and len(value) == 2 and all(type(n) is int and n >= 1 for n in value)
    if not (pair or value == "record" or isinstance(value, PolicySection)):
        raise ValueError(
            "it must be 'record', [rows, samples], both whole numbers of at least 1, or a table with a policy"
        )
    return tuple(value) if pair else value


WindowSection = Annotated[Literal["record"] | PolicySection | tuple[int, int], BeforeValidator(_window)]
"""Of a study file: "record", [rows, samples], or a policy."""
