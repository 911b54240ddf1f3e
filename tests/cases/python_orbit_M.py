# Elements as catalogues and REBOUND give them: gravity.Orbit(a=1, e=0.1, M=1.0) or f=1.0. Both are accepted and not
# read: the body is put at the pericentre, (0.9, 0, 0), and nothing says so (the docstring does: "which is not
# read"; the same in C, .M = 1).
# Right: M and f are elements, so that x = (0.363728, 0.881537) for M = 1 and (0.507480, 0.790353) for f = 1
# (Kepler's equation in 30 digits: x = a (cos E - e), y = a (1 - e^2)^(1/2) sin E, E - e sin E = M; r = a (1 - e^2)
# / (1 + e cos f)); where they disagree with a time that is given, a refusal that names them. M = time for a = mu =
# 1.
import tvi  # noqa: F401
from tvi import gravity
from verdict import attempt, refuses, row, told, verdict

for elements, right in ((dict(M=1.0), (0.363728, 0.881537)), (dict(f=1.0), (0.507480, 0.790353)),
                        (dict(M=1.0, time=1.0), (0.363728, 0.881537))):
    answer = attempt(lambda: gravity.Orbit(a=1, e=0.1, **elements).state(1.0)[0])
    row(not isinstance(answer, Exception) and abs(answer[0] - right[0]) < 1e-6 and abs(answer[1] - right[1]) < 1e-6,
        elements, told(answer))
for elements, word in (dict(M=1.0, time=0.5), r"\bM\b"), (dict(f=1.0, time=0.5), r"\bf\b"), \
        (dict(M=1.0, f=2.0), r"\bM\b"):
    answer = attempt(lambda: gravity.Orbit(a=1, e=0.1, **elements).state(1.0)[0])
    row(refuses(answer, word), elements, told(answer))
verdict()
