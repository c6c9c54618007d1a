// libFuzzer's side: RELAMP_FUZZ_TARGET names the target.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "base/parallel.h"
#include "fuzz/target.h"

namespace {

const std::string& targetName() {
    static const std::string target = [] {
        const char* name = std::getenv("RELAMP_FUZZ_TARGET");
        if (name && relamp::fuzz::targets().count(name)) return std::string(name);
        std::fputs("RELAMP_FUZZ_TARGET names none of the targets:", stderr);
        for (const auto& [one, run] : relamp::fuzz::targets()) std::fprintf(stderr, " %s", one.c_str());
        std::fputc('\n', stderr);
        std::exit(2);
    }();
    return target;
}

}  // namespace

/// What a target makes once is made here, so that the first input's time is its own.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
    relamp::fuzz::runTarget(targetName(), {});
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const relamp::ThreadLimit oneThread(1);
    relamp::fuzz::runTarget(targetName(), {reinterpret_cast<const char*>(data), size});
    return 0;
}
