// The compute shader against the processor. Runs in any OpenGL 4.3, llvmpipe too; without EGL it says so.
#include "viewport/gpu_transport.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

#include "base/error.h"

namespace relamp::ui {
namespace {

constexpr size_t cells = 1024;

TransportBlock randomBlock(std::mt19937& random) {
    TransportBlock block;
    const double fraction = std::uniform_real_distribution<>(0, 0.6)(random);
    for (size_t i = 0; i < cells; ++i)
        if (i == 0 || std::uniform_real_distribution<>(0, 1)(random) < fraction) block.index.push_back(uint16_t(i));
    for (size_t v = 0; v < block.index.size() * transportLanes; ++v)
        block.value.push_back(int16_t(int(random() % 65535) - 32767));
    for (float& s : block.scale) s = std::uniform_real_distribution<float>(0, 3e-5f)(random);
    return block;
}

TransportStore randomStore(size_t vertices, uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<TransportBlock> blocks((vertices + transportLanes - 1) / transportLanes);
    for (TransportBlock& b : blocks) b = randomBlock(random);
    return TransportStore(std::move(blocks));
}

std::array<std::vector<float>, 3> randomLight(uint32_t seed) {
    std::mt19937 random(seed);
    std::array<std::vector<float>, 3> coefs;
    for (auto& channel : coefs)
        for (size_t i = 0; i < cells; ++i) channel.push_back(std::normal_distribution<float>(0, i ? 0.3f : 5)(random));
    return coefs;
}

/// Difference from the processor's answer as a fraction of the brightest vertex.
float difference(TransportDevice& device, const TransportStore& store, const std::array<std::vector<float>, 3>& light) {
    std::vector<Rgb> expected(store.blocks() * transportLanes), found(expected.size(), Rgb(-7));
    store.apply(light, expected);
    device.load(store);
    device.apply(light, found);
    float worst = 0, brightest = 0;
    for (size_t v = 0; v < expected.size(); ++v)
        for (int k = 0; k < 3; ++k) {
            worst = std::max(worst, std::abs(expected[v][k] - found[v][k]));
            brightest = std::max(brightest, std::abs(expected[v][k]));
        }
    EXPECT_GT(brightest, 0);
    return worst / brightest;
}

class GpuTransport : public testing::Test {
protected:
    std::string why;
    std::shared_ptr<TransportDevice> device = makeGpuTransport(true, &why);
    void SetUp() override {
        if (why.find("EGL is not installed") != std::string::npos || why == "EGL offers no display")
            GTEST_SKIP() << why;
        ASSERT_TRUE(device) << "EGL is here but no context with OpenGL 4.3 could be made: " << why;
    }
};

TEST_F(GpuTransport, SumsAsTheProcessorDoesWhateverTheSize) {
    for (const size_t vertices : {1u, 16u, 17u, 64u, 100u, 1000u, 5000u})
        EXPECT_LT(difference(*device, randomStore(vertices, uint32_t(vertices)), randomLight(3)), 1e-5f)
            << vertices << " vertices on " << device->name();
}

TEST_F(GpuTransport, GivesTheSameBitsEveryTime) {
    const TransportStore store = randomStore(3000, 5);
    const auto light = randomLight(6);
    std::vector<Rgb> first(store.blocks() * transportLanes), again(first.size());
    device->load(store);
    device->apply(light, first);
    device->apply(randomLight(7), again);
    EXPECT_NE(first, again);
    device->apply(light, again);
    EXPECT_EQ(first, again);
}

TEST_F(GpuTransport, TakesAChangedStoreAndAnEmptyOne) {
    TransportStore store = randomStore(500, 8);
    const auto light = randomLight(9);
    EXPECT_LT(difference(*device, store, light), 1e-5f);
    std::mt19937 random(10);
    store.replace({{3, randomBlock(random)}, {31, randomBlock(random)}});
    EXPECT_LT(difference(*device, store, light), 1e-5f);
    device->load(TransportStore());
    std::vector<Rgb> none;
    device->apply(light, none);
    EXPECT_LT(difference(*device, store, light), 1e-5f);
}

TEST_F(GpuTransport, TwoOfThemDoNotDisturbEachOther) {
    const auto other = makeGpuTransport(true);
    ASSERT_TRUE(other);
    const TransportStore one = randomStore(700, 11), two = randomStore(300, 12);
    const auto light = randomLight(13);
    for (int i = 0; i < 2; ++i) {
        EXPECT_LT(difference(*device, one, light), 1e-5f);
        EXPECT_LT(difference(*other, two, light), 1e-5f);
    }
    float apart = 1;
    std::thread([&] {
        const auto own = makeGpuTransport(true);
        apart = own ? difference(*own, two, light) : 1;
    }).join();
    EXPECT_LT(apart, 1e-5f);
    EXPECT_LT(difference(*device, one, light), 1e-5f);
}

TEST_F(GpuTransport, RefusesAWrongNumberOfPlaces) {
    device->load(randomStore(32, 14));
    std::vector<Rgb> out(16);
    EXPECT_THROW(device->apply(randomLight(15), out), Error);
}

TEST_F(GpuTransport, UnforcedASoftwareRendererIsPassedOver) {
    if (device->name().find("llvmpipe") == std::string::npos)
        GTEST_SKIP() << "this machine has a graphics card: " << device->name();
    std::string reason;
    EXPECT_FALSE(makeGpuTransport(false, &reason));
    EXPECT_NE(reason.find("software"), std::string::npos) << reason;
}

TEST_F(GpuTransport, ChoiceKeepsTheFasterOneAndForceTheDevice) {
    const TransportStore store = randomStore(5000, 16);
    Progress progress;
    TransportSums sums;
    sums.choose(store, cells, device, false, progress);
    EXPECT_GT(sums.processorMs(), 0);
    EXPECT_GT(sums.deviceMs(), 0);
    EXPECT_EQ(sums.device().empty(), sums.deviceMs() >= sums.processorMs());
    sums.choose(store, cells, device, true, progress);
    EXPECT_EQ(sums.device(), device->name());
    std::printf("sums of 5008 vertices, %.1f MB: processor %.2f ms, %s %.2f ms\n", double(store.bytes()) * 1e-6,
                sums.processorMs(), device->name().c_str(), sums.deviceMs());
}

}  // namespace
}  // namespace relamp::ui
