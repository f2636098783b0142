#include "slam/world/office_people.h"

#include <cmath>
#include <memory>

#include "slam/world/office_objects.h"

namespace penumbra::slam::synthetic {

namespace {

using Kind = Step::Kind;

Step walk_to(double x, double z, double speed) {
  return {.kind = Kind::walk, .place = {x, z}, .speed = speed};
}
Step stand_for(double seconds) { return {.kind = Kind::stand, .seconds = seconds}; }

// A random way through the office, which begins before the desks on the left (-1) or right (1).
class Wanderer {
 public:
  Wanderer(RandomSequence& random, double lane, double side) : random_(random), lane_(lane), side_(side) {}

  void add_moves(std::vector<Step>& steps, int count) {
    for (int i = 0; i < count; ++i) add_move(steps);
  }

 private:
  double between(float from, float to) { return static_cast<double>(random_.uniform(from, to)); }
  double pace() { return between(0.5F, 0.95F); }
  double front() { return -1.38 + lane_ + between(-0.15F, 0.15F); }

  void add_move(std::vector<Step>& steps) {
    const float choice = random_.uniform();
    if (choice < 0.50F) {  // across the picture
      const double speed = pace();
      side_ = -side_;
      const double x = side_ * between(0.55F, 1.0F);
      steps.push_back(walk_to(x, front(), speed));
      if (random_.chance(0.3F)) steps.push_back(stand_for(between(0.3F, 0.8F)));
    } else if (choice < 0.70F) {  // towards the camera
      const double speed = 0.8 * pace();
      const double x = between(-0.25F, 0.25F);
      steps.push_back(walk_to(1.5 * x, -0.75 + lane_, speed));
      steps.push_back(walk_to(x, -1.60 + lane_, 0.7 * speed));
      steps.push_back(stand_for(between(0.4F, 1.0F)));
      side_ = random_.chance(0.5F) ? 1.0 : -1.0;
      const double end = side_ * between(0.6F, 1.0F);
      steps.push_back(walk_to(end, front(), speed));
    } else if (choice < 0.86F) {  // half outside the picture
      const double speed = pace();
      const double x = side_ * between(0.52F, 0.75F);
      steps.push_back(walk_to(x, front(), speed));
      steps.push_back(stand_for(between(0.5F, 1.4F)));
    } else {  // round the desks
      const double speed = pace(), back = 1.05 + lane_ + between(0.0F, 0.4F);
      steps.push_back(walk_to(side_ * 1.85, -0.3, speed));
      steps.push_back(walk_to(side_ * 1.6, back, speed));
      side_ = -side_;
      steps.push_back(walk_to(side_ * 1.6, back, speed));
      if (random_.chance(0.3F)) {  // and back again behind them
        side_ = -side_;
        steps.push_back(walk_to(side_ * 1.6, back, speed));
      }
      steps.push_back(walk_to(side_ * 1.85, -0.3, speed));
      const double end = side_ * between(0.2F, 0.7F);
      steps.push_back(walk_to(end, front(), speed));
    }
  }

  RandomSequence& random_;
  double lane_, side_;
};

}  // namespace

void add_people(World& world, RandomSequence& random, const Crew& crew) {
  if (crew.people == People::none) return;
  const int pusher = random.chance(0.6F) ? random.below(2) : -1;
  const int carrier = random.chance(0.6F) ? (pusher >= 0 ? 1 - pusher : random.below(2)) : -1;
  for (int number = 0; number < 2; ++number) {
    const GroundPose& chair = crew.chairs[static_cast<std::size_t>(number)];
    const double side = number == 0 ? -1.0 : 1.0;
    const double stature = static_cast<double>(random.uniform(1.58F, 1.92F));
    const Build build{.stature = stature, .girth = random.uniform(0.9F, 1.2F)};
    const Eigen::Vector2d ahead(std::sin(chair.heading), std::cos(chair.heading)),
        right(ahead.y(), -ahead.x());
    std::vector<Step> steps{
        {.kind = Kind::sit, .seconds = 1e9, .place = chair.position, .heading = chair.heading}};
    std::vector<Prop> props{{.start = on_ground(chair)}};
    int loop_from = 0;
    if (crew.people == People::walking) {
      steps[0].seconds = static_cast<double>(random.uniform(0.2F, 1.5F));
      steps.push_back({.kind = Kind::rise});
      if (number == pusher) {
        const Eigen::Vector2d beside = chair.position + 0.65 * side * right,
                              behind = chair.position - 0.62 * ahead;
        steps.push_back(walk_to(beside.x(), beside.y(), 0.9));
        steps.push_back(
            walk_to(behind.x() + 0.4 * side * right.x(), behind.y() + 0.4 * side * right.y(), 0.8));
        steps.push_back(walk_to(behind.x(), behind.y(), 0.8));
        steps.push_back({.kind = Kind::grasp, .prop = 0});
        steps.push_back(walk_to(-side * 0.7, -1.2, 0.7));
        steps.push_back({.kind = Kind::release});
      } else if (number == carrier) {
        props.push_back({.start = on_ground({{side * 1.64, -0.1}, side * 0.3}), .carried = true});
        steps.push_back(walk_to(side * 1.6, -0.62, 1.0));
        steps.push_back({.kind = Kind::grasp, .prop = 1});
        steps.push_back(walk_to(side * 0.9, -1.2, 1.0));
      }
      loop_from = static_cast<int>(steps.size());
      Wanderer(random, number == 0 ? 0.0 : 0.22, side).add_moves(steps, 24);
    }
    const auto acting =
        std::make_shared<const Performance>(build, steps, loop_from, props, 1.0, random.bits(), crew.seconds);
    add_figure(world, random, build, crew.next_instance(),
               [acting](double time) { return acting->posture_at(time); });
    const auto follow = [&](Object& object, int prop) {
      object.instance = crew.next_instance();
      object.motion.moves = acting->prop_moves(prop);
      object.motion.placement = [acting, prop](double time) { return acting->prop_at(prop, time); };
    };
    follow(add_chair(world, random, random.chance(0.5F)), 0);
    if (props.size() > 1) {
      follow(add_box(world, random, 0.0F), 1);
    }
  }
}

}  // namespace penumbra::slam::synthetic
