/* stats() and options() of an integrator in C++ that was moved from read a null pointer, and the program ends.
 * Right: they throw tvi::error, as its other members do. */
#include <tvi.hpp>
#include <utility>
#include "verdict.h"

template <class Call> static void throws(const char *name, Call call)
{
    try {
        call();
        row(false, "%s returned", name);
    } catch (const tvi::error &error) {
        row(true, "%s: %s", name, error.what());
    }
}

int main()
{
    tvi::potential spring(1, [](const jet *q, jet) { return sqr(q[0]); });
    tvi::integrator a(spring), b(std::move(a));
    throws("save", [&] { a.save(); });
    throws("stats", [&] { static_cast<void>(a.stats()); });
    throws("options", [&] { static_cast<void>(a.options()); });
    return verdict();
}
