// Recordings of the office: every preset renders, bytes repeat, truth agrees with itself.
#include "slam/world/office_sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "slam/frontend/features/orb_extractor.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/open_dataset.h"
#include "slam/world/hand_held_path.h"
#include "slam/world/layouts.h"
#include "tests/slam/world/synthetic_support.h"
#include "tests/support/test_data.h"

namespace penumbra::slam::synthetic {
namespace {

using test::TemporaryDirectory;

OfficeSettings small(const std::string& preset, std::uint32_t seed = 3, int frames = 40) {
  OfficeSettings settings = office_preset(preset);
  settings.size = {320, 240};
  settings.frames = frames;
  settings.seed = seed;
  return settings;
}

TEST(OfficeSequence, EveryPresetRenders) {
  for (const char* preset :
       {"walking-xyz", "walking-static", "walking-rpy", "walking-halfsphere", "sitting-xyz", "sitting-static",
        "sitting-rpy", "sitting-halfsphere", "desk", "twolaps"}) {
    OfficeSettings settings = small(preset);
    settings.size = {160, 120};
    OfficeSequence office(settings);
    SequenceFrame frame;
    for (const int i : {0, 25}) {
      office.render(i, frame);
      int holes = 0, sensed = 0, people = 0;
      for (int v = 0; v < 120; ++v) {
        for (int u = 0; u < 160; ++u) {
          ASSERT_GT(frame.left.depth.at(u, v), 0.0F) << preset;  // the room is closed
          EXPECT_LT(frame.left.depth.at(u, v), 12.0F);
          sensed += frame.sensed_depth.at(u, v) > 0.0F ? 1 : 0;
          holes += frame.sensed_depth.at(u, v) == 0.0F ? 1 : 0;
          people += frame.left.instance.at(u, v) != 0 ? 1 : 0;
        }
      }
      EXPECT_GT(sensed, 160 * 120 / 2) << preset;
      EXPECT_GT(holes, 160 * 120 / 20) << preset;
      EXPECT_GT(people, 100) << preset;
    }
  }
  EXPECT_THROW(office_preset("running-xyz"), UsageError);
  EXPECT_THROW(OfficeSequence{[] {
                 OfficeSettings settings;
                 settings.path = "spiral";
                 return settings;
               }()},
               UsageError);
}

std::uint64_t hash_of_office(std::uint32_t seed, int threads) {
  const int before = thread_count();
  set_thread_count(threads);
  OfficeSettings settings = small("walking-rpy", seed);
  settings.flow = settings.annotations = true;
  OfficeSequence office(settings);
  SequenceFrame frame;
  std::uint64_t hash = 1;
  for (const int i : {30, 4}) {
    office.render(i, frame);
    hash = hash_image(frame.left_bgr, hash_image(frame.sensed_depth, hash));
    hash = hash_image(frame.left.instance, hash_image(frame.flow, hash));
    for (const InstanceMasks& masks : frame.instances)
      hash = hash * 31U + static_cast<std::uint64_t>(masks.whole_area);
  }
  set_thread_count(before);
  return hash;
}

TEST(OfficeSequence, TheSameSeedGivesTheSameBytesForAnyNumberOfThreads) {
  const std::uint64_t one = hash_of_office(5, 1);
  EXPECT_EQ(one, hash_of_office(5, 2));
  EXPECT_EQ(one, hash_of_office(5, 5));
  EXPECT_NE(one, hash_of_office(6, 2));
}

TEST(OfficeSequence, AnInstanceIsTheUnionOfItsLimbs) {
  OfficeSettings settings = small("sitting-static");
  settings.annotations = true;
  OfficeSequence office(settings);
  SequenceFrame frame;
  office.render(10, frame);
  std::map<std::uint16_t, int> visible;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) ++visible[frame.left.instance.at(u, v)];
  }
  int people = 0;
  std::uint16_t last = 0;
  for (const InstanceMasks& masks : frame.instances) {
    EXPECT_GT(masks.instance, last) << "one entry an instance, in their order";
    last = masks.instance;
    EXPECT_EQ(masks.visible_area, visible[masks.instance]);
    EXPECT_GE(masks.whole_area, masks.visible_area);
    people += masks.object_class == ObjectClass::person ? 1 : 0;
    if (masks.object_class == ObjectClass::person) {
      EXPECT_TRUE(masks.moving);
    }
  }
  EXPECT_EQ(people, 2);
}

