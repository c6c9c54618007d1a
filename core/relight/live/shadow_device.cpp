#include "relight/live/shadow_device.h"

#include <chrono>
#include <utility>

#include "base/error.h"
#include "base/log.h"

namespace relamp {
namespace {

/// Of the slots: a ray that just passes an edge here may hit it there.
constexpr double leastAgreement = 0.98;

}  // namespace

void ShadowPlace::offer(std::shared_ptr<ShadowDevice> device, bool force) {
    device_ = device && !device->gaveUp() ? std::move(device) : nullptr;
    force_ = force;
    measured_ = false;
    pending_ = 0;
    processorMs_ = deviceMs_ = 0;
    if (device_) device_->forget();
}

void ShadowPlace::fail(const std::exception& error) {
    logWarning("Shadows in the environment are traced on the processor: {}: {}", device_->name(), error.what());
    device_->giveUp();
    device_.reset();
    deviceMs_ = 0;
    pending_ = 0;
}

void ShadowPlace::forget() {
    if (open() && std::exchange(pending_, 0)) device_->forget();
}

void ShadowPlace::measure(const ShadowQuery& query, double processorMs,
                          const std::function<double(const ShadowAnswers&)>& same) {
    if (!open()) return;
    processorMs_ = processorMs;
    measured_ = true;
    try {
        device_->forget();
        for (int run = 0; run < 2; ++run) {  // the first one brings the scene there
            const auto begin = std::chrono::steady_clock::now();
            device_->start(query);
            device_->finish(answers_);
            deviceMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
        }
        if (const double agreed = same(answers_); !(agreed >= leastAgreement))
            throw Error("{:.1f} % of its shadows agree, expected {:.0f} % at least", 100 * agreed,
                        100 * leastAgreement);
        if (force_ || deviceMs_ < processorMs_) return;
        device_->clear();
        device_.reset();
    } catch (const std::exception& error) { fail(error); }
}

bool ShadowPlace::start(const ShadowQuery& query) {
    if (!open() || !measured_) return false;
    try {
        device_->start(query);
        ++pending_;
        return true;
    } catch (const std::exception& error) { fail(error); }
    return false;
}

const ShadowAnswers* ShadowPlace::finish() {
    if (!open() || !pending_) return nullptr;
    --pending_;
    try {
        device_->finish(answers_);
        return &answers_;
    } catch (const std::exception& error) { fail(error); }
    return nullptr;
}

}  // namespace relamp
