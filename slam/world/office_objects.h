// The things that stand in an office, each as one object of a few convex bodies; sizes and colours come from
// `random`. The caller sets the pose and the instance number. Whoever uses a thing stands on its -z side and
// looks along +z.
#pragma once

#include "slam/world/noise.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

constexpr float kDeskHeight = 0.73F;  // metres

// A desk `width` metres wide (x) and `depth` deep (z) with a top and four legs.
Object& add_desk(World& world, RandomSequence& random, float width, float depth);
// A cloth-covered panel that stands on the floor, along x.
Object& add_partition(World& world, RandomSequence& random, float width, float height);
// A swivel chair on five feet, or one on four legs, for somebody who looks along +z.
Object& add_chair(World& world, RandomSequence& random, bool swivels);
// On top of a surface `height` metres above the floor: a monitor (its screen faces -z), keyboard and mouse,
// a cup, a lying pile of books, a bottle, a cardboard box.
Object& add_monitor(World& world, RandomSequence& random, float height);
Object& add_keyboard(World& world, RandomSequence& random, float height);
Object& add_mouse(World& world, RandomSequence& random, float height);
Object& add_cup(World& world, RandomSequence& random, float height);
Object& add_books(World& world, RandomSequence& random, float height);
Object& add_bottle(World& world, RandomSequence& random, float height);
Object& add_box(World& world, RandomSequence& random, float height);
// Sheets of paper on a desk.
Object& add_papers(World& world, RandomSequence& random, float height);
// A case of shelves along x, open towards -z, and its boards' rows of books as objects of their own.
void add_shelf(World& world, RandomSequence& random, const GroundPose& pose, float width, float height,
               const std::function<void(Object&)>& give_instance);
Object& add_plant(World& world, RandomSequence& random);
Object& add_backpack(World& world, RandomSequence& random);
// A poster whose back is at z = 0 and which faces -z, its middle `height` metres above the floor.
Object& add_poster(World& world, RandomSequence& random, float width, float tall, float height);
// A cable that lies on the floor or hangs down a desk: pieces through points.
Object& add_cable(World& world, RandomSequence& random, const std::vector<Eigen::Vector3f>& points);
// Pipes or ducts under the ceiling, along x.
Object& add_pipe(World& world, RandomSequence& random, float length, float radius, float height);

}  // namespace penumbra::slam::synthetic
