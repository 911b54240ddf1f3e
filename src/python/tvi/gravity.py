"""Bodies that attract each other, and orbits of two of them: include/tvi_bodies.h in numpy's terms (docs/bodies.md).

`Bodies` have the potential, the time scale for steps that adapt, p from v, centre of mass and angular momentum; `Orbit`
has orbital elements, and their places and velocities.
"""

from typing import Any, Callable, NamedTuple

import numpy as np

from ._arrays import Array, Doubles, _floats, integer, number, numbers, pointer
from ._jets import Jet, Recording
from ._library import OK, Error, check, ffi, lib, name_of, text_of
from ._systems import MAX_DIMENSION, System, potential

__all__ = ["Bodies", "Orbit"]


class Bodies:
    """Bodies with one mass each, whose states are [..., n], n = bodies * axes: body i has the coordinates axes i to
    axes i + axes - 1.

    mass: [bodies]; a body of mass 0 is a test particle, which moves as if it had 1e-30 of the largest mass. axes: 1 to
    3. softening: r^2 + softening^2 stands for r^2. J2, radius, pole: of the body number `oblate`; of the pole [3] the
    length does not matter, None is the third axis. sharpness: k of scale(); 0 stands for 3 where one mass is ten times
    all others together, and for 1 elsewhere. Any units that fit together. It is read-only once made, and pickles.

    Raises ValueError for numbers that are out of range or not finite, and tvi.Error (EINVAL) for negative masses,
    masses that are all 0, J2 without a radius and a negative sharpness.

    >>> import numpy as np
    >>> from tvi import gravity
    >>> sun = gravity.Bodies([1, 9.5e-4])  # G = 1: AU, and years of 2 pi
    >>> x, v = gravity.Orbit(a=5.2, e=0.048).state(1 + 9.5e-4)
    >>> q, p = sun.to_centre(np.r_[0, 0, 0, x], sun.momenta(np.r_[0, 0, 0, v]))
    >>> print(sun.system(), round(sun.system().energy(0, q, p) * 5.2 * 2 / 9.5e-4, 12))
    <tvi system: potential, n = 6> -1.0
    """

    def __init__(self, mass: Array, axes: int = 3, *, G: float = 1.0, softening: float = 0.0, J2: float = 0.0,
                 radius: float = 0.0, pole: Array = None, oblate: int = 0, sharpness: float = 0.0):
        self._mass = numbers("mass", mass, None)
        self._mass.flags.writeable = False
        bodies = self._bodies = ffi.new("tvi_bodies *")
        bodies.axes = integer("axes", axes, 1, 3)
        integer("bodies * axes", self.n, 1, MAX_DIMENSION)
        bodies.bodies, bodies.mass = len(self._mass), pointer(self._mass)
        bodies.G, bodies.softening = number("G", G), number("softening", softening)
        bodies.J2, bodies.radius = number("J2", J2), number("radius", radius)
        bodies.pole = (0.0, 0.0, 0.0) if pole is None else numbers("pole", pole, 3).tolist()
        bodies.oblate = integer("oblate", oblate, 0, len(self._mass) - 1)
        bodies.sharpness = number("sharpness", sharpness)
        check(lib.tvi_bodies_check(bodies))
        self._others = dict(G=bodies.G, softening=bodies.softening, J2=bodies.J2, radius=bodies.radius,
                            pole=list(bodies.pole), oblate=bodies.oblate, sharpness=bodies.sharpness)

    def __reduce__(self) -> tuple:
        return _again, (self._mass, self.axes, self._others)

    def __repr__(self) -> str:
        return f"<tvi bodies: {len(self._mass)}, axes = {self.axes}>"

    @property
    def mass(self) -> np.ndarray:
        """[bodies], as they were given."""
        return self._mass

    @property
    def axes(self) -> int:
        return self._bodies.axes

    @property
    def n(self) -> int:
        return len(self._mass) * self.axes

    @property
    def has_test_particles(self) -> bool:
        """Whether one of the masses is 0. Then `rescaled(scale)` makes the reversible form."""
        return 0.0 in self._mass

    @property
    def coordinate_masses(self) -> np.ndarray:
        """[n], the masses of the coordinates: what tvi.potential takes beside a potential that contains this one."""
        masses = Doubles(self.n)
        lib.tvi_bodies_masses(self._bodies, masses.pointer)
        return masses.array.copy()

    # ---- Functions of jets -------------------------------------------------------------------------------------------

    def system(self) -> System:
        """The system M q'' = -dV/dq of these bodies. Its `rescaled(bodies.scale)` has steps that adapt.

        >>> from tvi import gravity
        >>> three = gravity.Bodies([3, 4, 5], axes=2)
        >>> three.system().rescaled(three.scale)
        <tvi system: rescaled, n = 6>
        """
        return potential(self.n, self.potential, mass=self.coordinate_masses)

    def potential(self, q: Array) -> Any:
        """V = -sum_{i<j} G m_i m_j / r_ij, with the oblate body's J2, of jets or of numbers q [n], to which a potential
        of your own may add what it likes.

        >>> import numpy as np, tvi
        >>> from tvi import gravity
        >>> star = gravity.Bodies([1, 1e-6], axes=2)
        >>> in_a_disk = lambda q: star.potential(q) + 1e-9 * np.log(1 + (q[2:] - q[:2]) @ (q[2:] - q[:2]))
        >>> system = tvi.potential(4, in_a_disk, mass=star.coordinate_masses)
        >>> star.potential([0, 0, 2, 0])
        -5e-07
        """
        return _of_jets(lambda x: lib.tvi_bodies_potential(x, (0.0, ffi.NULL), self._bodies), q=(q, self.n))

    def scale(self, q: Array, p: Array = None) -> Any:
        """The g for System.rescaled, (sum_{i<j} ((G (m_i + m_j))^(1/3) / r_ij)^k)^(-3/(2k)), of jets or of numbers. Of
        one pair it is (r^3 / (G (m_1 + m_2)))^(1/2). p is not read.

        >>> from tvi import gravity
        >>> gravity.Bodies([3, 1], axes=1).scale([0, 4])
        4.0
        """
        return _of_jets(lambda x: lib.tvi_bodies_scale(x, ffi.NULL, (0.0, ffi.NULL), self._bodies), q=(q, self.n))

    def field(self, at: Array, x: Array) -> Any:
        """The potential at x [axes] of a mass of 1 that moves nobody, where the bodies are at [n]; both jets or
        numbers. So bodies may move as functions of time tell them to.

        >>> import numpy as np, tvi
        >>> from tvi import gravity
        >>> pair = gravity.Bodies([0.5, 0.5], axes=2)
        >>> def in_the_field(q, t):
        ...     x, y = np.cos(t) / 2, np.sin(t) / 2
        ...     return pair.field([x, y, -x, -y], q)
        >>> planet = tvi.potential(2, in_the_field)
        """
        return _of_jets(lambda at, x: lib.tvi_bodies_field(self._bodies, at, x), at=(at, self.n), x=(x, self.axes))

    def field_scale(self, at: Array, x: Array) -> Any:
        """The g of this motion, as scale(); a sharpness of 0 stands for 3.

        >>> from tvi import gravity
        >>> gravity.Bodies([4], axes=1).field_scale([0], [4])
        4.0
        """
        return _of_jets(lambda at, x: lib.tvi_bodies_field_scale(self._bodies, at, x), at=(at, self.n),
                        x=(x, self.axes))

    # ---- Functions of states -----------------------------------------------------------------------------------------

    def momenta(self, v: Array) -> np.ndarray:
        """p = M v, of velocities [..., n].

        >>> from tvi import gravity
        >>> gravity.Bodies([3, 1], axes=2).momenta([0, 1, 0, 1])
        array([0., 3., 0., 1.])
        """
        v, p = _states(self.n, v=v), Doubles(*np.shape(v))
        _each(lib.tvi_bodies_momenta, self._bodies, _rows(v), _rows(p.array))
        return p.array.copy()

    def velocities(self, p: Array) -> np.ndarray:
        """v = M^-1 p, of momenta [..., n].

        >>> from tvi import gravity
        >>> gravity.Bodies([4, 1], axes=2).velocities([0, 1, 0, 1])
        array([0.  , 0.25, 0.  , 1.  ])
        """
        p, v = _states(self.n, p=p), Doubles(*np.shape(p))
        _each(lib.tvi_bodies_velocities, self._bodies, _rows(p), _rows(v.array))
        return v.array.copy()

    def centre(self, q: Array, p: Array) -> tuple[np.ndarray, np.ndarray]:
        """The centre of mass and its velocity, [..., axes], of states [..., n].

        >>> from tvi import gravity
        >>> gravity.Bodies([3, 1], axes=1).centre([0, 4], [0, 2])
        (array([1.]), array([0.5]))
        """
        q, p = _states(self.n, q=q, p=p)
        x, v = (Doubles(*q.shape[:-1], self.axes) for _ in "xv")
        _each(lib.tvi_bodies_centre, self._bodies, _rows(q), _rows(p), _rows(x.array), _rows(v.array))
        return x.array.copy(), v.array.copy()

    def to_centre(self, q: Array, p: Array) -> tuple[np.ndarray, np.ndarray]:
        """q and p, [..., n], in the frame where the centre of mass is at 0 and at rest.

        >>> from tvi import gravity
        >>> gravity.Bodies([3, 1], axes=1).to_centre([0, 4], [0, 2])
        (array([-1.,  3.]), array([-1.5,  1.5]))
        """
        q, p = _states(self.n, q=q, p=p)
        _each(lib.tvi_bodies_to_centre, self._bodies, _rows(q), _rows(p))
        return q, p

    def angular_momentum(self, q: Array, p: Array) -> np.ndarray:
        """L = sum q_i x p_i about the origin, [..., 3], of states [..., n]. Missing axes count as 0.

        >>> from tvi import gravity
        >>> gravity.Bodies([3, 1], axes=2).angular_momentum([0, 0, 4, 0], [0, 0, 0, 2])
        array([0., 0., 8.])
        """
        q, p = _states(self.n, q=q, p=p)
        L = Doubles(*q.shape[:-1], 3)
        _each(lib.tvi_bodies_angular_momentum, self._bodies, _rows(q), _rows(p), _rows(L.array))
        return L.array.copy()

    def orbits(self, q: Array, p: Array, about: "int | str" = 0) -> "Orbit":
        """The orbital elements [..., bodies - 1] of all bodies but one, in their order, of states [..., n].

        about: the number of the body that they move about, with mu = G (m_about + m_j); or "inner": each about the
        centre of mass of all bodies before it (Jacobi's coordinates), with mu = G (m_0 + ... + m_j). Raises tvi.Error
        as Orbit.of, with the place of the state in [..., bodies - 1].

        >>> from tvi import gravity
        >>> sun = gravity.Bodies([1, 1e-3, 1e-4], axes=2)
        >>> q, v = [0, 0, 1, 0, 2, 0], [0, 0, 0, 1.0005, 0, 0.7]
        >>> orbits = sun.orbits(q, sun.momenta(v))
        >>> print(orbits.a.round(3), orbits.e.round(3))
        [1.    1.961] [0.   0.02]
        """
        q, p = _states(self.n, q=q, p=p)
        shape = (*q.shape[:-1], len(self._mass), self.axes)
        x, v = (np.zeros((*shape[:-1], 3)) for _ in "xv")
        x[..., :self.axes], v[..., :self.axes] = q.reshape(shape), self.velocities(p).reshape(shape)
        G = self._bodies.G or 1.0
        if about == "inner":
            inside = np.cumsum(self._mass)
            middle = [np.cumsum(self._mass[:, None] * y, axis=-2)[..., :-1, :] / inside[:-1, None] for y in (x, v)]
            return Orbit.of(G * inside[1:], *(y[..., 1:, :] - m for y, m in zip((x, v), middle)))
        about = integer("about", about, 0, len(self._mass) - 1)
        others = np.delete(np.arange(len(self._mass)), about)
        return Orbit.of(G * (self._mass[about] + self._mass[others]),
                        *(y[..., others, :] - y[..., [about], :] for y in (x, v)))


