/* tvi_rigid.h - declares rigid bodies and their joints, as a constrained system: a body is its centre of mass and its
 * directors, the unit vectors along its axes (docs/rigid.md). tvi.h does not include it. The functions allocate nothing
 * but systems, and may be called by several threads. */
#ifndef TVI_RIGID_H
#define TVI_RIGID_H

#include "tvi.h"

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wreturn-type-c-linkage" /* a jet is passed as in C (docs/bindings.md) */
#endif
extern "C" {
#endif

/* ---- Bodies ------------------------------------------------------------------------------------------------------ */

/* A body by its mass and its principal moments of inertia about the centre of mass. Its own axes are the principal
 * ones, and its origin is the centre of mass. inertia[k] is about axis k; in the plane inertia[2] alone is read. Its
 * coordinates are the centre, and the director of each axis k for which E_k = (sum of the other two - inertia[k]) / 2
 * is positive: 12 numbers; 9 of a plate, which has one E_k = 0 (up to 16 units of roundoff); 6 of a line, which has one
 * E_k > 0; 3 of a point, whose inertia is 0. In the plane: the centre and the first director, 4 numbers; 2 of a
 * point. */
typedef struct {
    double mass, inertia[3];
} tvi_rigid_body;

/* Bodies of usual shapes, homogeneous: a ball; a box with edges along the axes; a cylinder and a thin disc about axis 2
 * (the third one); a thin rod along axis 0. */
tvi_rigid_body tvi_rigid_sphere(double mass, double radius);
tvi_rigid_body tvi_rigid_box(double mass, double a, double b, double c);
tvi_rigid_body tvi_rigid_cylinder(double mass, double radius, double height);
tvi_rigid_body tvi_rigid_disc(double mass, double radius);
tvi_rigid_body tvi_rigid_rod(double mass, double length);

/* What a joint holds. Points and axes are in the coordinates of the body that has them; axes have any length but 0. The
 * numbers of constraints are those in space, and in the plane. */
typedef enum {
    TVI_BALL,   /* point is at other_point; 3, 2. With TVI_WORLD it is a fixed point. In the plane it is a hinge. */
    TVI_HINGE,  /* a ball, and axis is along other_axis; 5, 2 */
    TVI_GUIDE,  /* point is on the line through other_point along other_axis; 2, 1 */
    TVI_SLIDER, /* a guide, and axis is along other_axis, about which the bodies may turn in space; 4, 2 */
    TVI_ROD,    /* point has the distance `length` > 0 from other_point; 1, 1 */
    TVI_CROSS   /* axis is perpendicular to other_axis; 1, 1. A ball with it is a universal joint. */
} tvi_joint_kind;

enum { TVI_WORLD = -1 }; /* as a body: the frame at rest, whose coordinates are those of space */

typedef struct {
    tvi_joint_kind kind;
    int body, other; /* two numbers of bodies, or TVI_WORLD */
    double point[3], other_point[3], axis[3], other_axis[3], length;
} tvi_joint;

/* Bodies with their joints. The coordinates are those of body 0, then of body 1, and so on. */
typedef struct {
    int bodies, axes; /* 3 axes: space, 2: the plane, where third components are 0 */
    const tvi_rigid_body *body;
    int joints;
    const tvi_joint *joint;
    double gravity[3]; /* an acceleration */
} tvi_rigid;

/* Tells whether these are bodies and joints; tvi_last_error names the member that is wrong. All functions below begin
 * with it: those that record jets give a number that is not finite where it fails, and others that return nothing do
 * nothing.
 *   TVI_EINVAL      a count or a body's number out of range; NULL; a mass <= 0; a moment of inertia that is negative,
 *                   or more than the sum of the other two; a joint of a body with itself; an axis of length 0; a point
 *                   or an axis off a line, or a line as `other` with an axis, which it cannot tell; a length <= 0 of a
 *                   rod
 *   TVI_ENONFINITE  a number is not finite */
TVI_NODISCARD tvi_status tvi_rigid_check(const tvi_rigid *r);

/* The numbers of coordinates and constraints; 0 where tvi_rigid_check fails. The constraints stand in the order of the
 * bodies: d_i.d_j = 0 or 1 for i <= j, then the joints whose later body this is. */
int tvi_rigid_dimension(const tvi_rigid *r);   /* n */
int tvi_rigid_constraints(const tvi_rigid *r); /* m */
/* The numbers of a body's first coordinate, and of a joint's first constraint, whose multipliers tvi_multipliers finds;
 * -1: there is none. */
int tvi_rigid_first(const tvi_rigid *r, int body);
int tvi_rigid_joint(const tvi_rigid *r, int joint);

/* Makes the constrained system with the potential of gravity and of `potential`, which may be NULL. It returns what
 * tvi_rigid_check, tvi_system_potential or tvi_system_constrained return. */
TVI_NODISCARD tvi_status tvi_rigid_system(tvi_system **out, const tvi_rigid *r, tvi_potential_fn *potential, void *ctx);

/* The parts of it, for systems of another kind, such as driven ones: masses of the coordinates, mass[n], for which p =
 * M v; a tvi_potential_fn, the potential of gravity, and a tvi_constraint_fn; their ctx is a tvi_rigid. */
void tvi_rigid_masses(const tvi_rigid *r, double mass[]);
jet tvi_rigid_potential(const jet q[], jet t, void *ctx);
void tvi_rigid_constraint(const jet q[], jet t, jet value[], void *ctx);

/* ---- Points and forces ------------------------------------------------------------------------------------------- */

/* Records where the point X[axes] of a body, or of the world, is, x[axes]; tvi_rigid_place computes it, of a body. They
 * are not finite where the body has no such point, which is one off a line. */
void tvi_rigid_point(const tvi_rigid *r, const jet q[], int body, const double X[], jet x[]);
void tvi_rigid_place(const tvi_rigid *r, const double q[], int body, const double X[], double x[]);

/* Add a force F[axes], in the coordinates of space, at the point X[axes] of a body to force[n], which is along q, and a
 * torque[3], of which the plane has torque[2]. A line takes no torque about itself, and a point none at all. */
void tvi_rigid_force(const tvi_rigid *r, const jet q[], int body, const double X[], const jet F[], jet force[]);
void tvi_rigid_torque(const tvi_rigid *r, const jet q[], int body, const jet torque[3], jet force[]);

/* ---- States ------------------------------------------------------------------------------------------------------ */

/* The state of a body. Third components of place, velocity and point are 0 in the plane, as are quaternion[1, 2] and
 * omega[0, 1]. */
typedef struct {
    double place[3], velocity[3]; /* of the point */
    double quaternion[4];         /* w, x, y, z of the rotation from the body to space, of any length; 0: no rotation */
    double omega[3];              /* the angular velocity about the body's own axes */
    double point[3];              /* of the body; 0: the centre of mass */
} tvi_rigid_motion;

/* Sets the body's components of q[n] and p[n] to a state of it; of a line omega about itself is not seen. It says
 * nothing of joints: tvi_project moves a state onto them.
 *   TVI_EINVAL      a body out of range; NULL; components out of the plane; a point off a line
 *   TVI_ENONFINITE  a number is not finite
 *   others          as of tvi_rigid_check */
TVI_NODISCARD tvi_status tvi_rigid_state(const tvi_rigid *r, int body, const tvi_rigid_motion *motion, double q[],
                                         double p[]);

/* Finds the state of a body: of motion->point, which it reads, the place and velocity, the quaternion of length 1 with
 * w >= 0, and omega. A line has the quaternion of the least rotation, and no omega about itself.
 *   TVI_EINVAL      as above, and directors of which a product is not 0 or 1 to 1e-3, or that are left-handed */
TVI_NODISCARD tvi_status tvi_rigid_of(const tvi_rigid *r, int body, const double q[], const double p[],
                                      tvi_rigid_motion *motion);

/* Sets the quaternion of a rotation about an axis of space, of any length but 0, by an angle in radians. */
void tvi_rigid_turn(const double axis[3], double angle, double quaternion[4]);

/* Finds the angular momentum of all bodies about the origin, L[3]; the plane has L[2]. */
void tvi_rigid_angular_momentum(const tvi_rigid *r, const double q[], const double p[], double L[3]);

#ifdef __cplusplus
}
#if defined(__clang__)
#pragma clang diagnostic pop
#endif
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#endif
