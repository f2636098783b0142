#include "slam/world/street_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "nn/base/error.h"
#include "slam/world/road_layout.h"
#include "slam/world/street_objects.h"
#include "slam/world/street_traffic.h"

namespace penumbra::slam::synthetic {

namespace {

class StreetBuilder {
 public:
  StreetBuilder(const Drive& drive, const StreetSettings& settings, std::uint32_t seed)
      : drive_(drive), settings_(settings), random_(hash_of(seed, 0x57ee7U)) {
    world_.seed = seed;
    world_.route = drive.route;
    roads_ = lay_roads(drive.route);
    world_.road_map = RoadMap(roads_);
    track_ = RoadMap({drive.route});
    world_.camera_arc = drive.arc;
    world_.texture = settings.texture;
    light_street();
  }

  World build() {
    for (const Route& road : roads_) {
      for (const int side : {1, -1}) line_with_houses(road, side, 0.25);
    }
    // A second row closes the view through gaps and beyond bends.
    for (const Route& road : roads_) {
      for (const int side : {1, -1}) line_with_houses(road, side, 9.0);
    }
    for (const Route& road : roads_) {
      for (const int side : {1, -1}) {
        park_cars(road, side);
        if (!settings_.alike) furnish(road, side);
      }
    }
    for (const Route& road : roads_) {
      for (const int side : {1, -1}) line_with_lamps(road, side);
    }
    shade_static_objects();
    add_traffic(world_, {drive_, settings_, moving_cars_, [this](Object& object) { give_instance(object); }},
                random_);
    return std::move(world_);
  }

 private:
  // The sun stands 45 to 62 degrees high (12 to 20 in the evening) and shines across and along the first
  // heading, from before or behind, so that houses shade one side of the street only.
  void light_street() {
    float azimuth = random_.uniform(0.5F, 1.1F);
    if (!random_.chance(0.5F)) azimuth = -azimuth;
    if (random_.chance(0.6F)) azimuth += static_cast<float>(std::numbers::pi);
    float height = random_.uniform(0.78F, 1.08F);
    if (settings_.light == Light::evening) {
      height = 0.2F + 0.45F * (height - 0.78F);
      world_.sun_colour = {1.30F, 0.80F, 0.42F};
      world_.sky_colour = {0.26F, 0.28F, 0.36F};
      world_.sky_tint = {0.95F, 0.78F, 0.68F};
    } else if (settings_.light == Light::overcast) {
      world_.sun_colour = Colour::Constant(0.06F);
      world_.sky_colour = {0.72F, 0.75F, 0.80F};
      world_.clouds = 1.0F;
    }
    world_.to_sun = Eigen::Vector3f(std::cos(height) * std::sin(azimuth), -std::sin(height),
                                    std::cos(height) * std::cos(azimuth));
  }

  GroundPose beside(const Route& road, double along, int side, double lateral) const {
    GroundPose pose = road.at(along, side * lateral);
    if (side < 0) pose.heading += std::numbers::pi;
    return pose;
  }

  double road_distance(const Eigen::Vector2d& p) const {
    return world_.road_map.at(static_cast<float>(p.x()), static_cast<float>(p.y())).distance;
  }
  double track_distance(const Eigen::Vector2d& p) const {
    return track_.at(static_cast<float>(p.x()), static_cast<float>(p.y())).distance;
  }

  // Whether the camera's track stays `clearance` metres away from all of `area`.
  bool off_track(const Footprint& area, double clearance) const {
    for (const double x : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        if (track_distance(area.centre + x * area.half_x * area.axis_x + z * area.half_z * area.axis_z) <
            clearance) {
          return false;
        }
      }
    }
    return true;
  }

  bool is_free(const Footprint& area, double road_clearance) const {
    constexpr int kSamples = 8;  // along each axis: closer together than a road is wide
    for (int i = 0; i <= kSamples; ++i) {
      for (int k = 0; k <= kSamples; ++k) {
        const Eigen::Vector2d p = area.centre + area.axis_x * area.half_x * (2.0 * i / kSamples - 1.0) +
                                  area.axis_z * area.half_z * (2.0 * k / kSamples - 1.0);
        if (road_distance(p) < road_clearance || track_distance(p) < road_clearance - kPavementEnd + 4.0)
          return false;
      }
    }
    return std::none_of(houses_.begin(), houses_.end(), [&](const Footprint& h) { return h.overlaps(area); });
  }

