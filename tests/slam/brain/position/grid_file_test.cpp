#include "slam/brain/position/grid_file.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "nn/base/error.h"
#include "nn/io/safetensors.h"
#include "slam/brain/position/grid_training.h"
#include "slam/brain/position/position_model.h"
#include "tests/support/bytes.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam::brain {
namespace {

GridCode small_code() {
  GridTrainingSettings settings;
  settings.seconds = 5.0;
  settings.modules = 2;
  settings.rule.cells = 3;
  return train_grid_code(settings).at_scales(0.5, 1.4);
}

void expect_same_code(const GridCode& a, const GridCode& b, float tolerance) {
  EXPECT_EQ(a.rule.threshold, b.rule.threshold);
  EXPECT_EQ(a.rule.bipolar, b.rule.bipolar);
  ASSERT_EQ(a.directions.cols(), b.directions.cols());
  EXPECT_LE((a.directions - b.directions).cwiseAbs().maxCoeff(), tolerance);
  ASSERT_EQ(a.modules.size(), b.modules.size());
  for (std::size_t m = 0; m < a.modules.size(); ++m) {
    EXPECT_EQ(a.modules[m].wavelength, b.modules[m].wavelength);
    EXPECT_EQ(a.modules[m].start, b.modules[m].start);
    ASSERT_EQ(a.modules[m].weights.rows(), b.modules[m].weights.rows());
    EXPECT_LE((a.modules[m].weights - b.modules[m].weights).cwiseAbs().maxCoeff(), tolerance);
  }
}

TEST(GridFile, ReadsWhatItWrote) {
  const test::TemporaryDirectory folder;
  const GridCode code = small_code();
  write_grid_code(folder / "grid.safetensors", code, {{"room", "square"}, {"seed", "7"}});
  const StoredGridCode stored = read_grid_code(folder / "grid.safetensors");
  expect_same_code(stored.code, code, 0.0F);
  EXPECT_EQ(stored.history, (GridCodeHistory{{"room", "square"}, {"seed", "7"}}));
  GridCodeReader read(stored.code), own(code);
  const std::span<const float> a = read.at(Eigen::Vector2d(0.4, 0.1)), b = own.at(Eigen::Vector2d(0.4, 0.1));
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
}

// The file that ships is what the program trains for itself. Other compilers' cosines may differ in the last
// bit, which training does not make large.
TEST(GridFile, TheOneThatShipsIsTheStandardCode) {
  const StoredGridCode shipped =
      read_grid_code(test::source_path("weights_tools/models/penumbra-grid.safetensors"));
  expect_same_code(shipped.code, standard_grid_code(), 1e-3F);
  EXPECT_EQ(shipped.history.at("room"), "square");
  EXPECT_EQ(shipped.history.at("seconds"), "1000");
}

TEST(GridFile, RefusesTornFilesAtEveryLength) {
  const test::TemporaryDirectory folder;
  write_grid_code(folder / "whole", small_code(), {});
  const std::string bytes = test::read_file(folder / "whole");
  for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97) {
    test::write_file(folder / "torn", bytes.substr(0, length));
    EXPECT_THROW(read_grid_code(folder / "torn"), InputError) << length;
  }
}

TEST(GridFile, RefusesOtherFilesAndSaysWhy) {
  const test::TemporaryDirectory folder;
  const auto path = folder / "grid";
  const auto refuse = [&](std::initializer_list<std::string> parts) {
    test::expect_error<InputError>([&] { read_grid_code(path); }, parts);
  };
  test::write_file(path, "not a grid code");
  EXPECT_THROW(read_grid_code(path), InputError);
  nn::write_safetensors(path, {});
  refuse({"grid", "format", "penumbra grid code 1", "none"});
  write_grid_code(path, small_code(), {});
  const auto with = [&](const auto& change) {
    write_grid_code(path, small_code(), {});
    nn::StateDict state = nn::read_safetensors(path);
    change(state);
    nn::write_safetensors(folder / "changed", state);
    std::filesystem::rename(folder / "changed", path);
  };
  with([](nn::StateDict& state) { state.metadata["format"] = "penumbra grid code 2"; });
  refuse({"penumbra grid code 1", "penumbra grid code 2"});
  with([](nn::StateDict& state) { state.tensors.erase("directions"); });
  refuse({"directions", "none"});
  with([](nn::StateDict& state) { state.tensors.erase("modules.0.weights"); });
  refuse({"modules.0.weights", "none"});
  with([](nn::StateDict& state) { state.tensors["modules.1.start"] = state.tensors["output"]; });
  refuse({"modules.1.start", "[12]", "[2]"});
  with([](nn::StateDict& state) { state.tensors["output"].type = nn::DataType::i64; });
  refuse({"output", "F64", "I64"});
}

TEST(GridFile, RefusesNumbersThatCannotBe) {
  const test::TemporaryDirectory folder;
  const auto path = folder / "grid";
  const auto refuse = [&](const GridCode& code, std::initializer_list<std::string> parts) {
    write_grid_code(path, code, {});
    test::expect_error<InputError>([&] { read_grid_code(path); }, parts);
  };
  GridCode code = small_code();
  code.modules[1].weights(1, 2) = std::numeric_limits<float>::quiet_NaN();
  refuse(code, {"modules.1.weights", "finite"});
  code = small_code();
  code.modules[0].wavelength = -1.0;
  refuse(code, {"modules.0.wavelength", "above 0"});
  code = small_code();
  code.directions *= 1.5;
  refuse(code, {"directions", "length 1"});
  code = small_code();
  code.directions.conservativeResize(2, 8);
  refuse(code, {"directions", "multiple of 6"});
}

}  // namespace
}  // namespace penumbra::slam::brain
