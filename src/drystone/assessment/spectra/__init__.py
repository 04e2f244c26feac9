"""Response spectra of the codes, from tables, and at a height above the ground."""

from drystone.assessment.spectra.base import Spectrum, damping_factor
from drystone.assessment.spectra.ec8 import Ec8Spectrum
from drystone.assessment.spectra.floor import FloorSpectrum, Mode, first_mode
from drystone.assessment.spectra.ntc2018 import NtcSpectrum
from drystone.assessment.spectra.table import TableSpectrum, read_spectrum

__all__ = [
    "Ec8Spectrum",
    "FloorSpectrum",
    "Mode",
    "NtcSpectrum",
    "Spectrum",
    "TableSpectrum",
    "damping_factor",
    "first_mode",
    "read_spectrum",
]
