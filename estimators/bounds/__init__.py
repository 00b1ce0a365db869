"""Bounds and exact statistics of interferometric delay estimates."""

from estimators.bounds.crlb import coherent_delay_crlb, group_delay_crlb, phase_crlb, split_spectrum_crlb
from estimators.bounds.sample_coherence import debias_coherence, sample_coherence_mean_square
from estimators.bounds.wrap_errors import split_spectrum_wrap_error_probability, wrap_error_probability
from estimators.bounds.ziv_zakai import ziv_zakai_delay_std

__all__ = [
    "coherent_delay_crlb",
    "debias_coherence",
    "group_delay_crlb",
    "phase_crlb",
    "sample_coherence_mean_square",
    "split_spectrum_crlb",
    "split_spectrum_wrap_error_probability",
    "wrap_error_probability",
    "ziv_zakai_delay_std",
]
