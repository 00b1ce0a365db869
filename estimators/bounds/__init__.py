"""Bounds and exact statistics of interferometric delay estimates."""

from .conventions import coherence_from_snr, effective_looks, snr_from_coherence
from .crlb import (
    coherent_delay_crlb,
    depth_crlb,
    group_delay_crlb,
    intensity_delay_crlb,
    phase_crlb,
    split_spectrum_crlb,
)
from .wrap_errors import envelope_pair_probability, wrap_error_probability

__all__ = [
    "coherence_from_snr",
    "coherent_delay_crlb",
    "depth_crlb",
    "effective_looks",
    "envelope_pair_probability",
    "group_delay_crlb",
    "intensity_delay_crlb",
    "phase_crlb",
    "snr_from_coherence",
    "split_spectrum_crlb",
    "wrap_error_probability",
]
