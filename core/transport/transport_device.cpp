#include "transport/transport_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/log.h"

namespace relamp {
namespace {

constexpr float agreement = 1e-3f;

double millisecondsOf(const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double medianOfThree(const auto& work, Progress& progress) {
    double ms[3];
    for (double& m : ms) {
        m = millisecondsOf(work);
        progress.check();
    }
    std::sort(ms, ms + 3);
    return ms[1];
}

/// Constant light with a different, falling fraction of every other coefficient in each channel.
std::array<std::vector<float>, 3> trialLight(size_t cells) {
    std::array<std::vector<float>, 3> coefs;
    for (size_t k = 0; k < 3; ++k) {
        coefs[k].assign(cells, 0);
        for (size_t i = 0; i < cells; ++i)
            coefs[k][i] = float((i * 2654435761u >> 7 * k & 255)) / 255 / std::sqrt(float(i + 1));
    }
    return coefs;
}

/// The largest difference as a fraction of the brightest vertex; not a number where `b` is not.
float difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    float worst = 0, brightest = 0;
    for (size_t v = 0; v < a.size(); ++v)
        for (int k = 0; k < 3; ++k) {
            const float d = std::abs(a[v][k] - b[v][k]);
            if (!(d <= worst)) worst = d;
            if (std::isnan(worst)) return worst;
            brightest = std::max(brightest, std::abs(a[v][k]));
        }
    return brightest > 0 ? worst / brightest : worst;
}

}  // namespace

void TransportSums::choose(const TransportStore& store, size_t cells, std::shared_ptr<TransportDevice> device,
                           bool force, Progress& progress) {
    device_.reset();
    deviceMs_ = 0;
    const std::array<std::vector<float>, 3> light = trialLight(cells);
    std::vector<Rgb> here(store.blocks() * transportLanes), there(here.size());
    store.apply(light, here);
    processorMs_ = medianOfThree([&] { store.apply(light, here); }, progress);
    if (!device || device->gaveUp()) return;
    try {
        device->load(store);
        device->apply(light, there);
        if (const float off = difference(here, there); !(off <= agreement))
            throw Error("its sums are off by {:.2g} of the brightest point, expected {:.2g} at most", off, agreement);
        deviceMs_ = medianOfThree([&] { device->apply(light, there); }, progress);
        if (force || deviceMs_ < processorMs_) device_ = std::move(device);
        else device->load(TransportStore());  // its memory is of use elsewhere
    } catch (const std::exception& error) {
        device_.reset();
        deviceMs_ = 0;
        if (device) device->giveUp();
        logWarning("Light is summed on the processor: {}: {}", device ? device->name() : "the graphics card",
                   error.what());
    }
}

void TransportSums::apply(const TransportStore& store, const std::array<std::vector<float>, 3>& coefs,
                          std::span<Rgb> out) {
    if (device_ && !device_->gaveUp()) {
        try {
            device_->load(store);
            device_->apply(coefs, out);
            return;
        } catch (const std::exception& error) {
            device_->giveUp();
            deviceMs_ = 0;
            logWarning("Light is summed on the processor from now on: {}: {}", device_->name(), error.what());
        }
    }
    device_.reset();
    store.apply(coefs, out);
}

}  // namespace relamp
