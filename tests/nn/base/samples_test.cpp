#include "nn/base/samples.h"

#include <gtest/gtest.h>

#include "nn/base/quantile.h"

namespace penumbra {
namespace {

TEST(Samples, KeepsAllOfAFew) {
  Samples samples;
  EXPECT_TRUE(samples.values().empty());
  for (const double value : {3.0, 1.0, 2.0}) samples.add(value);
  EXPECT_EQ(samples.values(), (std::vector<double>{3.0, 1.0, 2.0}));
  EXPECT_EQ(samples.count(), 3U);
}

TEST(Samples, ThinsOutManyEvenly) {
  Samples samples;
  constexpr std::size_t kCount = 1000000;
  for (std::size_t i = 0; i < kCount; ++i) samples.add(static_cast<double>(i));
  EXPECT_EQ(samples.count(), kCount);
  ASSERT_LT(samples.values().size(), Samples::kMost);
  EXPECT_GE(samples.values().size(), Samples::kMost / 2);
  const double step = samples.values()[1] - samples.values()[0];
  for (std::size_t i = 0; i < samples.values().size(); ++i) {
    ASSERT_EQ(samples.values()[i], step * static_cast<double>(i));
  }
  for (const double q : {0.05, 0.5, 0.95}) {
    EXPECT_NEAR(quantile_of(samples.values(), q), q * kCount, 0.001 * kCount) << q;
  }
}

}  // namespace
}  // namespace penumbra
