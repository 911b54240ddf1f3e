/* rigid.h - Declares what rigid.c knows of the coordinates of a rigid body, for motion.c. */
#ifndef TVI_SRC_SYSTEM_RIGID_H
#define TVI_SRC_SYSTEM_RIGID_H

#include "refusal.h"
#include "tvi_rigid.h"

/* What the coordinates of a body are. */
typedef struct {
    int start, count, end; /* the first one, the number of directors, and the first one behind */
    int at[3];             /* where the director of each axis begins; -1: it is left out */
    double E[3];           /* the second moments of mass along the axes */
} rigid_layout;

rigid_layout tvi_rigid_layout(const tvi_rigid *r, int body);

/* Tells whether the body knows where its own axis k points: a line knows this only of itself. */
bool tvi_rigid_has_axis(const tvi_rigid *r, int body, int k);

/* A vector of space. Of the plane its third component is 0. */
typedef struct {
    jet x[3];
} jet_vector;

/* The unit vector along the body's axis k: its director, or the product of the other two. */
jet_vector tvi_rigid_director(const tvi_rigid *r, const jet q[], int body, int k);

/* Counts the directors among the coordinates that turn with an angular velocity about axis k. */
static inline int rigid_turning(const rigid_layout *layout, int k)
{
    return (layout->at[(k + 1) % 3] >= 0) + (layout->at[(k + 2) % 3] >= 0);
}

#endif
