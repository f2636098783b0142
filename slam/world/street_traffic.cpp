#include "slam/world/street_traffic.h"

#include <algorithm>
#include <cmath>

#include "slam/world/street_objects.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr double kOncomingSpeed = 9.0;  // metres per second
constexpr double kCheckStep = 0.2;      // seconds between the looks for collisions

class Traffic {
 public:
  Traffic(World& world, const TrafficPlan& plan, RandomSequence& random)
      : world_(world), plan_(plan), drive_(plan.drive), settings_(plan.settings), random_(random) {
    first_ = drive_.arc.front();
    last_ = drive_.arc.back();
    last_time_ = drive_.poses.back().timestamp;
    tracks_.push_back(camera_track());
  }

  void add() {
    if (settings_.lorry) {
      lead_with_lorry(*settings_.lorry);
    } else if (settings_.car_ahead) {
      drive_ahead();
    }
    if (settings_.moving) {
      spread_oncoming(plan_.moving_cars);
    } else if (settings_.traffic > 0.0F) {
      meet_oncoming(static_cast<double>(settings_.oncoming_seconds / settings_.traffic));
    }
    add_people();
    add_cyclists();
  }

 private:
  using Track = std::vector<GroundPose>;  // at 0, kCheckStep, 2 kCheckStep, ...

  Track camera_track() const {
    Track track;
    for (double time = 0.0; time <= last_time_; time += kCheckStep) {
      const auto frame = std::min(static_cast<std::size_t>(time * kFrameRate + 0.5), drive_.poses.size() - 1);
      const SE3& pose = drive_.poses[frame].T_wc;
      track.push_back({{pose.translation.x(), pose.translation.z()},
                       std::atan2(pose.rotation(0, 2), pose.rotation(2, 2))});
    }
    return track;
  }

  Track track_of(const Motion& motion) const {
    Object object;
    object.motion = motion;
    Track track;
    for (double time = 0.0; time <= last_time_; time += kCheckStep)
      track.push_back(pose_at(world_, object, time));
    return track;
  }

