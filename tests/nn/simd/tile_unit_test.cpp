// The tile instructions: by hand, against the manual's definition step by step, and the emulation against the
// processor's own where there is one.
#include "nn/simd/tile_unit.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <random>

#include "nn/simd/amx_permission.h"
#include "nn/simd/isa.h"

namespace penumbra::nn {
namespace {

std::uint16_t bf16(float value) {
  return static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(value) >> 16);
}
float f32(std::uint16_t value) { return std::bit_cast<float>(std::uint32_t{value} << 16); }

struct alignas(64) TileMemory {
  std::array<std::byte, kTileRows * kLineBytes> bytes{};
  template <class T>
  T get(int row, int column) const {
    T value;
    std::memcpy(
        &value,
        &bytes[static_cast<std::size_t>(row * kLineBytes) + static_cast<std::size_t>(column) * sizeof(T)],
        sizeof(T));
    return value;
  }
  template <class T>
  void set(int row, int column, T value) {
    std::memcpy(
        &bytes[static_cast<std::size_t>(row * kLineBytes) + static_cast<std::size_t>(column) * sizeof(T)],
        &value, sizeof(T));
  }
  bool operator==(const TileMemory&) const = default;
};

struct Product {
  Precision precision = Precision::bf16;
  int rows = kTileRows, depth_bytes = kLineBytes, column_bytes = kLineBytes;
  TileMemory a, b, c;

  TileMemory run(const TileUnit& unit) const {
    TileMemory result = c;
    unit.tile_product(
        {precision, rows, depth_bytes, column_bytes, a.bytes.data(), b.bytes.data(), result.bytes.data()});
    return result;
  }
};

// What TILESTORED leaves alone stays as it was: rows and columns beyond the shape are not written.
float flushed(float x) { return std::abs(x) < FLT_MIN ? std::copysign(0.0F, x) : x; }

// The manual's pseudo-code. Results within half a step of the least normal number are not decided by a
// fused multiply-add whose denormal results are flushed afterwards; the inputs below do not come near.
TileMemory by_definition(const Product& p) {
  TileMemory c = p.c;
  for (int m = 0; m < p.rows; ++m) {
    for (int n = 0; n < p.column_bytes / 4; ++n) {
      if (p.precision == Precision::bf16) {
        float chains[2] = {0.0F, 0.0F};
        for (int k = 0; k < p.depth_bytes / 4; ++k) {
          for (int i = 0; i < 2; ++i) {
            const float x = flushed(f32(p.a.get<std::uint16_t>(m, 2 * k + i)));
            const float w = flushed(f32(p.b.get<std::uint16_t>(k, 2 * n + i)));
            chains[i] = flushed(std::fma(x, w, chains[i]));
          }
        }
        const float both = flushed(chains[0] + chains[1]);
        c.set(m, n, flushed(flushed(p.c.get<float>(m, n)) + both));
      } else {
        std::int32_t sum = p.c.get<std::int32_t>(m, n);
        for (int k = 0; k < p.depth_bytes; ++k) {
          sum += p.a.get<std::uint8_t>(m, k) * p.b.get<std::int8_t>(k / 4, 4 * n + k % 4);
        }
        c.set(m, n, sum);
      }
    }
  }
  return c;
}

Product random_product(std::mt19937& random, Precision precision) {
  const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  Product p;
  p.precision = precision;
  p.rows = pick(1, 16);
  p.depth_bytes = 4 * pick(1, 16);
  p.column_bytes = 4 * pick(1, 16);
  std::normal_distribution<float> normal;
  for (int i = 0; i < kTileRows * kLineBytes / 2; ++i) {
    const int row = i / 32, column = i % 32;
    p.a.set(row, column,
            precision == Precision::bf16 ? bf16(normal(random)) : static_cast<std::uint16_t>(random()));
    p.b.set(row, column,
            precision == Precision::bf16 ? bf16(normal(random)) : static_cast<std::uint16_t>(random()));
  }
  for (int i = 0; i < kTileRows * 16; ++i) {
    if (precision == Precision::bf16) {
      p.c.set(i / 16, i % 16, normal(random));
    } else {
      p.c.set(i / 16, i % 16, pick(-1'000'000, 1'000'000));
    }
  }
  return p;
}

class TileUnitTest : public ::testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!is_supported(GetParam())) {
      GTEST_SKIP() << to_string(GetParam()) << ": " << describe(amx_state());
    }
    use_isa(GetParam());
    unit_ = tile_unit();
  }
  void TearDown() override { use_isa(before_); }
  Isa before_ = current_isa();
  const TileUnit* unit_ = nullptr;
};

// The example of docs/engine/tile-units.md: one pixel, four channels, one output.
TEST_P(TileUnitTest, MultipliesTheChaptersExample) {
  Product p;
  p.rows = 1;
  p.depth_bytes = 8;
  p.column_bytes = 4;
  const float x[4] = {1.0F, 2.0F, 3.0F, 4.0F}, w[4] = {0.5F, -1.0F, 2.0F, 0.25F};
  for (int k = 0; k < 4; ++k) {
    p.a.set(0, k, bf16(x[k]));
    p.b.set(k / 2, k % 2, bf16(w[k]));
  }
  p.c.set(0, 0, 10.0F);
  EXPECT_EQ(p.run(*unit_).get<float>(0, 0), 10.0F + (0.5F + 6.0F) + (-2.0F + 1.0F));
}