TEST(OfficeSequence, FlowLeadsToTheSamePersonInTheNextFrame) {
  OfficeSettings settings = small("walking-static", 2, 90);
  settings.flow = true;
  OfficeSequence office(settings);
  SequenceFrame now, next;
  office.render(70, now);
  office.render(71, next);
  int on_people = 0, same = 0, moved = 0;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const std::int32_t object = now.left.object.at(u, v);
      if (object < 0 ||
          office.world().objects[static_cast<std::size_t>(object)].object_class != ObjectClass::person)
        continue;
      const std::array<float, 3>& flow = now.flow.at(u, v);
      const int to_u = static_cast<int>(std::lround(static_cast<float>(u) + flow[0]));
      const int to_v = static_cast<int>(std::lround(static_cast<float>(v) + flow[1]));
      if (to_u < 0 || to_v < 0 || to_u >= 320 || to_v >= 240) continue;
      ++on_people;
      moved += std::hypot(flow[0], flow[1]) > 0.5F ? 1 : 0;
      same += next.left.object.at(to_u, to_v) == object ? 1 : 0;
    }
  }
  EXPECT_GT(on_people, 2000);
  EXPECT_GT(moved, on_people / 4);
  EXPECT_GT(same, on_people * 85 / 100);  // the rest is hidden by another limb, or an edge
}

TEST(OfficeSequence, PathsAreThoseTheyAreNamedFor) {
  const auto extent = [](const Trajectory& poses) {
    Eigen::Vector3d low = poses.front().T_wc.translation, high = low;
    double turned = 0.0;
    for (const TimedPose& pose : poses) {
      low = low.cwiseMin(pose.T_wc.translation);
      high = high.cwiseMax(pose.T_wc.translation);
      turned = std::max(turned, (poses.front().T_wc.inverse() * pose.T_wc).angle());
    }
    return std::pair<Eigen::Vector3d, double>(high - low, turned * 180.0 / 3.14159265);
  };
  const auto of = [&](const char* kind) {
    HandHeldPath path;
    path.kind = kind;
    path.seed = 11;
    const Trajectory poses = hand_held_trajectory(path, 600);
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const SE3 step = poses[i - 1].T_wc.inverse() * poses[i].T_wc;
      EXPECT_LT(step.translation.norm(), path.kind == "twolaps" ? 0.09 : 0.045)
          << kind << " frame " << i;                            // 1.3 m/s
      EXPECT_LT(step.angle(), 0.05) << kind << " frame " << i;  // 86 degrees a second
    }
    return extent(poses);
  };
  EXPECT_LT(of("still").first.maxCoeff(), 0.04);
  EXPECT_LT(of("still").second, 3.0);
  EXPECT_GT(of("xyz").first.minCoeff(), 0.3);
  EXPECT_LT(of("xyz").second, 12.0);
  EXPECT_LT(of("rpy").first.maxCoeff(), 0.2);
  EXPECT_GT(of("rpy").second, 20.0);
  EXPECT_LT(of("rpy").second, 40.0);
  EXPECT_GT(of("halfsphere").first.x(), 0.6);
  EXPECT_LT(of("halfsphere").first.x(), 1.05);
  HandHeldPath laps;
  laps.kind = "twolaps";
  const Trajectory poses = hand_held_trajectory(laps, 1500);
  EXPECT_LT((poses.front().T_wc.inverse() * poses.back().T_wc).log().norm(), 1e-6);
  EXPECT_NEAR(extent(poses).first.x(), 7.0, 0.1);
  EXPECT_NEAR(extent(poses).first.z(), 5.0, 0.1);
}

TEST(OfficeSequence, APoseFileIsFollowed) {
  const TemporaryDirectory folder;
  HandHeldPath path;
  const Trajectory poses = hand_held_trajectory(path, 40);
  write_tum_trajectory(folder / "way.txt", poses);
  OfficeSettings settings = small("sitting-xyz", 1, 30);
  settings.path = (folder / "way.txt").string();
  OfficeSequence office(settings);
  ASSERT_EQ(office.size(), 30);
  for (const std::size_t i : {0U, 13U, 29U}) {
    const SE3 wanted = poses.front().T_wc.inverse() * poses[i].T_wc,
              found = office.poses().front().T_wc.inverse() * office.poses()[i].T_wc;
    EXPECT_LT((wanted.inverse() * found).log().norm(), 1e-6);
  }
  settings.frames = 41;
  EXPECT_THROW(OfficeSequence{settings}, UsageError);
}

