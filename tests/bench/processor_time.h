// Processor time of a measurement.
#pragma once
#include <sys/resource.h>

namespace relamp {

/// Of this process so far, all threads, milliseconds.
inline double processorMs() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1e3 * double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-3 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

}  // namespace relamp
