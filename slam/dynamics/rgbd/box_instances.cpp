#include "slam/dynamics/rgbd/box_instances.h"

#include "nn/base/counted.h"
#include "nn/base/error.h"

namespace penumbra::slam {

void keep_inside(const Size& image, double least_score, std::vector<Instance>& instances) {
  std::erase_if(instances, [&](Instance& instance) {
    instance.region = intersection(instance.region, {0, 0, image.width, image.height});
    return instance.region.empty() || static_cast<double>(instance.score) < least_score;
  });
}

void take_whole_box(Instance& instance) {
  instance.mask = ByteImage::filled(instance.region.width, instance.region.height, 255);
}

void check_depth_size(const ImageToSegment& from) {
  const Size size = from.image.size();
  if (from.depth.empty() || (from.depth.size() == size && from.depth.channels() == 1)) return;
  throw InputError(fmt::format("frame {}, depth", from.frame),
                   fmt::format("{}x{} as the image, metres", size.width, size.height),
                   fmt::format("{}x{} with {}", from.depth.width(), from.depth.height(),
                               counted(from.depth.channels(), "channel")));
}

}  // namespace penumbra::slam
