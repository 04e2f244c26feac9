"""drystone: pushover curves of masonry made of blocks, past the peak and down to nothing."""

# The command line begins here: no module is imported before it has seen to signals.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from drystone.analysis.directions import Polar, polar
    from drystone.analysis.driver import pushover
    from drystone.assessment.errors import AssessmentError
    from drystone.common.compilation import Compilation
    from drystone.engines.base import EngineError, UnstableError
    from drystone.io.drawings.blocks import imported
    from drystone.io.drawings.settings import ImportSettings
    from drystone.io.modelfile import read_model, write_model
    from drystone.io.results.folder import OutputError
    from drystone.limit import Collapse, collapse_load
    from drystone.model.assembly import Assembly, Block, Corner
    from drystone.model.builders import ModelError, extruded, make_model, published_wall
    from drystone.model.builders import coursed_wall as wall
    from drystone.model.builders.arch import arch
    from drystone.model.builders.circular_arch import circular_arch
    from drystone.model.builders.column import column, stack
    from drystone.model.inspection import Inspection, inspect
    from drystone.model.joint_law import JointLaw
    from drystone.model.loading.acceleration import Acceleration, AccelerationPattern
    from drystone.model.loading.dead import FaceLoad, FillLoad, ForceLoad, SurchargeLoad
    from drystone.model.loading.forces import ForcesPattern
    from drystone.model.loading.mass import MassPattern
    from drystone.model.loading.modal import ModalPattern
    from drystone.model.loading.targets import PointForce
    from drystone.model.loading.tilt import TiltPattern
    from drystone.model.loading.triangular import TriangularPattern
    from drystone.model.loading.uniform import UniformPattern
    from drystone.model.model import Analysis, Model
    from drystone.model.mortar import Mortar
    from drystone.model.settlement import Settlement
    from drystone.model.ties import Tie, TieEnd, spring
    from drystone.report import plot_curve, plot_mechanism, plot_model
    from drystone.report.folder.directory import ResultsDirectory
    from drystone.report.folder.results import Results, load_results, save_results
    from drystone.report.folder.resume import resume
    from drystone.results.curve import CapacityCurve, CurvePoint
    from drystone.studies.conduct import study

if TYPE_CHECKING:
    from typing import Any

    __version__: str

#: Where each name is, and its name there if that is another.  Heavy imports wait until a name is
#: used, so that the command line starts at once.
_PLACES = {
    "Acceleration": "drystone.model.loading",
    "AccelerationPattern": "drystone.model.loading",
    "Analysis": "drystone.model.model",
    "Assembly": "drystone.model.assembly",
    "AssessmentError": "drystone.assessment.errors",
    "Block": "drystone.model.assembly",
    "CapacityCurve": "drystone.results.curve",
    "Collapse": "drystone.limit",
    "Compilation": "drystone.common.compilation",
    "Corner": "drystone.model.assembly",
    "CurvePoint": "drystone.results.curve",
    "EngineError": "drystone.engines.base",
    "FaceLoad": "drystone.model.loading",
    "FillLoad": "drystone.model.loading",
    "ForceLoad": "drystone.model.loading",
    "ForcesPattern": "drystone.model.loading",
    "ImportSettings": "drystone.io.drawings.settings",
    "Inspection": "drystone.model.inspection",
    "JointLaw": "drystone.model.joint_law",
    "MassPattern": "drystone.model.loading",
    "ModalPattern": "drystone.model.loading",
    "Model": "drystone.model.model",
    "ModelError": "drystone.model.builders",
    "Mortar": "drystone.model.mortar",
    "OutputError": "drystone.io.results.folder",
    "PointForce": "drystone.model.loading",
    "Polar": "drystone.analysis.directions",
    "Results": "drystone.report.folder.results",
    "ResultsDirectory": "drystone.report.folder.directory",
    "Settlement": "drystone.model.settlement",
    "SurchargeLoad": "drystone.model.loading",
    "Tie": "drystone.model.ties",
    "TieEnd": "drystone.model.ties",
    "TiltPattern": "drystone.model.loading",
    "TriangularPattern": "drystone.model.loading",
    "UniformPattern": "drystone.model.loading",
    "UnstableError": "drystone.engines.base",
    "arch": "drystone.model.builders",
    "circular_arch": "drystone.model.builders",
    "collapse_load": "drystone.limit",
    "column": "drystone.model.builders.column",
    "extruded": "drystone.model.builders",
    "imported": "drystone.io.drawings.blocks",
    "inspect": "drystone.model.inspection",
    "load_results": "drystone.report.folder.results",
    "make_model": "drystone.model.builders",
    "plot_curve": "drystone.report",
    "plot_mechanism": "drystone.report",
    "plot_model": "drystone.report",
    "polar": "drystone.analysis.directions",
    "published_wall": "drystone.model.builders",
    "pushover": "drystone.analysis.driver",
    "read_model": "drystone.io.modelfile",
    "resume": "drystone.report.folder.resume",
    "save_results": "drystone.report.folder.results",
    "spring": "drystone.model.ties",
    "stack": "drystone.model.builders.column",
    "study": "drystone.studies.conduct",
    "wall": "drystone.model.builders:coursed_wall",
    "write_model": "drystone.io.modelfile",
}

__all__ = [*_PLACES, "__version__"]


def __getattr__(name: str) -> "Any":
    if name == "__version__":
        from drystone.common.version import package_version

        return package_version()
    if name not in _PLACES:
        raise AttributeError(f"module 'drystone' has no attribute {name!r}")
    from importlib import import_module

    module, _, there = _PLACES[name].partition(":")
    return getattr(import_module(module), there or name)


def __dir__() -> list[str]:
    return sorted(__all__)
