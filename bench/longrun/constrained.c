/* constrained.c - States the scenes on constraints (longrun.h), of numbers that are not short. */
#include "longrun.h"
#include "tvi_rigid.h"

/* (|x - y|^2 - l^2) / 2; y NULL: the origin. */
static jet rod(int axes, const jet x[], const jet y[], double length)
{
    jet d[3];
    for (int i = 0; i < axes; i++) d[i] = y ? jet_sub(x[i], y[i]) : x[i];
    return jet_mul(0.5, jet_sub(jet_dot(d, d, axes), length * length));
}

/* ---- Pendulums --------------------------------------------------------------------------------------------------- */

static jet falls(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(1.3 * 1.07, q[1]);
}

static void one_rod(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = rod(2, q, NULL, 0.93);
}

static const double one_mass[] = {1.3, 1.3}, one_q[] = {0.93, 0}, one_p[] = {0, 0.61};
const longrun_constraints longrun_pendulum = {.scene = {.name = "constrained",
                                                        .n = 2,
                                                        .mass = one_mass,
                                                        .potential = falls,
                                                        .q = one_q,
                                                        .p = one_p,
                                                        .energy_scale = 1},
                                              .m = 1,
                                              .phi = one_rod};

/* scenes/double_pendulum.c */
static jet both_fall(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(9.8125, jet_add(q[1], jet_mul(0.625, q[3])));
}

static void two_rods(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = rod(2, q, NULL, 1);
    value[1] = rod(2, q + 2, q, 0.75);
}

static const double two_masses[] = {1, 1, 0.625, 0.625};
static const double two_q[] = {0.8414709848, -0.5403023059, 0.3302419148, -1.0890689575};
static const double two_p[] = {0.1483038855, 0.2309696168, -0.1288324401, 0.3507254648};
const longrun_constraints longrun_double_pendulum = {.scene = {.name = "constrained",
                                                               .n = 4,
                                                               .mass = two_masses,
                                                               .potential = both_fall,
                                                               .q = two_q,
                                                               .p = two_p,
                                                               .energy_scale = 10},
                                                     .m = 2,
                                                     .phi = two_rods};

/* ---- Water ------------------------------------------------------------------------------------------------------- */

/* Three atoms O, H, H in the field of a charge at the origin, and a soft wall for O. */
static jet field(const jet q[], jet t, void *ctx)
{
    static const double charge[] = {-3, 1.5, 1.5};
    jet V = jet_mul(0.0625, jet_dot(q, q, 3));
    (void)t, (void)ctx;
    for (int a = 0; a < 3; a++)
        V = jet_add(V, jet_div(charge[a], jet_sqrt(jet_add(1, jet_dot(q + 3 * a, q + 3 * a, 3)))));
    return V;
}

/* The bonds of length 1, at 104.52 degrees. */
static void bonds(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = rod(3, q + 3, q, 1);
    value[1] = rod(3, q + 6, q, 1);
    value[2] = rod(3, q + 6, q + 3, 1.5817);
}

static const double water_mass[] = {16, 16, 16, 1, 1, 1, 1, 1, 1};
static const double water_q[] = {2, 0.5, -0.25, 3, 0.5, -0.25, 1.749, 1.468, -0.25};
static const double water_p[] = {-1, 8, 4, 0.3, 1.5, -0.6, -0.2, 0.4, 1.3};
const longrun_constraints longrun_water = {.scene = {.name = "constrained",
                                                     .n = 9,
                                                     .mass = water_mass,
                                                     .potential = field,
                                                     .q = water_q,
                                                     .p = water_p,
                                                     .energy_scale = 1},
                                           .m = 3,
                                           .phi = bonds};

/* ---- Tops -------------------------------------------------------------------------------------------------------- */

/* The masses of directors are (sum of the other two moments - the own one) / 2. */
static const tvi_rigid_body unequal = {.mass = 1.1, .inertia = {1.03, 1.91, 2.37}},
                            symmetric = {.mass = 1.1, .inertia = {0.77, 0.77, 0.53}};
static const tvi_joint pivot = {.kind = TVI_BALL, .other = TVI_WORLD, .point = {0, 0, -0.47}};
static const tvi_rigid euler = {.bodies = 1, .axes = 3, .body = &unequal}, heavy = {.bodies = 1,
                                                                                    .axes = 3,
                                                                                    .body = &symmetric,
                                                                                    .joints = 1,
                                                                                    .joint = &pivot,
                                                                                    .gravity = {0, 0, -3.87}};

static void of_euler(const jet q[], jet t, jet value[], void *ctx)
{
    (void)ctx;
    tvi_rigid_constraint(q, t, value, (void *)&euler);
}

static void of_heavy(const jet q[], jet t, jet value[], void *ctx)
{
    (void)ctx;
    tvi_rigid_constraint(q, t, value, (void *)&heavy);
}

static jet no_weight(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return tvi_rigid_potential(q, t, (void *)&euler);
}

static jet weight(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return tvi_rigid_potential(q, t, (void *)&heavy);
}

static const double euler_mass[] = {1.1, 1.1, 1.1, 1.625, 1.625, 1.625, 0.745, 0.745, 0.745, 0.285, 0.285, 0.285};
static const double heavy_mass[] = {1.1, 1.1, 1.1, 0.265, 0.265, 0.265, 0.265, 0.265, 0.265, 0.505, 0.505, 0.505};

/* omega = (0.9, 0.2, 0.4) about its axes, turned by 0.3 about (1, 0.2, 0). */
static const double euler_q[] = {0,
                                 0,
                                 0,
                                 0.998282173,
                                 0.00858913671,
                                 -0.0579562808,
                                 0.00858913671,
                                 0.957054316,
                                 0.289781404,
                                 0.0579562808,
                                 -0.289781404,
                                 0.955336489};
static const double euler_p[] = {0,
                                 0,
                                 0,
                                 -0.0132528524,
                                 0.716264262,
                                 -0.122126446,
                                 -0.258628401,
                                 -0.196857994,
                                 0.657824088,
                                 0.0546989703,
                                 -0.244994851,
                                 -0.0776324381};
const longrun_constraints longrun_euler_top = {.scene = {.name = "constrained",
                                                         .n = 12,
                                                         .mass = euler_mass,
                                                         .potential = no_weight,
                                                         .q = euler_q,
                                                         .p = euler_p,
                                                         .energy_scale = 0.5},
                                               .m = 6,
                                               .phi = of_euler};

/* omega = (0.3, 0.2, 5), turned by 0.5. */
static const double heavy_q[] = {0.0441908493, -0.220954247, 0.412463804, 0.995291637,  0.023541815,  -0.0940230837,
                                 0.023541815,  0.882290925,  0.470115419, 0.0940230837, -0.470115419, 0.877582562};
static const double heavy_p[] = {0.0992618198, -0.134409099,  -0.0826368883, 0.0262096815, 1.19395159,   0.576391054,
                                 -1.31128658,  -0.0685670807, 0.1943484,     0.0969578704, -0.131289352, -0.0807188174};
const longrun_constraints longrun_heavy_top = {.scene = {.name = "constrained",
                                                         .n = 12,
                                                         .mass = heavy_mass,
                                                         .potential = weight,
                                                         .q = heavy_q,
                                                         .p = heavy_p,
                                                         .energy_scale = 5},
                                               .m = 9,
                                               .phi = of_heavy};
