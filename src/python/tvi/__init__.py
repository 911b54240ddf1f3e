"""Taylor variational integrators: symplectic integrators of any order from the Taylor series of your own equations.

State a problem with `potential`, `force`, `lagrangian` or `hamiltonian`, perhaps `constrained`; `solve` makes a run of
it. `Integrator` goes step by step, `ensemble` many orbits at once; `gravity` has bodies and orbital elements, `rigid`
rigid bodies and joints. docs/python.md is the way in, include/tvi.h the reference of the library.
"""

from . import gravity, rigid
from ._alike import Stats
from ._chaos import lyapunov, megno
from ._ensemble import Ensemble
from ._events import Event, Found, event
from ._integrator import Integrator, peek
from ._jets import Jet, erf
from ._library import Error, Interrupted, __version__
from ._many import EnsembleResult, ensemble
from ._methods import Compiled, Method, compile, suggest_step, taylor_order, write_compiled
from ._result import Result
from ._solve import solve
from ._systems import System, constrained, force, hamiltonian, lagrangian, potential

for _public in (Compiled, Ensemble, EnsembleResult, Error, Event, Found, Integrator, Interrupted, Jet, Method, Result,
                Stats, System):
    _public.__module__ = __name__  # where users and pickles find them
del _public
