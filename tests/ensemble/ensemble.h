/* ensemble.h - Declares what the suites of ensembles share: one problem in every form, started everywhere. */
#ifndef TVI_TESTS_ENSEMBLE_H
#define TVI_TESTS_ENSEMBLE_H

#include "tvi.h"

#include <check.h>

Suite *suite_bits(void);
Suite *suite_runs(void);
Suite *suite_failing(void);
Suite *suite_states(void);
Suite *suite_texts(void);
void add_text_format(Suite *suite); /* a case of it */
Suite *suite_refused(void);
Suite *suite_members(void);
Suite *suite_walks(void);

enum { N = 2, MOST = 1000, COLUMNS = 2, ROWS = 2 * N + 1 };

/* V = |q|^2 / 2 + a x^2 y - y^3 / 3, a the parameter of the system, 1 as recorded; what is not separable has masses
 * 1 + x^2 / 8. */
typedef struct {
    const char *name;
    tvi_status (*make)(tvi_system **system);
} form;
extern const form forms[];
extern const int form_count;

typedef struct {
    const char *name;
    int order;
} method;
extern const method methods[];
extern const int method_count;
static const double H = 0.125;

/* Ends the test where it fails. */
tvi_system *system_of(const form *as);
/* Whether the method serves the form. */
bool has_options(const tvi_system *system, const method *by, tvi_options *options);

/* This number of members, of which number k is orbit first + k: all of them bounded, and no two the same. */
typedef struct {
    int members;
    double t[MOST], q[N * MOST], p[N * MOST], D[ROWS * COLUMNS * MOST];
    tvi_status status[MOST];
} group;
void start_group(group *c, int members, int first);
/* A value of the parameter of each. */
void set_values(tvi_ensemble *ensemble, int members, int first);
double value_of(int orbit);

/* Member `a` of one is bit for bit member `b` of the other. */
void expect_same(const char *what, const group *x, int a, const group *y, int b);
/* The largest difference of q and p. */
double distance(const group *x, int a, const group *y, int b);

/* One member, by an integrator of its own. */
typedef struct {
    tvi_integrator *integrator;
    double t, q[N], p[N], D[ROWS * COLUMNS];
} alone;
alone start_alone(const tvi_system *system, const tvi_options *options, int orbit);
void end_alone(alone *a);
/* Makes c the group of this one member. */
group *group_of(const alone *a, group *c);

#define OK(call) ck_assert_msg((call) == TVI_OK, "%s: %s", #call, tvi_last_error())

#endif
