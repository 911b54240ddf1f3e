"""Declares to cffi what the module uses of the headers of libtvi; tests/python/test_declarations.py compares both."""

# Enumerations are ints here; the functions below are declared to the letter as in the headers.
STRUCTURES = """
typedef int jet_function;
typedef int jet_function2;
typedef int tvi_status;
typedef int tvi_direction;
typedef struct { double number; void *node; } jet;

typedef struct tvi_system tvi_system;
typedef struct tvi_compiled tvi_compiled;
typedef struct tvi_integrator tvi_integrator;
typedef struct tvi_event tvi_event;
typedef struct tvi_ensemble tvi_ensemble;
typedef struct tvi_record tvi_record;

typedef struct {
    int method, expansion, nodes;
    int order, degree;
    bool compose_adjoint;
    int quadrature, quadrature_points;
    double tolerance;
    int passes, max_passes;
    double max_tail;
    const tvi_compiled *compiled;
} tvi_options;

typedef struct { const char *compiler, *flags, *cache; } tvi_compiler;

typedef struct {
    long steps, passes, expansions, force_evaluations, factorisations;
    double residual, tail, largest_tail, largest_defect;
    size_t bytes;
    bool is_compiled;
} tvi_stats;

typedef int tvi_ensemble_observer(long step, int members, const double t[], const double q[], const double p[],
                                  const tvi_status status[], void *ctx);
typedef int tvi_member_observer(int member, int which, double t, const double q[], const double p[], void *ctx);

typedef struct {
    double h, tolerance;
    long steps;
    double t_end;
    bool has_t_end;
    const double *times;
    int time_count;
    const tvi_event *const *events;
    int event_count;
    double *D;
    int columns;
    tvi_ensemble_observer *observer;
    tvi_member_observer *at_time, *on_event;
    void *ctx;
    double largest_step;
    tvi_member_observer *at_step;
    tvi_record *record;
    bool columns_at_once;
    size_t size;
} tvi_run_plan;

typedef struct {
    double lyapunov, megno, y, growth, time, t_start;
    long steps;
    size_t size;
} tvi_chaos;

typedef struct {
    const double *end, *at_times, *at_events, *integrals;
    size_t size;
} tvi_loss;

typedef struct {
    int bodies, axes;
    const double *mass;
    double G, softening, J2, radius, pole[3];
    int oblate;
    double sharpness;
} tvi_bodies;

typedef struct {
    double a, q, e, i, node, pericentre, time, f, M, mean_longitude, longitude_of_pericentre;
} tvi_orbit;

typedef struct { double mass, inertia[3]; } tvi_rigid_body;

typedef struct {
    int kind;
    int body, other;
    double point[3], other_point[3], axis[3], other_axis[3], length;
} tvi_joint;

typedef struct {
    int bodies, axes;
    const tvi_rigid_body *body;
    int joints;
    const tvi_joint *joint;
    double gravity[3];
} tvi_rigid;

typedef struct { double place[3], velocity[3], quaternion[4], omega[3], point[3]; } tvi_rigid_motion;

typedef void tvi_force_fn(const jet q[], jet t, jet force[], void *ctx);
typedef jet tvi_potential_fn(const jet q[], jet t, void *ctx);
typedef jet tvi_lagrangian_fn(const jet q[], const jet v[], jet t, void *ctx);
typedef jet tvi_hamiltonian_fn(const jet q[], const jet p[], jet t, void *ctx);
typedef jet tvi_rescale_fn(const jet q[], const jet p[], jet t, void *ctx);
typedef jet tvi_event_fn(const jet q[], const jet p[], jet t, void *ctx);
typedef void tvi_drive_fn(const jet q[], const jet v[], jet t, jet force[], void *ctx);
typedef void tvi_constraint_fn(const jet q[], jet t, jet value[], void *ctx);
"""

JETS = """
jet jet_record_add(jet a, jet b);
jet jet_record_sub(jet a, jet b);
jet jet_record_mul(jet a, jet b);
jet jet_record_div(jet a, jet b);
jet jet_record_pow(jet a, double c);
jet jet_record_function(jet_function f, jet a);
jet jet_record_function2(jet_function2 f, jet a, jet b);
jet jet_parameter(jet of_recording, int index, double value);
"""