def bodies_of(system: System) -> "Bodies | None":
    """The bodies whose potential a system has, perhaps rescaled, driven or constrained; None where it has another."""
    while isinstance(system._arguments[0], System):
        system = system._arguments[0]
    bodies = getattr(system._arguments[1], "__self__", None)
    return bodies if isinstance(bodies, Bodies) else None


def _again(mass: np.ndarray, axes: int, others: dict) -> Bodies:
    return Bodies(mass, axes, **others)


class Orbit(NamedTuple):
    """Orbital elements: numbers, or arrays of any shapes that go together, with angles in radians.

    An ellipse has e < 1 and a > 0, a parabola e = 1 and an infinite a, a hyperbola e > 1 and a < 0. None is what is not
    given. Give a or q; pericentre or longitude_of_pericentre, which are 0 without either; and one of time, f, M and
    mean_longitude, without which the body is at the pericentre. Elements that are given twice must agree: a change of
    each by 1e-12 of itself makes both the same, apart from whole revolutions. `of` gives all elements, and near e = 1
    neither a nor q alone is enough. at() is the same orbit at another place, and `_replace` changes single elements.

    >>> from tvi import gravity
    >>> x, v = gravity.Orbit(q=[1, 2, 3], e=[0.5, 1, 2], i=0.1, time=2).state(1.0)
    >>> x.shape, gravity.Orbit.of(1.0, x, v).e.round(12)
    ((3, 3), array([0.5, 1. , 2. ]))
    """

    a: Any = None
    q: Any = None
    e: Any = 0.0
    i: Any = 0.0
    node: Any = 0.0
    pericentre: Any = None
    time: Any = None
    f: Any = None
    M: Any = None
    mean_longitude: Any = None
    longitude_of_pericentre: Any = None

    def at(self, *, time: Array = None, f: Array = None, M: Array = None, mean_longitude: Array = None) -> "Orbit":
        """The same orbit at another place, said by one of these; without any, at the pericentre.

        >>> import numpy as np
        >>> from tvi import gravity
        >>> mars = gravity.Orbit(a=1.524, e=0.0934)
        >>> x, v = mars.at(M=np.linspace(0, np.pi, 5)).state(1.0)
        >>> np.linalg.norm(x, axis=-1).round(3)
        array([1.382, 1.431, 1.537, 1.631, 1.666])
        """
        return self._replace(time=time, f=f, M=M, mean_longitude=mean_longitude)

    def state(self, mu: Array) -> tuple[np.ndarray, np.ndarray]:
        """The places and velocities, [..., 3], of a body relative to another, mu = G (m_1 + m_2).

        Raises tvi.Error, which names the element and, among several orbits, which of them: EINVAL for mu <= 0, e < 0, i
        outside [0, pi], no q = a (1 - e) > 0, elements that disagree, f outside of the asymptotes, and M of a parabola
        other than 0; ENONFINITE where they lead to what is not finite.

        >>> from tvi import gravity
        >>> x, v = gravity.Orbit(a=1, e=0.1, M=1).state(1)
        >>> print(x.round(6))
        [0.363728 0.881537 0.      ]
        """
        given = zip(self._fields, self)
        *elements, mu = np.broadcast_arrays(*(_element(name, value) for name, value in given), _floats("mu", mu))
        orbits, mu = np.ascontiguousarray(np.stack(elements, axis=-1)), np.ravel(mu)
        x, v = (Doubles(*orbits.shape[:-1], 3) for _ in "xv")
        of = ffi.cast("tvi_orbit *", pointer(orbits))
        for k in range(len(mu)):
            status = lib.tvi_orbit_state(of + k, mu[k], x.pointer + 3 * k, v.pointer + 3 * k)
            _check_one(status, "orbit", k, x.array.shape[:-1])
        return x.array.copy(), v.array.copy()

    @classmethod
    def of(cls, mu: Array, x: Array, v: Array) -> "Orbit":
        """All elements of states x and v, [..., 3], for mu of a shape that goes with theirs. Angles are from -pi to pi,
        M and both longitudes so on ellipses only, and the node is 0 where i is 0 or pi.

        Raises tvi.Error: EINVAL for mu <= 0, EDOMAIN for x and v on one line through the centre, ENONFINITE where an
        element is not finite.

        >>> from tvi import gravity
        >>> earth = gravity.Orbit.of(1.0, [1, 0, 0], [0, 1.01, 0])
        >>> print(round(earth.e, 12), round(earth.q, 12), round(earth.a, 3))
        0.0201 1.0 1.021
        """
        x, v, mu = _vectors("x", x, 3), _vectors("v", v, 3), _floats("mu", mu)
        shape = np.broadcast_shapes(x.shape[:-1], v.shape[:-1], mu.shape)
        x, v = (np.ascontiguousarray(np.broadcast_to(y, (*shape, 3))) for y in (x, v))
        mu, found = np.ravel(np.broadcast_to(mu, shape)), Doubles(*shape, len(cls._fields))
        of, places, speeds = ffi.cast("tvi_orbit *", found.pointer), pointer(x), pointer(v)
        for k in range(len(mu)):
            _check_one(lib.tvi_orbit_of(mu[k], places + 3 * k, speeds + 3 * k, of + k), "state", k, shape)
        return cls(*(found.array[..., k].copy()[()] for k in range(len(cls._fields))))


