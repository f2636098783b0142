#include "nn/evaluation/coco_rle.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "nn/base/error.h"

namespace penumbra::nn {
namespace {

TEST(CocoRle, EncodesAsTheCocoApi) {
  // Values of pycocotools.mask.encode for these masks.
  const Mask square{1, 1, 2, 2, {1, 1, 1, 1}};
  EXPECT_EQ(mask_runs(square, 4, 4), (std::vector<std::uint32_t>{5, 2, 2, 2, 5}));
  EXPECT_EQ(encode_runs({5, 2, 2, 2, 5}), "52203");
  EXPECT_EQ(mask_runs(Mask{0, 0, 2, 2, {1, 1, 1, 1}}, 2, 2), (std::vector<std::uint32_t>{0, 4}));
  EXPECT_EQ(mask_runs(Mask{}, 3, 2), (std::vector<std::uint32_t>{6}));
  EXPECT_EQ(encode_runs({6}), "6");
  EXPECT_EQ(encode_runs({100}), "T3");
}

TEST(CocoRle, RandomMasksSurviveTheRoundTrip) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const int width = 1 + static_cast<int>(random() % 60), height = 1 + static_cast<int>(random() % 60);
    Mask mask;
    mask.x = static_cast<int>(random() % static_cast<unsigned>(width));
    mask.y = static_cast<int>(random() % static_cast<unsigned>(height));
    mask.width = static_cast<int>(random() % static_cast<unsigned>(width - mask.x + 1));
    mask.height = static_cast<int>(random() % static_cast<unsigned>(height - mask.y + 1));
    for (int i = 0; i < mask.width * mask.height; ++i) mask.bits.push_back(random() % 7 < 4 ? 1 : 0);
    const std::vector<std::uint32_t> runs = mask_runs(mask, width, height);
    const auto pixels = static_cast<std::uint64_t>(width * height);
    EXPECT_EQ(std::accumulate(runs.begin(), runs.end(), std::uint64_t{0}), pixels);
    EXPECT_EQ(decode_runs(encode_runs(runs), pixels), runs);
    std::uint64_t ones = 0;
    for (std::size_t i = 1; i < runs.size(); i += 2) ones += runs[i];
    EXPECT_EQ(ones, static_cast<std::uint64_t>(std::count(mask.bits.begin(), mask.bits.end(), 1)));
  }
}

TEST(CocoRle, DamagedTextIsAnInputError) {
  for (const char* text : {"\x01", "~", "T", "TTTTTTTTTTTTTTTTTTTTT3", "99999", "O"}) {
    EXPECT_THROW(decode_runs(text, 16), InputError) << text;
  }
}

}  // namespace
}  // namespace penumbra::nn
