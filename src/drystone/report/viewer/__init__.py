"""A page that shows a structure as it moves along its curve: one file, no network.

`contents` gathers what there is to show, `codec` packs it, `page` puts the page together of the
files in ``assets``, which are JavaScript modules with tests of their own.
"""

from __future__ import annotations

from drystone.report.viewer.contents import Contents, Mark, contents_of_folder, contents_of_model
from drystone.report.viewer.page import page, write_page

__all__ = ["Contents", "Mark", "contents_of_folder", "contents_of_model", "page", "write_page"]
