#include "slam/frontend/disparity/chosen_disparity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "nn/base/parallel.h"

namespace penumbra::slam {

namespace {

using Costs = std::vector<std::int16_t>;

// Where between d - 1 and d + 1 the least cost is: two lines of opposite slopes.
float with_fraction(int d, const std::int16_t* costs) {
  const int before = costs[d - 1] - costs[d], after = costs[d + 1] - costs[d];
  const int steep = std::max(before, after);
  return static_cast<float>(d) +
         (steep > 0 ? 0.5F * static_cast<float>(before - after) / static_cast<float>(steep) : 0.0F);
}

// One row of an image. Its loops along d are plain, for the compiler to make vectors of.
class RowChoice {
 public:
  RowChoice(int width, int disparities, const DisparityChoice& choice)
      : width_(width),
        disparities_(disparities),
        choice_(choice),
        sum_(static_cast<std::size_t>(disparities)),
        right_cost_(static_cast<std::size_t>(width + disparities)),
        right_(right_cost_.size()),
        left_(static_cast<std::size_t>(width)) {}

  void run(const std::int16_t* down, const std::int16_t* up, float* out) {
    std::fill(right_cost_.begin(), right_cost_.end(), std::numeric_limits<std::int16_t>::max());
    for (int x = 0; x < width_; ++x, down += disparities_, up += disparities_) {
      const int best = add(down, up);
      offer_to_right(x);
      left_[static_cast<std::size_t>(x)] = static_cast<std::int16_t>(best);
      const bool inside = best > 0 && best < disparities_ - 1;
      out[x] = inside && is_unique(best) ? with_fraction(best, sum_.data()) : kNoDisparity;
    }
    for (int x = 0; x < width_; ++x) {
      const int d = left_[static_cast<std::size_t>(x)];
      if (x < d || std::abs(*right_at(right_, x - d) - d) > choice_.agree) out[x] = kNoDisparity;
    }
  }

 private:
  // What a right pixel has; columns run backwards, so that those which x - d runs through lie in order.
  std::int16_t* right_at(Costs& numbers, int column) const { return numbers.data() + (width_ - 1 - column); }

  // Returns the disparity of the least sum.
  int add(const std::int16_t* down, const std::int16_t* up) {
    std::int16_t* const sum = sum_.data();
    std::int16_t least = std::numeric_limits<std::int16_t>::max();
    for (int d = 0; d < disparities_; ++d) {
      sum[d] = static_cast<std::int16_t>(down[d] + up[d]);
      least = std::min(least, sum[d]);
    }
    return static_cast<int>(std::find(sum, sum + disparities_, least) - sum);
  }

  void offer_to_right(int x) {
    const std::int16_t* const sum = sum_.data();
    std::int16_t* __restrict const costs = right_at(right_cost_, x);
    std::int16_t* __restrict const found = right_at(right_, x);
    for (int d = 0; d < disparities_; ++d) {
      const bool better = sum[d] < costs[d];
      costs[d] = better ? sum[d] : costs[d];
      found[d] = better ? static_cast<std::int16_t>(d) : found[d];
    }
  }

  bool is_unique(int best) const {
    const std::int16_t* const sum = sum_.data();
    const double limit = std::ceil((1.0 + choice_.unique) * sum[best]);
    const auto below = static_cast<std::int16_t>(std::min(limit, 32767.0));
    std::int16_t rivals = 0;
    for (int d = 0; d < disparities_; ++d) rivals = static_cast<std::int16_t>(rivals + (sum[d] < below));
    for (int d = best - 1; d <= best + 1; ++d) rivals = static_cast<std::int16_t>(rivals - (sum[d] < below));
    return rivals == 0;
  }

  const int width_, disparities_;
  const DisparityChoice choice_;
  Costs sum_;                 // of one pixel
  Costs right_cost_, right_;  // the least cost of each right pixel so far, and its disparity
  Costs left_;                // disparity of each left pixel
};

}  // namespace

void choose_disparities(const DisparityVolume<std::int16_t>& down, const DisparityVolume<std::int16_t>& up,
                        const DisparityChoice& choice, FloatImage& out) {
  out.create(down.width(), down.height());
  parallel_pieces(down.height(), 8, [&](std::int64_t first, std::int64_t end, int) {
    RowChoice row(down.width(), down.disparities(), choice);
    for (int y = static_cast<int>(first); y < static_cast<int>(end); ++y)
      row.run(down.at(0, y), up.at(0, y), out.row(y));
  });
}

}  // namespace penumbra::slam