  // Cars in neighbouring lanes pass each other at 3.3 m; cars that cross need their whole length.
  static bool collide(const Track& a, const Track& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double squared = (a[i].position - b[i].position).squaredNorm();
      if (squared > 64.0) continue;
      const bool crossing = std::abs(std::sin(a[i].heading - b[i].heading)) > 0.6;
      const double least = crossing ? 8.0 : 2.7;
      if (squared < least * least) return true;
    }
    return false;
  }

  // Adds a car or lorry with that motion unless it would run into another or the camera.
  bool drive(const Motion& motion, float lorries) {
    Track track = track_of(motion);
    for (const Track& other : tracks_) {
      if (collide(track, other)) return false;
    }
    tracks_.push_back(std::move(track));
    Object& car = random_.chance(lorries) ? add_lorry(world_, random_) : add_car(world_, random_);
    car.motion = motion;
    plan_.give_instance(car);
    return true;
  }

  bool has_room(double start) const {
    constexpr double kCarSpace = 14.0;
    return std::none_of(starts_.begin(), starts_.end(), [&](double other) {
      double apart = std::abs(start - other);
      if (world_.route.closed()) apart = std::abs(std::remainder(apart, world_.route.length()));
      return apart < kCarSpace;
    });
  }

  bool drive_oncoming(double start) {
    if (!has_room(start)) return false;
    const double lane = -2.0 * static_cast<double>(kLaneCentre);
    if (!drive({.moves = true, .arc = start, .speed = -kOncomingSpeed, .right = lane}, settings_.lorries))
      return false;
    starts_.push_back(start);
    return true;
  }

  // Oncoming cars, each meeting the camera at its own time.
  void meet_oncoming(double seconds) {
    double meet = std::min(0.6 * last_time_, 3.2);
    do {
      const auto frame = static_cast<std::size_t>(meet * kFrameRate);
      drive_oncoming(drive_.arc[std::min(frame, drive_.arc.size() - 1)] + kOncomingSpeed * meet);
      meet += std::max(seconds, 0.5) * static_cast<double>(random_.uniform(0.7F, 1.3F));
    } while (meet < last_time_);
  }

  // A number of oncoming cars, as many as find room, anywhere along the drive.
  void spread_oncoming(int count) {
    const double span = last_ - first_ + kOncomingSpeed * last_time_ + 60.0;
    for (int i = 0; i < count; ++i) {
      for (int attempt = 0; attempt < 4; ++attempt) {
        if (drive_oncoming(first_ - 10.0 + span * static_cast<double>(random_.uniform()))) break;
      }
    }
  }

  void drive_ahead() {
    constexpr double kStart = 14.0;  // metres
    double speed = 1.0;
    for (std::size_t i = 1; i < drive_.arc.size(); ++i) {
      speed = std::max(speed, (drive_.arc[i] - first_) / drive_.poses[i].timestamp + 1.0);
    }
    // On a closed route it must not come round to the camera's back.
    const double gained = kStart + speed * last_time_ - (last_ - first_);
    if (world_.route.closed() && gained > world_.route.length() - 20.0) return;
    drive({.moves = true, .arc = first_ + kStart, .speed = speed}, 0.0F);
  }

  void lead_with_lorry(const LorryAhead& ahead) {
    // Narrow enough that a rim of the street remains in view from 1.5 m behind it, and high.
    Object& lorry = add_lorry(world_, random_, {6.0F, 2.2F, 4.0F});
    Motion& motion = lorry.motion;
    motion.moves = motion.leads = true;
    // From the camera to the rear, but the motion is that of the middle.
    const double half = static_cast<double>(lorry.upper.z());
    motion.nearest = static_cast<double>(ahead.nearest) + half;
    motion.farthest = static_cast<double>(ahead.farthest) + half;
    plan_.give_instance(lorry);
    tracks_.push_back(track_of(motion));
  }

  int count_along(float per_100m) const {
    return static_cast<int>(std::lround(span() * static_cast<double>(per_100m * settings_.traffic) / 100.0));
  }
  double span() const {
    const double beyond = last_ + 60.0 - first_;
    return world_.route.closed() ? std::min(beyond, world_.route.length()) : beyond;
  }

  // Whether a walk stays on pavements and crossings; behind them are gardens and houses.
  bool stays_out_of_houses(const Motion& motion) const {
    const Track track = track_of(motion);
    return std::all_of(track.begin(), track.end(), [&](const GroundPose& pose) {
      const auto x = static_cast<float>(pose.position.x()), z = static_cast<float>(pose.position.y());
      return world_.road_map.at(x, z).distance < kPavementEnd;
    });
  }

  void add_people() {
    const int count = count_along(settings_.people_per_100m);
    for (int i = 0; i < count; ++i) {
      for (int attempt = 0; attempt < 4; ++attempt) {
        const double side = random_.chance(0.5F) ? 1.0 : -1.0, lateral = random_.uniform(6.6F, 7.8F);
        const double arc = first_ + span() * static_cast<double>(random_.uniform());
        const double pace = random_.uniform(0.9F, 1.6F), speed = random_.chance(0.5F) ? pace : -pace;
        const double right = side * lateral - static_cast<double>(kLaneCentre);
        const Motion motion{.moves = true, .arc = arc, .speed = speed, .right = right};
        if (!stays_out_of_houses(motion)) continue;
        Object& person = add_person(world_, random_);
        person.motion = motion;
        plan_.give_instance(person);
        break;
      }
    }
  }

  // Cyclists of both directions keep between the lane and the parked cars; a lorry leaves them no room in its
  // own direction.
  void add_cyclists() {
    const int count = count_along(settings_.cyclists_per_100m);
    for (int i = 0; i < count; ++i) {
      const bool oncoming = random_.chance(0.5F) || settings_.lorry;
      const double beside_lane = 1.25 + static_cast<double>(random_.uniform(-0.08F, 0.12F));
      const double arc =
          first_ + 8.0 + span() * static_cast<double>(random_.uniform()) * (oncoming ? 1.5 : 1.0);
      const double speed = random_.uniform(3.2F, 5.0F);
      Object& cyclist = add_cyclist(world_, random_);
      cyclist.motion = {
          .moves = true,
          .arc = arc,
          .speed = oncoming ? -speed : speed,
          .right = oncoming ? -2.0 * static_cast<double>(kLaneCentre) - beside_lane : beside_lane};
      plan_.give_instance(cyclist);
    }
  }

  World& world_;
  const TrafficPlan& plan_;
  const Drive& drive_;
  const StreetSettings& settings_;
  RandomSequence& random_;
  double first_ = 0.0, last_ = 0.0, last_time_ = 0.0;  // arc lengths of the first and last frame, metres; s
  std::vector<double> starts_;                         // of oncoming cars
  std::vector<Track> tracks_;                          // of the camera and all cars
};

}  // namespace

void add_traffic(World& world, const TrafficPlan& plan, RandomSequence& random) {
  Traffic(world, plan, random).add();
}

}  // namespace penumbra::slam::synthetic
