#include "slam/frontend/disparity/speckles.h"

#include <cmath>

namespace penumbra::slam {

void SpeckleFilter::apply(FloatImage& disparity, float step, int fewest) {
  const int width = disparity.width(), height = disparity.height();
  float* const values = disparity.data();
  seen_.assign(disparity.elements(), 0);
  for (std::int32_t start = 0; start < static_cast<std::int32_t>(disparity.elements()); ++start) {
    if (seen_[static_cast<std::size_t>(start)] != 0 || values[start] <= 0.0F) continue;
    piece_.assign(1, start);
    seen_[static_cast<std::size_t>(start)] = 1;
    for (std::size_t looked = 0; looked < piece_.size(); ++looked) {
      const std::int32_t at = piece_[looked];
      const int x = at % width, y = at / width;
      const auto take = [&](bool inside, std::int32_t next) {
        if (!inside || seen_[static_cast<std::size_t>(next)] != 0 || values[next] <= 0.0F ||
            std::abs(values[next] - values[at]) > step)
          return;
        seen_[static_cast<std::size_t>(next)] = 1;
        piece_.push_back(next);
      };
      take(x > 0, at - 1);
      take(x + 1 < width, at + 1);
      take(y > 0, at - width);
      take(y + 1 < height, at + width);
    }
    if (static_cast<int>(piece_.size()) >= fewest) continue;
    for (const std::int32_t at : piece_) values[at] = 0.0F;
  }
}

}  // namespace penumbra::slam