  void line_with_houses(const Route& road, int side, double nearest) {
    if (settings_.alike) return line_with_equal_houses(road, side, nearest);
    double along = random_.uniform(0.0F, 4.0F);
    while (along < road.length()) {
      const double width = random_.uniform(7.0F, 15.0F), depth = random_.uniform(7.0F, 10.0F);
      const double setback = nearest + (random_.chance(0.6F) ? 0.0 : random_.uniform(0.2F, 3.2F));
      bool placed = false;
      for (const double scale : {1.0, 0.7, 0.45}) {
        const double w = width * scale, d = std::max(5.0, depth * scale);
        const GroundPose pose = beside(road, along + 0.5 * w, side, kPavementEnd + setback + 0.5 * d);
        const Footprint area = footprint_of(pose, 0.5 * d, 0.5 * w);
        if (along + w > road.length() || !is_free(area, kPavementEnd + 0.1)) continue;
        add_house(world_, random_, static_cast<float>(w), static_cast<float>(d)).pose = pose;
        houses_.push_back(area);
        along += w + (random_.chance(0.7F) ? 0.02 : random_.uniform(1.0F, 5.0F));
        placed = true;
        break;
      }
      if (!placed) along += 1.5;
    }
  }

  void line_with_equal_houses(const Route& road, int side, double nearest) {
    constexpr double kWidth = 10.0, kDepth = 8.0;
    for (double along = 0.0; along + kWidth <= road.length(); along += kWidth) {
      const GroundPose pose = beside(road, along + 0.5 * kWidth, side, kPavementEnd + nearest + 0.5 * kDepth);
      const Footprint area = footprint_of(pose, 0.5 * kDepth - 0.05, 0.5 * kWidth - 0.05);
      if (!is_free(area, kPavementEnd + 0.1)) continue;
      RandomSequence same(hash_of(world_.seed, 0xa11ceU));
      add_house(world_, same, static_cast<float>(kWidth), static_cast<float>(kDepth)).pose = pose;
      houses_.push_back(area);
    }
  }

  void line_with_lamps(const Route& road, int side) {
    if (settings_.lamps_per_100m <= 0.0F) return;
    const double step = 100.0 / static_cast<double>(settings_.lamps_per_100m);
    for (double along = 0.5 * step; along < road.length(); along += step) {
      const GroundPose kerb = beside(road, along, side, kKerb + 0.45);
      if (road_distance(kerb.position) < kKerb + 0.2 || track_distance(kerb.position) < 3.0) continue;
      RandomSequence same(hash_of(world_.seed, 0x1a3bU));
      add_lamp(world_, same).pose = kerb;
    }
  }

  double bend(const Route& road, double along) const {
    const double turn = road.at(along + 3.0).heading - road.at(along - 3.0).heading;
    return std::abs(std::remainder(turn, 2.0 * std::numbers::pi));
  }

  void park_cars(const Route& road, int side) {
    double along = random_.uniform(1.0F, 6.0F);
    while (along < road.length()) {
      const bool lorry = random_.chance(settings_.lorries);
      const double place = random_.uniform(5.3F, 6.3F) + (lorry ? 3.5 : 0.0);
      if (along + place > road.length()) break;  // a closed road's first place follows
      const GroundPose pose = beside(road, along + 0.5 * place, side,
                                     kParkedCentre + (lorry ? 0.25F : random_.uniform(-0.08F, 0.1F)));
      const Footprint area = footprint_of(pose, lorry ? 1.35 : 1.1, lorry ? 4.4 : 2.7);
      const bool wanted = random_.chance(settings_.parked_cars);
      if (wanted && road_distance(pose.position) > kParkedCentre - 0.5 && off_track(area, 1.2) &&
          bend(road, along + 0.5 * place) < 0.15) {
        if (settings_.moving && random_.chance(*settings_.moving)) {
          ++moving_cars_;
          along += place;
          continue;
        }
        Object& car = lorry ? add_lorry(world_, random_) : add_car(world_, random_);
        car.pose = pose;
        const double askew = random_.uniform(-0.03F, 0.03F);
        car.pose.heading += askew + (random_.chance(0.12F) ? std::numbers::pi : 0.0);
        give_instance(car);
      }
      along += place;
    }
  }

