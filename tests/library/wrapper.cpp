/* wrapper.cpp - Tests tvi.hpp: what it makes is what the C functions make, exceptions come out with nothing leaked (it
 * is run under the address sanitizer), and every container with data() and size() holds a state. */
#include "tvi.hpp"

#include <array>
#include <cstdio>
#include <cstring>
#if defined(WITH_EIGEN)
#include <Eigen/Core>
#endif

static int failures;

static void expect(const char *what, bool holds)
{
    if (holds) return;
    failures++;
    std::printf("failed: %s\n", what);
}

/* The status and the text of what the call throws; false where it throws nothing. */
template <class Call> static bool throws(Call call, tvi_status status, const char *text)
{
    try {
        call();
    } catch (const tvi::error &e) {
        return e.status() == status && std::strstr(e.what(), text);
    }
    return false;
}

template <class Call> static bool throws_seven(Call call)
{
    try {
        call();
    } catch (int thrown) {
        return thrown == 7;
    }
    return false;
}

static jet kepler(const jet *q, jet) { return -1 / hypot(q[0], q[1]); }
static jet kepler_in_c(const jet q[], jet t, void *) { return kepler(q, t); }

static void same_bits_as_c()
{
    tvi_system *system = nullptr;
    tvi_integrator *by_c = nullptr;
    double t_c = 0, q_c[] = {1, 0}, p_c[] = {0, 0.8}, t = 0;
    std::vector<double> q = {1, 0}, p = {0, 0.8};
    expect("in C", tvi_system_potential(&system, 2, nullptr, kepler_in_c, nullptr) == TVI_OK &&
                       tvi_integrator_create(&by_c, system, nullptr) == TVI_OK &&
                       tvi_integrate(by_c, 0.25, 100, &t_c, q_c, p_c, nullptr, nullptr) == TVI_OK);
    tvi::integrator orbit{tvi::potential(2, kepler)}; /* keeps the system */
    const double H = orbit.system().energy(t, q, p);
    const double h = tvi::suggest_step(orbit.system(), orbit.options(), t, q, p, -40, 1e-8);
    expect("suggested", h < -0.2 && h > -0.6);
    orbit.integrate(0.25, 100, t, q, p);
    expect("the same bits",
           t == t_c && std::memcmp(q.data(), q_c, sizeof q_c) == 0 && p[0] == p_c[0] && p[1] == p_c[1]);
    expect("energy", std::fabs(orbit.system().energy(t, q, p) - H) < 1e-13);
    tvi_integrator_free(by_c);
    tvi_system_free(system);
}

/* The four statements and a time scale, by lambdas that capture, of one oscillator. */
static void every_system()
{
    const double k = 4, m = 2;
    const std::vector<tvi::system> systems = {
        tvi::force(1, [=](const jet *q, jet, jet *f) { f[0] = -k * q[0]; }, {m}),
        tvi::potential(1, [=](const jet *q, jet) { return 0.5 * k * sqr(q[0]); }, {m}),
        tvi::lagrangian(1, [=](const jet *q, const jet *v, jet) { return 0.5 * (m * sqr(v[0]) - k * sqr(q[0])); }),
        tvi::hamiltonian(1, [=](const jet *q, const jet *p, jet) { return sqr(p[0]) / (2 * m) + 0.5 * k * sqr(q[0]); }),
        tvi::rescaled(tvi::potential(1, [=](const jet *q, jet) { return 0.5 * k * sqr(q[0]); }, {m})),
        tvi::rescaled(tvi::potential(1, [=](const jet *q, jet) { return 0.5 * k * sqr(q[0]); }, {m}),
                      [=](const jet *, const jet *, jet) { return jet(k); }),
    };
    for (const tvi::system &system : systems) {
        double t = 0;
        std::array<double, 1> q = {{1}}, p = {{0}};
        tvi::integrator swing(system, tvi::options("galerkin", 12));
        expect("to the end", swing.integrate_to(0.1, 1, t, q, p));
        expect("cos(w t)", t == 1 && std::fabs(q[0] - std::cos(std::sqrt(k / m))) < 1e-12);
        expect("p = m v", std::fabs(system.velocity(t, q, p)[0] * m - p[0]) < 1e-15);
        expect("and back", std::fabs(system.momentum(t, q, system.velocity(t, q, p))[0] - p[0]) < 1e-15);
    }
}

