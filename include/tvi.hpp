/* tvi.hpp - the library for C++11 and later: classes that own, any callable as a function of the system, exceptions,
 * and states in std::vector, Eigen vectors or anything else that has data() and size().
 *
 *     tvi::potential system(2, [](const jet *q, jet) { return -1 / hypot(q[0], q[1]); });
 *     tvi::integrator orbit(system);
 *     double t = 0;
 *     std::vector<double> q = {1, 0}, p = {0, 0.8};
 *     orbit.integrate(0.25, 16000, t, q, p);
 *
 * The rules of tvi.h for a function hold for the member of the same name. A status that is neither TVI_OK nor
 * TVI_ESTOPPED is thrown as a tvi::error, whose text is tvi_last_error. An exception of a callable comes out of the
 * function that called it, after the library has returned and freed what it had. Objects may be moved and copied;
 * copies share what they own, and an integrator keeps its system. */
#ifndef TVI_HPP
#define TVI_HPP

#include "tvi_bodies.h"
#include "tvi_rigid.h"

#include <cmath>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tvi
{

class error : public std::runtime_error
{
  public:
    error(tvi_status status, const std::string &text) : std::runtime_error(text), status_(status) {}
    tvi_status status() const noexcept { return status_; }

  private:
    tvi_status status_;
};

namespace detail
{

inline void check(tvi_status status)
{
    if (status != TVI_OK) throw error(status, tvi_last_error());
}

/* The text that write(buffer, &size) makes. */
template <class Write> std::string text_of(Write write)
{
    std::size_t size = 0;
    check(write(nullptr, &size));
    std::string text(size, '\0');
    check(write(&text[0], &size));
    return text;
}

/* Returns the numbers of a vector, which must have n of them. */
template <class Vector> auto data_of(const char *name, std::size_t n, Vector &x) -> decltype(x.data())
{
    if (static_cast<std::size_t>(x.size()) != n)
        throw error(TVI_EINVAL,
                    std::string(name) + " has " + std::to_string(x.size()) + " components, not " + std::to_string(n));
    return x.data();
}

/* Returns what p points to. An object that was moved from has nothing. */
template <class T> const T &value_of(const T *p)
{
    if (!p) throw error(TVI_EINVAL, "the object was moved from");
    return *p;
}

/* ---- Callables: nothing is thrown through the library ------------------------------------------------------------ */

/* A callable, and the exception that it has thrown. */
template <class Function> struct guarded {
    Function &function;
    std::exception_ptr thrown;

    explicit guarded(Function &f) : function(f), thrown() {}
    void rethrow() const
    {
        if (thrown) std::rethrow_exception(thrown);
    }
    template <class... Arguments> jet value(Arguments... arguments)
    {
        try {
            return function(arguments...);
        } catch (...) {
            thrown = std::current_exception();
            return refused();
        }
    }
    template <class... Arguments> void set(jet out[], Arguments... arguments)
    {
        try {
            function(arguments..., out);
        } catch (...) {
            thrown = std::current_exception();
            out[0] = refused();
        }
    }
    /* Calls the callable. Returns whether the run stops. */
    template <class... Arguments> int stops(Arguments... arguments)
    {
        if (thrown) return 1;
        try {
            return observe(std::is_void<decltype(function(arguments...))>(), arguments...);
        } catch (...) {
            thrown = std::current_exception();
            return 1;
        }
    }

  private:
    static jet refused() { return jet_record_div(jet(1), jet(0)); }
    template <class... Arguments> int observe(std::true_type, Arguments... arguments)
    {
        function(arguments...);
        return 0;
    }
    template <class... Arguments> int observe(std::false_type, Arguments... arguments)
    {
        return function(arguments...) ? 1 : 0;
    }
};

template <class Function> void force_of(const jet q[], jet t, jet force[], void *ctx)
{
    static_cast<guarded<Function> *>(ctx)->set(force, q, t);
}

template <class Function> void drive_of(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    static_cast<guarded<Function> *>(ctx)->set(force, q, v, t);
}

template <class Function> jet potential_of(const jet q[], jet t, void *ctx)
{
    return static_cast<guarded<Function> *>(ctx)->value(q, t);
}

/* Calls the function of a Lagrangian, a Hamiltonian, a time scale or an event. */
template <class Function> jet value_of(const jet q[], const jet x[], jet t, void *ctx)
{
    return static_cast<guarded<Function> *>(ctx)->value(q, x, t);
}

/* Calls the observer of a step or of an event: tvi_observer, tvi_event_observer. */
template <class Function, class Number>
int observer_of(Number which, double t, const double q[], const double p[], void *ctx)
{
    return static_cast<guarded<Function> *>(ctx)->stops(which, t, q, p);
}

struct no_observer {
    template <class... Arguments> void operator()(Arguments...) const {}
};

/* Calls the observer of a step of an ensemble. */
template <class Function>
int ensemble_of(long step, int members, const double t[], const double q[], const double p[], const tvi_status status[],
                void *ctx)
{
    return static_cast<guarded<Function> *>(ctx)->stops(step, members, t, q, p, status);
}
template <class Function> int member_of(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    return static_cast<guarded<Function> *>(ctx)->stops(member, which, t, q, p);
}

/* The two observers of a run with events. */
template <class Step, class Event> struct observers {
    guarded<Step> step;
    guarded<Event> event;
};
template <class Step, class Event> int step_of(long number, double t, const double q[], const double p[], void *ctx)
{
    return static_cast<observers<Step, Event> *>(ctx)->step.stops(number, t, q, p);
}
template <class Step, class Event> int event_of(int which, double t, const double q[], const double p[], void *ctx)
{
    return static_cast<observers<Step, Event> *>(ctx)->event.stops(which, t, q, p);
}

/* The observers of members that a plan has: callables, or none. */
template <class Event, class Time, class Step> class plan_observers
{
  public:
    plan_observers(Event &event, Time &time, Step &step) : event_(event), time_(time), step_(step) {}
    /* Returns the plan with these observers in the place of its own, or as it is if there are none. */
    tvi_run_plan in(tvi_run_plan plan)
    {
        if (!is_one<Event>() && !is_one<Time>() && !is_one<Step>()) return plan;
        plan.on_event = is_one<Event>() ? tell_event : nullptr;
        plan.at_time = is_one<Time>() ? tell_time : nullptr;
        plan.at_step = is_one<Step>() ? tell_step : nullptr;
        plan.observer = nullptr;
        plan.ctx = static_cast<void *>(this);
        return plan;
    }
    void rethrow() const
    {
        event_.rethrow();
        time_.rethrow();
        step_.rethrow();
    }

  private:
    template <class Function> static constexpr bool is_one() { return !std::is_same<Function, no_observer>::value; }
    static int tell_event(int member, int which, double t, const double q[], const double p[], void *ctx)
    {
        return static_cast<plan_observers *>(ctx)->event_.stops(member, which, t, q, p);
    }
    static int tell_time(int member, int which, double t, const double q[], const double p[], void *ctx)
    {
        return static_cast<plan_observers *>(ctx)->time_.stops(member, which, t, q, p);
    }
    static int tell_step(int member, int which, double t, const double q[], const double p[], void *ctx)
    {
        return static_cast<plan_observers *>(ctx)->step_.stops(member, which, t, q, p);
    }
    guarded<Event> event_;
    guarded<Time> time_;
    guarded<Step> step_;
};

/* The [m] numbers that way(owner, t, q, p, numbers, other) computes of the m constraints of a system of n coordinates,
 * where the library also says that there are none. `other` gets its size. */
template <class Way, class Owner, class Q, class P>
std::vector<double> of_constraints(Way way, const Owner *owner, std::size_t n, int m, double t, const Q &q, const P &p,
                                   std::vector<double> &other, std::size_t size)
{
    std::vector<double> found(static_cast<std::size_t>(m) + 1), others(size + 1); /* memory for m = 0, too */
    check(way(owner, t, data_of("q", n, q), data_of("p", n, p), found.data(), others.data()));
    found.pop_back();
    others.pop_back();
    other.swap(others);
    return found;
}

/* Tells whether a run came to its end; false if an observer or an event stopped it. */
inline bool ended(tvi_status status)
{
    if (status != TVI_ESTOPPED) check(status);
    return status == TVI_OK;
}

} // namespace detail

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

class system
{
  public:
    const tvi_system *get() const noexcept { return handle_.get(); }
    int dimension() const noexcept { return tvi_system_dimension(get()); }
    int parameters() const noexcept { return tvi_system_parameters(get()); }

    template <class Q, class P> double energy(double t, const Q &q, const P &p) const
    {
        double H = 0;
        detail::check(tvi_energy(get(), t, detail::data_of("q", size(), q), detail::data_of("p", size(), p), &H));
        return H;
    }
    template <class Q, class V> V momentum(double t, const Q &q, const V &v) const
    {
        return transform(tvi_momentum, t, q, "v", v);
    }
    template <class Q, class P> P velocity(double t, const Q &q, const P &p) const
    {
        return transform(tvi_velocity, t, q, "p", p);
    }

    /* Of a constrained system: m, and what tvi_project, tvi_constraint_values and tvi_multipliers do. `rate` and
     * `force` get their size; they stay what they were where anything is thrown. */
    int constraints() const noexcept { return tvi_system_constraints(get()); }
    template <class Q, class P> void project(double t, Q &q, P &p) const
    {
        detail::check(tvi_project(get(), t, detail::data_of("q", size(), q), detail::data_of("p", size(), p)));
    }
    template <class Q, class P>
    std::vector<double> constraint_values(double t, const Q &q, const P &p, std::vector<double> &rate) const
    {
        const std::size_t m = static_cast<std::size_t>(constraints());
        return detail::of_constraints(tvi_constraint_values, get(), size(), constraints(), t, q, p, rate, m);
    }
    template <class Q, class P>
    std::vector<double> multipliers(double t, const Q &q, const P &p, std::vector<double> &force) const
    {
        return detail::of_constraints(tvi_multipliers, get(), size(), constraints(), t, q, p, force, size());
    }

  protected:
    system() = default;
    std::size_t size() const { return static_cast<std::size_t>(dimension()); }

    /* Creates the handle by make(&handle, function, ctx), with the callable as the library calls it. */
    template <class Function, class Make> void own(Function &function, Make make)
    {
        detail::guarded<Function> g(function);
        tvi_system *made = nullptr;
        const tvi_status status = make(&made, static_cast<void *>(&g));
        handle_.reset(made, tvi_system_free);
        g.rethrow();
        detail::check(status);
    }
    static const double *masses(int n, const std::vector<double> &mass)
    {
        return mass.empty() ? nullptr : detail::data_of("mass", static_cast<std::size_t>(n), mass);
    }

  private:
    typedef tvi_status legendre(const tvi_system *, double, const double[], const double[], double[]);
    template <class Q, class X> X transform(legendre *way, double t, const Q &q, const char *name, const X &x) const
    {
        X y(x);
        detail::check(way(get(), t, detail::data_of("q", size(), q), detail::data_of(name, size(), x), y.data()));
        return y;
    }
    std::shared_ptr<tvi_system> handle_;
};

/* The callable is void function(const jet *q, jet t, jet *force). Without masses all are 1. */
class force : public system
{
  public:
    template <class Function> force(int n, Function function, const std::vector<double> &mass = std::vector<double>())
    {
        const double *m = masses(n, mass);
        own(function,
            [=](tvi_system **out, void *g) { return tvi_system_force(out, n, m, detail::force_of<Function>, g); });
    }
};

/* The callable is jet function(const jet *q, jet t). */
class potential : public system
{
  public:
    template <class Function>
    potential(int n, Function function, const std::vector<double> &mass = std::vector<double>())
    {
        const double *m = masses(n, mass);
        own(function, [=](tvi_system **out, void *g) {
            return tvi_system_potential(out, n, m, detail::potential_of<Function>, g);
        });
    }
};

/* Bodies that attract each other: tvi_bodies_system. For steps that adapt, pass tvi_bodies_scale to rescaled. */
class gravity : public system
{
  public:
    explicit gravity(const tvi_bodies &bodies)
    {
        detail::no_observer none;
        own(none, [&](tvi_system **out, void *) { return tvi_bodies_system(out, &bodies); });
    }
};

/* Rigid bodies with joints and gravity: tvi_rigid_system. The callable, a potential beside that of gravity, is jet
 * function(const jet *q, jet t). */
class rigid : public system
{
  public:
    explicit rigid(const tvi_rigid &bodies)
    {
        detail::no_observer none;
        own(none, [&](tvi_system **out, void *) { return tvi_rigid_system(out, &bodies, nullptr, nullptr); });
    }
    template <class Function> rigid(const tvi_rigid &bodies, Function function)
    {
        own(function, [&](tvi_system **out, void *g) {
            return tvi_rigid_system(out, &bodies, detail::potential_of<Function>, g);
        });
    }
};

/* The callable is jet function(const jet *q, const jet *v, jet t). */
class lagrangian : public system
{
  public:
    template <class Function> lagrangian(int n, Function function)
    {
        own(function,
            [=](tvi_system **out, void *g) { return tvi_system_lagrangian(out, n, detail::value_of<Function>, g); });
    }
};

/* The callable is jet function(const jet *q, const jet *p, jet t). */
class hamiltonian : public system
{
  public:
    template <class Function> hamiltonian(int n, Function function)
    {
        own(function,
            [=](tvi_system **out, void *g) { return tvi_system_hamiltonian(out, n, detail::value_of<Function>, g); });
    }
};

/* Pass it to rescaled for the reversible form, tvi_system_rescaled_reversible. */
struct reversible_form {
};
constexpr reversible_form reversible{};

/* The callable is jet scale(const jet *q, const jet *p, jet t); without it, the automatic time scale is used. */
class rescaled : public system
{
  public:
    explicit rescaled(const system &base)
    {
        detail::no_observer none;
        own(none, [&](tvi_system **out, void *) { return tvi_system_rescaled(out, base.get(), nullptr, nullptr); });
    }
    template <class Function> rescaled(const system &base, Function scale)
    {
        own(scale, [&](tvi_system **out, void *g) {
            return tvi_system_rescaled(out, base.get(), detail::value_of<Function>, g);
        });
    }
    template <class Function> rescaled(const system &base, Function scale, reversible_form)
    {
        own(scale, [&](tvi_system **out, void *g) {
            return tvi_system_rescaled_reversible(out, base.get(), detail::value_of<Function>, g);
        });
    }
};

/* The callable is void drive(const jet *q, const jet *v, jet t, jet *force), which is added to dp/dt. */
class driven : public system
{
  public:
    template <class Function> driven(const system &base, Function drive)
    {
        own(drive, [&](tvi_system **out, void *g) {
            return tvi_system_driven(out, base.get(), detail::drive_of<Function>, g);
        });
    }
};

/* The system on m constraints. The callable is void function(const jet *q, jet t, jet *value). */
class constrained : public system
{
  public:
    template <class Function> constrained(const system &base, int m, Function function)
    {
        own(function, [&](tvi_system **out, void *g) {
            return tvi_system_constrained(out, base.get(), m, detail::force_of<Function>, g);
        });
    }
};

/* The tangent system (tvi_gradient.h), for second derivatives; rates are those of the parameters, or none. */
class tangent : public system
{
  public:
    explicit tangent(const system &base, const std::vector<double> &rates = {})
    {
        const auto count = static_cast<std::size_t>(tvi_system_parameters(base.get()));
        const double *const given = rates.empty() ? nullptr : detail::data_of("rates", count, rates);
        detail::no_observer none;
        own(none, [&](tvi_system **out, void *) { return tvi_system_tangent(out, base.get(), given); });
    }
};

/* ---- Events ------------------------------------------------------------------------------------------------------ */

/* The callable is jet g(const jet *q, const jet *p, jet t). */
class event
{
  public:
    template <class Function> event(int n, Function g, tvi_direction direction = TVI_EITHER, bool terminal = false)
    {
        detail::guarded<Function> guard(g);
        tvi_event *made = nullptr;
        const tvi_status status =
            tvi_event_create(&made, n, direction, terminal, detail::value_of<Function>, static_cast<void *>(&guard));
        handle_.reset(made, tvi_event_free);
        guard.rethrow();
        detail::check(status);
    }
    const tvi_event *get() const noexcept { return handle_.get(); }

  private:
    std::shared_ptr<tvi_event> handle_;
};

/* ---- Integrators ------------------------------------------------------------------------------------------------- */

inline tvi_options options(const std::string &name, int order)
{
    tvi_options found;
    detail::check(tvi_options_named(name.c_str(), order, &found));
    return found;
}

/* Does what tvi_measure_step does, for a run of that duration without events; `measured` is its error. */
template <class Q, class P>
double suggest_step(const system &of, const tvi_options &options, double t, const Q &q, const P &p, double duration,
                    double error, double &measured)
{
    const std::size_t n = static_cast<std::size_t>(of.dimension());
    tvi_run_plan plan = {};
    double h = 0;
    plan.t_end = t + duration;
    detail::check(tvi_measure_step(of.get(), &options, &plan, t, detail::data_of("q", n, q), detail::data_of("p", n, p),
                                   error, &h, &measured));
    return h;
}

/* Does what tvi_suggest_step does. */
template <class Q, class P>
double suggest_step(const system &of, const tvi_options &options, double t, const Q &q, const P &p, double duration,
                    double error)
{
    double measured = 0;
    return suggest_step(of, options, t, q, p, duration, error, measured);
}

/* Compiled code for the system and the options: options.compiled = code.get(). */
class compiled
{
  public:
    compiled(const system &of, const tvi_options &options, const tvi_compiler *how = nullptr)
    {
        tvi_compiled *made = nullptr;
        detail::check(tvi_compile(&made, of.get(), &options, how));
        handle_.reset(made, tvi_compiled_free);
    }
    const tvi_compiled *get() const noexcept { return handle_.get(); }

  private:
    std::shared_ptr<tvi_compiled> handle_;
};

/* Runs return whether they came to their end; false: an observer or a terminal event stopped them. An observer returns
 * nothing, or true to stop. q and p are changed in place. */
class integrator
{
  public:
    explicit integrator(const tvi::system &system, const tvi_options &options = tvi_options_default()) : system_(system)
    {
        tvi_integrator *made = nullptr;
        detail::check(tvi_integrator_create(&made, system.get(), &options));
        handle_.reset(made, tvi_integrator_free);
    }
    tvi_integrator *get() const noexcept { return handle_.get(); }
    const tvi::system &system() const noexcept { return system_; }
    const tvi_options &options() const { return detail::value_of(tvi_integrator_options(get())); }
    const tvi_stats &stats() const { return detail::value_of(tvi_integrator_stats(get())); }
    void reset() { tvi_integrator_reset(get()); }
    /* Sets the integrator's own values, [parameters]. `energy` then uses these values. */
    void set_parameters(const std::vector<double> &value)
    {
        const std::size_t count = static_cast<std::size_t>(system_.parameters());
        detail::check(tvi_integrator_set_parameters(get(), detail::data_of("parameters", count, value)));
    }
    template <class Q, class P> double energy(double t, const Q &q, const P &p) const
    {
        double H = 0;
        detail::check(
            tvi_integrator_energy(get(), t, detail::data_of("q", size(), q), detail::data_of("p", size(), p), &H));
        return H;
    }
    /* These do what those of a constrained system do, with the integrator's values of the parameters. */
    template <class Q, class P> void project(double t, Q &q, P &p) const
    {
        detail::check(tvi_integrator_project(get(), t, of("q", q), of("p", p)));
    }
    template <class Q, class P>
    std::vector<double> constraint_values(double t, const Q &q, const P &p, std::vector<double> &rate) const
    {
        const std::size_t m = static_cast<std::size_t>(system_.constraints());
        return detail::of_constraints(tvi_integrator_constraint_values, get(), size(), system_.constraints(), t, q, p,
                                      rate, m);
    }
    template <class Q, class P>
    std::vector<double> multipliers(double t, const Q &q, const P &p, std::vector<double> &force) const
    {
        return detail::of_constraints(tvi_integrator_multipliers, get(), size(), system_.constraints(), t, q, p, force,
                                      size());
    }

    template <class Q, class P> void step(double h, double &t, Q &q, P &p)
    {
        detail::check(tvi_step(get(), h, &t, of("q", q), of("p", p)));
    }
    /* Makes a step, and moves D [2n + parameters][columns], row-major. */
    template <class Q, class P, class Columns>
    void step_tangent(double h, double &t, Q &q, P &p, Columns &D, int columns)
    {
        const std::size_t rows = 2 * size() + static_cast<std::size_t>(system_.parameters());
        double *const d = detail::data_of("D", rows * static_cast<std::size_t>(columns), D);
        detail::check(tvi_step_tangent(get(), h, &t, of("q", q), of("p", p), d, columns));
    }
    template <class Q, class P> void dense(double theta, Q &q, P &p)
    {
        detail::check(tvi_dense(get(), theta, of("q", q), of("p", p)));
    }

    /* The observer is observer(long step, double t, const double *q, const double *p). */
    template <class Q, class P, class Observer = detail::no_observer>
    bool integrate(double h, long steps, double &t, Q &q, P &p, Observer observer = Observer())
    {
        return run_seen(observer, [&](tvi_observer *call, void *g) {
            return tvi_integrate(get(), h, steps, &t, of("q", q), of("p", p), call, g);
        });
    }
    template <class Q, class P, class Observer = detail::no_observer>
    bool integrate_to(double h, double t_end, double &t, Q &q, P &p, Observer observer = Observer())
    {
        return run_seen(observer, [&](tvi_observer *call, void *g) {
            return tvi_integrate_to(get(), h, t_end, &t, of("q", q), of("p", p), call, g);
        });
    }
    template <class Q, class P, class Observer>
    bool integrate_at(double h, const std::vector<double> &times, double &t, Q &q, P &p, Observer observer)
    {
        return run_seen(observer, [&](tvi_observer *call, void *g) {
            return tvi_integrate_at(get(), h, times.data(), static_cast<int>(times.size()), &t, of("q", q), of("p", p),
                                    call, g);
        });
    }
    template <class Q, class P, class Observer = detail::no_observer>
    bool integrate_tolerance(double tolerance, double t_end, double &t, Q &q, P &p, Observer observer = Observer())
    {
        return run_seen(observer, [&](tvi_observer *call, void *g) {
            return tvi_integrate_tolerance(get(), tolerance, t_end, &t, of("q", q), of("p", p), call, g);
        });
    }
    /* The observer of events is on_event(int which, double t, const double *q, const double *p). */
    template <class Q, class P, class On_event, class Observer = detail::no_observer>
    bool integrate_events(double h, long steps, const std::vector<event> &events, double &t, Q &q, P &p,
                          On_event on_event, Observer observer = Observer())
    {
        return run_with(
            events, on_event, observer,
            [&](const tvi_event *const list[], int count, tvi_observer *each, tvi_event_observer *call, void *g) {
                return tvi_integrate_events(get(), h, steps, list, count, &t, of("q", q), of("p", p), each, call, g);
            });
    }
    template <class Q, class P, class On_event, class Observer = detail::no_observer>
    bool integrate_tolerance_events(double tolerance, double t_end, const std::vector<event> &events, double &t, Q &q,
                                    P &p, On_event on_event, Observer observer = Observer())
    {
        return run_with(
            events, on_event, observer,
            [&](const tvi_event *const list[], int count, tvi_observer *each, tvi_event_observer *call, void *g) {
                return tvi_integrate_tolerance_events(get(), tolerance, t_end, list, count, &t, of("q", q), of("p", p),
                                                      each, call, g);
            });
    }

    /* Runs any plan. Its events, times and D are those that the plan points to. The observers, of (int member, int
     * which, double t, const double *q, const double *p), take the place of the plan's own. The plan's own observers
     * must not throw. */
    template <class Q, class P, class On_event = detail::no_observer, class At_time = detail::no_observer,
              class At_step = detail::no_observer>
    bool run(const tvi_run_plan &plan, double &t, Q &q, P &p, On_event on_event = On_event(),
             At_time at_time = At_time(), At_step at_step = At_step())
    {
        detail::plan_observers<On_event, At_time, At_step> all(on_event, at_time, at_step);
        const tvi_run_plan told = all.in(plan);
        const tvi_status status = tvi_run(get(), &told, &t, of("q", q), of("p", p));
        all.rethrow();
        return detail::ended(status);
    }
    /* Does the same with tvi_run_chaos. Without D in the plan `chaos` begins anew. */
    template <class Q, class P, class On_event = detail::no_observer, class At_time = detail::no_observer,
              class At_step = detail::no_observer>
    bool run_chaos(const tvi_run_plan &plan, tvi_chaos &chaos, double &t, Q &q, P &p, On_event on_event = On_event(),
                   At_time at_time = At_time(), At_step at_step = At_step())
    {
        detail::plan_observers<On_event, At_time, At_step> all(on_event, at_time, at_step);
        const tvi_run_plan told = all.in(plan);
        const tvi_status status = tvi_run_chaos(get(), &told, &chaos, &t, of("q", q), of("p", p));
        all.rethrow();
        return detail::ended(status);
    }

    /* The text of the last step's state (tvi_state_to_text), and its reading; `last` returns what was read. */
    std::string save() const
    {
        double t = 0;
        std::vector<double> q(size()), p(size());
        last(t, q, p);
        return to_text(t, q, p);
    }
    void load(const std::string &text)
    {
        double t = 0;
        std::vector<double> q(size()), p(size());
        from_text(text, t, q, p);
    }
    template <class Q, class P> void last(double &t, Q &q, P &p) const
    {
        detail::check(tvi_state_last(get(), &t, of("q", q), of("p", p)));
    }
    template <class Q, class P> std::string to_text(double t, const Q &q, const P &p) const
    {
        const double *const q_of = of("q", q), *const p_of = of("p", p);
        return detail::text_of(
            [&](char *to, std::size_t *size) { return tvi_state_to_text(get(), t, q_of, p_of, to, size); });
    }
    template <class Q, class P> void from_text(const std::string &text, double &t, Q &q, P &p)
    {
        detail::check(tvi_state_from_text(get(), text.data(), text.size(), &t, of("q", q), of("p", p)));
    }

  private:
    std::size_t size() const { return static_cast<std::size_t>(system_.dimension()); }
    template <class Vector> auto of(const char *name, Vector &x) const -> decltype(x.data())
    {
        return detail::data_of(name, size(), x);
    }
    template <class Observer, class Run> bool run_seen(Observer &observer, Run steps)
    {
        detail::guarded<Observer> g(observer);
        const tvi_status status = steps(detail::observer_of<Observer, long>, static_cast<void *>(&g));
        g.rethrow();
        return detail::ended(status);
    }

    template <class On_event, class Observer, class Run>
    bool run_with(const std::vector<event> &events, On_event &on_event, Observer &observer, Run steps)
    {
        std::vector<const tvi_event *> list;
        for (const event &one : events) list.push_back(one.get());
        detail::observers<Observer, On_event> both = {detail::guarded<Observer>(observer),
                                                      detail::guarded<On_event>(on_event)};
        const tvi_status status = steps(list.data(), static_cast<int>(list.size()), detail::step_of<Observer, On_event>,
                                        detail::event_of<Observer, On_event>, static_cast<void *>(&both));
        both.event.rethrow();
        both.step.rethrow();
        return detail::ended(status);
    }

    tvi::system system_; /* outlives the handle */
    std::shared_ptr<tvi_integrator> handle_;
};

/* ---- Gradients --------------------------------------------------------------------------------------------------- */

/* What runs leave behind for gradients: plan.record = record.get(). */
class record
{
  public:
    /* The derivatives of a loss: by q, p and t at the start, [2n + 1], and by the parameters. */
    struct gradient_of_loss {
        std::vector<double> start, parameters;
    };
    explicit record(const integrator &of, std::size_t bytes = 0) : system_(of.system())
    {
        tvi_record *made = nullptr;
        detail::check(tvi_record_create(&made, of.get(), bytes));
        handle_.reset(made, tvi_record_free);
    }
    tvi_record *get() const noexcept { return handle_.get(); }
    long steps() const { return tvi_record_counts(get(), nullptr, nullptr); }
    int times() const
    {
        int count = 0;
        (void)tvi_record_counts(get(), &count, nullptr);
        return count;
    }
    int events() const
    {
        int count = 0;
        (void)tvi_record_counts(get(), nullptr, &count);
        return count;
    }
    std::size_t bytes() const { return tvi_record_bytes(get()); }
    /* Adds a running integral of jet l(const jet *q, const jet *p, jet t). */
    template <class Function> void integral(Function l)
    {
        detail::guarded<Function> guard(l);
        const tvi_status status = tvi_record_integral(get(), detail::value_of<Function>, static_cast<void *>(&guard));
        guard.rethrow();
        detail::check(status);
        integrals_++;
    }
    std::vector<double> integrals() const
    {
        std::vector<double> value(integrals_);
        tvi_record_integrals(get(), value.data());
        return value;
    }
    gradient_of_loss gradient(const tvi_loss &loss)
    {
        const std::size_t parameters = static_cast<std::size_t>(system_.parameters());
        gradient_of_loss by = {std::vector<double>(2 * static_cast<std::size_t>(system_.dimension()) + 1),
                               std::vector<double>(parameters)};
        detail::check(tvi_gradient(get(), &loss, by.start.data(), by.parameters.data()));
        return by;
    }

  private:
    tvi::system system_; /* outlives the handle */
    std::shared_ptr<tvi_record> handle_;
    std::size_t integrals_ = 0;
};

/* ---- Ensembles --------------------------------------------------------------------------------------------------- */

/* Many orbits of one system. t and status are [members], q and p [n][members], the member fastest; status gets this
 * size. Runs return as those of an integrator: also true if members have failed, which status tells. An exception from
 * an observer of a member ends the runs of the others at their next call. */
class ensemble
{
  public:
    ensemble(const tvi::system &system, int members, const tvi_options &options = tvi_options_default(),
             int threads = 0)
        : members_(members), system_(system)
    {
        tvi_ensemble *made = nullptr;
        detail::check(tvi_ensemble_create(&made, system.get(), &options, members, threads));
        handle_.reset(made, tvi_ensemble_free);
    }
    tvi_ensemble *get() const noexcept { return handle_.get(); }
    const tvi::system &system() const noexcept { return system_; }
    int members() const noexcept { return members_; }
    tvi_stats stats() const
    {
        tvi_stats found;
        detail::check(tvi_ensemble_stats(get(), &found));
        return found;
    }
    void reset() { tvi_ensemble_reset(get()); }
    /* Sets the values [parameters][members]. */
    void set_parameters(const std::vector<double> &value)
    {
        detail::check(tvi_ensemble_set_parameters(get(), of("parameters", system_.parameters(), value)));
    }

    /* The observer is observer(long step, int members, const double *t, const double *q, const double *p, const
     * tvi_status *status). */
    template <class T, class Q, class P, class Observer = detail::no_observer>
    bool integrate(double h, long steps, T &t, Q &q, P &p, std::vector<tvi_status> &status,
                   Observer observer = Observer())
    {
        const bool is_seen = !std::is_same<Observer, detail::no_observer>::value;
        tvi_ensemble_observer *const call = is_seen ? detail::ensemble_of<Observer> : nullptr;
        detail::guarded<Observer> g(observer);
        double *const t_of = of("t", 1, t), *const q_of = of("q", n(), q), *const p_of = of("p", n(), p);
        status.resize(static_cast<std::size_t>(members_));
        const tvi_status end = tvi_ensemble_integrate(get(), h, steps, t_of, q_of, p_of, status.data(), call, &g);
        g.rethrow();
        return detail::ended(end);
    }
    template <class T, class Q, class P>
    bool integrate_to(double h, double t_end, T &t, Q &q, P &p, std::vector<tvi_status> &status)
    {
        tvi_run_plan plan = {};
        plan.h = h, plan.t_end = t_end, plan.has_t_end = true;
        return run(plan, t, q, p, status);
    }
    template <class T, class Q, class P>
    bool integrate_tolerance(double tolerance, double t_end, T &t, Q &q, P &p, std::vector<tvi_status> &status)
    {
        tvi_run_plan plan = {};
        plan.tolerance = tolerance, plan.t_end = t_end, plan.has_t_end = true;
        return run(plan, t, q, p, status);
    }
    /* The observer is at_time(int member, int which, double t, const double *q, const double *p). */
    template <class T, class Q, class P, class At_time>
    bool integrate_at(double h, const std::vector<double> &times, T &t, Q &q, P &p, std::vector<tvi_status> &status,
                      At_time at_time)
    {
        detail::guarded<At_time> g(at_time);
        tvi_run_plan plan = {};
        plan.h = h, plan.times = times.data(), plan.time_count = static_cast<int>(times.size());
        plan.at_time = detail::member_of<At_time>, plan.ctx = &g;
        return go(plan, t, q, p, status, g);
    }
    /* The observer on_event has the arguments of at_time. */
    template <class T, class Q, class P, class On_event>
    bool integrate_events(double h, long steps, const std::vector<event> &events, T &t, Q &q, P &p,
                          std::vector<tvi_status> &status, On_event on_event)
    {
        detail::guarded<On_event> g(on_event);
        std::vector<const tvi_event *> list;
        for (const event &one : events) list.push_back(one.get());
        tvi_run_plan plan = {};
        plan.h = h, plan.steps = steps, plan.events = list.data(), plan.event_count = static_cast<int>(list.size());
        plan.on_event = detail::member_of<On_event>, plan.ctx = &g;
        return go(plan, t, q, p, status, g);
    }
    /* Runs any other plan, with observers as those of integrator::run. */
    template <class T, class Q, class P, class On_event = detail::no_observer, class At_time = detail::no_observer,
              class At_step = detail::no_observer>
    bool run(const tvi_run_plan &plan, T &t, Q &q, P &p, std::vector<tvi_status> &status,
             On_event on_event = On_event(), At_time at_time = At_time(), At_step at_step = At_step())
    {
        detail::plan_observers<On_event, At_time, At_step> all(on_event, at_time, at_step);
        return go(all.in(plan), t, q, p, status, all);
    }

    /* The texts of all members after their last run, one after the other, and their reading. Members that have failed
     * are tried again. */
    std::string save() const
    {
        const std::size_t count = static_cast<std::size_t>(members_), numbers = count * static_cast<std::size_t>(n());
        std::vector<double> t(count), q(numbers), p(numbers);
        std::vector<tvi_status> status;
        std::string texts;
        last(t, q, p, status);
        for (int m = 0; m < members_; m++) texts += member_to_text(m, t, q, p);
        return texts;
    }
    void load(const std::string &texts)
    {
        const std::size_t count = static_cast<std::size_t>(members_), numbers = count * static_cast<std::size_t>(n());
        const std::size_t each = texts.size() / count;
        std::vector<double> t(count), q(numbers), p(numbers);
        std::vector<std::string> text(count);
        int dimension = 0;
        for (std::size_t m = 0; m < count; m++) {
            text[m] = texts.substr(m * each, m + 1 < count ? each : std::string::npos);
            detail::check(tvi_state_peek(text[m].data(), text[m].size(), &dimension, nullptr, nullptr, nullptr));
        }
        for (int m = 0; m < members_; m++) member_from_text(m, text[static_cast<std::size_t>(m)], t, q, p);
    }
    template <class T, class Q, class P> void last(T &t, Q &q, P &p, std::vector<tvi_status> &status) const
    {
        status.resize(static_cast<std::size_t>(members_));
        detail::check(tvi_ensemble_last(get(), of("t", 1, t), of("q", n(), q), of("p", n(), p), status.data()));
    }
    template <class T, class Q, class P>
    std::string member_to_text(int member, const T &t, const Q &q, const P &p) const
    {
        const double *const t_of = of("t", 1, t), *const q_of = of("q", n(), q), *const p_of = of("p", n(), p);
        return detail::text_of([&](char *to, std::size_t *size) {
            return tvi_ensemble_member_to_text(get(), member, t_of, q_of, p_of, to, size);
        });
    }
    template <class T, class Q, class P> void member_from_text(int member, const std::string &text, T &t, Q &q, P &p)
    {
        detail::check(tvi_ensemble_member_from_text(get(), member, text.data(), text.size(), of("t", 1, t),
                                                    of("q", n(), q), of("p", n(), p)));
    }

  private:
    int n() const { return system_.dimension(); }
    template <class Vector> auto of(const char *name, int rows, Vector &x) const -> decltype(x.data())
    {
        return detail::data_of(name, static_cast<std::size_t>(rows) * static_cast<std::size_t>(members_), x);
    }
    template <class T, class Q, class P, class Guarded>
    bool go(const tvi_run_plan &plan, T &t, Q &q, P &p, std::vector<tvi_status> &status, const Guarded &g)
    {
        double *const t_of = of("t", 1, t), *const q_of = of("q", n(), q), *const p_of = of("p", n(), p);
        status.resize(static_cast<std::size_t>(members_));
        const tvi_status end = tvi_ensemble_run(get(), &plan, t_of, q_of, p_of, status.data());
        g.rethrow();
        return detail::ended(end);
    }

    int members_;
    tvi::system system_; /* outlives the handle */
    std::shared_ptr<tvi_ensemble> handle_;
};

} // namespace tvi

