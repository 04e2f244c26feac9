"""drystone: pushover curves of masonry made of blocks, past the peak and down to nothing."""

__version__ = "0.1.0"

# The command line begins here: no module is imported before it has seen to signals.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from drystone.analysis import pushover
    from drystone.around import Polar, polar
    from drystone.assembly import Assembly, Block, Corner, JointLaw
    from drystone.builders import ModelError, extruded, make_model, published_wall
    from drystone.builders import coursed_wall as wall
    from drystone.builders.arch import circular_arch
    from drystone.builders.column import column, stack
    from drystone.builders.kinds.arch import arch
    from drystone.curve import CapacityCurve, CurvePoint
    from drystone.drawings.blocks import imported
    from drystone.drawings.settings import ImportSettings
    from drystone.engines.base import EngineError, UnstableError
    from drystone.export.directory import ResultsDirectory
    from drystone.export.folder import OutputError
    from drystone.export.results import Results, load_results, save_results
    from drystone.inspection import Inspection, inspect
    from drystone.kernels.compilation import Compilation
    from drystone.limit import Collapse, collapse_load
    from drystone.loading.acceleration import Acceleration, AccelerationPattern
    from drystone.loading.dead import FaceLoad, FillLoad, ForceLoad, SurchargeLoad
    from drystone.loading.forces import ForcesPattern
    from drystone.loading.mass import MassPattern
    from drystone.loading.modal import ModalPattern
    from drystone.loading.targets import PointForce
    from drystone.loading.tilt import TiltPattern
    from drystone.loading.triangular import TriangularPattern
    from drystone.loading.uniform import UniformPattern
    from drystone.model import Analysis, Model
    from drystone.modelfile import read_model, write_model
    from drystone.mortar import Mortar
    from drystone.report import plot_curve, plot_mechanism, plot_model
    from drystone.settlement import Settlement
    from drystone.ties import Tie, TieEnd, spring

if TYPE_CHECKING:
    from typing import Any

#: Where each name is, and its name there if that is another.  Heavy imports wait until a name is
#: used, so that the command line starts at once.
_PLACES = {
    "Acceleration": "drystone.loading",
    "AccelerationPattern": "drystone.loading",
    "Analysis": "drystone.model",
    "Assembly": "drystone.assembly",
    "Block": "drystone.assembly",
    "CapacityCurve": "drystone.curve",
    "Collapse": "drystone.limit",
    "Compilation": "drystone.kernels.compilation",
    "Corner": "drystone.assembly",
    "CurvePoint": "drystone.curve",
    "EngineError": "drystone.engines.base",
    "FaceLoad": "drystone.loading",
    "FillLoad": "drystone.loading",
    "ForceLoad": "drystone.loading",
    "ForcesPattern": "drystone.loading",
    "ImportSettings": "drystone.drawings.settings",
    "Inspection": "drystone.inspection",
    "JointLaw": "drystone.assembly",
    "MassPattern": "drystone.loading",
    "ModalPattern": "drystone.loading",
    "Model": "drystone.model",
    "ModelError": "drystone.builders",
    "Mortar": "drystone.mortar",
    "OutputError": "drystone.export.folder",
    "PointForce": "drystone.loading",
    "Polar": "drystone.around",
    "Results": "drystone.export.results",
    "ResultsDirectory": "drystone.export.directory",
    "Settlement": "drystone.settlement",
    "SurchargeLoad": "drystone.loading",
    "Tie": "drystone.ties",
    "TieEnd": "drystone.ties",
    "TiltPattern": "drystone.loading",
    "TriangularPattern": "drystone.loading",
    "UniformPattern": "drystone.loading",
    "UnstableError": "drystone.engines.base",
    "arch": "drystone.builders",
    "circular_arch": "drystone.builders",
    "collapse_load": "drystone.limit",
    "column": "drystone.builders.column",
    "extruded": "drystone.builders",
    "imported": "drystone.drawings.blocks",
    "inspect": "drystone.inspection",
    "load_results": "drystone.export.results",
    "make_model": "drystone.builders",
    "plot_curve": "drystone.report",
    "plot_mechanism": "drystone.report",
    "plot_model": "drystone.report",
    "polar": "drystone.around",
    "published_wall": "drystone.builders",
    "pushover": "drystone.analysis",
    "read_model": "drystone.modelfile",
    "save_results": "drystone.export.results",
    "spring": "drystone.ties",
    "stack": "drystone.builders.column",
    "wall": "drystone.builders:coursed_wall",
    "write_model": "drystone.modelfile",
}

__all__ = [*_PLACES, "__version__"]


def __getattr__(name: str) -> "Any":
    if name not in _PLACES:
        raise AttributeError(f"module 'drystone' has no attribute {name!r}")
    from importlib import import_module

    module, _, there = _PLACES[name].partition(":")
    return getattr(import_module(module), there or name)


def __dir__() -> list[str]:
    return sorted(__all__)