TEST(OfficeSequence, TheWritersFilesFitTogether) {
  const TemporaryDirectory folder;
  OfficeSettings settings = small("walking-xyz", 2, 3);
  settings.annotations = settings.flow = settings.amodal = true;
  settings.depth_camera = depth_camera("d435");
  OfficeSequence office(settings);
  write_tum_layout(office, folder / "out", false);
  for (const char* name :
       {"rgb/0.033333.png", "depth/0.066667.png", "depth_clean/0.000000.png", "instances/0.000000.png",
        "flow/0.033333.png", "amodal/0.000000", "annotations/instances.json", "depth_clean.txt"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out/flow/0.066667.png"));
  std::ifstream list(folder / "out/instances.json"), annotations(folder / "out/annotations/instances.json");
  const auto instances = nlohmann::json::parse(list), coco = nlohmann::json::parse(annotations);
  std::map<std::string, int> classes;
  for (const auto& [id, entry] : instances.items()) ++classes[entry["class"]];
  EXPECT_EQ(classes["person"], 2);
  EXPECT_GE(classes["chair"], 3);
  EXPECT_GE(classes["tv"], 2);
  EXPECT_EQ(coco["categories"].size(), 11U);
  for (const auto& annotation : coco["annotations"]) {
    const auto id = std::to_string(annotation["instance_id"].get<int>());
    ASSERT_TRUE(instances.contains(id));
    EXPECT_EQ(instances[id]["moving"], annotation["moving"]);
  }
  EXPECT_EQ(read_tum_trajectory(folder / "out/groundtruth.txt").size(), 3U);
}

TEST(OfficeSequence, DepthMayComeAfterTheColours) {
  const TemporaryDirectory folder;
  OfficeSettings settings = small("sitting-rpy", 4, 3);
  OfficeSequence at_once(settings);
  settings.depth_delay = 0.016F;
  OfficeSequence late(settings);
  SequenceFrame now, then;
  at_once.render(2, now);
  late.render(2, then);
  EXPECT_EQ(hash_image(now.left_bgr), hash_image(then.left_bgr));
  EXPECT_NE(hash_image(now.sensed_depth), hash_image(then.sensed_depth));
  write_tum_layout(late, folder / "out", false);
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder / "out");
  ASSERT_EQ(dataset->size(), 3);
  const StereoImages images = dataset->load(1);
  EXPECT_NEAR(images.timestamp, 1.0 / 30.0, 1e-5);
  EXPECT_NEAR(images.depth_delay, 0.016, 1e-5);
  settings.depth_delay = 0.1F;
  EXPECT_THROW(OfficeSequence{settings}, UsageError);
}

TEST(OfficeSequence, ARollingShutterTakesEveryRowAtATimeOfItsOwn) {
  OfficeSettings settings = small("sitting-rpy", 4, 30);
  settings.people = People::none;
  settings.exposure_change = settings.noise = 0.0F;
  OfficeSequence at_once(settings);
  settings.readout = 1.0F / 30.0F;
  OfficeSequence rolling(settings);
  SequenceFrame still, row_by_row;
  const auto difference = [&](int band) {
    double sum = 0.0;
    for (int v = band * kTileHeight; v < (band + 1) * kTileHeight; ++v) {
      for (int u = 0; u < 320; ++u) {
        sum += static_cast<double>((still.left.radiance.at(u, v) - row_by_row.left.radiance.at(u, v)).norm());
      }
    }
    return sum / (320.0 * kTileHeight);
  };
  at_once.render(20, still);
  rolling.render(20, row_by_row);
  EXPECT_EQ(hash_image(still.left.depth), hash_image(row_by_row.left.depth));
  EXPECT_LT(difference(7), 0.3 * difference(1));  // the middle rows are taken at the frame's own time
  EXPECT_LT(difference(7), 0.3 * difference(13));
}

TEST(OfficeSequence, OrbFindsFeaturesNearAndFarWithoutPeople) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    OfficeSettings settings = small("sitting-xyz", seed, 2);
    settings.size = {640, 480};
    OfficeSequence office(settings);
    SequenceFrame frame;
    office.render(0, frame);
    ByteImage grey(640, 480);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) grey.at(u, v) = frame.left_bgr.at(u, v, 1);
    }
    Features features;
    OrbExtractor({}).extract(grey, features);
    int still = 0, near = 0, far = 0;
    for (const Keypoint& point : features.keypoints) {
      const int u = static_cast<int>(point.u), v = static_cast<int>(point.v);
      const float z = frame.left.depth.at(u, v);
      near += z < 2.5F ? 1 : 0;
      far += z > 3.5F ? 1 : 0;
      still += frame.left.instance.at(u, v) == 0 ? 1 : 0;
    }
    EXPECT_GT(still, 200) << "seed " << seed;
    EXPECT_GT(near, 150) << "seed " << seed;
    EXPECT_GT(far, 100) << "seed " << seed;
  }
}

}  // namespace
}  // namespace penumbra::slam::synthetic
