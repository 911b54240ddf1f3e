"""Rigid bodies and their joints, a constrained system: include/tvi_rigid.h in numpy's terms (docs/rigid.md).

`sphere`, `box`, `cylinder`, `disc`, `rod` and `Body` are bodies, `Joint` what holds them; `Bodies` has the system of
them, and its states from `Motion` and back.
"""

from copy import deepcopy
from typing import Any, Callable, Iterable, NamedTuple

import numpy as np

from ._arrays import Array, Doubles, _floats, integer, number, numbers, pointer, spread
from ._library import check, ffi, lib
from ._systems import System, constrained, potential
from .gravity import _check_one, _each, _of_jets, _operands, _rows, _states, _vectors

__all__ = ["WORLD", "Bodies", "Body", "Joint", "Motion", "box", "cylinder", "disc", "rod", "sphere", "turn"]

WORLD = -1  # as a body of a joint: the frame at rest
_KINDS = ("ball", "hinge", "guide", "slider", "rod", "cross")
_ZERO = (0.0, 0.0, 0.0)


class Body(NamedTuple):
    """A body by its mass and its principal moments of inertia about the centre of mass, [3], or one number for all of
    them. Its own axes are the principal ones, and begin at the centre of mass. In the plane inertia[2] alone is read.

    >>> from tvi import rigid
    >>> rigid.rod(mass=3, length=2)
    Body(mass=3.0, inertia=(0.0, 1.0, 1.0))
    """

    mass: float
    inertia: Any


def _shape(function: Callable, **given: float) -> Body:
    body = function(*(number(name, value) for name, value in given.items()))
    return Body(body.mass, tuple(body.inertia))


def sphere(mass: float, radius: float) -> Body:
    """A homogeneous ball."""
    return _shape(lib.tvi_rigid_sphere, mass=mass, radius=radius)


def box(mass: float, a: float, b: float, c: float) -> Body:
    """A homogeneous box, whose edges a, b, c are along its axes 0, 1, 2."""
    return _shape(lib.tvi_rigid_box, mass=mass, a=a, b=b, c=c)


def cylinder(mass: float, radius: float, height: float) -> Body:
    """A homogeneous cylinder about its axis 2, the third one."""
    return _shape(lib.tvi_rigid_cylinder, mass=mass, radius=radius, height=height)


def disc(mass: float, radius: float) -> Body:
    """A thin disc about its axis 2, the third one."""
    return _shape(lib.tvi_rigid_disc, mass=mass, radius=radius)


def rod(mass: float, length: float) -> Body:
    """A thin rod along its axis 0, a line: it does not know how it is turned about itself."""
    return _shape(lib.tvi_rigid_rod, mass=mass, length=length)


class Joint(NamedTuple):
    """What holds the body number `body` to the body number `other`, or to the world. Points and axes are in the own
    coordinates of each; axes have any length but 0. In the plane they may have two components.

    kind: "ball": both points are at one place (points); "hinge": a ball, and the axes are parallel (points, axes);
    "guide": the point is on the line through other_point along other_axis; "slider": a guide, and the axes are
    parallel; "rod": the points have the distance `length`; "cross": the axes are perpendicular (axes). Others are not
    read.

    >>> from tvi import rigid
    >>> wheel = rigid.Joint("hinge", 0, axis=[0, 0, 1], other_axis=[1, 0, 0])  # about the x axis of the world
    """

    kind: str
    body: int
    other: int = WORLD
    point: Any = _ZERO
    other_point: Any = _ZERO
    axis: Any = _ZERO
    other_axis: Any = _ZERO
    length: float = 0.0


