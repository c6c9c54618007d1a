// Root may read everything; a test of files that may not be read takes that away from its thread for a while.
#pragma once
#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <stdexcept>

namespace relamp::test {

/// While it lives, permissions of files count for this thread, whoever runs it.
class WithoutOverride {
public:
    WithoutOverride() {
        call(SYS_capget);
        const auto before = sets_[0].effective;
        sets_[0].effective &= ~((1u << CAP_DAC_OVERRIDE) | (1u << CAP_DAC_READ_SEARCH));
        call(SYS_capset);
        sets_[0].effective = before;
    }
    ~WithoutOverride() { ::syscall(SYS_capset, &header_, sets_); }
    WithoutOverride(const WithoutOverride&) = delete;
    WithoutOverride& operator=(const WithoutOverride&) = delete;

private:
    __user_cap_header_struct header_{_LINUX_CAPABILITY_VERSION_3, 0};
    __user_cap_data_struct sets_[2]{};
    void call(long number) {
        if (::syscall(number, &header_, sets_) != 0) throw std::runtime_error("capabilities cannot be changed");
    }
};

}  // namespace relamp::test
