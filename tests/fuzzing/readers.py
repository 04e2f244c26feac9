"""The readers by name: which sound files each has, how these are changed, and what reads them."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random

from . import changes, judging, sound


@dataclass(frozen=True, kw_only=True)
class Reader:
    """What reads a kind of file."""

    file: str  # name of the file
    made: Callable[[Random], bytes]  # its contents, changed
    look: Callable[[Path, Random], str]  # what becomes of it: one of `judging.GOOD`, or a `Fault`
    beside: Callable[[Random], dict[str, bytes]] = lambda draw: {}  # other files in the folder
    share: int = 1  # of all cases


def _model(draw: Random) -> bytes:
    return json.dumps(changes.changed_tables(draw.choice(sound.models()), draw)).encode()


def _model_text(draw: Random) -> bytes:
    return changes.changed_bytes(draw.choice(sound.texts()).encode(), draw)


def _beside_models(draw: Random) -> dict[str, bytes]:
    return {"a.obj": sound.drawings("obj")[0]} | {
        name: text.encode() for name, text in sound.TABLES.items()
    }


def _drawing(ending: str) -> Reader:
    """A drawing is read as a model imports it."""

    def made(draw: Random) -> bytes:
        contents = draw.choice(sound.drawings(ending))
        if ending == "json" and draw.random() < 0.6:
            return changes.changed_json(contents, draw)
        return changes.changed_bytes(contents, draw)

    def look(path: Path, draw: Random) -> str:
        plane = ending in ("dxf", "dat") and draw.random() < 0.5
        model = path.with_name("model.toml")
        model.write_text(sound.importing(path.name, 2 if plane else 3), encoding="utf-8")
        return judging.of_model(model, draw)

    def beside(draw: Random) -> dict[str, bytes]:
        if ending != "dat":
            return {}
        files = {name: text.encode() for name, text in sound.BESIDE_BODIES.items()}
        name = draw.choice((*files, ""))
        return files | ({name: changes.changed_bytes(files[name], draw)} if name else {})

    return Reader(file=f"a.{ending}", made=made, look=look, beside=beside)


def _study(draw: Random) -> bytes:
    data = tomllib.loads(draw.choice(sound.STUDIES))
    return json.dumps(changes.changed_tables(data, draw)).encode()


def _study_text(draw: Random) -> bytes:
    return changes.changed_bytes(draw.choice(sound.STUDIES).encode(), draw)


def _beside_studies(draw: Random) -> dict[str, bytes]:
    return {"model.toml": sound.MODELS["plane"].encode()}


def _history(path: Path, draw: Random) -> str:
    """A file of displacements is read as a model names it."""
    model = path.with_name("model.toml")
    model.write_text(sound.of_history(path.name), encoding="utf-8")
    return judging.of_model(model, draw)


def _script(ending: str) -> Reader:
    def made(draw: Random) -> bytes:
        return changes.changed_bytes(draw.choice(sound.scripts(ending)), draw)

    return Reader(file=f"a.{ending}", made=made, look=judging.of_script)


def _table(name: str, look: Callable[[Path, Random], str]) -> Reader:
    def made(draw: Random) -> bytes:
        return changes.changed_bytes(sound.TABLES[name].encode(), draw)

    return Reader(file=name, made=made, look=look)


READERS: dict[str, Reader] = {
    "model": Reader(
        file="model.json", made=_model, look=judging.of_model, beside=_beside_models, share=6
    ),
    "toml": Reader(
        file="model.toml", made=_model_text, look=judging.of_model, beside=_beside_models, share=3
    ),
    "dxf": _drawing("dxf"),
    "obj": _drawing("obj"),
    "ply": _drawing("ply"),
    "stl": _drawing("stl"),
    "compas": _drawing("json"),
    "ifc": _drawing("ifc"),
    "bodies": _drawing("dat"),
    "udec": _script("dat"),
    "3dec": _script("3ddat"),
    "lmgc90": _script("py"),
    "spectrum": _table("spectrum.csv", judging.of_spectrum),
    "record": _table("record.csv", judging.of_record),
    "history": _table("history.txt", _history),
    "study": Reader(
        file="study.json", made=_study, look=judging.of_study, beside=_beside_studies, share=2
    ),
    "study-text": Reader(
        file="study.toml", made=_study_text, look=judging.of_study, beside=_beside_studies
    ),
}


def available() -> list[str]:
    """Readers whose libraries are installed."""
    return [
        name
        for name, reader in READERS.items()
        if name not in ("dxf", "ifc") or sound.drawings(reader.file.partition(".")[2])
    ]


@dataclass(frozen=True)
class Case:
    """One changed file: the same for the same reader, seed and number."""

    reader: str
    seed: int
    number: int

    def files(self) -> dict[str, bytes]:
        """Contents by name, the file itself first."""
        reader, draw = READERS[self.reader], Random(f"{self.reader} {self.seed} {self.number}")
        return {reader.file: reader.made(draw), **reader.beside(draw)}

    def written(self, folder: Path) -> Path:
        """The path of the file, written into a folder."""
        for name, contents in self.files().items():
            (folder / name).write_bytes(contents)
        return folder / READERS[self.reader].file

    def looked_at(self, path: Path) -> tuple[str, str]:
        """What becomes of the file at a path."""
        draw = Random(f"look {self.reader} {self.seed} {self.number}")
        return judging.outcome(READERS[self.reader].look, path, draw)


def cases(names: list[str], seed: int, count: int) -> Iterator[Case]:
    """As many cases, over readers by their shares; in the same order for the same seed."""
    turns = [name for name in names for _ in range(READERS[name].share)]
    return (Case(turns[k % len(turns)], seed, k) for k in range(count))