/* Two bodies on a circle, with adapting steps, and what has no masses. */
static void bodies()
{
    const double mass[] = {1, 3}, turn = std::acos(-1.0); /* at distance 1, angular velocity 2 */
    tvi_bodies pair = tvi_bodies();
    pair.bodies = pair.axes = 2, pair.mass = mass;
    const auto scale = [&](const jet *q, const jet *p, jet t) { return tvi_bodies_scale(q, p, t, &pair); };
    tvi::integrator circle(tvi::rescaled(tvi::gravity(pair), scale));
    double t = 0;
    std::vector<double> q = {-0.75, 0, 0.25, 0}, p = {0, -1.5, 0, 1.5};
    expect("to the end", circle.integrate_to(0.5, turn, t, q, p));
    expect("round", std::fabs(q[0] + 0.75) < 1e-13 && std::fabs(p[3] - 1.5) < 1e-13);
    tvi_orbit orbit = tvi_orbit();
    double x[3], u[3];
    orbit.a = 1, orbit.e = 0.1, orbit.M = 1;
    expect("an orbit", tvi_orbit_state(&orbit, 1, x, u) == TVI_OK && std::fabs(x[0] - 0.36372818) < 1e-8);
    orbit.f = 1;
    expect("two places", tvi_orbit_state(&orbit, 1, x, u) == TVI_EINVAL && std::strstr(tvi_last_error(), "disagree"));
    pair.J2 = 0.01;
    expect("no radius", throws([&] { tvi::gravity flat(pair); }, TVI_EINVAL, "J2 = 0.01 needs the radius"));
    const double negative[] = {1, -0.5};
    pair.mass = negative;
    expect("a mass", throws([&] { tvi::gravity light(pair); }, TVI_EINVAL, "mass[1] = -0.5 is negative"));
    pair.mass = nullptr;
    expect("no masses", throws([&] { tvi::gravity none(pair); }, TVI_EINVAL, "mass is NULL"));
    pair.bodies = -1431655765;
    expect("a count", throws([&] { tvi::gravity wrapped(pair); }, TVI_EINVAL, "bodies = -1431655765 is not"));
}

/* A rod that hangs from a point, with a spring to it, beside the same without one; and what is refused. */
static void rigid()
{
    tvi_rigid_body rod = tvi_rigid_rod(3, 2);
    tvi_joint joint = tvi_joint();
    joint.kind = TVI_BALL, joint.other = TVI_WORLD, joint.point[0] = -1;
    tvi_rigid hung = tvi_rigid();
    hung.bodies = 1, hung.axes = 2, hung.body = &rod, hung.joints = 1, hung.joint = &joint, hung.gravity[1] = -9.8;
    tvi_rigid_motion motion = tvi_rigid_motion();
    motion.point[0] = -1, motion.omega[2] = 0.5;
    std::vector<double> q(4), p(4);
    expect("a state", tvi_rigid_state(&hung, 0, &motion, q.data(), p.data()) == TVI_OK);
    const double stiffness = 7;
    const tvi::rigid plain(hung), sprung(hung, [&](const jet *x, jet) { return 0.5 * stiffness * (x[0] * x[0]); });
    expect("energy", std::fabs(plain.energy(0, q, p) - 0.5) < 1e-15);
    expect("with a spring", std::fabs(sprung.energy(0, q, p) - 4) < 1e-14);
    tvi::integrator run(sprung);
    double t = 0;
    expect("steps", run.integrate(0.05, 100, t, q, p) && std::fabs(sprung.energy(0, q, p) - 4) < 1e-13);
    rod.mass = -3;
    expect("a mass", throws([&] { tvi::rigid light(hung); }, TVI_EINVAL, "body[0].mass = -3 is not positive"));
}

