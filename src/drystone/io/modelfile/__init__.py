"""Model files: TOML or JSON in, TOML or JSON out."""

from drystone.io.modelfile.read import read_model
from drystone.io.modelfile.write import write_model
from drystone.model.construction.describe import model_to_dict
from drystone.model.construction.errors import ModelError

__all__ = ["ModelError", "model_to_dict", "read_model", "write_model"]
