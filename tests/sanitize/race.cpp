// Two tasks write one number: what ThreadSanitizer must find in spite of the suppressions, or it would find nothing in
// relamp's tasks either.
#include <cstdio>
#include <thread>

#include "base/parallel.h"

int main() {
    int sum = 0;
    relamp::parallelFor(64, 1, [&](size_t) {
        ++sum;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    });
    std::printf("%d\n", sum);
    return 0;
}
