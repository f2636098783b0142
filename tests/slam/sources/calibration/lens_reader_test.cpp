#include "slam/sources/calibration/lens_reader.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

using test::expect_error;

TEST(LensReader, ModelsAreCheckedByNameAndCoefficients) {
  LensCamera camera;
  set_lens_model(camera, "radtan", {1, 2, 3, 4}, "here");
  EXPECT_EQ(camera.distortion.size(), 4U);
  set_lens_model(camera, "none", {}, "here");
  EXPECT_TRUE(camera.distortion.empty());
  expect_error<InputError>([&] { set_lens_model(camera, "omni", {}, "here"); },
                           {"here", "equidistant", "'omni'"});
  expect_error<InputError>(
      [&] {
        set_lens_model(camera, "equidistant", {1, 2, 3, 4, 5}, "here");
      },
      {"4 to 4", "found 5"});
  expect_error<InputError>(
      [&] {
        set_lens_model(camera, "radial-tangential", {1, 2, 3}, "here");
      },
      {"4 to 5", "found 3"});
}

}  // namespace
}  // namespace penumbra::slam
