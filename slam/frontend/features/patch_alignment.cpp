#include "slam/frontend/features/patch_alignment.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "slam/frontend/features/four_pixels.h"

namespace penumbra::slam {

namespace {

constexpr int kHalf = 5, kWidth = 2 * kHalf + 1, kPixels = kWidth * kWidth;
constexpr float kConverged = 0.01F;               // pixels
using Window = Eigen::Matrix<float, kPixels, 1>;  // row by row

// What of the patch stays the same over the iterations: values and slopes, all without their mean.
struct Template {
  Window value, slope_x, slope_y;
  float variance = 0.0F;  // sum of value^2
  Eigen::Matrix2f H = Eigen::Matrix2f::Zero();
  Eigen::Vector2f slope_value = Eigen::Vector2f::Zero();  // sum of slope * value
};

// The patch drawn `ratio` times as large: 13 x 13 values, one more on each side for the slopes. First along
// its rows, each once, then across them.
constexpr int kDrawn = kWidth + 2;
using Drawn = std::array<float, kDrawn * kDrawn>;
Drawn draw(const Patch& patch, float ratio) {
  std::array<int, kDrawn> whole;
  std::array<float, kDrawn> share;
  for (int i = 0; i < kDrawn; ++i) {
    const float at = static_cast<float>(Patch::kHalf) + static_cast<float>(i - kHalf - 1) / ratio;
    const std::size_t k = static_cast<std::size_t>(i);
    whole[k] = std::min(static_cast<int>(at), Patch::kWidth - 2);
    share[k] = at - static_cast<float>(whole[k]);
  }
  std::array<std::array<float, kDrawn>, Patch::kWidth> along;
  for (int y = whole.front(); y <= whole.back() + 1; ++y) {
    const std::uint8_t* row = patch.pixels.data() + y * Patch::kWidth;
    for (std::size_t x = 0; x < kDrawn; ++x) {
      const int c = whole[x];
      along[static_cast<std::size_t>(y)][x] =
          static_cast<float>(row[c]) + share[x] * static_cast<float>(row[c + 1] - row[c]);
    }
  }
  Drawn drawn;
  for (std::size_t y = 0; y < kDrawn; ++y) {
    const auto& upper = along[static_cast<std::size_t>(whole[y])];
    const auto& lower = along[static_cast<std::size_t>(whole[y]) + 1];
    float* out = drawn.data() + y * kDrawn;
    for (std::size_t x = 0; x < kDrawn; ++x) out[x] = upper[x] + share[y] * (lower[x] - upper[x]);
  }
  return drawn;
}

Template make_template(const Patch& patch, float ratio) {
  const auto drawn = draw(patch, ratio);
  Template t;
  int n = 0;
  for (int y = 0; y < kWidth; ++y) {
    const float* row = drawn.data() + (y + 1) * kDrawn + 1;
    for (int x = 0; x < kWidth; ++x, ++n) {
      t.value[n] = row[x];
      t.slope_x[n] = 0.5F * (row[x + 1] - row[x - 1]);
      t.slope_y[n] = 0.5F * (row[x + kDrawn] - row[x - kDrawn]);
    }
  }
  for (Window* window : {&t.value, &t.slope_x, &t.slope_y}) window->array() -= window->mean();
  t.variance = t.value.squaredNorm();
  const float xy = t.slope_x.dot(t.slope_y);
  t.H << t.slope_x.squaredNorm(), xy, xy, t.slope_y.squaredNorm();
  t.slope_value << t.slope_x.dot(t.value), t.slope_y.dot(t.value);
  return t;
}

float smaller_eigenvalue(const Eigen::Matrix2f& H) {
  const float half_trace = 0.5F * H.trace();
  return half_trace - std::sqrt(std::max(0.0F, half_trace * half_trace - H.determinant()));
}

// The image's values around p, bilinear: four at a time, the last of a row in a group that begins earlier.
void sample(const ByteView& image, const Eigen::Vector2f& p, Window& window) {
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const float a = p.x() - static_cast<float>(x), b = p.y() - static_cast<float>(y);
  const float w00 = (1.0F - a) * (1.0F - b), w01 = a * (1.0F - b), w10 = (1.0F - a) * b, w11 = a * b;
  float* out = window.data();
  for (int dy = -kHalf; dy <= kHalf; ++dy, out += kWidth) {
    const std::uint8_t* upper = image.row(y + dy) + x - kHalf;
    const std::uint8_t* lower = image.row(y + dy + 1) + x - kHalf;
    for_each_four<kWidth>([&](int i) {
      store_four(out + i, w00 * load_four(upper + i) + w01 * load_four(upper + i + 1) +
                              w10 * load_four(lower + i) + w11 * load_four(lower + i + 1));
    });
  }
}

bool window_inside(const ByteView& image, const Eigen::Vector2f& p) {
  return p.x() >= kHalf && p.y() >= kHalf && p.x() + kHalf + 1 < static_cast<float>(image.width) &&
         p.y() + kHalf + 1 < static_cast<float>(image.height);
}

}  // namespace

std::optional<Eigen::Vector2f> align_patch(const Patch& patch, float ratio, const ByteView& image,
                                           const Eigen::Vector2f& start,
                                           const PatchAlignmentSettings& settings) {
  if (patch.empty() || !(ratio >= kSmallestPatchRatio && ratio <= kLargestPatchRatio)) return std::nullopt;
  const Template t = make_template(patch, ratio);
  if (smaller_eigenvalue(t.H) < settings.least_curvature * kPixels) return std::nullopt;
  const Eigen::Matrix2f H_inverse = t.H.inverse();

  Eigen::Vector2f p = start;
  Window seen;
  float correlation = 0.0F;
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    if (!window_inside(image, p)) return std::nullopt;  // also where p is not a number
    sample(image, p, seen);
    // The template has no mean: that of the image drops out of the products with it.
    const float variance = seen.squaredNorm() - seen.sum() * seen.mean();
    if (!(variance > 0.0F)) return std::nullopt;
    correlation = seen.dot(t.value) / std::sqrt(variance * t.variance);
    const float kappa = std::sqrt(t.variance / variance);
    const Eigen::Vector2f slope_seen(seen.dot(t.slope_x), seen.dot(t.slope_y));
    const Eigen::Vector2f step = -H_inverse * (kappa * slope_seen - t.slope_value);
    p += step;
    if (!((p - start).squaredNorm() <= settings.farthest * settings.farthest)) return std::nullopt;
    if (step.squaredNorm() < kConverged * kConverged) break;
  }
  if (correlation < settings.least_correlation) return std::nullopt;
  return p;
}

}  // namespace penumbra::slam
