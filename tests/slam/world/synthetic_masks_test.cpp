// Visible and whole masks of the street's objects.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/evaluation/coco_rle.h"
#include "slam/world/coco_annotations.h"
#include "slam/world/street_objects.h"
#include "tests/slam/world/synthetic_support.h"

namespace penumbra::slam::synthetic {
namespace {

// A camera 1.65 m above the ground at the origin, and `world` with cars at the given distances ahead of it.
World world_with_cars(const std::vector<Eigen::Vector2d>& places) {
  World world;
  world.seed = 5;
  RandomSequence random(9);
  std::uint16_t instance = 0;
  for (const Eigen::Vector2d& place : places) {
    Object& car = add_car(world, random);
    car.pose = {place, 0.3};
    car.instance = ++instance;
  }
  return world;
}

std::vector<InstanceMasks> masks_in(const World& world, const StereoCamera& camera) {
  SE3 pose;
  pose.translation = {0.0, -kCameraHeight, 0.0};
  RayCaster caster(world);
  RenderedView view;
  caster.render(camera, pose, 0.0, view);
  return find_instances(caster.geometry(), view);
}

TEST(SyntheticMasks, VisibleMasksAreTheIdImageAndLieInsideTheWholeOnes) {
  StreetSequence street({.street = street_preset("crowded"), .annotations = true});
  SequenceFrame frame;
  int hidden = 0;
  for (const int i : {0, 30}) {
    street.render(i, frame);
    WordImage ids = WordImage::filled(frame.left.instance.width(), frame.left.instance.height(), 0);
    for (const InstanceMasks& masks : frame.instances) {
      EXPECT_LE(masks.visible_area, masks.whole_area);
      EXPECT_GT(masks.whole_area, 0);
      hidden += masks.occlusion() > 0.1F && masks.visible_area > 0 ? 1 : 0;
      int visible = 0, whole = 0;
      for (int v = 0; v < ids.height(); ++v) {
        for (int u = 0; u < ids.width(); ++u) {
          whole += masks.whole.contains(u, v) ? 1 : 0;
          if (!masks.visible.contains(u, v)) continue;
          ++visible;
          ids.at(u, v) = masks.instance;
          EXPECT_TRUE(masks.whole.contains(u, v));
        }
      }
      EXPECT_EQ(visible, masks.visible_area);
      EXPECT_EQ(whole, masks.whole_area);
    }
    EXPECT_EQ(hash_image(ids), hash_image(frame.left.instance)) << "frame " << i;
  }
  EXPECT_GT(hidden, 5);
}

TEST(SyntheticMasks, TheWholeMaskIsWhatShowsWhenNothingHidesTheObject) {
  const StereoCamera camera = street_camera({620, 188});
  const auto both = masks_in(world_with_cars({{0.4, 18.0}, {-0.5, 10.0}}), camera);
  const auto alone = masks_in(world_with_cars({{0.4, 18.0}}), camera);
  ASSERT_EQ(both.size(), 2U);
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_GT(both[0].occlusion(), 0.3F);
  EXPECT_LT(both[0].occlusion(), 0.99F);
  EXPECT_EQ(both[1].occlusion(), 0.0F);
  EXPECT_EQ(alone[0].occlusion(), 0.0F);
  EXPECT_EQ(both[0].whole.bits, alone[0].visible.bits);
  EXPECT_EQ(both[0].whole.x, alone[0].visible.x);
  EXPECT_EQ(both[0].whole.y, alone[0].visible.y);
}

TEST(SyntheticMasks, AWhollyHiddenObjectHasAnEmptyVisibleMaskAndNoAnnotation) {
  World world = world_with_cars({{0.0, 60.0}});
  RandomSequence random(1);
  Object& lorry = add_lorry(world, random);  // a car would not do: the camera looks over its roof
  lorry.pose = {{0.0, 10.0}, 0.0};
  lorry.instance = 2;
  const auto masks = masks_in(world, street_camera({620, 188}));
  ASSERT_EQ(masks.size(), 2U);
  EXPECT_EQ(masks[0].visible_area, 0);
  EXPECT_TRUE(masks[0].visible.bits.empty());
  EXPECT_EQ(masks[0].occlusion(), 1.0F);
  CocoWriter writer({620, 188});
  writer.add("a.png", masks);
  const auto json = nlohmann::json::parse(writer.finish());
  ASSERT_EQ(json.at("annotations").size(), 1U);
  const auto& entry = json.at("annotations")[0];
  EXPECT_EQ(entry.at("instance_id"), 2);
  EXPECT_EQ(entry.at("segmentation"), entry.at("amodal_segmentation"));
  const auto runs =
      nn::decode_runs(entry.at("segmentation").at("counts").get<std::string>(), std::uint64_t{620} * 188);
  int area = 0;
  for (std::size_t i = 1; i < runs.size(); i += 2) area += static_cast<int>(runs[i]);
  EXPECT_EQ(entry.at("area"), area);
}

TEST(SyntheticMasks, SignsSeenFromBehindAreNotAnnotated) {
  const StereoCamera camera = street_camera({620, 188});
  CocoWriter writer({620, 188});
  for (const double heading : {0.0, 3.1}) {
    World world;
    RandomSequence random(3);
    add_sign(world, random, {{0.0, 8.0}, heading}).instance = 1;
    const auto masks = masks_in(world, camera);
    ASSERT_EQ(masks.size(), 1U);
    EXPECT_GT(masks[0].visible_area, kMinVisiblePixels);
    writer.add("a.png", masks);
  }
  const auto json = nlohmann::json::parse(writer.finish());
  ASSERT_EQ(json.at("annotations").size(), 1U);
  EXPECT_EQ(json.at("annotations")[0].at("image_id"), 1);
}

}  // namespace
}  // namespace penumbra::slam::synthetic
