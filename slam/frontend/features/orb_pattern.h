// The sampling pattern of the 256 binary tests of a descriptor: bit i is I(a_i) < I(b_i).
//
// Both ends of a test are drawn from an isotropic Gaussian with standard deviation S/5 (S = 31, the patch's
// width), the best of the random layouts in the BRIEF paper; they stay inside the patch's circle, and tests
// that are short or nearly repeat an earlier one are drawn again. The draws come from a counter-based
// generator: the pattern is a rule, not a table. For rotated patches the whole pattern is turned in steps of
// 2 pi / 64.
//
// Source: Calonder et al., BRIEF (ECCV 2010), section 3.2 layout G II; Rublee et al., ORB (ICCV 2011), 4.2.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "slam/frontend/features/feature.h"

namespace penumbra::slam {

inline constexpr int kPatchRadius = 15;  // pixels; patch of 31 x 31

struct BinaryTest {
  std::int8_t ax, ay, bx, by;  // pixels from the patch's centre
};

class OrbPattern {
 public:
  static constexpr int kRotations = 64;
  using Tests = std::array<BinaryTest, kDescriptorBits>;

  // The one pattern of the program, made at first use.
  static const OrbPattern& get();

  // The pattern turned by the multiple of 2 pi / 64 nearest to `angle` (radians).
  const Tests& rotated(float angle) const;

 private:
  OrbPattern();
  std::vector<Tests> rotations_;
};

}  // namespace penumbra::slam
