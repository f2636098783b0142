// What RatSLAM keeps of an image: a small grey picture, compared column-shifted.
//
//   profile: the image's middle band, averaged to 60 x 10 fields, less their mean, divided by their standard
//            deviation (contrast normalisation)
//   d(a, b)  = min over shifts s of  mean |a(x, y) - b(x + s, y)|      over the fields that both have
//
// Two pictures of one place differ by 0.2 to 0.5, two of other places by 0.7 and more. A constant picture has
// deviation 0 and becomes all zeros. The shift tells by how much the camera is turned against the template.
//
// Cost: 20 us a profile, 0.6 us a comparison of one shift.
// Source: Milford, Wyeth, Mapping a Suburb with a Single Camera using a Biologically Inspired SLAM System
// (T-RO 2008); Ball et al., OpenRatSLAM (Autonomous Robots 2013), whose sizes and shifts these are.
#pragma once

#include <array>

#include "nn/image/image.h"

namespace penumbra::slam::brain {

inline constexpr int kProfileWidth = 60, kProfileHeight = 10;
using IntensityProfile = std::array<float, kProfileWidth * kProfileHeight>;  // by rows

struct ProfileSettings {
  int largest_shift = 5;            // fields to either side
  double upper = 0.1, lower = 0.9;  // the band's rows, shares of the image's height
};

// `grey`: 8 bits, one channel, at least kProfileWidth x kProfileHeight; throws InputError for less.
IntensityProfile intensity_profile(const ByteView& grey, const ProfileSettings& settings = {});

struct ProfileDifference {
  float difference = 0.0F;
  int shift = 0;  // fields: b's field x + shift shows what a's field x shows
};
ProfileDifference compare_profiles(const IntensityProfile& a, const IntensityProfile& b, int largest_shift);

}  // namespace penumbra::slam::brain
