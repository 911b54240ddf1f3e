"""A pendulum of length 1 m, released from 1 rad: by ctypes as a force, by cffi as a potential.
   python3 pendulum.py"""
import tvi_cffi
import tvi_ctypes

gravity = 9.8
by_ctypes = tvi_ctypes.Run(1, lambda q, t: [-gravity * tvi_ctypes.sin(q[0])])
by_cffi = tvi_cffi.Run(1, lambda q, t: -gravity * tvi_cffi.cos(q[0]))
for name, run in ("ctypes", by_ctypes), ("cffi", by_cffi):
    t, q, p = run.integrate(0.02, 500, 0, [1], [0])
    print("%s: after %.0f s the angle is %.9f" % (name, t, q[0]))

for broken in (tvi_ctypes.Run, lambda q, t: [1 / 0]), (tvi_cffi.Run, lambda q, t: tvi_cffi.log(-1)):
    try:
        broken[0](1, broken[1])
    except Exception as error:
        print("%s: %s" % (type(error).__name__, error))
