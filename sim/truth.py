"""What a perfect estimator would find of a scene: delays, heights, shadow and layover."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.band import Real
from sim.echo_pair import Truth
from sim.geometry import Geometry, plane_delay, travel_times
from sim.heard import Heard, heard_at
from sim.profile import Profile
from sim.visibility import sees


def truth(profile: Profile, geometry: Geometry, times: Real, primary: Heard | None = None) -> Truth:
    """Delays, heights, shadow and layover of a section in a registered pair.

    Shadow is where either receiver hears no seabed at the time, layover where either hears more than one part of it.

    Parameters
    ----------
    profile
        The section.
    geometry
        The sonar, and the registration of the pair.
    times
        Times at the primary [s], rising, shape (time,).
    primary
        What the primary hears at these times, where that is known already.
    """
    sonar = geometry.sonar
    upper = sonar.altitude + sonar.baseline
    if primary is None:
        primary = heard_at(profile, sonar, times, sonar.altitude)
    secondary = heard_at(profile, sonar, times + plane_delay(sonar, times), upper)
    parts, parts_above = (np.bincount(heard.sample, minlength=len(times)) for heard in (primary, secondary))
    common = primary.chosen(sees(profile, primary.points, upper))
    delay = geometry.left_delay(common.ground_range, common.height)
    unique = (parts == 1) & (parts_above == 1) & (np.bincount(common.sample, minlength=len(times)) == 1)
    alone = unique[common.sample]
    only_delay, only_height = np.full((2, len(times)), np.nan)
    only_delay[common.sample[alone]], only_height[common.sample[alone]] = delay[alone], common.height[alone]
    return Truth(
        delay=only_delay,
        height=only_height,
        shadow=(parts == 0) | (parts_above == 0),
        layover=(parts > 1) | (parts_above > 1),
        branches=_branches(common, delay, len(times)),
    )


def truth_in_order(profile: Profile, geometry: Geometry, times: Real, primary: Heard) -> Truth:
    """What `truth` finds of a section of which no part hides another, and one is heard after the other.

    Shadow is then only before its first and after its last echo at either receiver.

    Parameters
    ----------
    profile, geometry, times, primary
        As for `truth`.
    """
    ends = travel_times(geometry.sonar, profile.ground_range[[0, -1]], profile.height[[0, -1]])
    # When the registered secondary hears the ends.
    first, last = ends[0] + geometry.registered_delay(*ends)
    shadow = (times < first) | (times >= last)
    delay, height = np.full((2, len(times)), np.nan)
    delay[primary.sample] = geometry.left_delay(primary.ground_range, primary.height)
    height[primary.sample] = primary.height
    shadow |= np.isnan(delay)
    # Where the secondary hears nothing, the branch stays.
    branches = delay[None].copy()
    delay[shadow] = height[shadow] = np.nan
    return Truth(delay=delay, height=height, shadow=shadow, layover=np.zeros_like(shadow), branches=branches)


def _branches(heard: Heard, delay: Real, times: int) -> Real:
    """Delays of all parts, in as few rows as keep stretches apart; shape (branch, time)."""
    rows: NDArray[np.int64] = np.zeros(int(heard.stretch.max(initial=0)) + 1, dtype=np.int64)
    last: list[int] = []
    # Parts come in the order of their stretches.
    numbers, first = np.unique(heard.stretch, return_index=True)
    starts, ends = np.zeros_like(rows), np.zeros_like(rows)
    if len(numbers):
        starts[numbers] = np.minimum.reduceat(heard.sample, first)
        ends[numbers] = np.maximum.reduceat(heard.sample, first)
    for number in numbers[np.argsort(starts[numbers], kind="stable")]:
        # A sample between two stretches of one row keeps them apart in figures.
        free = [row for row, end in enumerate(last) if end < starts[number] - 1]
        row = free[0] if free else len(last)
        last[row : row + 1] = [int(ends[number])]
        rows[number] = row
    branches = np.full((len(last), times), np.nan)
    branches[rows[heard.stretch], heard.sample] = delay
    return branches


def stacked(truths: Sequence[Truth]) -> Truth:
    """The truths of rows, one each, as that of them all: arrays of shape (rows, time)."""
    most = max(len(truth.branches) for truth in truths if truth.branches is not None)
    branches = np.empty((most, len(truths), len(truths[0].delay)))
    for row, truth in enumerate(truths):
        found = 0 if truth.branches is None else len(truth.branches)
        branches[:found, row] = truth.branches
        branches[found:, row] = np.nan

    def together(name: str) -> NDArray[Any]:
        return np.stack([getattr(truth, name) for truth in truths])

    return Truth(together("delay"), together("height"), together("shadow"), together("layover"), branches)
