// penumbra brain landmarks: pictures and JSON of what the finder finds.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/brain/landmark_finder.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/world/street_sequence.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

namespace brain = slam::brain;

TEST(BrainLandmarks, WritesPicturesAndLandmarks) {
  const std::filesystem::path weights = source_path("weights_tools/models/penumbra-interest.safetensors");
  slam::synthetic::StreetSequence street({.seed = 904, .colour = true});
  slam::synthetic::SequenceFrame frame;
  street.render(0, frame);
  const TemporaryDirectory folder;
  nn::write_image(folder / "a.png", frame.left_bgr);
  nn::write_file(folder / "b.png", "no image");
  const std::string common =
      fmt::format("brain landmarks --weights '{}' --out '{}' ", weights.string(), (folder / "out").string());
  const ProgramResult run = run_penumbra(common + "'" + (folder / "a.png").string() + "'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json report = read_json(folder / "out/landmarks.json");
  ASSERT_EQ(report.at("images").size(), 1U);
  const nlohmann::json& entry = report["images"][0];
  brain::Landmarks found;
  apps::ImageLandmarks{weights}(frame.left_bgr, found);
  ASSERT_EQ(entry.at("landmarks").size(), found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const nlohmann::json& landmark = entry["landmarks"][i];
    EXPECT_EQ(landmark.at("class"),
              brain::name_of(static_cast<brain::LandmarkClass>(found[i].landmark_class)));
    EXPECT_FLOAT_EQ(landmark.at("interest").get<float>(), found[i].interest);
    EXPECT_FLOAT_EQ(landmark.at("box").at(2).get<float>(), found[i].x1);
    EXPECT_EQ(landmark.at("descriptor").size(), static_cast<std::size_t>(brain::kDescriptorSize));
  }
  const ByteImage picture = nn::read_image(folder / "out/a_overlay.png", nn::ImageColour::bgr);
  EXPECT_EQ(picture.height() % 2, 0);
  EXPECT_GE(picture.width(), 640);

  // A file that is no image is named, and the others are done.
  const ProgramResult torn = run_penumbra(common + "--no-pictures '" + folder.path().string() + "'");
  EXPECT_EQ(torn.exit_code, 1);
  EXPECT_NE(torn.err.find("b.png"), std::string::npos) << torn.err;
  EXPECT_EQ(read_json(folder / "out/landmarks.json").at("images").size(), 1U);
}

}  // namespace
}  // namespace penumbra::test
