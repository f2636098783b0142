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

// A patch as the tests look at it: its rows, from the upper left pixel on, each kPatchStride bytes behind the
// one before.
inline constexpr int kPatchRows = 2 * kPatchRadius + 1, kPatchStride = 32;

class OrbPattern {
 public:
  static constexpr int kRotations = 64;
  using Tests = std::array<BinaryTest, kDescriptorBits>;
  // Where in a patch's bytes the ends of the tests are.
  struct Places {
    std::array<std::uint16_t, kDescriptorBits> a, b;
  };

  // The one pattern of the program, made at first use.
  static const OrbPattern& get();

  // The pattern turned by the multiple of 2 pi / 64 nearest to `angle` (radians).
  const Tests& rotated(float angle) const { return rotations_[rotation(angle)]; }
  const Places& places(float angle) const { return places_[rotation(angle)]; }

 private:
  OrbPattern();
  static std::size_t rotation(float angle);

  std::vector<Tests> rotations_;
  std::vector<Places> places_;
};

}  // namespace penumbra::slam