/* ---- std::sin(x) of a jet ---------------------------------------------------------------------------------------- */

/* The functions of a jet are found by its type, without std::, and these templates say so. They ask for a conversion,
 * so that the jet's own functions are taken if both are found, as after `using std::pow`. */
namespace tvi
{
namespace detail
{
struct jet_in_std {
    jet_in_std(jet) {}
};
struct number_in_std {
    number_in_std(double) {}
};
} // namespace detail
} // namespace tvi
#define TVI_NOT_IN_STD_OF(name, ...)                                                                                   \
    template <int right = 0> jet name(__VA_ARGS__)                                                                     \
    {                                                                                                                  \
        static_assert(right != 0, "of a jet write " #name "(...), without std::");                                     \
        return jet();                                                                                                  \
    }
#define TVI_NOT_IN_STD(name, code) TVI_NOT_IN_STD_OF(name, tvi::detail::jet_in_std)
#define TVI_NOT_IN_STD2(name, code)                                                                                    \
    TVI_NOT_IN_STD_OF(name, tvi::detail::jet_in_std, tvi::detail::jet_in_std)                                          \
    TVI_NOT_IN_STD_OF(name, tvi::detail::jet_in_std, tvi::detail::number_in_std)                                       \
    TVI_NOT_IN_STD_OF(name, tvi::detail::number_in_std, tvi::detail::jet_in_std)
namespace std
{
JET_FUNCTION_LIST(TVI_NOT_IN_STD)
JET_FUNCTION2_LIST(TVI_NOT_IN_STD2)
TVI_NOT_IN_STD2(pow, JET_POW)
} // namespace std
#undef TVI_NOT_IN_STD_OF
#undef TVI_NOT_IN_STD
#undef TVI_NOT_IN_STD2

#endif