class Motion(NamedTuple):
    """The state of a body, or states: arrays [..., 3] of shapes that go together, quaternion [..., 4].

    place and velocity are those of the `point` of the body, (0, 0, 0): the centre of mass. The quaternion w, x, y, z
    turns the body's coordinates to those of space (SciPy's has w last); it has any length, and 0 is no rotation. omega
    is the angular velocity about the body's own axes. In the plane place, velocity and point may have two components.
    """

    place: Any = _ZERO
    velocity: Any = _ZERO
    quaternion: Any = (1.0, 0.0, 0.0, 0.0)
    omega: Any = _ZERO
    point: Any = _ZERO

    @property
    def rotation(self) -> np.ndarray:
        """[..., 3, 3], the matrix of the quaternion: rotation @ X is in space what X is in the body."""
        u = _vectors("quaternion", self.quaternion, 4)
        w, x, y, z = np.moveaxis(u / np.maximum(np.linalg.norm(u, axis=-1, keepdims=True), 1e-300), -1, 0)
        rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
        return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def turn(axis: Array, angle: float) -> np.ndarray:
    """The quaternion [4] of a rotation about an axis [3] of space, of any length but 0, by an angle in radians.

    >>> import numpy as np
    >>> from tvi import rigid
    >>> print(rigid.turn([0, 0, 2], np.pi / 2).round(6))
    [0.707107 0.       0.       0.707107]
    """
    axis, quaternion = numbers("axis", axis, 3), Doubles(4)
    if not axis.any():
        raise ValueError("axis has the length 0")
    lib.tvi_rigid_turn(pointer(axis), number("angle", angle), quaternion.pointer)
    return quaternion.array.copy()


