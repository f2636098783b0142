// How well a position is read off a grid code whose cells are noisy: by place cells all over a room of 10 m.
//
//   error = || winner's place - true place || / side,   a <- a + noise z,   z normal
//
// Noise is in units of activity, the same for every code that is compared: a cell that hardly stirs is lost
// in it. 1 is the largest activity of a cell.
//
// Cost: 80 ms and 2 ms a trial for 75 cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slam/brain/position/grid_code.h"

namespace penumbra::slam::brain {

struct DecodingSettings {
  double side = 10.0;  // metres
  double step = 0.05;  // between place cells, metres
  int trials = 300;
  std::uint64_t seed = 1;
};

struct DecodingError {  // shares of the side
  double median = 0.0, percentile_95 = 0.0;
};

// One result for each noise.
std::vector<DecodingError> measure_decoding(const GridCode& code, std::span<const double> noises,
                                            const DecodingSettings& settings = {});

// Standard deviation of the activity over cells and places of the room.
double activity_deviation(const GridCode& code, const DecodingSettings& settings = {});

// The code with the weights of each module as long, all together, as those of `like`: random weights so
// stretched differ from learned ones in their shape alone.
GridCode as_long_as(const GridCode& code, const GridCode& like);

}  // namespace penumbra::slam::brain
