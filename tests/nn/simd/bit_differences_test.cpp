#include <vector>

#include "nn/simd/kernel_table.h"
#include "tests/support/image_cases.h"

namespace penumbra::nn {
namespace {

class BitDifferences : public test::EveryIsa {};

int naive_difference(const std::uint64_t* a, const std::uint64_t* b) {
  int sum = 0;
  for (int bit = 0; bit < 256; ++bit) sum += ((a[bit / 64] ^ b[bit / 64]) >> (bit % 64) & 1U) != 0;
  return sum;
}

TEST_P(BitDifferences, AreThoseOfTheFormula) {
  for (int count = 0; count < 40; ++count) {
    std::vector<std::uint64_t> rows(static_cast<std::size_t>(count * kBitRowWords)), one(kBitRowWords);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = counter_random(1, i + 1000 * std::size_t(count));
    for (std::size_t i = 0; i < one.size(); ++i) one[i] = counter_random(2, i);
    if (count > 4) {  // none and all
      std::copy(one.begin(), one.end(), rows.begin());
      for (std::size_t i = 0; i < one.size(); ++i) rows[4 * one.size() + i] = ~one[i];
    }
    std::vector<std::uint16_t> differences(static_cast<std::size_t>(count) + 1, 12345);
    kernels().bit_differences(one.data(), rows.data(), count, differences.data());
    for (int i = 0; i < count; ++i)
      ASSERT_EQ(differences[std::size_t(i)], naive_difference(one.data(), rows.data() + i * kBitRowWords))
          << i;
    EXPECT_EQ(differences.back(), 12345) << "nothing behind the last";
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, BitDifferences, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra::nn
