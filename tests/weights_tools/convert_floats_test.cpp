#include "weights_tools/convert_floats.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "nn/base/error.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"
#include "weights_tools/load_weights.h"

namespace penumbra::weights_tools {
namespace {

using nn::DataType;

TEST(ConvertFloats, FloatsChangeAndIntegersStay) {
  const nn::StateDict state = load_weights(test::fixture("checkpoints/every_kind_zip.pth"));
  for (const DataType type : {DataType::f32, DataType::f16}) {
    const FloatConversion conversion = convert_floats(state, type);
    EXPECT_TRUE(conversion.out_of_range.empty());
    for (const auto& [name, tensor] : conversion.state.tensors) {
      const nn::StoredTensor& before = state.tensors.at(name);
      EXPECT_EQ(tensor.shape, before.shape);
      if (before.type == DataType::f64 || before.type == DataType::f32 || before.type == DataType::f16 ||
          before.type == DataType::bf16) {
        EXPECT_EQ(tensor.type, type) << name;
        const std::vector<float> expected = before.to_f32(), found = tensor.to_f32();
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
          EXPECT_NEAR(found[i], expected[i], 1e-3F * std::abs(expected[i])) << name;
        }
      } else {
        EXPECT_EQ(tensor.type, before.type) << name;
        EXPECT_EQ(tensor.bytes.data(), before.bytes.data()) << name;
      }
    }
  }
}

// A network does not load with infinite weights, so f16 may not make them of finite ones.
TEST(ConvertFloats, ValuesBeyondTheRangeAreReportedAndStay) {
  const std::vector<float> values = {1.0F, 65520.0F}, infinite = {std::numeric_limits<float>::infinity()};
  nn::StateDict state;
  state.tensors["large"] = {DataType::f32, {2}, std::as_bytes(std::span(values))};
  state.tensors["infinite"] = {DataType::f32, {1}, std::as_bytes(std::span(infinite))};
  const FloatConversion conversion = convert_floats(state, DataType::f16);
  EXPECT_EQ(conversion.out_of_range, std::vector<std::string>{"large"});
  EXPECT_EQ(conversion.converted, 1U);
  EXPECT_EQ(conversion.state.tensors.at("large").type, DataType::f32);
  EXPECT_EQ(conversion.state.tensors.at("infinite").type, DataType::f16);
}

TEST(ConvertFloats, BatchNormsAndRowsThatF16WouldLoseStayF32) {
  const std::vector<float> variance = {1.0F, 2e-9F}, rows = {1.0F, 2.0F, 1e-6F, -1e-7F}, bias = {1.0F, 1e-7F};
  const auto tensor = [](const std::vector<float>& values, std::vector<std::int64_t> shape) {
    return nn::StoredTensor{DataType::f32, std::move(shape), std::as_bytes(std::span(values))};
  };
  nn::StateDict state;
  state.tensors["bn.running_var"] = tensor(variance, {2});
  state.tensors["bn.weight"] = tensor(bias, {2});
  state.tensors["conv.weight"] = tensor(rows, {2, 2});
  state.tensors["conv.bias"] = tensor(bias, {2});
  const FloatConversion conversion = convert_floats(state, DataType::f16);
  EXPECT_EQ(conversion.batch_norms, 2U);
  EXPECT_EQ(conversion.out_of_range, std::vector<std::string>{"conv.weight"});
  EXPECT_EQ(conversion.converted, 1U);
  EXPECT_EQ(conversion.state.tensors.at("bn.running_var").to_f32(), variance);
  EXPECT_EQ(conversion.state.tensors.at("conv.weight").to_f32(), rows);
  EXPECT_EQ(conversion.state.tensors.at("conv.bias").type, DataType::f16);
}

TEST(ConvertFloats, OnlyF32AndF16AreTargets) { EXPECT_THROW(convert_floats({}, DataType::i8), UsageError); }

TEST(ConvertFloats, ValuesBeyondF32AreAnErrorThatNamesTheTensor) {
  const std::vector<double> values = {1.0, -1e300};
  nn::StateDict state;
  state.tensors["scale"] = {DataType::f64, {2}, std::as_bytes(std::span(values))};
  EXPECT_CONTAINS(test::message_of<InputError>([&] { convert_floats(state, DataType::f32); }), "\"scale\"");
  const std::vector<double> infinite = {1.0, std::numeric_limits<double>::infinity()};
  state.tensors["scale"].bytes = std::as_bytes(std::span(infinite));
  EXPECT_EQ(convert_floats(state, DataType::f32).converted, 1U);
}

TEST(ConvertFloats, ComplexOfDoublesIsLeftOutByName) {
  const std::vector<double> values = {1.0, 2.0};
  nn::StateDict state;
  state.tensors["freqs"] = {DataType::c128, {1}, std::as_bytes(std::span(values))};
  state.tensors["w"] = {DataType::f64, {2}, std::as_bytes(std::span(values))};
  EXPECT_EQ(leave_out_unwritable(state), std::vector<std::string>{"freqs"});
  EXPECT_EQ(state.tensors.size(), 1U);
}

}  // namespace
}  // namespace penumbra::weights_tools
