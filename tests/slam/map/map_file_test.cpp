#include "slam/map/map_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nn/base/counter_random.h"
#include "nn/base/crc32.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/slam/world/synthetic.h"
#include "tests/support/bytes.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

using penumbra::test::expect_error;

constexpr std::size_t kHeaderBytes = 24;

std::shared_ptr<const FrameFeatures> random_features(int count, std::uint64_t seed) {
  auto f = std::make_shared<FrameFeatures>();
  for (int i = 0; i < count; ++i) {
    const std::uint64_t r = counter_random(seed, static_cast<std::uint64_t>(i));
    const bool stereo = i % 3 != 0;
    f->left.keypoints.push_back({static_cast<float>(r % 1200), static_cast<float>(r / 7 % 370),
                                 static_cast<int>(r % 3), 0.5F, static_cast<float>(i)});
    f->left.descriptors.push_back({r, ~r, r * 3, r >> 3});
    f->u_right.push_back(stereo ? 10.0F : -1.0F);
    f->depth.push_back(stereo ? 8.0F : -1.0F);
    f->colour.push_back({1, static_cast<std::uint8_t>(i), 3});
  }
  f->grid = FeatureGrid(f->left.keypoints, 1241, 376);
  return f;
}

class MapFile : public ::testing::Test {
 protected:
  MapFile() {
    std::vector<KeyFrame*> keyframes;
    for (int k = 0; k < 4; ++k) {
      keyframes.push_back(map.add_keyframe(7 * k, 0.7 * k, test::random_motion(k, 1.0, 0.3),
                                           random_features(k == 3 ? 0 : 60, static_cast<std::uint64_t>(k))));
      for (std::size_t i = 0; i < keyframes.back()->movable.size(); i += 10) keyframes.back()->movable[i] = 1;
    }
    for (int i = 0; i < 50; ++i) {
      MapPoint* point = map.add_point({0.1 * i, -1.0, 10.0}, keyframes[0], i);
      if (i % 2 == 0) map.add_observation(point, keyframes[1], i);
      map.add_observation(point, keyframes[2], 59 - i, i % 2 == 0);
      map.update_point(point);
      if (i % 5 != 0) {
        point->patch.level = i % 3;
        point->patch.offset = {0.1F, -0.2F};
        point->patch.pixels[17] = static_cast<std::uint8_t>(i);
        point->patch_depth = 9.0 + i;
      }
      point->visible = 5 + i;
      point->found = i;
    }
    for (KeyFrame* k : keyframes) map.update_covisibility(k);
    keyframes[3]->submap = 4;
    keyframes[2]->objects = {{3, "car", {1.0, 0.5, 9.0}, {10, -4, 60, 40}, true},
                             {8, "", {0.0, 1.0, 4.0}, {}, false}};
    keyframes[0]->objects = {{4, "car", {0.0, std::nan(""), 0.0}, {}, false}};
    map.set_disparity_offset(-0.125);
    map.erase_point(map.points()[9].get());
    map.erase_keyframe(keyframes[1]);
    write_map(path, map);
  }

  // Replaces the file's body and makes size and checksum fit.
  void write_body(const std::string& body) {
    std::string file = nn::read_file(path, "").substr(0, 12);
    const std::uint32_t crc = nn::crc32(body);
    const std::uint64_t size = body.size();
    file.append(reinterpret_cast<const char*>(&crc), 4).append(reinterpret_cast<const char*>(&size), 8);
    nn::write_file(path, file + body);
  }
  std::string body() const { return nn::read_file(path, "").substr(kHeaderBytes); }

  penumbra::test::TemporaryDirectory folder;
  std::filesystem::path path = folder / "street.map";
  StereoCamera camera = test::test_camera();
  Map map{camera, {1.0, 1.2, 1.44}};
};

