"""Build what is released: sdist, wheel and, with ``--kernels``, a wheel with compiled kernels.

    python tools/release.py                # dist/drystone-X.tar.gz and a wheel for every system
    python tools/release.py --kernels      # also a wheel for this system, Python and CPU baseline

Needs ``pip install build``.  The version is that of the last git tag; without one, the fallback of
pyproject.toml.  Nothing is uploaded.  A wheel with kernels is the plain one after it was installed
in an environment of its own and has run the models below: what the compiler kept is put into it
(`drystone.common.shipped_kernels`).
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import os
import platform
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

#: Baseline of processors: name of LLVM's, and sets of instructions that a processor must have.
BASELINES = {
    "x86_64": (
        "x86-64-v3",
        "+avx,+avx2,+bmi,+bmi2,+f16c,+fma,+lzcnt,+movbe,+popcnt,+sse4.1,+sse4.2,+ssse3,+xsave",
    ),
    "arm64": ("generic", "+neon,+fp-armv8"),
}
#: What machines call the same processors.
SAME = {"AMD64": "x86_64", "amd64": "x86_64", "aarch64": "arm64"}

#: Models whose kernels a wheel carries: the plane, and space.
MODELS = ("examples/wall1.toml", "examples/facade.toml")

#: The command, for an interpreter.
RUN = "from drystone.cli import main; main()"

#: Puts what was compiled into a folder; run with the interpreter of the environment.
COLLECT = """
import sys
from pathlib import Path
from drystone.common import kernel_cache, shipped_kernels
caches, sources = kernel_cache.kept_here()
package = kernel_cache.PACKAGE
print(shipped_kernels.collect(caches, package, Path(sys.argv[1]), sources), "kernels")
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "dist")
    parser.add_argument("--kernels", action="store_true", help="a wheel with compiled kernels")
    parser.add_argument("--model", action="append", help="to compile for, instead of the usual")
    given = parser.parse_args()
    wheel = build(given.out)
    print(wheel)
    if given.kernels:
        print(with_kernels(wheel, given.out, given.model or MODELS))


def build(out: Path) -> Path:
    """Build the sdist, and the wheel from it; the path of the wheel."""
    subprocess.run([sys.executable, "-m", "build", "--outdir", str(out), str(ROOT)], check=True)
    return max(out.glob("drystone-*-none-any.whl"), key=lambda path: path.stat().st_mtime)


def environment(folder: Path, wheel: Path) -> Path:
    """A fresh environment with a wheel installed; its interpreter."""
    venv.create(folder, with_pip=True)
    python = folder / ("Scripts" if os.name == "nt" else "bin") / "python"
    subprocess.run([python, "-m", "pip", "install", "--quiet", wheel], check=True)
    return python


def with_kernels(wheel: Path, out: Path, models: tuple[str, ...] | list[str]) -> Path:
    """A wheel of this system that carries what the compiler makes for a baseline."""
    machine = SAME.get(platform.machine(), platform.machine())
    if machine not in BASELINES:
        raise SystemExit(f"no baseline is known for {machine}: add it to BASELINES")
    name, features = BASELINES[machine]
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        python = environment(here / "environment", wheel)
        settings = {
            **os.environ,
            "NUMBA_CPU_NAME": name,
            "NUMBA_CPU_FEATURES": features,
            "PYTHONPATH": "",
        }
        for model in models:
            command = [python, "-c", RUN, "run", str(ROOT / model), "--out", str(here / "out")]
            subprocess.run(command, check=True, env=settings, cwd=here)
        kernels = here / "kernels"
        subprocess.run([python, "-c", COLLECT, kernels], check=True, env=settings, cwd=here)
        return packed(
            wheel, kernels, out / f"{wheel.name.removesuffix('py3-none-any.whl')}{tag()}.whl"
        )


def tag() -> str:
    """Python, ABI and platform: kernels are as particular as numba's wheel, and have its tag."""
    from importlib.metadata import distribution

    lines = (distribution("numba").read_text("WHEEL") or "").splitlines()
    tags = [line.removeprefix("Tag: ") for line in lines if line.startswith("Tag: ")]
    python, abi, _ = tags[0].split("-")
    return f"{python}-{abi}-{'.'.join(dict.fromkeys(each.split('-')[2] for each in tags))}"


def packed(wheel: Path, kernels: Path, target: Path) -> Path:
    """A wheel with a folder of kernels beside what another holds; its list of files anew."""
    python, abi, platforms = target.name.removesuffix(".whl").rsplit("-", 3)[1:]
    with zipfile.ZipFile(wheel) as old:
        files = {name: old.read(name) for name in old.namelist() if not name.endswith("/RECORD")}
        record = next(name for name in old.namelist() if name.endswith("/RECORD"))
    about = f"{record.removesuffix('RECORD')}WHEEL"
    kept = [
        line
        for line in files[about].decode().splitlines()
        if line and not line.startswith(("Tag:", "Root-Is-Purelib:"))
    ]
    tags = [f"Tag: {python}-{abi}-{one}" for one in platforms.split(".")]
    files[about] = "\n".join([*kept, "Root-Is-Purelib: false", *tags, ""]).encode()
    for file in sorted(path for path in kernels.rglob("*") if path.is_file()):
        files[f"drystone/kernels/{file.relative_to(kernels).as_posix()}"] = file.read_bytes()
    rows = [f"{name},sha256={_digest(data)},{len(data)}" for name, data in files.items()]
    files[record] = "\n".join([*rows, f"{record},,", ""]).encode()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as new:
        for name, data in files.items():
            new.writestr(name, data)
    return target


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


if __name__ == "__main__":
    main()