static void errors()
{
    const auto unset = [](const jet *, jet, jet *f) { f[0] = 1; };
    expect("an output", throws([&] { tvi::force(2, unset); }, TVI_EINVAL, "force[1] was not set"));
    expect("a mass", throws([] { tvi::potential(2, kepler, {1, -1}); }, TVI_EINVAL, "mass[1] = -1"));
    expect("masses", throws([] { tvi::potential(2, kepler, {1}); }, TVI_EINVAL, "mass has 1 components, not 2"));
    expect("a name", throws([] { tvi::options("galerkn", 4); }, TVI_EINVAL, "galerkin"));
    tvi::integrator orbit{tvi::potential(2, kepler)};
    double t = 0;
    std::vector<double> q = {0, 0}, p = {1, 1}, wrong(3);
    expect("a domain", throws([&] { orbit.step(0.1, t, q, p); }, TVI_EDOMAIN, "jet_"));
    expect("a size", throws([&] { orbit.step(0.1, t, wrong, p); }, TVI_EINVAL, "q has 3 components"));
    expect("theta", throws([&] { orbit.dense(0.5, q, p); }, TVI_EINVAL, "last step"));
    expect("a state", throws([&] { orbit.load(std::string(400, '\0')); }, TVI_EINVAL, "no state"));
}

/* A callable with memory of its own, which is freed as well. */
static void thrown_by_users()
{
    const std::vector<double> memory(100, 1.0);
    const auto scalar = [memory](const jet *q, jet) -> jet { return memory[99] > 0 ? throw 7 : q[0]; };
    const auto scalars = [memory](const jet *q, const jet *, jet) -> jet { return memory[99] > 0 ? throw 7 : q[0]; };
    const auto force = [memory](const jet *q, jet, jet *f) { f[0] = f[1] = q[0], memory[99] > 0 ? throw 7 : 0; };
    expect("a force", throws_seven([&] { tvi::force(2, force); }));
    expect("a potential", throws_seven([&] { tvi::potential(2, scalar); }));
    expect("a Lagrangian", throws_seven([&] { tvi::lagrangian(2, scalars); }));
    expect("a Hamiltonian", throws_seven([&] { tvi::hamiltonian(2, scalars); }));
    expect("a scale", throws_seven([&] { tvi::rescaled(tvi::potential(2, kepler), scalars); }));
    expect("an event", throws_seven([&] { tvi::event(2, scalars); }));
    tvi::integrator orbit{tvi::potential(2, kepler)};
    double t = 0;
    std::vector<double> q = {1, 0}, p = {0, 0.8};
    const auto third = [memory](long step, double, const double *, const double *) { step == 3 ? throw 7 : 0; };
    expect("an observer", throws_seven([&] { orbit.integrate(0.25, 10, t, q, p, third); }));
    expect("after three steps", t == 0.75);
    const auto any = [memory](int, double, const double *, const double *) { throw 7; };
    const std::vector<tvi::event> events = {tvi::event(2, [](const jet *x, const jet *, jet) { return x[0]; })};
    expect("an event's observer", throws_seven([&] { orbit.integrate_events(0.25, 100, events, t, q, p, any); }));
}

static void runs()
{
    tvi::integrator orbit{tvi::potential(2, kepler)}, other = orbit, fresh(orbit.system());
    double t = 0, t_fresh = 0;
    std::vector<double> q = {1, 0}, p = {0, 0.8}, D = {1, 0, 0, 0}, q_fresh(2), p_fresh(2);
    std::vector<double> seen;
    expect("stopped", !orbit.integrate(0.25, 10, t, q, p, [](long step, double, const double *, const double *) {
        return step == 4;
    }) && t == 1);
    expect(
        "at times", orbit.integrate_at(0.25, {1.5, 2}, t, q, p, [&](long, double at, const double *, const double *) {
            seen.push_back(at);
        }) && seen == std::vector<double>({1.5, 2}));
    const std::vector<tvi::event> events = {tvi::event(
        2, [](const jet *x, const jet *y, jet) { return jet_dot(x, y, 2); }, TVI_EITHER, true)};
    int found = 0;
    expect("an event ends it", !orbit.integrate_events(0.25, 100, events, t, q, p,
                                                       [&](int, double, const double *, const double *) { found++; }));
    expect("once", found == 1 && std::fabs(q[0] * p[0] + q[1] * p[1]) < 1e-13);
    orbit.step_tangent(0.25, t, q, p, D, 1);
    expect("copies share", other.stats().steps == orbit.stats().steps && D[0] != 1);
    fresh.load(orbit.save());
    fresh.last(t_fresh, q_fresh, p_fresh);
    expect("saved", t_fresh == t && q_fresh == q && p_fresh == p);
    const std::string text = orbit.to_text(t, q, p);
    t_fresh = 0, q_fresh[0] = 0;
    fresh.from_text(text, t_fresh, q_fresh, p_fresh);
    expect("as text", t_fresh == t && q_fresh == q && p_fresh == p && fresh.to_text(t, q, p) == text);
    expect("no text", throws([&] { fresh.from_text(text.substr(0, 40), t, q, p); }, TVI_EINVAL, "cut short"));
    tvi::integrator taylor(orbit.system(), tvi::options("taylor", 12));
    expect("tolerance", taylor.integrate_tolerance(1e-10, t + 1, t, q, p));
    expect("with events", !taylor.integrate_tolerance_events(1e-10, t + 10, events, t, q, p,
                                                             [](int, double, const double *, const double *) {}));
}