_ELEMENTS = {
    "a": "Semimajor axis, < 0 of a hyperbola, infinite of a parabola; None, or 0 in an array: q and e say it.",
    "q": "Distance of the pericentre, a (1 - e); None, or 0 in an array: a and e say it.",
    "e": "Eccentricity.",
    "i": "Inclination, from 0 to pi.",
    "node": "Longitude of the ascending node.",
    "pericentre": "Argument of the pericentre.",
    "time": "Time since the pericentre, M (|a|^3 / mu)^(1/2).",
    "f": "True anomaly.",
    "M": "Mean anomaly; that of a parabola is 0.",
    "mean_longitude": "Mean longitude, node + pericentre + M.",
    "longitude_of_pericentre": "Longitude of the pericentre, node + pericentre.",
}
for _name, _text in _ELEMENTS.items():
    getattr(Orbit, _name).__doc__ = _text


def _element(name: str, value: Any) -> np.ndarray:
    """An element as tvi_orbit has it: 0 is not given, and a 0 that is given is -0.0, where these differ."""
    array = _floats(name, 0.0 if value is None else value, name == "a")
    if value is not None and name not in ("a", "q", "e", "i", "node"):
        array[array == 0] = -0.0
    return array


def _check_one(status: int, what: str, k: int, shape: tuple) -> None:
    """Raises what a status other than TVI_OK says of the orbit or state number k of this shape."""
    if status != OK:
        where = "".join(f"[{i}]" for i in np.unravel_index(k, shape))
        raise Error(f"{what}{where}: {text_of(status)}", name_of(status))


