"""What _declarations.py says of the library is what its headers say, and nothing of the library is left out."""

import re
import subprocess
import unittest

from problems import CC, LIBRARY, ROOT
from tvi import _declarations, _library, rigid
from tvi._library import ffi

STRUCTURES = ("jet", "tvi_options", "tvi_compiler", "tvi_stats", "tvi_run_plan", "tvi_chaos", "tvi_bodies", "tvi_orbit",
              "tvi_rigid_body", "tvi_joint", "tvi_rigid", "tvi_rigid_motion")

# Functions that the module has no need of: tvi_run makes these runs, and Python has its own way for the others.
NOT_NEEDED = set("""tvi_integrate tvi_integrate_to tvi_integrate_at tvi_integrate_events tvi_integrate_tolerance
    tvi_integrate_tolerance_events tvi_ensemble_integrate tvi_progress tvi_options_default tvi_suggest_step
    tvi_system_dimension tvi_bodies_system tvi_rigid_system jet_sum jet_dot tvi_state_last
    tvi_ensemble_last tvi_record_bytes""".split())


def compile_c(text, *arguments):
    return subprocess.run([*CC, "-std=c11", f"-I{ROOT}/include", "-Werror", "-x", "c", "-", *arguments], input=text,
                          capture_output=True, text=True)


class Declarations(unittest.TestCase):
    def test_functions(self):
        """The compiler refuses declarations of one function that differ; a typedef may be made twice."""
        callbacks = re.findall(r"^typedef \w+ \w+_(?:fn|observer)\([^;]*;", _declarations.STRUCTURES, re.M)
        self.assertGreaterEqual(len(callbacks), 9)
        text = '#include "tvi_bodies.h"\n#include "tvi_rigid.h"\n' + "\n".join(callbacks) + _declarations.FUNCTIONS
        checked = compile_c(text, "-fsyntax-only")
        self.assertEqual(checked.returncode, 0, checked.stderr)
        wrong = text.replace("tvi_step(tvi_integrator *integrator, double", "tvi_step(tvi_integrator *integrator, int")
        self.assertNotEqual(wrong, text)
        self.assertIn("conflicting types", compile_c(wrong, "-fsyntax-only").stderr)

    def test_structures(self):
        """Sizes, and the places and sizes of members, as the compiler has them."""
        lines = ['#include "tvi_bodies.h"', '#include "tvi_rigid.h"', "#include <stddef.h>"]
        count = 0
        for name in STRUCTURES:
            kind = ffi.typeof(name)
            lines.append(f'_Static_assert(sizeof({name}) == {ffi.sizeof(name)}, "{name}");')
            for member, field in kind.fields:
                lines.append(f'_Static_assert(offsetof({name}, {member}) == {field.offset}, "{name}.{member}");')
                size = f"sizeof((({name} *)0)->{member})"
                lines.append(f'_Static_assert({size} == {ffi.sizeof(field.type)}, "{name}.{member}");')
                count += 1
        checked = compile_c("\n".join(lines), "-fsyntax-only")
        self.assertEqual(checked.returncode, 0, checked.stderr)
        self.assertGreater(count, 40)
        shifted = "\n".join(lines).replace("offsetof(tvi_stats, tail) == ", "offsetof(tvi_stats, tail) == 1 + ")
        self.assertIn("tvi_stats.tail", compile_c(shifted, "-fsyntax-only").stderr)

    def test_all_of_the_library(self):
        printed = subprocess.run(["nm", "-D", "--defined-only", str(LIBRARY)], capture_output=True, text=True).stdout
        exported = {line.split()[-1] for line in printed.splitlines()}
        declared = set(re.findall(r"\b((?:tvi|jet)_\w+)\(", _declarations.FUNCTIONS))
        self.assertEqual(exported - declared, NOT_NEEDED)
        self.assertEqual(declared - exported, set())

    def test_all_is_used(self):
        """Each declared function is called by its name, or by that of a kind of system."""
        text = "".join(path.read_text() for path in (ROOT / "src/python/tvi").glob("*.py"))
        kinds = "potential force lagrangian hamiltonian rescaled rescaled_reversible driven"
        by_kind = {f"tvi_system_{kind}" for kind in kinds.split()}
        called = set(re.findall(r"\blib(?:rary)?\.((?:tvi|jet)_\w+)", text)) | by_kind
        self.assertEqual(set(re.findall(r"\b((?:tvi|jet)_\w+)\(", _declarations.FUNCTIONS)) - called, set())

    def test_statuses(self):
        header = (ROOT / "include/jet.h").read_text()
        self.assertEqual(tuple(re.findall(r"ROW\(TVI_(\w+), \"", header)), _library.STATUSES)

    def test_functions_of_jets(self):
        """The codes of the functions that _jets.py counts."""
        header = (ROOT / "include/jet.h").read_text()
        names = re.findall(r"ROW\((\w+), JET_", header)
        self.assertEqual(names, "sqr sqrt exp log sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh erf "
                                "atan2 hypot".split())

    def test_words(self):
        """The words of tvi.Method and of joints are those of the enumerations, in their order."""
        from tvi._methods import _WORDS
        header = (ROOT / "include/tvi.h").read_text()
        wanted = {"method": "TVI_TYPE1, TVI_TYPE2, TVI_TYPE3, TVI_POINCARE, TVI_TAYLOR, TVI_STORMER_VERLET",
                  "expansion": "TVI_AT_START, TVI_AT_MIDPOINT, TVI_AT_END, TVI_AT_BOTH_ENDS, TVI_AT_NODES",
                  "nodes": "TVI_NODES_ON_CURVE, TVI_NODES_TRUNCATED"}
        for option, enumeration in wanted.items():
            self.assertIn(f"{{ {enumeration} }} tvi_{option};", header)
            self.assertEqual(len(_WORDS[option]), enumeration.count(",") + 1)
        quadratures = re.search(r"typedef enum \{([^}]*)\} tvi_quadrature", header).group(1)
        self.assertEqual([word.strip().lower().replace("tvi_", "").replace("quadrature_", "").replace("_", "-")
                          for word in quadratures.split(",")], list(_WORDS["quadrature"]))
        header = (ROOT / "include/tvi_rigid.h").read_text()
        kinds = re.search(r"typedef enum \{([^}]*)\} tvi_joint_kind", header).group(1)
        self.assertEqual([word.lower() for word in re.findall(r"\bTVI_(\w+)[, ]+/\*", kinds)], list(rigid._KINDS))
        self.assertIn(f"enum {{ TVI_WORLD = {rigid.WORLD} }}", header)

    def test_version(self):
        """That of tvi.h is the one; the first version of the changes, and how to cite, repeat it as the module does."""
        version = re.search(r'^#define TVI_VERSION "(.*)"', (ROOT / "include/tvi.h").read_text(), re.M).group(1)
        self.assertEqual(_library.__version__, version)
        self.assertEqual(ffi.string(_library.lib.tvi_version()).decode(), version)
        self.assertEqual(re.search(r"^## (\[\d\S+)", (ROOT / "docs/changes.md").read_text(), re.M).group(1),
                         f"[{version}]")
        self.assertIn(f"\nversion: {version}\n", (ROOT / "docs/CITATION.cff").read_text())
        dynamic = subprocess.run(["readelf", "-d", str(LIBRARY)], capture_output=True, text=True).stdout
        self.assertIn(f"[{_library.NAME}]\n", dynamic)


if __name__ == "__main__":
    unittest.main()
