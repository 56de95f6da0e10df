"""Do the steps of the Dockerfile in a folder, and run what they made as a user who may write to its `/work` alone."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.request import urlopen

REPOSITORY = Path(__file__).resolve().parents[1]
NOBODY = 65534
LEFT_OUT = shutil.ignore_patterns(
    ".git", ".venv", "__pycache__", "dist", "site", "demo_output", ".*_cache", "_compiled"
)
PLACES = ("/src", "/opt/polycnc-cache", "/work")


def instructions(text: str) -> Iterator[tuple[str, str]]:
    """Yield the instructions of a Dockerfile and what stands after them."""
    for line in text.splitlines():
        if line and not line.startswith("#"):
            word, _, rest = line.partition(" ")
            yield word, rest


class Image:
    """A folder that stands for the root of an image."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.environment = {
            "HOME": str(root / "nowhere"),
            "PATH": f"{root / 'venv' / 'bin'}:/usr/bin:/bin",
            **{
                name: value for name, value in os.environ.items() if name.startswith(("PIP_", "SSL_", "LANG"))
            },
        }
        self.user: int | None = None
        self.entry: list[str] = []
        self.ports: list[str] = []

    def do(self, word: str, rest: str) -> None:
        """Carry out one instruction."""
        print(f"{word} {rest}", flush=True)
        match word:
            case "FROM":
                subprocess.run([sys.executable, "-m", "venv", str(self.root / "venv")], check=True)
            case "ENV":
                for pair in shlex.split(rest):
                    name, _, value = pair.partition("=")
                    self.environment[name] = self.moved(value)
            case "COPY":
                source, target = rest.split()
                shutil.copytree(REPOSITORY / source, self.moved(target), ignore=LEFT_OUT)
            case "RUN":
                subprocess.run(["/bin/sh", "-ec", self.moved(rest)], env=self.environment, check=True)
            case "EXPOSE":
                self.ports = rest.split()
            case "USER":
                self.user = int(rest.partition(":")[0])
            case "WORKDIR":
                Path(self.moved(rest)).mkdir(exist_ok=True)
            case "ENTRYPOINT":
                self.entry = json.loads(rest)
            case _:
                raise SystemExit(f"nobody said how to do '{word}' here")

    @property
    def reachable(self) -> bool:
        """Whether any user may run the interpreter."""
        real = Path(sys.executable).resolve()
        return all(folder.stat().st_mode & 0o005 == 0o005 for folder in real.parents)

    def moved(self, text: str) -> str:
        """Return a text with the places of the image moved into the folder."""
        for place in PLACES:
            text = text.replace(place, f"{self.root}{place}")
        return text

    def _start(self, *arguments: str) -> subprocess.Popen[str]:
        """Start the entry point as the user of the image."""
        user = self.user if os.geteuid() == 0 and self.reachable else None
        return subprocess.Popen(
            [str(self.root / "venv" / "bin" / self.entry[0]), *arguments],
            env=self.environment,
            cwd=self.root / "work",
            user=user,
            group=user,
            extra_groups=None if user is None else [],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def serve(self, *arguments: str) -> float:
        """Serve a machine by HTTP until it answers; return how long that took, in s."""
        begin = time.monotonic()
        process = self._start("serve", *arguments, "--doors", "http=0")
        assert process.stdout is not None
        url = process.stdout.readline().partition(" ")[2].strip()
        try:
            with urlopen(f"{url}/api/machines/machine/status") as answer:
                answer.read()
        finally:
            process.terminate()
            said = process.communicate()[1]
        if said:
            raise SystemExit(f"serve {' '.join(arguments)} is not quiet:\n{said}")
        return time.monotonic() - begin

    def run(self, *arguments: str) -> tuple[str, str, float]:
        """Run the entry point as the user of the image; return what it said, and how long it took."""
        begin = time.monotonic()
        process = self._start(*arguments)
        stdout, stderr = process.communicate()
        if process.returncode:
            raise SystemExit(f"{' '.join(arguments)}: exit status {process.returncode}\n{stdout}{stderr}")
        return stdout, stderr, time.monotonic() - begin


def main() -> None:
    """Make the image in a folder, take away every right to write, and run a program in it."""
    root = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="polycnc-image-")).resolve()
    root.mkdir(parents=True, exist_ok=True)
    root.chmod(0o755)
    image = Image(root)
    for word, rest in instructions((REPOSITORY / "Dockerfile").read_text("utf-8")):
        image.do(word, rest)
    shutil.copy(REPOSITORY / "examples" / "bracket.nc", root / "work")
    subprocess.run(["chmod", "-R", "a-w", str(root)], check=True)
    (root / "work").chmod(0o1777)
    image.environment["POLYCNC_COMPILE_AT_ONCE"] = "1"  # so small a program would not be compiled anyway
    said, remarks, seconds = image.run("run", "bracket.nc")
    print(said, end="")
    if remarks:
        raise SystemExit(f"the first run is not warm or not quiet:\n{remarks}")
    print(f"warm from the start: {seconds:.1f} s")
    print(image.run("batch", "bracket.nc", "--jobs", "1")[0], end="")
    for kind in (["--plain", "mill3"], ["--fanuc"], ["--bosch"], ["--apci"], ["--imc"]):
        print(f"serves {kind[0]} after {image.serve(*kind, '--memory', f'kept{kind[0]}.sqlite'):.1f} s")
    if os.geteuid() == 0 and not image.reachable:
        print(
            f"run as root: {sys.executable} lies where no other user may look (POLYCNC_PYTHON names another)"
        )
    print(f"The image is {root}")


if __name__ == "__main__":
    main()