/* A run to a time with an event, D and an observer of steps. */
static void plans()
{
    tvi::integrator orbit{tvi::potential(2, kepler)}, same(orbit.system());
    const tvi::event radial(2, [](const jet *x, const jet *y, jet) { return jet_dot(x, y, 2); });
    const tvi_event *const events[] = {radial.get()};
    double t = 0, t_same = 0, at_event = 0;
    std::vector<double> q = {1, 0}, p = {0, 0.8}, D = {1, 0, 0, 0}, q_same = q, p_same = p;
    int found = 0, steps = 0;
    tvi_run_plan plan = {};
    plan.h = 0.25, plan.t_end = 3.1, plan.has_t_end = true, plan.events = events, plan.event_count = 1,
    plan.D = D.data(), plan.columns = 1;
    const auto on_event = [&](int member, int which, double, const double *, const double *) {
        found += member == 0 && which == 0;
        at_event = D[0];
    };
    const auto at_step = [&](int, int which, double, const double *, const double *) { steps = which; };
    expect("by a plan", orbit.run(plan, t, q, p, on_event, tvi::detail::no_observer(), at_step) && t == 3.1);
    expect("told", found > 0 && steps == 13 && at_event != 0 && at_event != D[0] && D[0] != 1);
    same.integrate_to(0.25, 3.1, t_same, q_same, p_same);
    expect("its bits", q == q_same && p == p_same);
    plan.t_end = 4;
    expect("as it is", orbit.run(plan, t, q, p) && t == 4);
    const auto seven = [](int, int, double, const double *, const double *) { throw 7; };
    tvi_chaos chaos = {};
    plan.t_end = 20;
    expect("chaos throws", throws_seven([&] { orbit.run_chaos(plan, chaos, t, q, p, seven); }));
    expect("chaos", orbit.run_chaos(plan, chaos, t, q, p) && t == 20 && chaos.steps > 0 && D[0] != 0);
    plan.t_end = 40;
    expect("an event throws", throws_seven([&] { orbit.run(plan, t, q, p, seven); }));
    expect("contradicts", throws([&] { orbit.run(tvi_run_plan(), t, q, p); }, TVI_EINVAL, "h is 0"));
    tvi::ensemble two(orbit.system(), 2);
    std::vector<double> ts(2), qs = {1, 1, 0, 0}, ps = {0, 0, 0.8, 0.8}, Ds(8, 1);
    std::vector<tvi_status> status;
    plan.t_end = 3.1, plan.D = Ds.data(), found = 0;
    const auto count = [&](int, int, double, const double *, const double *) { found++; };
    expect("two", two.run(plan, ts, qs, ps, status, count) && found == 2 && qs[0] == q_same[0] && ts[1] == 3.1);
}

/* V = k q^2/2, k a parameter: its values, the derivative with respect to it, and generated code for it. */
static void parameters_and_code()
{
    const tvi::potential system(1, [](const jet *q, jet) { return 0.5 * jet_parameter(q[0], 0, 4) * sqr(q[0]); });
    const tvi_compiler how = {nullptr, "-O1", ""};
    tvi_options options = tvi::options("galerkin", 12);
    const tvi::compiled code(system, options, &how);
    options.compiled = code.get();
    tvi::integrator swing(system, options);
    double t = 0;
    std::vector<double> q = {1}, p = {0}, D = {0, 0, 1}, none;
    expect("one", system.parameters() == 1 && swing.stats().is_compiled);
    expect("size", throws([&] { swing.set_parameters(none); }, TVI_EINVAL, "parameters has 0 components, not 1"));
    swing.set_parameters({9});
    expect("energy", swing.energy(t, q, p) == 4.5 && system.energy(t, q, p) == 2);
    for (int step = 0; step < 10; step++) swing.step_tangent(0.1, t, q, p, D, 1);
    expect("cos(3 t)", std::fabs(q[0] - std::cos(3.0)) < 1e-12);
    expect("-t sin(3 t) / 6", std::fabs(D[0] + std::sin(3.0) / 6) < 1e-12);
}

