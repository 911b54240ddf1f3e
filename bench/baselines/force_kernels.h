/* force_kernels.h - Computes the scenes' accelerations a = M^-1 F(q) by hand, at LANES points at once: q and a are
 * [n][LANES].
 *
 * Included once for each number of LANES that a file needs, 1 for an ordinary force. The loop over the lanes is the
 * innermost everywhere and has no branch, so that the compiler makes it vectors. */
#define KERNEL_JOIN_(name, lanes) name##_##lanes
#define KERNEL_JOIN(name, lanes)  KERNEL_JOIN_(name, lanes)
#define KERNEL(name)              KERNEL_JOIN(name, LANES)

/* a = -g sin q. */
static INLINE void KERNEL(pendulum)(const double *restrict q, double *restrict a)
{
    FOR_EACH_LANE(l, LANES) a[l] = -PENDULUM_G * sin(q[l]);
}

/* a = -q / r^3. */
static INLINE void KERNEL(kepler)(const double *restrict q, double *restrict a)
{
    FOR_EACH_LANE(l, LANES) {
        const double x = q[l], y = q[LANES + l], r2 = x * x + y * y, w = -1 / (r2 * sqrt(r2));
        a[l] = w * x;
        a[LANES + l] = w * y;
    }
}

/* a = (-x - 2 x y, -y - x^2 + y^2). */
static INLINE void KERNEL(henon_heiles)(const double *restrict q, double *restrict a)
{
    FOR_EACH_LANE(l, LANES) {
        const double x = q[l], y = q[LANES + l];
        a[l] = -x - 2 * x * y;
        a[LANES + l] = y * y - y - x * x;
    }
}

/* a_i = T_i - T_{i-1}, T_i = 4 d_i^3 for even i and w^2/2 d_i for odd i, d_i = q_{i+1} - q_i, i = 0..6, q_0 = q_7 =
 * 0. */
static INLINE void KERNEL(fpu)(const double *restrict q, double *restrict a)
{
    FOR_EACH_LANE(l, LANES) {
        double left = 4 * q[l] * q[l] * q[l];
        for (int i = 0; i < 6; i++) {
            const double d = (i < 5 ? q[(i + 1) * LANES + l] : 0) - q[i * LANES + l];
            const double right = i % 2 == 0 ? FPU_W * FPU_W / 2 * d : 4 * d * d * d;
            a[i * LANES + l] = right - left;
            left = right;
        }
    }
}

/* Accelerations that two bodies give each other: a_i -= G m_j d / |d|^3, a_j += G m_i d / |d|^3, d = q_i - q_j. */
static INLINE void KERNEL(attract)(double gmi, double gmj, const double *restrict qi, const double *restrict qj,
                                   double *restrict ai, double *restrict aj)
{
    FOR_EACH_LANE(l, LANES) {
        const double x = qi[l] - qj[l], y = qi[LANES + l] - qj[LANES + l], z = qi[2 * LANES + l] - qj[2 * LANES + l];
        const double r2 = x * x + y * y + z * z, w = 1 / (r2 * sqrt(r2)), wi = gmi * w, wj = gmj * w;
        ai[l] -= wj * x, ai[LANES + l] -= wj * y, ai[2 * LANES + l] -= wj * z;
        aj[l] += wi * x, aj[LANES + l] += wi * y, aj[2 * LANES + l] += wi * z;
    }
}

static INLINE void KERNEL(solar)(const double *restrict q, double *restrict a)
{
    for (int k = 0; k < 18 * LANES; k++) a[k] = 0;
    for (int i = 1; i < 6; i++)
        for (int j = 0; j < i; j++) {
            const double *qi = q + 3 * i * LANES, *qj = q + 3 * j * LANES;
            double *ai = a + 3 * i * LANES, *aj = a + 3 * j * LANES;
            KERNEL(attract)(SOLAR_G * SOLAR_MASS[i], SOLAR_G * SOLAR_MASS[j], qi, qj, ai, aj);
        }
}
