"""What is said to people, in several languages: sentences by key, words, decimal marks.

A folder for each language holds tables of templates; `say` makes a sentence of one.  Who writes a
page or a screen says in which language, by `speaking`.
"""

from drystone.common.language.catalogue import (
    DECIMAL_MARKS,
    LANGUAGES,
    current,
    number,
    speaking,
    with_mark,
    words,
)
from drystone.common.language.saying import Saying, said_end, said_status, say, spoken

__all__ = [
    "DECIMAL_MARKS",
    "LANGUAGES",
    "Saying",
    "current",
    "number",
    "said_end",
    "said_status",
    "say",
    "speaking",
    "spoken",
    "with_mark",
    "words",
]
