#include "base/significant.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

TEST(Significant, NumbersThatPeopleReadHaveNoExponent) {
    EXPECT_EQ(significant(100, 2), "100");
    EXPECT_EQ(significant(99.6, 2), "100");
    EXPECT_EQ(significant(99.4, 2), "99");
    EXPECT_EQ(significant(9.54, 2), "9.5");
    EXPECT_EQ(significant(0.0123, 2), "0.012");
    EXPECT_EQ(significant(-3600, 3), "-3600");
    EXPECT_EQ(significant(0, 3), "0");
    EXPECT_EQ(significant(9999999, 3), "9999999");
    EXPECT_EQ(significant(2.5e9, 3), "2.5e+09");
    EXPECT_EQ(significant(2.5e-9, 3), "2.5e-09");
}

}  // namespace
}  // namespace relamp
