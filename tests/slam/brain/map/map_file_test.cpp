#include "slam/brain/map/map_file.h"

#include <gtest/gtest.h>

#include <limits>

#include "nn/base/crc32.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/slam/world/synthetic.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam::brain {
namespace {

using penumbra::test::expect_error;

class CognitiveMapFile : public ::testing::TestWithParam<TemplateKind> {
 protected:
  CognitiveMapFile() {
    stored.camera = test::test_camera();
    stored.templates = GetParam();
    stored.scene_distance = 14.5;
    for (int i = 0; i < 3; ++i) {
      Node node;
      node.frame = 7 * i;
      node.timestamp = 0.7 * i;
      node.pose = {1.0 * i, -0.5, 0.1 * i};
      node.activity = {0.25F, 0.5F, 1.0F};
      node.strength = 0.8 + i;
      for (int k = 0; k < 2 * i; ++k)
        node.points.push_back({{1ULL << k, 2, 3, ~0ULL}, {1.0F, 2.0F, 3.0F + static_cast<float>(k)}, 0.0F});
      stored.map.add(std::move(node));
      Template view;
      if (GetParam() == TemplateKind::landmarks) {
        Landmark landmark;
        landmark.landmark_class = kLamp;
        landmark.x1 = 9.0F;
        landmark.interest = 0.5F;
        landmark.descriptor[5] = 1.0F;
        view.landmarks.assign(static_cast<std::size_t>(i), landmark);
      } else {
        view.profile[17] = 0.5F * static_cast<float>(i);
      }
      stored.views.push_back(view);
    }
    stored.map.add(link(0, 1, false));
    stored.map.add(link(1, 2, false));
    stored.map.add(link(0, 2, true));
    write_cognitive_map(path, stored);
  }
  static Link link(int from, int to, bool recalled) {
    Link link;
    link.from = from;
    link.to = to;
    link.motion = {1.0, 0.125, -0.25};
    link.recalled = recalled;
    link.metres = 0.3;
    link.radians = 0.02;
    return link;
  }
  // Writes `stored` and expects that reading it back is refused.
  void expect_refused(std::initializer_list<std::string> parts) {
    write_cognitive_map(path, stored);
    expect_error<InputError>([&] { read_cognitive_map(path); }, parts);
  }

  penumbra::test::TemporaryDirectory folder;
  std::filesystem::path path = folder / "yard.brain";
  StoredMap stored;
};

INSTANTIATE_TEST_SUITE_P(Kinds, CognitiveMapFile,
                         ::testing::Values(TemplateKind::landmarks, TemplateKind::intensity),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST_P(CognitiveMapFile, GivesTheSameMapBack) {
  const StoredMap read = read_cognitive_map(path);
  EXPECT_EQ(read.camera.fx, stored.camera.fx);
  EXPECT_EQ(read.camera.height, stored.camera.height);
  EXPECT_EQ(read.templates, GetParam());
  EXPECT_EQ(read.scene_distance, 14.5);
  ASSERT_EQ(read.map.size(), 3);
  for (int i = 0; i < 3; ++i) {
    const Node &a = stored.map.node(i), &b = read.map.node(i);
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_EQ(a.timestamp, b.timestamp);
    EXPECT_EQ(a.pose.x, b.pose.x);
    EXPECT_EQ(a.pose.heading, b.pose.heading);
    EXPECT_EQ(a.activity, b.activity);
    EXPECT_EQ(a.strength, b.strength);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t k = 0; k < a.points.size(); ++k) {
      EXPECT_EQ(a.points[k].descriptor, b.points[k].descriptor);
      EXPECT_EQ(a.points[k].position, b.points[k].position);
    }
    const std::size_t n = static_cast<std::size_t>(i);
    EXPECT_EQ(stored.views[n].profile, read.views[n].profile);
    ASSERT_EQ(stored.views[n].landmarks.size(), read.views[n].landmarks.size());
    if (!read.views[n].landmarks.empty()) {
      EXPECT_EQ(read.views[n].landmarks.front().landmark_class, kLamp);
      EXPECT_EQ(read.views[n].landmarks.front().descriptor[5], 1.0F);
    }
  }
  ASSERT_EQ(read.map.links().size(), 3U);
  EXPECT_TRUE(read.map.links()[2].recalled);
  EXPECT_EQ(read.map.links()[0].motion.y, 0.125);
  EXPECT_EQ(read.map.links()[0].metres, 0.3);
  write_cognitive_map(folder / "again.brain", read);
  EXPECT_EQ(nn::read_file(path, ""), nn::read_file(folder / "again.brain", ""));
}

TEST_P(CognitiveMapFile, ATornFileIsRefusedWhereverItEnds) {
  const std::string whole = nn::read_file(path, "");
  for (std::size_t size = 0; size < whole.size(); size += 13) {
    nn::write_file(path, whole.substr(0, size));
    EXPECT_THROW(read_cognitive_map(path), InputError) << size;
  }
}

TEST_P(CognitiveMapFile, ADamagedByteIsFound) {
  const std::string whole = nn::read_file(path, "");
  for (std::size_t i = 0; i < whole.size(); i += 29) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    nn::write_file(path, damaged);
    EXPECT_THROW(read_cognitive_map(path), InputError) << i;
  }
}

TEST_P(CognitiveMapFile, ABodyThatEndsEarlyIsRefusedThoughItsChecksumFits) {
  const std::string whole = nn::read_file(path, ""), body = whole.substr(24);
  for (std::size_t size = 0; size < body.size(); size += 17) {
    const std::string part = body.substr(0, size);
    std::string file = whole.substr(0, 12);
    const std::uint32_t crc = nn::crc32(part);
    const std::uint64_t bytes = part.size();
    file.append(reinterpret_cast<const char*>(&crc), 4).append(reinterpret_cast<const char*>(&bytes), 8);
    nn::write_file(path, file + part);
    EXPECT_THROW(read_cognitive_map(path), InputError) << size;
  }
}

TEST_P(CognitiveMapFile, SaysWhatCannotBe) {
  stored.map.node(1).pose.y = std::numeric_limits<double>::infinity();
  expect_refused({"yard.brain", "finite pose"});
  stored.map.node(1).pose.y = 0.0;
  stored.scene_distance = std::numeric_limits<double>::quiet_NaN();
  expect_refused({"distance of the scene"});
  stored.scene_distance = 0.0;
  stored.camera.baseline = 0.0;
  expect_refused({"baseline"});
  stored.camera.baseline = 0.5;
  Link bad = link(0, 1, false);
  bad.metres = 0.0;
  stored.map.add(bad);
  expect_refused({"deviations above 0"});
}

TEST_P(CognitiveMapFile, AnotherFileOrVersionIsNamed) {
  nn::write_file(path, "PENUMAP\nwhatever");
  expect_error<InputError>([&] { read_cognitive_map(path); },
                           {"yard.brain", "a cognitive map that Penumbra saved"});
  write_cognitive_map(path, stored);
  std::string file = nn::read_file(path, "");
  file[8] = 9;
  nn::write_file(path, file);
  expect_error<InputError>([&] { read_cognitive_map(path); }, {"version 1", "version 9"});
  expect_error<InputError>([&] { read_cognitive_map(folder / "none.brain"); }, {"none.brain"});
}

}  // namespace
}  // namespace penumbra::slam::brain
