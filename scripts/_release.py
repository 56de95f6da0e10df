"""Add to the archives of a release the list of its software, the context of its image, and checksums.

python scripts/_release.py DIST
"""

from __future__ import annotations

import hashlib
import io
import json
import subprocess
import sys
import tarfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from polycnc.web import libraries

REPOSITORY = Path(__file__).parents[1]


def software(report: dict[str, Any]) -> dict[str, Any]:
    """Return a list in the format CycloneDX of what a report of pip would install, and of what the pages consist of."""
    entries = [each["metadata"] for each in report["install"]]
    (product,) = (_python(each) for each in entries if each["name"] == "polycnc")
    others = [_python(each) for each in entries if each["name"] != "polycnc"]
    pages = {
        (each.package, each.version): _component("npm", each.package, each.version, each.licence)
        for each in libraries()
    }
    found = sorted([*others, *pages.values()], key=lambda each: str(each["purl"]))
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": {**product, "type": "application"}},
        "components": found,
    }


def _python(metadata: dict[str, Any]) -> dict[str, Any]:
    licence = metadata.get("license_expression") or metadata.get("license") or ""
    return _component("pypi", metadata["name"].lower(), metadata["version"], licence.split("\n", 1)[0][:80])


def _component(kind: str, name: str, version: str, licence: str) -> dict[str, Any]:
    made: dict[str, Any] = {"type": "library", "name": name, "version": version}
    made["purl"] = f"pkg:{kind}/{name}@{version}"
    return {**made, "licenses": [{"license": {"name": licence}}]} if licence else made


def image_context(source: Path, dockerfile: bytes, out: Path) -> None:
    """Write what `docker build - < FILE` takes: the source archive without its top folder, and the Dockerfile."""
    with tarfile.open(source) as given, tarfile.open(out, "w:gz") as context:
        _add(context, "Dockerfile", dockerfile)
        for member in given:
            name = member.name.partition("/")[2]
            content = given.extractfile(member) if member.isfile() else None
            if content is not None and name != "Dockerfile":
                _add(context, name, content.read(), member.mode)


def _add(archive: tarfile.TarFile, name: str, content: bytes, mode: int = 0o644) -> None:
    member = tarfile.TarInfo(name)
    member.size, member.mode = len(content), mode
    archive.addfile(member, io.BytesIO(content))


def checksums(files: Iterable[Path]) -> str:
    """Return the lines of a file for `sha256sum -c`."""
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in sorted(files)
    )


def main() -> None:
    """Complete a folder that holds a source archive and wheels."""
    folder = Path(sys.argv[1])
    (source,) = folder.glob("*.tar.gz")
    (plain,) = folder.glob("*-py3-none-any.whl")
    name = source.name.removesuffix(".tar.gz")
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--dry-run",
        "--ignore-installed",
        "--report",
        "-",
    ]
    done = subprocess.run([*pip, str(plain)], capture_output=True, text=True, check=True)
    listed = json.dumps(software(json.loads(done.stdout)), indent=1)
    (folder / f"{name}-software.cdx.json").write_text(listed + "\n", "utf-8")
    image_context(source, (REPOSITORY / "Dockerfile").read_bytes(), folder / f"{name}-image.tgz")
    (folder / "SHA256SUMS").write_text(checksums(folder.iterdir()), "utf-8")
    for path in sorted(folder.iterdir()):
        print(f"{path.stat().st_size:12,d}  {path.name}")


if __name__ == "__main__":
    main()
