#include "slam/frontend/features/orb_pattern.h"

#include <cmath>
#include <numbers>

#include "nn/base/counter_random.h"

namespace penumbra::slam {

namespace {

constexpr std::uint64_t kSeed = 2022;
constexpr double kSigma = 31.0 / 5.0;  // pixels
constexpr double kRadius = 14.0;       // pixels; turned and rounded it stays within kPatchRadius
constexpr double kShortest = 3.0;      // pixels between the ends of a test
constexpr double kDistinct = 2.0;      // pixels by which tests must differ at one end at least

struct Test {
  double ax, ay, bx, by;
};

// A standard normal draw as the sum of twelve uniforms less six: no library function whose last bit may
// differ.
double gaussian(std::uint64_t& counter) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += counter_uniform(kSeed, counter++);
  return sum;
}

bool nearly_equal(const Test& p, const Test& q) {
  const auto near = [](double x0, double y0, double x1, double y1) {
    return std::hypot(x0 - x1, y0 - y1) < kDistinct;
  };
  return (near(p.ax, p.ay, q.ax, q.ay) && near(p.bx, p.by, q.bx, q.by)) ||
         (near(p.ax, p.ay, q.bx, q.by) && near(p.bx, p.by, q.ax, q.ay));
}

std::vector<Test> draw_tests() {
  std::vector<Test> tests;
  std::uint64_t counter = 0;
  while (tests.size() < kDescriptorBits) {
    Test t;
    t.ax = kSigma * gaussian(counter);
    t.ay = kSigma * gaussian(counter);
    t.bx = kSigma * gaussian(counter);
    t.by = kSigma * gaussian(counter);
    if (std::hypot(t.ax, t.ay) > kRadius || std::hypot(t.bx, t.by) > kRadius) continue;
    if (std::hypot(t.ax - t.bx, t.ay - t.by) < kShortest) continue;
    bool repeated = false;
    for (const Test& earlier : tests) repeated = repeated || nearly_equal(t, earlier);
    if (!repeated) tests.push_back(t);
  }
  return tests;
}

}  // namespace

OrbPattern::OrbPattern() : rotations_(kRotations), places_(kRotations) {
  const auto place = [](std::int8_t x, std::int8_t y) {
    return static_cast<std::uint16_t>((y + kPatchRadius) * kPatchStride + x + kPatchRadius);
  };
  const std::vector<Test> tests = draw_tests();
  for (int r = 0; r < kRotations; ++r) {
    const double angle = 2.0 * std::numbers::pi * r / kRotations;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto turned = [&](double x, double y) {
      return std::array<std::int8_t, 2>{static_cast<std::int8_t>(std::lround(c * x - s * y)),
                                        static_cast<std::int8_t>(std::lround(s * x + c * y))};
    };
    for (std::size_t i = 0; i < tests.size(); ++i) {
      const auto a = turned(tests[i].ax, tests[i].ay), b = turned(tests[i].bx, tests[i].by);
      const auto rotation = static_cast<std::size_t>(r);
      rotations_[rotation][i] = {a[0], a[1], b[0], b[1]};
      places_[rotation].a[i] = place(a[0], a[1]);
      places_[rotation].b[i] = place(b[0], b[1]);
    }
  }
}

const OrbPattern& OrbPattern::get() {
  static const OrbPattern pattern;
  return pattern;
}

std::size_t OrbPattern::rotation(float angle) {
  constexpr float kStep = 2.0F * std::numbers::pi_v<float> / kRotations;
  return static_cast<std::size_t>(static_cast<int>(std::lround(angle / kStep)) & (kRotations - 1));
}

}  // namespace penumbra::slam
