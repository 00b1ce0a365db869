"""Draws family.png: masks of the frequency-frequency matrix, and what each makes of time and lag.

Run it as `.venv/bin/python docs/figures/family.py`.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

LINES = np.arange(-20, 21)
"""Fourier lines of a flat band; the record is as long as 41 resolution cells."""

CELLS = len(LINES)
FINE = 8
"""Instants in a resolution cell."""

n, m = LINES[:, None], LINES[None, :]


def window(cells):
    """A window of so many resolution cells: a mask in `m - n`."""
    return np.sinc((m - n) * cells / CELLS)


def block(low, high):
    """A sub-band: a block on the diagonal."""
    inside = (low <= LINES) & (high >= LINES)
    return np.outer(inside, inside).astype(float)


def steered(delay):
    """Towards a delay, in resolution cells: the same factor along each anti-diagonal."""
    return np.exp(1j * np.pi * (n + m) * delay / CELLS)


MASKS = {
    "one pixel, at zero lag:\ninterferogram": np.ones((CELLS, CELLS)),
    "one pixel, at delay 3:\nfull-band phase slope": steered(3.0),
    "window of 9, at zero lag:\ncross-correlation, likelihood": window(9),
    "whole record:\nthe diagonal": (n == m).astype(float),
    "window of 9, two sub-bands:\nsplit spectrum": window(9) * (block(-20, -8) + block(8, 20)),
}


def in_time(mask):
    """Weight of `p*(t + u - l/2) s(t + u + l/2)` over the place u and the lag l, in resolution cells."""
    half = 8 * FINE
    place, lag = np.arange(-half, half + 1), np.arange(-half, half + 1)
    # Instants are 1 / FINE cells apart; the lag moves either series by half of it.
    before, after = (place[None, :] + sign * lag[:, None] for sign in (-1, 1))
    instants = np.arange(-2 * half, 2 * half + 1)
    turn = np.exp(2j * np.pi * np.outer(instants, LINES) / CELLS / FINE)
    kernel = np.abs(turn @ mask @ turn.conj().T)
    weight = kernel[before + 2 * half, after + 2 * half]
    ends = half / FINE
    return weight / weight.max(), (-ends, ends, -2 * ends, 2 * ends)


def main():
    """Draw and save."""
    figure, axes = plt.subplots(2, len(MASKS), figsize=(15, 6.4), layout="constrained")
    for column, (name, mask) in enumerate(MASKS.items()):
        above, below = axes[:, column]
        shown = above.imshow(
            np.real(mask), origin="lower", cmap="RdBu_r", vmin=-1, vmax=1, extent=(-0.5, 0.5, -0.5, 0.5)
        )
        above.set_title(name, fontsize=11)
        above.set_xlabel("frequency of the secondary / B")
        weight, extent = in_time(mask)
        seen = below.imshow(weight, origin="lower", cmap="viridis", vmin=0, vmax=1, extent=extent, aspect="auto")
        below.set_xlabel("place in time [1/B]")
        if column == 0:
            above.set_ylabel("frequency of the primary / B")
            below.set_ylabel("lag [1/B]")
    figure.colorbar(shown, ax=axes[0], label="mask, real part", pad=0.01)
    figure.colorbar(seen, ax=axes[1], label="weight, magnitude", pad=0.01)
    figure.savefig(Path(__file__).with_name("family.png"), dpi=110)


if __name__ == "__main__":
    main()