/* q'' = -4 q - 2 q': damped. */
static void drives()
{
    const double c = 2;
    double t = 0;
    std::vector<double> q = {1}, p = {-1};
    const tvi::potential spring(1, [](const jet *x, jet) { return 2 * sqr(x[0]); });
    tvi::integrator damped{tvi::driven(spring, [=](const jet *, const jet *v, jet, jet *f) { f[0] = -c * v[0]; })};
    damped.integrate_to(0.1, 1, t, q, p);
    expect("exp(-t) cos(sqrt 3 t)", std::fabs(q[0] - std::exp(-1.0) * std::cos(std::sqrt(3.0))) < 1e-12);
    expect("a drive", throws_seven([&] {
               tvi::driven(spring, [=](const jet *, const jet *, jet, jet *f) { f[0] = c, c > 0 ? throw 7 : 0; });
           }));
}

/* A free particle on a circle, whose radius is a parameter that phi is divided by, too. */
static void constraints()
{
    const double half = 0.5;
    const tvi::potential free(2, [](const jet *, jet) { return jet(0); });
    const auto circle = [=](const jet *x, jet, jet *value) {
        const jet radius = jet_parameter(x[0], 0, 1);
        value[0] = half * (x[0] * x[0] + x[1] * x[1] - sqr(radius)) / radius;
    };
    const tvi::constrained ring(free, 1, circle);
    tvi::integrator moving(ring), wide(ring);
    double t = 0;
    std::vector<double> q = {1, 0}, p = {0, 1}, far = {3, 4}, p_far = {3, 5}, rate, force;
    expect("one", ring.constraints() == 1 && free.constraints() == 0 && ring.parameters() == 1);
    expect("to the end", moving.integrate_to(0.1, 1, t, q, p));
    expect("cos t", std::fabs(q[0] - std::cos(1.0)) < 1e-15 && std::fabs(p[0] + std::sin(1.0)) < 1e-14);
    const std::vector<double> lambda = ring.multipliers(t, q, p, force);
    expect("lambda", lambda.size() == 1 && force.size() == 2 && std::fabs(lambda[0] - 1) < 1e-14);
    expect("its force", std::fabs(force[0] + q[0]) < 1e-14 && std::fabs(force[1] + q[1]) < 1e-14);
    expect("phi", ring.constraint_values(t, far, p_far, rate)[0] == 12 && rate == std::vector<double>({29}));
    wide.set_parameters({10});
    expect("off", throws([&] { wide.step(0.1, t, far, p_far); }, TVI_EINVAL, "phi[0] = -3.75: the state is not"));
    std::vector<double> on = far, p_on = p_far;
    wide.project(t, on, p_on);
    expect("onto the wide one", std::fabs(on[0] - 6) < 1e-14 && std::fabs(p_on[0] + 0.48) < 1e-14);
    expect("is on it", std::fabs(wide.constraint_values(t, on, p_on, rate)[0]) < 1e-13 && std::fabs(rate[0]) < 1e-14);
    expect("its lambda", std::fabs(wide.multipliers(t, on, p_on, force)[0] - 0.036) < 1e-15);
    ring.project(t, far, p_far);
    expect("onto it", std::fabs(far[0] - 0.6) < 1e-15 && std::fabs(p_far[1] - 0.36) < 1e-14);
    rate = {7};
    expect("none", throws([&] { free.multipliers(t, q, p, rate); }, TVI_EUNSUPPORTED, "has no constraints"));
    expect("none, either", throws([&] { free.constraint_values(t, q, p, rate); }, TVI_EUNSUPPORTED, "constraints"));
    expect("as it was", rate == std::vector<double>({7}));
    expect("two", throws([&] { tvi::constrained(free, 2, circle); }, TVI_EINVAL, "m = n = 2"));
    expect("twice", throws([&] { tvi::constrained(ring, 1, circle); }, TVI_EUNSUPPORTED, "constrained"));
    expect("a constraint", throws_seven([&] {
               tvi::constrained(free, 1, [=](const jet *x, jet, jet *v) { v[0] = x[0], half > 0 ? throw 7 : 0; });
           }));
}