class Bodies:
    """Rigid bodies with their joints, in space (axes = 3) or in the plane (2). Their coordinates q, [..., n], are the
    centres of mass and the directors, the unit vectors along the axes of each body, one body after the other.

    body: a Body or several; joints: Joints, one or several; gravity: [axes], an acceleration. Any units that fit
    together. It is read-only once made, and pickles. Raises ValueError and TypeError for what are no finite numbers of
    these shapes, and tvi.Error (EINVAL), which names the member, for what is no body or joint, as a mass that is not
    positive and a moment of inertia that is more than the sum of the other two.

    >>> import numpy as np, tvi
    >>> from tvi import rigid
    >>> hung = rigid.Joint("ball", 0, point=[-0.5, 0])
    >>> pendulum = rigid.Bodies(rigid.rod(1, 1), hung, axes=2, gravity=[0, -9.8])
    >>> q, p = pendulum.state(rigid.Motion(point=[-0.5, 0]))
    >>> run = tvi.solve(pendulum.system(), (0, 10), q, p, h=0.02)
    >>> angle = np.arctan2(run.q[:, 3], run.q[:, 2])  # of the director of axis 0
    >>> pendulum, np.ptp(run.energy) < 1e-13, abs(angle.min() + np.pi) < 1e-3
    (<tvi rigid bodies: 1, joints: 1, axes = 2>, True, True)
    """

    def __init__(self, body: "Body | Iterable[Body]", joints: "Joint | Iterable[Joint]" = (), axes: int = 3,
                 gravity: Array = _ZERO):
        axes = integer("axes", axes, 2, 3)
        bodies = [body] if isinstance(body, Body) else list(body)
        joints = [joints] if isinstance(joints, Joint) else list(joints)
        self._body = ffi.new("tvi_rigid_body[]", [_body(b, one) for b, one in enumerate(bodies)])
        self._joint = ffi.new("tvi_joint[]", [_joint(k, one, axes) for k, one in enumerate(joints)])
        gravity = _components("gravity", gravity, axes)
        self._given = deepcopy((bodies, joints, axes, gravity))
        self._rigid = ffi.new("tvi_rigid *", (len(bodies), axes, self._body, len(joints), self._joint, tuple(gravity)))
        check(lib.tvi_rigid_check(self._rigid))

    def __reduce__(self) -> tuple:
        return Bodies, self._given

    def __repr__(self) -> str:
        return f"<tvi rigid bodies: {self._rigid.bodies}, joints: {self._rigid.joints}, axes = {self.axes}>"

    @property
    def axes(self) -> int:
        return self._rigid.axes

    @property
    def n(self) -> int:
        """How many coordinates they have: in space 12 for each body, 9 for a plate, 6 for a line and 3 for a point."""
        return lib.tvi_rigid_dimension(self._rigid)

    @property
    def coordinate_masses(self) -> np.ndarray:
        """[n], the masses of the coordinates, for systems of your own."""
        masses = Doubles(self.n)
        lib.tvi_rigid_masses(self._rigid, masses.pointer)
        return masses.array.copy()

    def first(self, body: int) -> int:
        """The number of the body's first coordinate: q[..., first:first + axes] is its centre of mass."""
        return lib.tvi_rigid_first(self._rigid, integer("body", body, 0, self._rigid.bodies - 1))

    def multiplier(self, joint: int) -> int:
        """The number of the joint's first constraint among the multipliers of a run."""
        return lib.tvi_rigid_joint(self._rigid, integer("joint", joint, 0, self._rigid.joints - 1))

    # ---- Functions of jets -------------------------------------------------------------------------------------------

    def system(self, V: "Callable | None" = None, **parameters: Any) -> System:
        """The constrained system of these bodies, with the potential of gravity and V(q) or V(q, t), which may take
        parameters by keyword, as that of tvi.potential.

        >>> from tvi import rigid
        >>> ball = rigid.Bodies(rigid.sphere(1, 0.1))
        >>> ball.system(lambda q, k: k / 2 * q[:3] @ q[:3], k=2.0)
        <tvi system: constrained, n = 12, 6 constraints, k=2.0>
        """
        both = self.potential if V is None else _Sum(self, V) if callable(V) else V
        system = potential(self.n, both, mass=self.coordinate_masses, **parameters)
        return constrained(system, self.constraint) if lib.tvi_rigid_constraints(self._rigid) else system

    def potential(self, q: Array) -> Any:
        """The potential of gravity, of jets or of numbers q [n]."""
        return _of_jets(lambda x: lib.tvi_rigid_potential(x, (0.0, ffi.NULL), self._rigid), q=(q, self.n))

    def constraint(self, q: Array) -> np.ndarray:
        """The constraints, of jets or of numbers q [n]: with it, potential() and coordinate_masses systems of another
        kind are made, such as one with friction.

        >>> import tvi
        >>> from tvi import rigid
        >>> wheel = rigid.Bodies(rigid.disc(2, 0.5), rigid.Joint("hinge", 0, axis=[0, 0, 1], other_axis=[0, 0, 1]))
        >>> free = tvi.potential(wheel.n, wheel.potential, mass=wheel.coordinate_masses)
        >>> def brake(q, v):
        ...     omega = q[3] * v[4] - q[4] * v[3]  # of the director of axis 0
        ...     return wheel.torque(q, [0, 0, -0.1 * omega])
        >>> tvi.constrained(free.driven(brake), wheel.constraint)
        <tvi system: constrained, n = 9, 8 constraints>
        """
        return self._written(lib.tvi_rigid_constraints(self._rigid), lambda x, out: lib.tvi_rigid_constraint(
            x, (0.0, ffi.NULL), out, self._rigid), q=(q, self.n))

    def point(self, q: Array, X: Array, body: int = 0) -> np.ndarray:
        """Where the point X [axes] of a body is: of jets q [n], or of states q [..., n], then [..., axes].

        >>> from tvi import rigid
        >>> ball = rigid.Bodies(rigid.sphere(1, 0.1))
        >>> spring = ball.system(lambda q: 3 * ball.point(q, [0, 0, 0.1]) @ ball.point(q, [0, 0, 0.1]))
        """
        body, X = self._point(body, X)
        if np.asarray(q).dtype == object:
            return self._written(self.axes, lambda q, x: lib.tvi_rigid_point(self._rigid, q, body, X, x), q=(q, self.n))
        q = _states(self.n, q=q)
        x = Doubles(*q.shape[:-1], self.axes)
        _each(lambda r, q, x: lib.tvi_rigid_place(r, q, body, X, x), self._rigid, _rows(q), _rows(x.array))
        return x.array.copy()

    def force(self, q: Array, F: Array, body: int = 0, point: Array = _ZERO) -> np.ndarray:
        """The force along q, [n], of a force F [axes] in space at a point of a body, of jets or numbers. The sum of
        such is what System.driven and tvi.force take."""
        body, X = self._point(body, point)
        return self._written(self.n, lambda q, F, out: lib.tvi_rigid_force(self._rigid, q, body, X, F, out),
                             q=(q, self.n), F=(F, self.axes))

    def torque(self, q: Array, T: Array, body: int = 0) -> np.ndarray:
        """The force along q, [n], of a torque T [3] in space on a body, of jets or numbers; in the plane T[2] is
        read."""
        body, _ = self._point(body, _ZERO)
        return self._written(self.n, lambda q, T, out: lib.tvi_rigid_torque(self._rigid, q, body, T, out),
                             q=(q, self.n), T=(T, 3))

    def _point(self, body: int, X: Array) -> tuple[int, Any]:
        """A body and a point of it, which the library refuses where there are none."""
        body, motion = integer("body", body, 0, self._rigid.bodies - 1), ffi.new("tvi_rigid_motion *")
        motion.point = tuple(_components("point", X, self.axes))
        check(lib.tvi_rigid_state(self._rigid, body, motion, Doubles(self.n).pointer, Doubles(self.n).pointer))
        return body, ffi.new("double[]", list(motion.point))

    def _written(self, count: int, function: Callable, **given: tuple[Any, int]) -> np.ndarray:
        """The values that a function writes: jets, or numbers where all vectors are."""
        recording, has_jets, pointers = _operands(given)
        out = ffi.new("jet[]", count)
        function(*pointers, out)
        return recording.jets(out, count) if has_jets else np.array([x.number for x in out])

    # ---- States ------------------------------------------------------------------------------------------------------

    def state(self, *motions: Motion) -> tuple[np.ndarray, np.ndarray]:
        """q and p, [..., n], of motions of the bodies, one for each. Joints are not looked at: System.project of the
        system moves a state onto them. Raises tvi.Error (EINVAL), which names the motion, for components out of the
        plane, and a point off a line.

        >>> import numpy as np
        >>> from tvi import rigid
        >>> box = rigid.Bodies(rigid.box(1, 1, 2, 3))
        >>> q, p = box.state(rigid.Motion(quaternion=rigid.turn([1, 0, 0], 0.6), omega=[[0, 0, 1], [0, 1, 0]]))
        >>> q.shape, box.motion(q, p).omega[1].round(12) + 0.0
        ((2, 12), array([0., 1., 0.]))
        """
        if len(motions) != self._rigid.bodies or not all(isinstance(one, Motion) for one in motions):
            raise TypeError(f"state() has one Motion for each body, {self._rigid.bodies}")
        given = [_motion(motion, self.axes) for motion in motions]
        shape = np.broadcast_shapes(*(one.shape[:-1] for one in given))
        q, p = (Doubles(*shape, self.n) for _ in "qp")
        for b, one in enumerate(given):
            rows = np.ascontiguousarray(np.broadcast_to(one, (*shape, one.shape[-1])))
            of = ffi.cast("tvi_rigid_motion *", pointer(rows))
            for k in range(rows.size // rows.shape[-1]):
                status = lib.tvi_rigid_state(self._rigid, b, of + k, q.pointer + k * self.n, p.pointer + k * self.n)
                _check_one(status, f"motion {b}", k, shape)
        return q.array.copy(), p.array.copy()

    def motion(self, q: Array, p: Array, body: int = 0, point: Array = _ZERO) -> Motion:
        """The Motion of a body in states q and p, [..., n]: place and velocity of its point, the quaternion of length 1
        with w >= 0, and omega, arrays [..., 3] and [..., 4]. Raises tvi.Error (EINVAL) where directors are no axes."""
        q, p = _states(self.n, q=q, p=p)
        body, X = self._point(body, point)
        shape, rows = q.shape[:-1], Doubles(*q.shape[:-1], 16)
        rows.array[..., 13:] = list(X)
        of, n = ffi.cast("tvi_rigid_motion *", rows.pointer), self.n
        for k in range(q.size // n):
            _check_one(lib.tvi_rigid_of(self._rigid, body, pointer(q) + k * n, pointer(p) + k * n, of + k), "state", k,
                       shape)
        return Motion(*(part.copy() for part in np.split(rows.array, [3, 6, 10, 13], axis=-1)))

    def angular_momentum(self, q: Array, p: Array) -> np.ndarray:
        """L of all bodies about the origin, [..., 3], of states [..., n].

        >>> from tvi import rigid
        >>> wheel = rigid.Bodies(rigid.disc(2, 1))
        >>> print(wheel.angular_momentum(*wheel.state(rigid.Motion(omega=[0, 0, 3]))))
        [0. 0. 3.]
        """
        q, p = _states(self.n, q=q, p=p)
        L = Doubles(*q.shape[:-1], 3)
        _each(lib.tvi_rigid_angular_momentum, self._rigid, _rows(q), _rows(p), _rows(L.array))
        return L.array.copy()


class _Sum:
    """A potential of the user, whose arguments it has, and that of gravity."""

    def __init__(self, bodies: Bodies, V: Callable):
        self.bodies, self.__wrapped__ = bodies, V

    def __call__(self, q: Any, *others: Any, **named: Any) -> Any:
        own = self.__wrapped__(q, *others, **named)
        try:
            return own + self.bodies.potential(q)
        except TypeError:  # It is no jet, as tvi.potential will say.
            return own


def _body(b: int, one: Any) -> tuple:
    if not isinstance(one, Body):
        raise TypeError(f"body[{b}] is a Body, not {type(one).__name__}")
    return number(f"body[{b}].mass", one.mass), tuple(spread(f"body[{b}].inertia", one.inertia, 3))


def _joint(k: int, one: Any, axes: int) -> tuple:
    if not isinstance(one, Joint) or one.kind not in _KINDS:
        raise TypeError(f"joint[{k}] is a Joint of the kind {', '.join(_KINDS[:-1])} or {_KINDS[-1]}, not "
                        f"{getattr(one, 'kind', type(one).__name__)}")
    places = [tuple(_components(f"joint[{k}].{name}", getattr(one, name), axes))
              for name in ("point", "other_point", "axis", "other_axis")]
    bodies = (integer(f"joint[{k}].{name}", getattr(one, name), WORLD) for name in ("body", "other"))
    return _KINDS.index(one.kind), *bodies, *places, number(f"joint[{k}].length", one.length)


def _components(name: str, value: Any, axes: int) -> np.ndarray:
    """A vector [3], which in the plane may have two components."""
    array = _padded(name, value, axes)
    return numbers(name, array, 3)


def _padded(name: str, value: Any, axes: int) -> np.ndarray:
    """Vectors [..., 3], which in the plane may have two components."""
    array = _floats(name, value)
    if axes == 2 and array.ndim and array.shape[-1] == 2:
        array = np.concatenate([array, np.zeros((*array.shape[:-1], 1))], axis=-1)
    return _vectors(name, array, 3)


def _motion(motion: Motion, axes: int) -> np.ndarray:
    """The numbers [..., 16] of a tvi_rigid_motion."""
    parts = [_vectors(name, value, 4) if name == "quaternion" else _padded(name, value, 3 if name == "omega" else axes)
             for name, value in zip(motion._fields, motion)]
    shape = np.broadcast_shapes(*(part.shape[:-1] for part in parts))
    return np.concatenate([np.broadcast_to(part, (*shape, part.shape[-1])) for part in parts], axis=-1)