def _vectors(name: str, value: Any, n: int) -> np.ndarray:
    """A copy of vectors [..., n]."""
    array = _floats(name, value)
    if array.ndim < 1 or array.shape[-1] != n:
        raise ValueError(f"{name} has the shape {array.shape}, not (..., {n})")
    return array


def _states(n: int, **given: Any) -> Any:
    """Copies of one or two arrays of the same shape [..., n]."""
    arrays = [_vectors(name, value, n) for name, value in given.items()]
    if len({array.shape for array in arrays}) > 1:
        raise ValueError(" and ".join(given) + f" have the shapes {arrays[0].shape} and {arrays[1].shape}")
    return arrays if len(arrays) > 1 else arrays[0]


def _rows(array: np.ndarray) -> tuple[Any, int, int]:
    """Where the vectors of a C-contiguous array stand, how many, and how long one is."""
    return ffi.from_buffer("double[]", array), array.size // max(array.shape[-1], 1), array.shape[-1]


def _each(function: Callable, bodies: Any, *arrays: tuple[Any, int, int]) -> None:
    """Calls the function with the vectors of all arrays, one after the other."""
    for k in range(arrays[0][1]):
        function(bodies, *(first + k * n for first, _, n in arrays))


def _of_jets(function: Callable, **given: tuple[Any, int]) -> Any:
    """The value of a function of vectors of jets or numbers: a jet, or a number where all of them are."""
    recording, has_jets, pointers = _operands(given)
    value = function(*pointers)
    if value.node and not has_jets:
        raise Error("there is no value where bodies meet", "EDOMAIN")
    return Jet(value, recording) if value.node else float(value.number)


def _operands(given: dict[str, tuple[Any, int]]) -> tuple[Recording, bool, list]:
    """Vectors of jets or numbers of these lengths as the library takes them, their recording, and whether there are
    jets."""
    vectors = {name: np.asarray(value, dtype=object) for name, (value, _) in given.items()}
    jets = [x for vector in vectors.values() for x in vector.flat if isinstance(x, Jet)]
    recording = jets[0]._recording if jets else Recording()
    pointers = []
    for name, vector in vectors.items():
        if vector.shape != (given[name][1],):
            raise ValueError(f"{name} has the shape {vector.shape}, not ({given[name][1]},)")
        operands = [recording.operand(x) for x in vector]
        if None in operands:
            raise TypeError(f"{name} has jets or real numbers, not {type(vector[operands.index(None)]).__name__}")
        pointers.append(ffi.new("jet[]", operands))
    return recording, bool(jets), pointers
