"""The module finds its library by the documented order, and says what to do where there is none or another one."""

import os
import shutil
import subprocess
import tempfile
import unittest
import zipfile
from pathlib import Path

from problems import CC, LIBRARY, ROOT, python
from tvi._library import NAME, __version__

WHICH = "import tvi; print(open('/proc/self/maps').read().count(%r) > 0)"


class Loading(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def package(self):
        """A copy of the package, in a folder where nothing is beside it."""
        shutil.copytree(ROOT / "src/python/tvi", self.folder / "tvi", ignore=shutil.ignore_patterns("*.pyc"))
        return {"PYTHONPATH": str(self.folder), "TVI_LIBRARY": ""}

    def library(self, version):
        source = "const char *tvi_version(void);\nconst char *tvi_version(void) { return \"%s\"; }\n" % version
        path = self.folder / "other.so"
        subprocess.run([*CC, "-shared", "-fPIC", "-x", "c", "-", "-o", str(path)], input=source, text=True, check=True)
        return path

    def test_named(self):
        self.assertEqual(python(WHICH % str(LIBRARY)), "True\n")
        os.chdir(LIBRARY.parent)
        self.addCleanup(os.chdir, ROOT / "tests/python")
        self.assertEqual(python(WHICH % str(LIBRARY), TVI_LIBRARY=LIBRARY.name), "True\n")

    def test_beside(self):
        environment = self.package()
        shutil.copy(LIBRARY, self.folder / "tvi" / NAME)
        self.assertEqual(python(WHICH % str(self.folder), **environment), "True\n")
        self.assertEqual(python(WHICH % str(self.folder), **{**environment, "TVI_LIBRARY": str(LIBRARY)}), "False\n")

    def test_by_the_loader(self):
        environment = self.package()
        (self.folder / "lib").mkdir()
        shutil.copy(LIBRARY, self.folder / "lib" / NAME)
        found = python(WHICH % str(self.folder / "lib"), LD_LIBRARY_PATH=str(self.folder / "lib"), **environment)
        self.assertEqual(found, "True\n")

    def test_wheel(self):
        """What pip would install is the module, whole, with what it needs said; it is imported out of the wheel."""
        printed = python(f"import backend; print(backend.build_wheel({str(self.folder)!r}))",
                         PYTHONPATH=str(ROOT / "src/python")).strip()
        with zipfile.ZipFile(self.folder / printed) as wheel:
            names = {name for name in wheel.namelist() if name.startswith("tvi/")}
            record = next(name for name in wheel.namelist() if name.endswith("RECORD"))
            listed = [line.split(",")[0] for line in wheel.read(record).decode().splitlines()]
            metadata = wheel.read(record.replace("RECORD", "METADATA")).decode()
        files = {f"tvi/{path.name}" for path in (ROOT / "src/python/tvi").glob("*.py")}
        self.assertEqual(names, files | {"tvi/py.typed"})
        self.assertEqual(sorted(listed), sorted(zipfile.ZipFile(self.folder / printed).namelist()))
        self.assertIn("Requires-Dist: numpy", metadata)
        self.assertIn(f"Version: {__version__}\n", metadata)
        self.assertEqual(python(WHICH % str(LIBRARY), PYTHONPATH=str(self.folder / printed)), "True\n")

    def test_none(self):
        printed = python("import tvi", TVI_LIBRARY=str(self.folder / "none.so"))
        self.assertIn("ImportError: the library of the module tvi was not found", printed)
        self.assertIn("make install", printed)
        (self.folder / "text.so").write_text("no library")
        self.assertIn("was not found", python("import tvi", TVI_LIBRARY=str(self.folder / "text.so")))

    def test_another_version(self):
        printed = python("import tvi", TVI_LIBRARY=str(self.library("0.0.9")))
        self.assertIn("other.so has version 0.0.9, and the module tvi needs", printed)
        self.assertIn("install both from the same sources", printed)
        empty = str(self.folder / "empty.so")
        subprocess.run([*CC, "-shared", "-fPIC", "-x", "c", "-", "-o", empty], input="", text=True, check=True)
        self.assertIn("has version an older one", python("import tvi", TVI_LIBRARY=empty))


if __name__ == "__main__":
    unittest.main()
