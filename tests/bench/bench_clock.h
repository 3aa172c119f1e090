// SPDX-License-Identifier: MIT
// bench_clock.h - the clock of benchmarks on a busy machine.
#ifndef BENCH_CLOCK_H
#define BENCH_CLOCK_H
#include <chrono>
#include <ctime>

namespace bench {

// Nanoseconds that this thread has had of a processor; where that is not told, that have passed.
inline double now()
{
#ifdef CLOCK_THREAD_CPUTIME_ID
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
#else
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
#endif
}

} // namespace bench
#endif