SYSTEMS = """
const char *tvi_version(void);
const char *tvi_status_string(tvi_status status);
const char *tvi_last_error(void);
tvi_status tvi_system_force(tvi_system **out, int n, const double mass[], tvi_force_fn *force, void *ctx);
tvi_status tvi_system_potential(tvi_system **out, int n, const double mass[], tvi_potential_fn *potential, void *ctx);
tvi_status tvi_system_lagrangian(tvi_system **out, int n, tvi_lagrangian_fn *lagrangian, void *ctx);
tvi_status tvi_system_hamiltonian(tvi_system **out, int n, tvi_hamiltonian_fn *hamiltonian, void *ctx);
tvi_status tvi_system_rescaled(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g, void *ctx);
tvi_status tvi_system_rescaled_reversible(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g, void *ctx);
tvi_status tvi_system_driven(tvi_system **out, const tvi_system *system, tvi_drive_fn *drive, void *ctx);
tvi_status tvi_system_constrained(tvi_system **out, const tvi_system *system, int m, tvi_constraint_fn *constraint,
                                  void *ctx);
void tvi_system_free(tvi_system *system);
int tvi_system_parameters(const tvi_system *system);
int tvi_system_constraints(const tvi_system *system);
tvi_status tvi_energy(const tvi_system *system, double t, const double q[], const double p[], double *H);
tvi_status tvi_momentum(const tvi_system *system, double t, const double q[], const double v[], double p[]);
tvi_status tvi_velocity(const tvi_system *system, double t, const double q[], const double p[], double v[]);
tvi_status tvi_project(const tvi_system *system, double t, double q[], double p[]);
tvi_status tvi_constraint_values(const tvi_system *system, double t, const double q[], const double p[], double value[],
                                 double rate[]);
tvi_status tvi_multipliers(const tvi_system *system, double t, const double q[], const double p[], double lambda[],
                           double force[]);
tvi_status tvi_event_create(tvi_event **out, int n, tvi_direction direction, bool terminal, tvi_event_fn *g, void *ctx);
void tvi_event_free(tvi_event *event);
"""

METHODS = """
tvi_status tvi_options_named(const char *name, int order, tvi_options *options);
tvi_status tvi_options_check(const tvi_system *system, const tvi_options *options, const char **why);
tvi_status tvi_compile(tvi_compiled **out, const tvi_system *system, const tvi_options *options,
                       const tvi_compiler *how);
tvi_status tvi_compiled_write(const tvi_system *system, const tvi_options *options, const char *name, const char *path);
void tvi_compiled_free(tvi_compiled *compiled);
int tvi_taylor_order(double tolerance);
tvi_status tvi_measure_step(const tvi_system *system, const tvi_options *options, const tvi_run_plan *plan, double t,
                            const double q[], const double p[], double error, double *h, double *measured);
"""

INTEGRATORS = """
tvi_status tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const tvi_options *options);
void tvi_integrator_free(tvi_integrator *integrator);
const tvi_options *tvi_integrator_options(const tvi_integrator *integrator);
tvi_status tvi_integrator_set_parameters(tvi_integrator *integrator, const double value[]);
tvi_status tvi_integrator_energy(const tvi_integrator *integrator, double t, const double q[], const double p[],
                                 double *H);
tvi_status tvi_integrator_momentum(const tvi_integrator *integrator, double t, const double q[], const double v[],
                            double p[]);
tvi_status tvi_integrator_velocity(const tvi_integrator *integrator, double t, const double q[], const double p[],
                            double v[]);
tvi_status tvi_integrator_project(const tvi_integrator *integrator, double t, double q[], double p[]);
tvi_status tvi_integrator_constraint_values(const tvi_integrator *integrator, double t, const double q[],
                                            const double p[], double value[], double rate[]);
tvi_status tvi_integrator_multipliers(const tvi_integrator *integrator, double t, const double q[], const double p[],
                                      double lambda[], double force[]);
tvi_status tvi_step(tvi_integrator *integrator, double h, double *t, double q[], double p[]);
tvi_status tvi_step_tangent(tvi_integrator *integrator, double h, double *t, double q[], double p[], double D[],
                            int columns);
tvi_status tvi_dense(tvi_integrator *integrator, double theta, double q[], double p[]);
tvi_status tvi_run(tvi_integrator *integrator, const tvi_run_plan *plan, double *t, double q[], double p[]);
tvi_status tvi_run_chaos(tvi_integrator *integrator, const tvi_run_plan *plan, tvi_chaos *chaos, double *t, double q[],
                         double p[]);
void tvi_integrator_reset(tvi_integrator *integrator);
const tvi_stats *tvi_integrator_stats(const tvi_integrator *integrator);
tvi_status tvi_state_peek(const char *text, size_t size, int *n, double *t, double q[], double p[]);
tvi_status tvi_state_to_text(const tvi_integrator *integrator, double t, const double q[], const double p[], char *text,
                             size_t *size);
tvi_status tvi_state_from_text(tvi_integrator *integrator, const char *text, size_t size, double *t, double q[],
                               double p[]);
"""

