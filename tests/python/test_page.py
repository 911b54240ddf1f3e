"""The programs of docs/python.md, bodies.md, chaos.md, constraints.md, rigid.md, fits.md and three-fits.md run one
after the other and print what stands below them; the examples of docstrings do, too, and every public name has one."""

import contextlib
import doctest
import importlib
import importlib.util
import inspect
import io
import os
import pkgutil
import re
import tempfile
import unittest

import matplotlib

import tvi
from problems import ROOT
from tvi import _functions

PAGE = (ROOT / "docs/python.md").read_text()


class Page(unittest.TestCase):
    def run_programs(self, page, least, without=()):
        """All but those that import or take what is left out."""
        blocks = re.findall(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", page, re.S)
        self.assertGreaterEqual(len(blocks), least)
        matplotlib.use("Agg")
        names, kept = {}, os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for program, wanted in blocks:
                    if any(re.search(rf"\b{name}\b", program) for name in without):
                        continue
                    printed = io.StringIO()
                    with contextlib.redirect_stdout(printed):
                        exec(compile(program, "a page", "exec"), names)
                    self.assertEqual(printed.getvalue(), wanted, program)
                return {name: os.path.getsize(name) for name in os.listdir()}
            finally:
                os.chdir(kept)

    def test_programs(self):
        self.assertGreater(self.run_programs(PAGE, 8)["kepler.png"], 10000)
        for page in ("bodies", "chaos", "constraints", "rigid"):
            self.run_programs((ROOT / f"docs/{page}.md").read_text(), 1)

    def test_fits(self):
        """Both pages are one program. Those of JAX and PyTorch are never run, and those of SciPy where it is."""
        without = ["jax", "torch"] + ([] if importlib.util.find_spec("scipy") else ["scipy", "minimize"])
        pages = [(ROOT / f"docs/{page}.md").read_text() for page in ("fits", "three-fits")]
        self.run_programs("".join(pages), 5, without)

    def test_readme(self):
        program = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S).group(1)
        names = {}
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(program, "README.md", "exec"), names)
        self.assertTrue(printed.getvalue().startswith("[ 0.2568"), printed.getvalue())
        self.assertLess(abs(names["run"].q[-1] - [0.256821, -0.685955]).max(), 1e-6)

    def test_opening(self):
        """The picture at the head of the page is made by the lines below it."""
        first = re.search(r"```python\n(.*?)```", PAGE, re.S).group(1)
        self.assertEqual(first, (ROOT / "docs/python/kepler.py").read_text())

    def test_gallery(self):
        """Each program has its picture, small, and both are on the page."""
        gallery = (ROOT / "docs/python/README.md").read_text()
        for program in (ROOT / "docs/python").glob("*.py"):
            self.assertIn(f"({program.name})", gallery)
            self.assertIn(f"({program.stem}.png)", gallery)
            self.assertLess(program.with_suffix(".png").stat().st_size, 60000)
            self.assertLessEqual(len(program.read_text().splitlines()), 40)

    def test_refused(self):
        """The texts that refused.md explains are texts of the library."""
        sources = " ".join(path.read_text() for folder in ("src", "ad", "include") for path in
                           (ROOT / folder).rglob("*.[ch]"))
        sources = re.sub(r'"\s*"', "", re.sub(r'"\s+[A-Z_]+\s+"', "", sources)).replace("%%", "%").replace('\\"', '"')
        rows = re.findall(r"^\| (?!text)([^|-][^|]*) \|", (ROOT / "docs/refused.md").read_text(), re.M)
        self.assertGreater(len(rows), 30)
        for row in rows:
            for text in re.split(r"; |, |\.\.\.", re.sub(r"\*\*TVI_(\w+)\*\*(, )?", "", row)):
                self.assertIn(text.strip(), sources)

    def test_docstrings(self):
        finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
        names = ["tvi", *(f"tvi.{module.name}" for module in pkgutil.iter_modules(tvi.__path__))]
        seen = set()
        for name in names:
            for test in finder.find(importlib.import_module(name), name):
                if test.examples and id(test.docstring) not in seen:
                    seen.add(id(test.docstring))
                    printed = io.StringIO()
                    runner.run(test, out=printed.write)
                    self.assertEqual(printed.getvalue(), "")
        self.assertGreater(runner.tries, 55)

    def test_parameters(self):
        """A parameter is given by keyword beside arguments, whose names are reserved."""
        kinds = [getattr(tvi, name) for name in dir(tvi) if not name.startswith("_")]
        for kind in kinds + [tvi.System.driven]:
            arguments = inspect.signature(kind).parameters if inspect.isclass(kind) or inspect.isfunction(kind) else {}
            if "parameters" in arguments and arguments["parameters"].kind is inspect.Parameter.VAR_KEYWORD:
                self.assertLessEqual(set(arguments) - {"parameters", "L", "F", "H"}, _functions.RESERVED, kind)

    def test_every_name(self):
        """What is public has a docstring, functions one with an example, and their arguments have types."""
        public = [name for name in dir(tvi) if not name.startswith("_")]
        self.assertGreater(len(public), 20)
        for name in public:
            thing = getattr(tvi, name)
            self.assertTrue(thing.__doc__, name)
            if inspect.isfunction(thing):
                self.assertIn(">>>", thing.__doc__, name)
                self.assertEqual(thing.__annotations__.keys() >= {"return"}, True, name)
        for kind in (tvi.Integrator, tvi.Ensemble, tvi.System, tvi.Method, tvi.Result, tvi.gravity.Bodies,
                     tvi.gravity.Orbit, tvi.rigid.Bodies):
            for name, member in vars(kind).items():
                if not name.startswith("_") and inspect.isfunction(member):
                    self.assertTrue(member.__doc__, f"{kind.__name__}.{name}")


if __name__ == "__main__":
    unittest.main()
