"""Model files: TOML or JSON in, TOML or JSON out."""

from drystone.builders.describe import model_to_dict
from drystone.builders.errors import ModelError
from drystone.modelfile.read import ENGINES, read_model
from drystone.modelfile.write import write_model

__all__ = ["ENGINES", "ModelError", "model_to_dict", "read_model", "write_model"]
