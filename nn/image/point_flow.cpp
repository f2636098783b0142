#include "nn/image/point_flow.h"

#include <cmath>

#include "nn/image/border.h"
#include "nn/simd/kernel_table.h"

namespace penumbra {

namespace {

constexpr int kFlowHalf = nn::kFlowWindow / 2;

// The window's upper left corner: whole pixel, and weights of the four pixels around each of its places.
struct Placement {
  int x, y;
  int weights[4];
};
Placement placement(float left, float top) {
  constexpr int kOne = 1 << nn::kFlowWeightBits;
  const int x = static_cast<int>(std::floor(left)), y = static_cast<int>(std::floor(top));
  const float a = left - static_cast<float>(x), b = top - static_cast<float>(y);
  Placement p{x, y, {}};
  p.weights[0] = static_cast<int>(std::lrint((1.0F - a) * (1.0F - b) * kOne));
  p.weights[1] = static_cast<int>(std::lrint(a * (1.0F - b) * kOne));
  p.weights[2] = static_cast<int>(std::lrint((1.0F - a) * b * kOne));
  p.weights[3] = kOne - p.weights[0] - p.weights[1] - p.weights[2];
  return p;
}

// `side` x `side` pixels from (x, y) on, for kernels that read beyond them to the right: from a copy where
// that would be beyond the image's end.
class Patch {
 public:
  Patch(const ByteView& image, int x, int y, int side) {
    inside_ = x >= 0 && y >= 0 && x + side <= image.width && y + side <= image.height;
    if (!inside_) return;
    first_ = image.row(y) + x;
    pitch_ = image.pitch;
    if (y + side < image.height || x + kWidth <= image.width) return;
    for (int row = 0; row < side; ++row) std::copy_n(first_ + row * image.pitch, side, copy_ + row * kWidth);
    first_ = copy_;
    pitch_ = kWidth;
  }
  bool is_inside() const { return inside_; }
  const std::uint8_t* at(int x, int y) const { return first_ + y * pitch_ + x; }
  std::ptrdiff_t pitch() const { return pitch_; }

 private:
  static constexpr int kMostRows = nn::kFlowWindow + 3, kWidth = nn::kFlowStride + 1;
  bool inside_;
  const std::uint8_t* first_ = nullptr;
  std::ptrdiff_t pitch_ = 0;
  std::uint8_t copy_[kMostRows * kWidth + kWidth];  // set where used
};

// One point on one level: false where it is lost. `at`: in the level of `to`, in and out.
bool align(const ByteView& from, const ByteView& to, float x, float y, float& at_x, float& at_y,
           const FlowSettings& settings) {
  constexpr float kHalf = kFlowHalf, kFarthest = 1e6F;  // places that are not are none
  const auto is_place = [](float u, float v) { return std::abs(u) < kFarthest && std::abs(v) < kFarthest; };
  if (!is_place(x, y)) return false;
  const Placement p = placement(x - kHalf, y - kHalf);
  // A pixel more around it for the slopes, and one for what lies between pixels.
  const Patch around(from, p.x - 1, p.y - 1, nn::kFlowWindow + 3);
  if (!around.is_inside()) return false;
  nn::FlowWindow window;
  nn::kernels().image.flow_window(around.at(1, 1), around.pitch(), p.weights, window);
  const auto xx = static_cast<double>(window.xx), xy = static_cast<double>(window.xy),
             yy = static_cast<double>(window.yy);
  const double determinant = xx * yy - xy * xy;
  const double smaller = 0.5 * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy));
  constexpr double kOne = 1 << nn::kFlowValueBits, kPixels = nn::kFlowWindow * nn::kFlowWindow;
  if (determinant <= 0.0 || smaller / (kOne * kOne * kPixels) < settings.least_structure) return false;

  double before_x = 0.0, before_y = 0.0;
  for (int i = 0; i < settings.iterations; ++i) {
    if (!is_place(at_x, at_y)) return false;
    const Placement q = placement(at_x - kHalf, at_y - kHalf);
    const Patch seen(to, q.x, q.y, nn::kFlowWindow + 1);
    if (!seen.is_inside()) return false;
    std::int64_t sums[2];
    nn::kernels().image.flow_mismatch(seen.at(0, 0), seen.pitch(), q.weights, window, sums);
    const auto bx = static_cast<double>(sums[0]), by = static_cast<double>(sums[1]);
    const double step_x = (xy * by - yy * bx) / determinant, step_y = (xy * bx - xx * by) / determinant;
    at_x += static_cast<float>(step_x);
    at_y += static_cast<float>(step_y);
    if (step_x * step_x + step_y * step_y <= settings.smallest_step * settings.smallest_step) break;
    // To and fro between two places: the middle.
    if (i > 0 && std::abs(step_x + before_x) < 0.01 && std::abs(step_y + before_y) < 0.01) {
      at_x -= static_cast<float>(0.5 * step_x);
      at_y -= static_cast<float>(0.5 * step_y);
      break;
    }
    before_x = step_x;
    before_y = step_y;
  }
  return true;
}

}  // namespace

void HalvingPyramid::build(const ByteImage& grey, int levels) {
  images_.resize(static_cast<std::size_t>(std::max(levels, 1)));
  images_[0] = grey;
  used_ = grey.empty() ? 0 : 1;
  if (used_ == 0) return;
  for (int l = 1; l < levels; ++l) {
    const ByteView fine = images_[static_cast<std::size_t>(l - 1)].view();
    const Size size{(fine.width + 1) / 2, (fine.height + 1) / 2};
    if (std::min(size.width, size.height) < 2) break;
    ByteImage& coarse = images_[static_cast<std::size_t>(l)];
    coarse.create(size.width, size.height);
    constexpr int kReach = 2;
    // The row has room for the mirrored ends, and for a column more where the width is odd.
    rows_.resize(static_cast<std::size_t>(2 * size.width + 2 * kReach));
    std::uint16_t* middle = rows_.data() + kReach;
    for (int y = 0; y < size.height; ++y) {
      const std::uint8_t* rows[2 * kReach + 1];
      for (int j = -kReach; j <= kReach; ++j) rows[j + kReach] = fine.row(mirrored(2 * y + j, fine.height));
      nn::kernels().image.halve_rows(rows, fine.width, middle);
      for (const int x : {-2, -1, fine.width, fine.width + 1})
        if (x < 2 * size.width + kReach) middle[x] = middle[mirrored(x, fine.width)];
      nn::kernels().image.halve_columns(middle, size.width, coarse.row(y));
    }
    used_ = l + 1;
  }
}

void track_points(const HalvingPyramid& from, const HalvingPyramid& to, std::span<const FlowPoint> points,
                  std::span<FlowPoint> moved, const FlowSettings& settings) {
  const int levels = std::min({from.levels(), to.levels(), settings.levels});
  for (std::size_t i = 0; i < points.size(); ++i) {
    FlowPoint& point = moved[i];
    const FlowPoint start = point;
    float scale = std::ldexp(1.0F, -(levels - 1));
    point.x *= scale;
    point.y *= scale;
    point.found = false;
    for (int l = levels - 1; l >= 0; --l, scale *= 2.0F) {
      float x = point.x, y = point.y;
      point.found =
          align(from.level(l), to.level(l), points[i].x * scale, points[i].y * scale, x, y, settings);
      // A coarse level may not have room for the window; the next one begins where this one did.
      if (point.found) {
        point.x = x;
        point.y = y;
      }
      if (l > 0) {
        point.x *= 2.0F;
        point.y *= 2.0F;
      }
    }
    if (!point.found) point = {start.x, start.y, false};
  }
}

}  // namespace penumbra