static bool same_bits(const std::vector<double> &a, const double b[])
{
    return std::memcmp(a.data(), b, a.size() * sizeof *b) == 0;
}

/* Three orbits of Kepler; q and p are [2][3]. */
static void ensembles()
{
    enum { MEMBERS = 3 };
    const std::vector<double> zero(MEMBERS), q0 = {1, 1.5, 2, 0, 0, 0}, p0 = {0, 0, 0, 0.8, 0.7, 0.6};
    double t_c[MEMBERS] = {0}, q_c[] = {1, 1.5, 2, 0, 0, 0}, p_c[] = {0, 0, 0, 0.8, 0.7, 0.6};
    tvi_status status_c[MEMBERS];
    tvi_ensemble *by_c = nullptr;
    tvi::ensemble crowd(tvi::potential(2, kepler), MEMBERS), other = crowd; /* they keep the system */
    expect("in C", tvi_ensemble_create(&by_c, crowd.system().get(), nullptr, MEMBERS, 0) == TVI_OK &&
                       tvi_ensemble_integrate(by_c, 0.25, 100, t_c, q_c, p_c, status_c, nullptr, nullptr) == TVI_OK);
    tvi_ensemble_free(by_c);
    std::vector<double> t = zero, q = q0, p = p0;
    std::vector<tvi_status> status;
    expect("all steps", crowd.integrate(0.25, 100, t, q, p, status) && crowd.members() == MEMBERS);
    expect("the same bits", same_bits(t, t_c) && same_bits(q, q_c) && same_bits(p, p_c) && status[2] == TVI_OK);
    expect("copies share", other.stats().steps == 3 * 100);
    expect("no steps", crowd.integrate(0.25, 0, t, q, p, status) && same_bits(t, t_c));
    t = zero, q = q0, p = p0;
    long steps = 0;
    expect("stopped", !crowd.integrate(0.25, 10, t, q, p, status,
                                       [&](long step, int, const double *, const double *, const double *,
                                           const tvi_status *) { return (steps = step) == 4; }) &&
                          steps == 4 && t[2] == 1);
    expect("to a time", crowd.integrate_to(0.25, 1.6, t, q, p, status) && t[0] == 1.6 && t[2] == 1.6);
    tvi::ensemble fresh(crowd.system(), MEMBERS, tvi_options_default(), 1);
    std::vector<double> t_fresh(3), q_fresh(6), p_fresh(6);
    const std::string saved = crowd.save();
    fresh.load(saved);
    fresh.last(t_fresh, q_fresh, p_fresh, status);
    expect("saved", t_fresh == t && q_fresh == q && p_fresh == p && fresh.save() == saved);
    expect("cut short", throws([&] { fresh.load(saved.substr(0, saved.size() - 2)); }, TVI_EINVAL, "state"));
    expect("longer", throws([&] { fresh.load(saved + "end"); }, TVI_EINVAL, ""));
    expect("and left as it was", fresh.save() == saved);
    fresh.member_from_text(1, crowd.member_to_text(2, t, q, p), t_fresh, q_fresh, p_fresh);
    expect("as text", q_fresh[1] == q[2] && q_fresh[2] == q[2] && q_fresh[0] == q[0] && p_fresh[4] == p[5]);
    int seen[MEMBERS] = {0};
    const auto count = [&](int member, int, double, const double *, const double *) { seen[member]++; };
    expect("at times", crowd.integrate_at(0.25, {2, 2.5}, t, q, p, status, count) && seen[0] == 2 && seen[2] == 2);
    const std::vector<tvi::event> events = {tvi::event(
        2, [](const jet *x, const jet *y, jet) { return jet_dot(x, y, 2); }, TVI_EITHER, true)};
    expect("events end members", crowd.integrate_events(0.25, 100, events, t, q, p, status, count) && seen[1] == 3 &&
                                     status[0] == TVI_ESTOPPED && status[2] == TVI_ESTOPPED);
    tvi::ensemble taylor(crowd.system(), MEMBERS, tvi::options("taylor", 12));
    expect("tolerance", taylor.integrate_tolerance(1e-10, 9, t, q, p, status) && t[1] == 9);
}

