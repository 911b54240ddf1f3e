/* thrown.cpp - Tests exceptions that leave observers of the C functions: they come out, nothing is leaked (it is run
 * under the address sanitizer), and the integrator or the ensemble goes on from what it has reached. */
#include "tvi_runs.h"

#include <cstdio>
#include <initializer_list>
#include <thread>
#include <vector>

static int failures;

static void expect(const char *what, bool holds)
{
    if (holds) return;
    failures++;
    std::printf("failed: %s\n", what);
}

static jet kepler(const jet q[], jet, void *) { return -1 / hypot(q[0], q[1]); }
static jet radial(const jet q[], const jet p[], jet, void *) { return q[0] * p[0] + q[1] * p[1]; }

static bool is_thrown;

/* Throws in the thread of the test, unless other threads have run all members before: an exception of another thread
 * would end the program. */
static int throw_seven(int, int, double, const double[], const double[], void *ctx)
{
    if (std::this_thread::get_id() != *static_cast<std::thread::id *>(ctx)) return 0;
    is_thrown = true;
    throw 7;
}

template <class Call> static bool throws_seven(Call call)
{
    try {
        (void)call();
    } catch (int thrown) {
        return thrown == 7;
    }
    return false;
}

static std::vector<tvi_run_plan> list_plans(const tvi_event *const events[], const double times[], void *ctx)
{
    std::vector<tvi_run_plan> plans(3);
    for (tvi_run_plan &plan : plans) plan.h = 0.25, plan.ctx = ctx;
    plans[0].steps = 5000, plans[0].at_step = throw_seven;
    plans[1].t_end = 1000, plans[1].has_t_end = true, plans[1].events = events, plans[1].event_count = 1,
    plans[1].on_event = throw_seven;
    plans[2].times = times, plans[2].time_count = 2, plans[2].at_time = throw_seven;
    return plans;
}

static void leave_integrators(const tvi_system *system, const std::vector<tvi_run_plan> &plans)
{
    for (const tvi_run_plan &plan : plans) {
        tvi_integrator *integrator = nullptr;
        double t = 0, q[] = {1, 0}, p[] = {0, 0.8};
        expect("an integrator", tvi_integrator_create(&integrator, system, nullptr) == TVI_OK);
        expect("it is thrown", throws_seven([&] { return tvi_run(integrator, &plan, &t, q, p); }));
        expect("a step was made", t > 0);
        expect("steps go on", tvi_step(integrator, 0.25, &t, q, p) == TVI_OK);
        tvi_integrator_free(integrator);
    }
}

static void leave_ensembles(const tvi_system *system, const std::vector<tvi_run_plan> &plans)
{
    enum { MEMBERS = 5 };
    for (int threads : {1, 3})
        for (const tvi_run_plan &plan : plans) {
            tvi_ensemble *ensemble = nullptr;
            tvi_stats stats;
            double t[MEMBERS] = {0}, q[2 * MEMBERS], p[2 * MEMBERS];
            tvi_status status[MEMBERS];
            for (int m = 0; m < MEMBERS; m++) q[m] = 1, q[MEMBERS + m] = p[m] = 0, p[MEMBERS + m] = 0.8;
            expect("an ensemble", tvi_ensemble_create(&ensemble, system, nullptr, MEMBERS, threads) == TVI_OK);
            is_thrown = false;
            const bool comes_out = throws_seven([&] { return tvi_ensemble_run(ensemble, &plan, t, q, p, status); });
            expect("it is thrown", comes_out == is_thrown && (is_thrown || threads > 1));
            expect("counts are read", tvi_ensemble_stats(ensemble, &stats) == TVI_OK && stats.steps > 0);
            expect("members go on",
                   tvi_ensemble_integrate(ensemble, 0.25, 1, t, q, p, status, nullptr, nullptr) == TVI_OK);
            for (int m = 0; m < MEMBERS; m++) expect("a member goes on", status[m] == TVI_OK && t[m] > 0);
            tvi_ensemble_free(ensemble);
        }
}

int main()
{
    tvi_system *system = nullptr;
    tvi_event *event = nullptr;
    const double times[] = {0.3, 1000};
    std::thread::id own = std::this_thread::get_id();
    expect("a system", tvi_system_potential(&system, 2, nullptr, kepler, nullptr) == TVI_OK);
    expect("an event", tvi_event_create(&event, 2, TVI_EITHER, false, radial, nullptr) == TVI_OK);
    const tvi_event *const events[] = {event};
    leave_integrators(system, list_plans(events, times, &own));
    leave_ensembles(system, list_plans(events, times, &own));
    tvi_event_free(event);
    tvi_system_free(system);
    return failures != 0;
}
