"""Packs the module for `pip install ./src/python` (PEP 517), as its files are: nothing is compiled, and nothing else is
needed, so that it works without a network."""

import base64
import hashlib
import re
import zipfile
from pathlib import Path

HERE = Path(__file__).parent


def _project():
    """The lines of pyproject.toml that a wheel repeats, which Python can read from 3.11 on, and the version."""
    text = (HERE / "pyproject.toml").read_text()
    value = {name: re.search(rf'^{name} = "(.*)"$', text, re.M).group(1)
             for name in ("name", "description", "requires-python")}
    value["version"] = re.search(r'^__version__ = "(.*)"$', (HERE / "tvi/_library.py").read_text(), re.M).group(1)
    needed = re.findall(r'"([^"]+)"', re.search(r"^dependencies = \[(.*)\]$", text, re.M).group(1))
    return value, needed


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    value, needed = _project()
    folder = f"{value['name']}-{value['version']}.dist-info"
    metadata = [f"Metadata-Version: 2.1\nName: {value['name']}\nVersion: {value['version']}",
                f"Summary: {value['description']}\nRequires-Python: {value['requires-python']}",
                *(f"Requires-Dist: {package}" for package in needed)]
    files = {f"tvi/{path.name}": path.read_bytes() for path in sorted((HERE / "tvi").iterdir())
             if path.suffix == ".py" or path.name == "py.typed"}
    files[f"{folder}/METADATA"] = "\n".join(metadata + [""]).encode()
    files[f"{folder}/WHEEL"] = b"Wheel-Version: 1.0\nGenerator: tvi\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    rows = [f"{name},sha256={_hash(content)},{len(content)}" for name, content in files.items()]
    files[f"{folder}/RECORD"] = "\n".join([*rows, f"{folder}/RECORD,,", ""]).encode()
    wheel = f"{value['name']}-{value['version']}-py3-none-any.whl"
    with zipfile.ZipFile(Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return wheel


def _hash(content):
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("the sources of the module are those of the library")