GRADIENTS = """
tvi_status tvi_record_create(tvi_record **out, const tvi_integrator *integrator, size_t bytes);
void tvi_record_free(tvi_record *record);
long tvi_record_counts(const tvi_record *record, int *times, int *events);
tvi_status tvi_record_integral(tvi_record *record, tvi_event_fn *l, void *ctx);
void tvi_record_integrals(const tvi_record *record, double value[]);
tvi_status tvi_gradient(tvi_record *record, const tvi_loss *loss, double by_start[], double by_parameters[]);
tvi_status tvi_system_tangent(tvi_system **out, const tvi_system *system, const double rates[]);
"""

ENSEMBLES = """
tvi_status tvi_ensemble_create(tvi_ensemble **out, const tvi_system *system, const tvi_options *options, int members,
                        int threads);
void tvi_ensemble_free(tvi_ensemble *ensemble);
tvi_status tvi_ensemble_set_parameters(tvi_ensemble *ensemble, const double value[]);
void tvi_ensemble_reset(tvi_ensemble *ensemble);
tvi_status tvi_ensemble_run(tvi_ensemble *ensemble, const tvi_run_plan *plan, double t[], double q[], double p[],
                     tvi_status status[]);
tvi_status tvi_ensemble_stats(const tvi_ensemble *ensemble, tvi_stats *stats);
tvi_status tvi_ensemble_member_to_text(const tvi_ensemble *ensemble, int member, const double t[], const double q[],
                                       const double p[], char *text, size_t *size);
tvi_status tvi_ensemble_member_from_text(tvi_ensemble *ensemble, int member, const char *text, size_t size, double t[],
                                         double q[], double p[]);
"""

BODIES = """
tvi_status tvi_bodies_check(const tvi_bodies *b);
jet tvi_bodies_potential(const jet q[], jet t, void *ctx);
jet tvi_bodies_scale(const jet q[], const jet p[], jet t, void *ctx);
jet tvi_bodies_field(const tvi_bodies *b, const jet at[], const jet x[]);
jet tvi_bodies_field_scale(const tvi_bodies *b, const jet at[], const jet x[]);
void tvi_bodies_masses(const tvi_bodies *b, double mass[]);
void tvi_bodies_momenta(const tvi_bodies *b, const double v[], double p[]);
void tvi_bodies_velocities(const tvi_bodies *b, const double p[], double v[]);
void tvi_bodies_centre(const tvi_bodies *b, const double q[], const double p[], double x[], double v[]);
void tvi_bodies_to_centre(const tvi_bodies *b, double q[], double p[]);
void tvi_bodies_angular_momentum(const tvi_bodies *b, const double q[], const double p[], double L[3]);
tvi_status tvi_orbit_state(const tvi_orbit *orbit, double mu, double x[3], double v[3]);
tvi_status tvi_orbit_of(double mu, const double x[3], const double v[3], tvi_orbit *orbit);
"""

RIGID = """
tvi_rigid_body tvi_rigid_sphere(double mass, double radius);
tvi_rigid_body tvi_rigid_box(double mass, double a, double b, double c);
tvi_rigid_body tvi_rigid_cylinder(double mass, double radius, double height);
tvi_rigid_body tvi_rigid_disc(double mass, double radius);
tvi_rigid_body tvi_rigid_rod(double mass, double length);
tvi_status tvi_rigid_check(const tvi_rigid *r);
int tvi_rigid_dimension(const tvi_rigid *r);
int tvi_rigid_constraints(const tvi_rigid *r);
int tvi_rigid_first(const tvi_rigid *r, int body);
int tvi_rigid_joint(const tvi_rigid *r, int joint);
void tvi_rigid_masses(const tvi_rigid *r, double mass[]);
jet tvi_rigid_potential(const jet q[], jet t, void *ctx);
void tvi_rigid_constraint(const jet q[], jet t, jet value[], void *ctx);
void tvi_rigid_point(const tvi_rigid *r, const jet q[], int body, const double X[], jet x[]);
void tvi_rigid_place(const tvi_rigid *r, const double q[], int body, const double X[], double x[]);
void tvi_rigid_force(const tvi_rigid *r, const jet q[], int body, const double X[], const jet F[], jet force[]);
void tvi_rigid_torque(const tvi_rigid *r, const jet q[], int body, const jet torque[3], jet force[]);
tvi_status tvi_rigid_state(const tvi_rigid *r, int body, const tvi_rigid_motion *motion, double q[], double p[]);
tvi_status tvi_rigid_of(const tvi_rigid *r, int body, const double q[], const double p[], tvi_rigid_motion *motion);
void tvi_rigid_turn(const double axis[3], double angle, double quaternion[4]);
void tvi_rigid_angular_momentum(const tvi_rigid *r, const double q[], const double p[], double L[3]);
"""

FUNCTIONS = JETS + SYSTEMS + METHODS + INTEGRATORS + GRADIENTS + ENSEMBLES + BODIES + RIGID
