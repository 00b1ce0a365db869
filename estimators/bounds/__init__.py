"""Bounds and exact statistics of interferometric delay estimates."""

from .coherent_pair import coherent_pair_probability, lugannani_rice_pair_probability
from .conventions import coherence_from_snr, effective_looks, snr_from_coherence
from .crlb import (
    coherent_delay_crlb,
    depth_crlb,
    group_delay_crlb,
    intensity_delay_crlb,
    phase_crlb,
    split_spectrum_crlb,
)
from .debiasing import debias_coherence
from .gaussian_wrap_error import gaussian_split_spectrum_wrap_error_probability, gaussian_wrap_error_probability
from .multilook import (
    multilook_depth_std,
    multilook_phase_cdf,
    multilook_phase_pdf,
    multilook_phase_quantile,
    multilook_phase_std,
    sample_multilook_phase,
)
from .passband_wrap_errors import (
    cross_correlation_wrap_error_probability,
    likelihood_wrap_error_probability,
)
from .sample_coherence import (
    sample_coherence_mean,
    sample_coherence_pdf,
    sample_coherence_std,
    sample_sample_coherence,
)
from .split_spectrum import split_spectrum_wrap_error_probability
from .wrap_errors import (
    envelope_pair_probability,
    several_wraps_error_probability,
    wrap_error_probability,
)
from .ziv_zakai import ziv_zakai_delay_std

__all__ = [
    "coherence_from_snr",
    "coherent_delay_crlb",
    "coherent_pair_probability",
    "cross_correlation_wrap_error_probability",
    "debias_coherence",
    "depth_crlb",
    "effective_looks",
    "envelope_pair_probability",
    "gaussian_split_spectrum_wrap_error_probability",
    "gaussian_wrap_error_probability",
    "group_delay_crlb",
    "intensity_delay_crlb",
    "likelihood_wrap_error_probability",
    "lugannani_rice_pair_probability",
    "multilook_depth_std",
    "multilook_phase_cdf",
    "multilook_phase_pdf",
    "multilook_phase_quantile",
    "multilook_phase_std",
    "phase_crlb",
    "sample_coherence_mean",
    "sample_coherence_pdf",
    "sample_coherence_std",
    "sample_multilook_phase",
    "sample_sample_coherence",
    "several_wraps_error_probability",
    "snr_from_coherence",
    "split_spectrum_crlb",
    "split_spectrum_wrap_error_probability",
    "wrap_error_probability",
    "ziv_zakai_delay_std",
]
