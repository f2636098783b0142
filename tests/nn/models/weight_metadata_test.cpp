// Numbers in the metadata of weights, good and bad.
#include "nn/models/weight_metadata.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"

namespace penumbra::nn {
namespace {

StateDict with(const std::string& text) {
  StateDict weights;
  weights.source = "w.safetensors";
  weights.metadata["key"] = text;
  return weights;
}

TEST(WeightMetadata, ReadsNumbersAndLists) {
  EXPECT_EQ(metadata_number(with("0.25"), "key", {0, 1}), 0.25);
  EXPECT_EQ(metadata_number(with("1e-05"), "key", {0, 1}), 1e-5);
  EXPECT_EQ(metadata_integer(with("620"), "key", {1, 1000}), 620);
  EXPECT_EQ(metadata_numbers(with("8,16.5,32"), "key", 3, {1, 100}), (std::vector<double>{8, 16.5, 32}));
}

TEST(WeightMetadata, WhatIsNotThereIsLeftToTheCaller) {
  EXPECT_EQ(metadata_number(with("1"), "other", {0, 1}), std::nullopt);
  EXPECT_EQ(metadata_integer(with("1"), "other", {0, 1}), std::nullopt);
  EXPECT_TRUE(metadata_numbers(with("1"), "other", 3, {0, 1}).empty());
}

TEST(WeightMetadata, WhatIsNoSuchNumberIsAnError) {
  for (const char* wrong : {"", " ", "x", "nan", "inf", "1x", "-1", "101", "1e400", "0x10"}) {
    EXPECT_THROW(metadata_number(with(wrong), "key", {0, 100}), InputError) << wrong;
    EXPECT_THROW(metadata_integer(with(wrong), "key", {0, 100}), InputError) << wrong;
    EXPECT_THROW(metadata_numbers(with(wrong), "key", 1, {0, 100}), InputError) << wrong;
  }
  EXPECT_THROW(metadata_integer(with("1.5"), "key", {0, 100}), InputError);
  for (const char* wrong : {"1", "1,2,3", "1,,2", "1,2,", ",1,2", "1;2", "1,101"}) {
    EXPECT_THROW(metadata_numbers(with(wrong), "key", 2, {0, 100}), InputError) << wrong;
  }
}

TEST(WeightMetadata, TheErrorNamesFileAndKey) {
  try {
    metadata_integer(with("many\x1b"), "key", {1, 8});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "w.safetensors, metadata key: expected a number in 1..8, found 'many\\x1b'");
  }
}

}  // namespace
}  // namespace penumbra::nn