  void furnish(const Route& road, int side) {
    double along = random_.uniform(2.0F, 9.0F);
    while (along < road.length()) {
      const GroundPose kerb = beside(road, along, side, kKerb + 0.75),
                       back = beside(road, along, side, kPavementEnd + 0.6);
      const auto stands = [&](const GroundPose& pose) {
        return road_distance(pose.position) > kKerb + 0.5 && track_distance(pose.position) > 3.0 &&
               std::none_of(houses_.begin(), houses_.end(),
                            [&](const Footprint& h) { return h.overlaps(footprint_of(pose, 0.4, 0.4)); });
      };
      if (stands(kerb)) {
        const float kind = random_.uniform();
        if (kind < 0.5F) {
          add_tree(world_, random_).pose = kerb;
        } else if (kind < 0.7F) {
          add_lamp(world_, random_).pose = kerb;
        } else if (kind < 0.85F) {
          give_instance(add_sign(world_, random_, kerb));
        } else {
          add_bin(world_, random_).pose = kerb;
        }
      }
      const double length = random_.uniform(3.0F, 6.0F);
      if (stands(back) && is_free(footprint_of(back, 0.5, 0.5 * length), kPavementEnd + 0.05)) {
        add_hedge(world_, random_, static_cast<float>(length)).pose = back;
      }
      // Trees in the gardens and gaps between houses.
      const GroundPose garden = beside(road, along, side, kPavementEnd + random_.uniform(3.0F, 8.0F));
      if (is_free(footprint_of(garden, 1.8, 1.8), kPavementEnd + 0.5))
        add_tree(world_, random_).pose = garden;
      along += random_.uniform(4.0F, 9.0F);
    }
  }

  // Cars and furniture in the shade of a house get little sun.
  void shade_static_objects() {
    for (Object& object : world_.objects) {
      if (object.upper.x() - object.lower.x() > 4.9F) continue;  // houses light themselves
      const Eigen::Vector3d middle(object.pose.position.x(), -1.0, object.pose.position.y());
      for (const Object& house : world_.objects) {
        if (house.upper.x() - house.lower.x() <= 4.9F ||
            (house.pose.position - object.pose.position).norm() > 35.0) {
          continue;
        }
        const Eigen::Matrix3d to_house = rotation_of(house.pose.heading).transpose();
        const Eigen::Vector3d offset(middle.x() - house.pose.position.x(), middle.y(),
                                     middle.z() - house.pose.position.y());
        const float shade = chord(world_.bodies[static_cast<std::size_t>(house.first_body)],
                                  (to_house * offset).cast<float>(), to_house.cast<float>() * world_.to_sun);
        if (shade > 0.3F) object.sunlight = 0.15F;
      }
    }
  }

  void give_instance(Object& object) {
    if (instances_ == std::numeric_limits<std::uint16_t>::max()) {
      throw UsageError("the drive is too long: its street has more than 65535 cars, people and signs");
    }
    object.instance = ++instances_;
  }

  const Drive& drive_;
  StreetSettings settings_;
  RandomSequence random_;
  World world_;
  std::vector<Route> roads_;
  RoadMap track_;
  std::vector<Footprint> houses_;
  int moving_cars_ = 0;  // that settings_.moving takes from the parking places
  std::uint16_t instances_ = 0;
};

}  // namespace

World build_street(const Drive& drive, const StreetSettings& settings, std::uint32_t seed) {
  return StreetBuilder(drive, settings, seed).build();
}

}  // namespace penumbra::slam::synthetic
