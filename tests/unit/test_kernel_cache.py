"""Compiled kernels are thrown away when any of their sources changes."""

from __future__ import annotations

from drystone.kernels.cache import STAMP, discard_outdated


def compiled(folder):
    return sorted(path.name for path in folder.glob("*.nb?"))


def test_kernels_of_other_sources_are_discarded(tmp_path):
    """Also where only a file that others call has changed."""
    sources = [tmp_path / "caller.py", tmp_path / "called.py"]
    for source in sources:
        source.write_text("first\n")
    folder = tmp_path / "cache"
    folder.mkdir()
    (folder / "caller.nbi").write_text("left by a version that had no stamp")
    discard_outdated(folder, sources)
    assert compiled(folder) == []

    (folder / "caller.nbi").write_text("index")
    (folder / "caller.1.nbc").write_text("code")
    discard_outdated(folder, sources)
    assert compiled(folder) == ["caller.1.nbc", "caller.nbi"]

    sources[1].write_text("second\n")
    discard_outdated(folder, sources)
    assert compiled(folder) == []
    discard_outdated(folder, sources)
    (folder / "called.nbi").write_text("index")
    discard_outdated(folder, sources)
    assert compiled(folder) == ["called.nbi"]


def test_a_folder_that_cannot_be_written_is_left_alone(tmp_path):
    source = tmp_path / "kernel.py"
    source.write_text("text\n")
    discard_outdated(tmp_path / "missing", [source])
    assert not (tmp_path / "missing" / STAMP).exists()