// The order of sums shows where numbers are lost: 2^24 + 1 is no f32.
TEST_P(TileUnitTest, AddsEvenAndOddProductsByThemselves) {
  Product p;
  p.rows = 1;
  p.depth_bytes = 8;
  p.column_bytes = 4;
  const float x[4] = {16777216.0F, 1.0F, -16777216.0F, 1.0F};
  for (int k = 0; k < 4; ++k) {
    p.a.set(0, k, bf16(x[k]));
    p.b.set(k / 2, k % 2, bf16(1.0F));
  }
  // Even: 2^24 - 2^24 = 0, odd: 1 + 1 = 2. One after the other the first 1 would be lost: 1.
  EXPECT_EQ(p.run(*unit_).get<float>(0, 0), 2.0F);
  // The sum that is there comes last: (2^24 + 1) is rounded to 2^24 once, not twice.
  p.c.set(0, 0, 16777216.0F);
  EXPECT_EQ(p.run(*unit_).get<float>(0, 0), 16777218.0F);
}

TEST_P(TileUnitTest, TakesDenormalNumbersForZero) {
  Product p;
  p.rows = 1;
  p.depth_bytes = 4;
  p.column_bytes = 4;
  p.a.set(0, 0, bf16(FLT_MIN / 2));  // an input
  p.b.set(0, 0, bf16(0x1p100F));
  EXPECT_EQ(p.run(*unit_).get<float>(0, 0), 0.0F);
  p.a.set(0, 0, bf16(0x1p-100F));  // a product
  p.b.set(0, 0, bf16(0x1p-30F));
  EXPECT_EQ(p.run(*unit_).get<float>(0, 0), 0.0F);
  p.b.set(0, 0, bf16(0.0F));  // a sum
  p.c.set(0, 0, FLT_MIN / 2);
  EXPECT_EQ(p.run(*unit_).get<float>(0, 0), 0.0F);
  // Nothing of the program's own arithmetic has changed.
  volatile float least = FLT_MIN;
  EXPECT_GT(least / 2, 0.0F);
}

TEST_P(TileUnitTest, KeepsInfinityAndNaN) {
  Product p;
  p.rows = 2;
  p.depth_bytes = 4;
  p.column_bytes = 4;
  p.a.set(0, 0, bf16(INFINITY));
  p.a.set(1, 0, bf16(NAN));
  p.b.set(0, 0, bf16(2.0F));
  const TileMemory c = p.run(*unit_);
  EXPECT_EQ(c.get<float>(0, 0), INFINITY);
  EXPECT_TRUE(std::isnan(c.get<float>(1, 0)));
}

TEST_P(TileUnitTest, MultipliesUnsignedBySignedBytes) {
  Product p;
  p.precision = Precision::int8;
  p.rows = 1;
  p.depth_bytes = 4;
  p.column_bytes = 4;
  const int x[4] = {255, 200, 1, 0}, w[4] = {-128, 127, -1, 5};
  for (int k = 0; k < 4; ++k) {
    p.a.set(0, k, static_cast<std::uint8_t>(x[k]));
    p.b.set(0, k, static_cast<std::int8_t>(w[k]));
  }
  p.c.set(0, 0, 7);
  EXPECT_EQ(p.run(*unit_).get<std::int32_t>(0, 0), 7 - 255 * 128 + 200 * 127 - 1);
}

TEST_P(TileUnitTest, AgreesWithTheManualOnRandomShapes) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Product p = random_product(random, trial % 2 == 0 ? Precision::bf16 : Precision::int8);
    ASSERT_EQ(p.run(*unit_), by_definition(p)) << "trial " << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, TileUnitTest, ::testing::Values(Isa::amx, Isa::amx_emulated),
                         [](const auto& info) {
                           return std::string(info.param == Isa::amx ? "amx" : "emulated");
                         });

// Any bits: denormal numbers, infinities and NaN among them.
TEST(TileUnit, IsEmulatedBitForBit) {
  if (!is_supported(Isa::amx)) GTEST_SKIP() << "AMX: " << describe(amx_state());
  std::mt19937 random(2);
  for (int trial = 0; trial < 2000; ++trial) {
    Product p = random_product(random, trial % 2 == 0 ? Precision::bf16 : Precision::int8);
    const int kind = trial / 2 % 3;
    for (int i = 0; i < kTileRows * 32 && kind > 0; ++i) {
      const auto any = static_cast<std::uint16_t>(random());
      // Of the second kind exponents are small, so that products are near the denormal numbers.
      const auto bits = static_cast<std::uint16_t>(kind == 1 ? any : (any & 0x80FFU) | (random() % 64) << 7);
      p.a.set(i / 32, i % 32, bits);
    }
    const TileMemory real = p.run(amx::kTileUnit), emulated = p.run(amx_emulated::kTileUnit);
    for (int m = 0; m < p.rows; ++m) {
      for (int n = 0; n < p.column_bytes / 4; ++n) {
        if (p.precision == Precision::bf16 && std::isnan(real.get<float>(m, n))) {
          EXPECT_TRUE(std::isnan(emulated.get<float>(m, n)));  // which NaN, the manual does not say
          continue;
        }
        ASSERT_EQ(real.get<std::uint32_t>(m, n), emulated.get<std::uint32_t>(m, n)) << "trial " << trial;
      }
    }
  }
}

TEST(TileUnit, IsThereOnlyWithItsInstructionSet) {
  const Isa before = current_isa();
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!is_supported(isa)) continue;
    use_isa(isa);
    EXPECT_EQ(tile_unit(), nullptr);
  }
  use_isa(before);
  EXPECT_NE(current_isa(), Isa::amx_emulated) << "is for who asks for it";
}

}  // namespace
}  // namespace penumbra::nn