static void errors_of_ensembles()
{
    const tvi::potential spring(1, [](const jet *x, jet) { return 0.5 * jet_parameter(x[0], 0, 4) * sqr(x[0]); });
    tvi::ensemble crowd(spring, 2);
    std::vector<double> t(2), q = {1, 1}, p(2), wrong(3);
    std::vector<tvi_status> status;
    const auto throwing = [](int, int, double, const double *, const double *) { throw 7; };
    const auto third = [](long step, int, const double *, const double *, const double *, const tvi_status *) {
        step == 3 ? throw 7 : 0;
    };
    expect("members", throws([&] { tvi::ensemble(spring, 0); }, TVI_EINVAL, "members = 0"));
    expect("a size", throws([&] { crowd.integrate(0.1, 1, t, wrong, p, status); }, TVI_EINVAL, "q has 3 components"));
    expect("its size", throws([&] { crowd.set_parameters({9}); }, TVI_EINVAL, "parameters has 1 components, not 2"));
    expect("not \"taylor\"",
           throws([&] { crowd.integrate_tolerance(1e-8, 1, t, q, p, status); }, TVI_EUNSUPPORTED, "taylor"));
    crowd.set_parameters({9, 16});
    crowd.integrate(0.1, 10, t, q, p, status);
    expect("cos(3 t), cos(4 t)", std::fabs(q[0] - std::cos(3.0)) < 1e-12 && std::fabs(q[1] - std::cos(4.0)) < 1e-12);
    expect("an observer", throws_seven([&] { crowd.integrate(0.1, 10, t, q, p, status, third); }));
    expect("at a time", throws_seven([&] { crowd.integrate_at(0.1, {2, 3}, t, q, p, status, throwing); }));
    const std::vector<tvi::event> events = {tvi::event(1, [](const jet *x, const jet *, jet) { return x[0]; })};
    expect("at an event", throws_seven([&] { crowd.integrate_events(0.1, 100, events, t, q, p, status, throwing); }));
}

/* A spring of k = 4: q = cos 2t, so that dq(1)/dk = -sin(2) / 4. */
static void gradients()
{
    const tvi::potential spring(1, [](const jet *q, jet) { return 0.5 * jet_parameter(q[0], 0, 4) * pow(q[0], 2); });
    tvi::integrator orbit(spring);
    tvi::record record(orbit);
    record.integral([](const jet *, const jet *p, jet) { return pow(p[0], 2); });
    std::vector<double> q = {1}, p = {0}, end = {1, 0, 0}, by_integrals = {0};
    double t = 0;
    tvi_run_plan plan = {};
    plan.h = 0.05, plan.has_t_end = true, plan.t_end = 1;
    plan.record = record.get();
    expect("a recorded run", orbit.run(plan, t, q, p) && record.steps() == 20 && record.times() == 0);
    tvi_loss loss = {};
    loss.end = end.data(), loss.integrals = by_integrals.data();
    const tvi::record::gradient_of_loss by = record.gradient(loss);
    expect("by the start", std::fabs(by.start[0] - std::cos(2.0)) < 1e-13 && by.start.size() == 3);
    expect("by k", std::fabs(by.parameters[0] + std::sin(2.0) / 4) < 1e-13);
    expect("an integral", std::fabs(record.integrals()[0] - (2 - std::sin(4.0) / 2)) < 1e-12);
    expect("bytes", record.bytes() > 20 * 6 * sizeof(double) && record.events() == 0);
    expect("a callable that throws",
           throws_seven([&] { record.integral([](const jet *, const jet *, jet) -> jet { throw 7; }); }));
    const tvi::record to(std::move(record));
    expect("moved from",
           throws([&] { static_cast<void>(record.gradient(loss)); }, TVI_EINVAL, "NULL") && to.steps() == 20);
}

