"""A pytest plugin: of the tests asked for, one in DRYSTONE_ONE_IN, chosen by DRYSTONE_SEED."""

import hashlib
import os

import pytest


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    seed, one_in = os.environ.get("DRYSTONE_SEED", "1"), int(os.environ["DRYSTONE_ONE_IN"])

    def is_chosen(item: pytest.Item) -> bool:
        digest = hashlib.sha256(f"{seed} {item.nodeid}".encode()).digest()
        return int.from_bytes(digest[:8], "big") % one_in == 0

    left = [item for item in items if not is_chosen(item)]
    config.hook.pytest_deselected(items=left)
    items[:] = [item for item in items if is_chosen(item)]
