/* gravity.h - bodies that attract each other with G = 1, body i at q[axes i], ..., q[axes i + axes - 1]. */
#ifndef GRAVITY_H
#define GRAVITY_H

#include "tvi.h"

enum { GRAVITY_BODIES_MAX = 8 };

/* V = -sum_{i<j} m_i m_j / |q_i - q_j|. */
jet gravity_potential(const jet q[], int bodies, int axes, const double mass[]);
/* The time scale of the closest pairs: g = (sum_{i<j} (m_i + m_j) / |q_i - q_j|^3)^(-1/2). */
jet gravity_scale(const jet q[], int bodies, int axes, const double mass[]);

#endif
