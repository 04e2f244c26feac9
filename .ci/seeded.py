"""A pytest plugin: of the tests asked for, those marked ``gate``, and one in DRYSTONE_ONE_IN of the
others but those marked ``long``, chosen by DRYSTONE_SEED."""

import hashlib
import os

import pytest


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    seed, one_in = os.environ.get("DRYSTONE_SEED", "1"), int(os.environ["DRYSTONE_ONE_IN"])

    def is_chosen(item: pytest.Item) -> bool:
        if item.get_closest_marker("gate"):
            return True
        if item.get_closest_marker("long"):
            return False
        digest = hashlib.sha256(f"{seed} {item.nodeid}".encode()).digest()
        return int.from_bytes(digest[:8], "big") % one_in == 0

    left = [item for item in items if not is_chosen(item)]
    config.hook.pytest_deselected(items=left)
    items[:] = [item for item in items if is_chosen(item)]