/* The second derivative of cos(sqrt(k) t) by k, at k = 4 and t = 1. */
static void second_derivatives()
{
    const tvi::potential spring(1, [](const jet *q, jet) { return 0.5 * jet_parameter(q[0], 0, 4) * pow(q[0], 2); });
    const tvi::tangent lifted(spring);
    tvi::integrator orbit(lifted);
    tvi::record record(orbit);
    std::vector<double> q = {1, 0}, p = {0, 0}, by_dq = {0, 1, 0, 0, 0};
    double t = 0;
    tvi_run_plan plan = {};
    plan.h = 0.05, plan.has_t_end = true, plan.t_end = 1;
    plan.record = record.get();
    orbit.set_parameters({4, 1});
    expect("a tangent vector", orbit.run(plan, t, q, p) && std::fabs(q[1] + std::sin(2.0) / 4) < 1e-13);
    tvi_loss loss = {};
    loss.end = by_dq.data();
    const double twice = record.gradient(loss).parameters[0];
    expect("by k twice", std::fabs(twice + (2 * std::cos(2.0) - std::sin(2.0)) / 32) < 1e-13);
}

/* Members of an object that was moved from throw, or return what nothing has. */
static void moved_from()
{
    tvi::potential spring(1, [](const jet *q, jet) { return pow(q[0], 2); });
    tvi::integrator from(spring), to(std::move(from));
    tvi::ensemble many(spring, 2), others(std::move(many));
    std::vector<double> q = {1}, p = {0};
    double t = 0;
    expect("stats", throws([&] { static_cast<void>(from.stats()); }, TVI_EINVAL, "moved"));
    expect("options", throws([&] { static_cast<void>(from.options()); }, TVI_EINVAL, "moved"));
    expect("step", throws([&] { from.step(0.1, t, q, p); }, TVI_EINVAL, ""));
    expect("save", throws([&] { static_cast<void>(from.save()); }, TVI_EINVAL, "NULL"));
    expect("to_text", throws([&] { static_cast<void>(from.to_text(t, q, p)); }, TVI_EINVAL, ""));
    expect("energy", throws([&] { static_cast<void>(from.energy(t, q, p)); }, TVI_EINVAL, ""));
    expect("stats of many", throws([&] { static_cast<void>(many.stats()); }, TVI_EINVAL, "NULL"));
    from.reset();
    many.reset();
    expect("where it went", to.stats().steps == 0 && others.stats().steps == 0);
}

static void powers()
{
    using std::atan2; /* as generic code does */
    using std::hypot;
    using std::pow;
    using std::sin;
    const jet x = 3;
    expect("found", pow(x, 2).number == 9 && pow(2, x).number > 7.9 && hypot(x, 4).number == 5 && pow(2, 3) == 8 &&
                        sin(jet(0)).number == 0 && atan2(0, x).number == 0 && sin(0.0f) == 0 && hypot(3, 4) == 5);
    expect("2^x", std::fabs(pow(2, x).number - 8) < 1e-14 && std::fabs(pow(2.0f, x).number - 8) < 1e-14);
    expect("x^x", std::fabs(pow(x, x).number - 27) < 1e-13);
    expect("x^2", pow(x, 2).number == 9 && pow(x, 2.0).number == 9);
    expect("(-1)^x",
           throws([] { tvi::potential(1, [](const jet *q, jet) { return pow(-1, q[0]); }); }, TVI_EDOMAIN, "jet_log"));
}

static void eigen()
{
#if defined(WITH_EIGEN)
    double t = 0;
    Eigen::Vector2d q(1, 0), p(0, 0.8);
    Eigen::VectorXd longer(3);
    tvi::integrator orbit{tvi::potential(2, kepler)};
    orbit.integrate(0.25, 100, t, q, p);
    expect("Eigen", std::fabs(orbit.system().energy(t, q, p) + 0.68) < 1e-13 && q.norm() > 0.4);
    expect("Eigen's size", throws([&] { orbit.step(0.25, t, longer, p); }, TVI_EINVAL, "q has 3"));
#endif
}

int main()
{
    same_bits_as_c();
    every_system();
    bodies();
    rigid();
    errors();
    thrown_by_users();
    runs();
    parameters_and_code();
    drives();
    constraints();
    plans();
    ensembles();
    errors_of_ensembles();
    gradients();
    second_derivatives();
    moved_from();
    powers();
    eigen();
    return failures != 0;
}
