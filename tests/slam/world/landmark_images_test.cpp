// Numbers of things: stable, whole, of the right classes; and the street where every place looks like others.
#include "slam/world/landmark_images.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "slam/world/office_sequence.h"
#include "tests/slam/world/synthetic_support.h"

namespace penumbra::slam::synthetic {
namespace {

// Pixels of each class in a frame.
std::map<std::string, int> classes_in(const ThingNumbers& things, const WordImage& image) {
  const nlohmann::json list = nlohmann::json::parse(things.list());
  std::map<std::string, int> pixels;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const int number = image.at(x, y);
      ++pixels[number == 0 ? "nothing" : list.at(std::to_string(number)).at("class").get<std::string>()];
    }
  }
  return pixels;
}

TEST(LandmarkImages, AStreetHasHousesTreesAndLamps) {
  StreetSequence street({.size = {310, 94}, .landmarks = true});
  const ThingNumbers things(street.world());
  SequenceFrame frame;
  std::map<std::string, int> pixels;
  for (const int i : {0, 20, 40}) {
    street.render(i, frame);
    const WordImage image = landmark_image(things, frame.left);
    // What has an instance number has one here, the same for the whole of it.
    std::map<int, std::set<int>> numbers;
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        if (frame.left.instance.at(x, y) != 0) numbers[frame.left.instance.at(x, y)].insert(image.at(x, y));
        EXPECT_TRUE(frame.left.depth.at(x, y) > 0.0F || image.at(x, y) == 0) << "the sky is no thing";
      }
    }
    for (const auto& [instance, found] : numbers) {
      EXPECT_EQ(found.size(), 1U) << instance;
      EXPECT_NE(*found.begin(), 0) << instance;
    }
    for (const auto& [name, count] : classes_in(things, image)) pixels[name] += count;
  }
  for (const char* name : {"facade", "plant", "vehicle", "nothing"}) EXPECT_GT(pixels[name], 1000) << name;
  for (const char* name : {"lamp", "sign", "person"}) EXPECT_GT(pixels[name], 0) << name;
}

TEST(LandmarkImages, AnOfficeHasPostersScreensAndFurniture) {
  OfficeSequence office({.size = {160, 120}, .seed = 3, .depth_camera = std::nullopt, .landmarks = true});
  const ThingNumbers things(office.world());
  SequenceFrame frame;
  office.render(0, frame);
  std::map<std::string, int> pixels = classes_in(things, landmark_image(things, frame.left));
  for (const char* name : {"furniture", "screen", "poster", "person", "small thing"})
    EXPECT_GT(pixels[name], 20) << name;
  // Each number has one class and says whether it moves.
  const nlohmann::json list = nlohmann::json::parse(things.list());
  int moving = 0;
  for (const auto& [number, thing] : list.items()) moving += thing.at("moves").get<bool>() ? 1 : 0;
  EXPECT_GE(moving, 2) << "people";
  EXPECT_LT(moving, static_cast<int>(list.size()) / 4);
}

// Two frames of the street "alike" a house apart differ by no more than noise would: the same windows, the
// same lamps. A street of its own kind never does.
double difference_after(double metres, const StreetSettings& settings) {
  StreetSettings still = settings;
  still.noise = still.exposure_change = 0.0F;
  StreetSequence street({.street = still, .path = "straight", .frames = 60, .size = {310, 94}});
  RayCaster caster(street.world());
  const auto radiance_at = [&](double z, RenderedView& view) {
    SE3 T_wc = street.poses()[20].T_wc;
    T_wc.translation.z() += z;
    caster.render(street.camera(), T_wc, 2.0, view);
  };
  RenderedView here, there;
  radiance_at(0.0, here);
  radiance_at(metres, there);
  double sum = 0.0;
  int counted = 0;
  for (int y = 0; y < 94; ++y) {
    for (int x = 0; x < 310; ++x) {
      if (here.depth.at(x, y) <= 0.0F || here.depth.at(x, y) > 25.0F) continue;
      if (caster.geometry().world().objects.empty()) continue;
      if (here.instance.at(x, y) != 0) continue;
      if (y > 47) continue;  // the ground's own texture
      sum += static_cast<double>((here.radiance.at(x, y) - there.radiance.at(x, y)).cwiseAbs().mean());
      ++counted;
    }
  }
  return sum / std::max(counted, 1);
}

TEST(StreetAlike, RepeatsItselfAfterEveryHouse) {
  const double alike = difference_after(10.0, street_preset("alike"));
  EXPECT_LT(alike, 0.02);
  EXPECT_GT(difference_after(5.0, street_preset("alike")), 3.0 * alike) << "half a house on";
  EXPECT_GT(difference_after(10.0, street_preset("street")), 3.0 * alike);
}

TEST(StreetAlike, HasNothingButHousesAndLamps) {
  StreetSequence street({.street = street_preset("alike"), .path = "corner", .frames = 80});
  for (const Object& object : street.world().objects) {
    const Thing thing = thing_of(object);
    EXPECT_TRUE(thing == Thing::facade || thing == Thing::lamp) << name_of(thing);
    EXPECT_FALSE(object.motion.moves);
  }
  // The path is an L: it ends looking to the right of where it began.
  const Eigen::Vector3d forward = street.poses().back().T_wc.rotation.col(2);
  EXPECT_GT(forward.x(), 0.99);
}

TEST(StreetLamps, StandInARowBesideWhatAStreetHasAnyway) {
  const auto lamps_of = [](float per_100m) {
    StreetSettings settings;
    settings.lamps_per_100m = per_100m;
    StreetSequence street({.street = settings, .path = "straight", .frames = 2});
    int lamps = 0, others = 0;
    for (const Object& object : street.world().objects) ++(thing_of(object) == Thing::lamp ? lamps : others);
    return std::pair(lamps, others);
  };
  const auto [few, others] = lamps_of(0.0F);
  const auto [many, same_others] = lamps_of(20.0F);
  EXPECT_EQ(others, same_others);
  EXPECT_NEAR(many - few, 2 * 60, 4) << "300 m of road, both sides";
}

}  // namespace
}  // namespace penumbra::slam::synthetic
