#include "shot/cryptomatte.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

namespace relamp {
namespace {

TEST(Cryptomatte, HashesAreMurmurHash3) {
    EXPECT_EQ(cryptomatteHash(""), 0u);
    EXPECT_EQ(cryptomatteHash("hello"), 0x248bfa47u);
    EXPECT_EQ(cryptomatteHash("hello, world"), 0x149bbb7fu);
    EXPECT_EQ(cryptomatteHash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(Cryptomatte, NumbersAreFloatsThatStayAsTheyAre) {
    EXPECT_EQ(std::bit_cast<uint32_t>(cryptomatteId("hello")), 0x248bfa47u);
    EXPECT_EQ(std::bit_cast<uint32_t>(cryptomatteId("")), 0x00800000u);  // an exponent of zeros would be flushed
    for (int i = 0; i < 2000; ++i) EXPECT_TRUE(std::isnormal(cryptomatteId("emitter-" + std::to_string(i))));
}

TEST(Cryptomatte, HeaderNamesTheLayerAndWhatIsInIt) {
    const auto header = cryptomatteHeader("hello", {"emitter-1", "a \"b\""});
    ASSERT_EQ(header.size(), 4u);
    EXPECT_EQ(header.at("cryptomatte/248bfa4/name"), "hello");
    EXPECT_EQ(header.at("cryptomatte/248bfa4/hash"), "MurmurHash3_32");
    EXPECT_EQ(header.at("cryptomatte/248bfa4/conversion"), "uint32_to_float32");
    const auto manifest = nlohmann::json::parse(header.at("cryptomatte/248bfa4/manifest"));
    EXPECT_EQ(manifest.size(), 2u);
    EXPECT_EQ(manifest["emitter-1"], fmt::format("{:08x}", std::bit_cast<uint32_t>(cryptomatteId("emitter-1"))));
    EXPECT_TRUE(manifest.contains("a \"b\""));
}

}  // namespace
}  // namespace relamp
