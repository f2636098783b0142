// The histogram filter at work, drawn: how far pairs moved, which of them are right, and what was removed.
#pragma once

#include <string>
#include <vector>

#include "slam/evaluation/matching_evaluation.h"
#include "slam/evaluation/plot_canvas.h"

namespace penumbra::slam {

struct HistogramPanel {
  std::string title;
  DisplacementHistogram histogram;
};

// One panel below the other, all over the same range of displacements: bars of the pairs that were kept
// (upwards) and removed (downwards), effective and wrong ones on top of each other.
PlotCanvas draw_displacements(const std::string& title, const std::vector<HistogramPanel>& panels);

}  // namespace penumbra::slam