TEST_F(MapFile, GivesTheSameMapBack) {
  const std::unique_ptr<Map> read = read_map(path);
  EXPECT_EQ(read->camera().fx, camera.fx);
  EXPECT_EQ(read->camera().width, camera.width);
  EXPECT_EQ(read->camera().disparity_offset, -0.125);
  EXPECT_EQ(read->next_object_number(), 9);
  EXPECT_EQ(read->scales(), map.scales());
  ASSERT_EQ(read->keyframes().size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const KeyFrame &a = *map.keyframes()[k], &b = *read->keyframes()[k];
    EXPECT_EQ(a.frame_index, b.frame_index);
    EXPECT_EQ(a.timestamp, b.timestamp);
    EXPECT_EQ(a.T_cw.rotation, b.T_cw.rotation);
    EXPECT_EQ(a.T_cw.translation, b.T_cw.translation);
    EXPECT_EQ(a.features->left.descriptors, b.features->left.descriptors);
    EXPECT_EQ(a.features->u_right, b.features->u_right);
    EXPECT_EQ(a.movable, b.movable);
    EXPECT_EQ(a.features->colour, b.features->colour);
    for (std::size_t i = 0; i < a.points.size(); ++i) {
      ASSERT_EQ(a.points[i] != nullptr, b.points[i] != nullptr);
      const bool shows_point = a.points[i] != nullptr;
      EXPECT_EQ(shows_point && a.aligned[i] != 0, shows_point && b.aligned[i] != 0) << i;
    }
    EXPECT_EQ(a.submap, b.submap);
    EXPECT_EQ(b.objects, k == 0 ? std::vector<SeenObject>() : a.objects);
    EXPECT_EQ(a.covisibles.size(), b.covisibles.size());
  }
  EXPECT_EQ(read->begin_submap(), 5);
  ASSERT_EQ(read->points().size(), 49U);
  const MapPoint &a = *map.points()[10], &b = *read->points()[9];
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.descriptor, b.descriptor);
  EXPECT_EQ(a.visible, b.visible);
  EXPECT_TRUE(b.patch.empty());
  const MapPoint &c = *map.points()[12], &d = *read->points()[11];
  EXPECT_EQ(c.patch.level, d.patch.level);
  EXPECT_EQ(c.patch.pixels, d.patch.pixels);
  EXPECT_EQ(c.patch.offset, d.patch.offset);
  EXPECT_EQ(c.patch_depth, d.patch_depth);
  EXPECT_EQ(a.found, b.found);
  ASSERT_EQ(a.observations.size(), b.observations.size());
  EXPECT_EQ(a.observations[1].feature, b.observations[1].feature);
}

TEST_F(MapFile, IsTheSameBytesWhenReadAndWrittenAgain) {
  const std::unique_ptr<Map> read = read_map(path);
  write_map(folder / "again.map", *read);
  EXPECT_EQ(nn::read_file(path, ""), nn::read_file(folder / "again.map", ""));
}

TEST_F(MapFile, HoldsAnEmptyMap) {
  write_map(path, Map(camera, {1.0}));
  EXPECT_TRUE(read_map(path)->keyframes().empty());
}

TEST_F(MapFile, IsRefusedWhereverItIsTorn) {
  const std::string whole = nn::read_file(path, "");
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 9) {
    nn::write_file(path, whole.substr(0, size));
    expect_error<InputError>([&] { read_map(path); }, {"street.map"});
  }
  nn::write_file(path, whole + "x");
  expect_error<InputError>([&] { read_map(path); }, {"street.map", "torn"});
}

TEST_F(MapFile, IsRefusedWhereABitIsFlipped) {
  const std::string whole = nn::read_file(path, "");
  for (std::size_t byte = 0; byte < whole.size(); byte += 97) {
    std::string damaged = whole;
    damaged[byte] = static_cast<char>(damaged[byte] ^ 4);
    nn::write_file(path, damaged);
    expect_error<InputError>([&] { read_map(path); }, {"street.map"});
  }
}

TEST_F(MapFile, OfAnotherVersionIsNamed) {
  std::string file = nn::read_file(path, "");
  file[8] = 77;
  nn::write_file(path, file);
  expect_error<InputError>([&] { read_map(path); }, {"street.map", "version 3", "version 77"});
}

TEST_F(MapFile, OfAnotherCameraIsNamed) {
  const StereoCamera saved = read_map(path)->camera();
  EXPECT_NO_THROW(require_same_camera(saved, camera, "street.map"));
  StereoCamera other = camera;
  other.fx *= 1.001;
  expect_error<InputError>([&] { require_same_camera(saved, other, "street.map"); },
                           {"street.map", "the dataset's camera", "fx"});
  other = camera;
  other.baseline *= 1.01;
  EXPECT_THROW(require_same_camera(saved, other, "street.map"), InputError);
  other = camera;
  --other.height;
  EXPECT_THROW(require_same_camera(saved, other, "street.map"), InputError);
}

TEST_F(MapFile, WithARightChecksumButWrongContentIsRefusedOrSound) {
  const std::string good = body();
  // Every word of the first keyframe's head and of the last points in turn becomes huge.
  const auto spoil = [&](std::size_t at) {
    std::string bad = good;
    for (std::size_t i = at; i < at + 4; ++i) bad[i] = '\xFF';
    write_body(bad);
    try {
      const std::unique_ptr<Map> read = read_map(path);
      for (const auto& point : read->points()) {
        for (const Observation& o : point->observations) {
          ASSERT_EQ(o.keyframe->points.at(static_cast<std::size_t>(o.feature)), point.get());
        }
      }
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("street.map"), std::string::npos);
    }
  };
  for (std::size_t at = 0; at < 300; at += 4) spoil(at);
  for (std::size_t at = good.size() - 400; at + 4 <= good.size(); at += 4) spoil(at);
}

TEST_F(MapFile, SaysWhatIsMissing) {
  expect_error<InputError>([&] { read_map(folder / "none.map"); }, {"none.map"});
  nn::write_file(path, "P5 1 1 255\n");
  expect_error<InputError>([&] { read_map(path); }, {"street.map", "a map that Penumbra saved"});
}

}  // namespace
}  // namespace penumbra::slam
