// Pictures of what grid cells have learned.
#pragma once

#include <vector>

#include "apps/brain/grid_survey.h"
#include "nn/image/image.h"
#include "slam/brain/position/head_direction_ring.h"
#include "slam/evaluation/plot_canvas.h"

namespace penumbra::apps {

// Rate maps of the first cells, each with its autocorrelogram and its gridness below: a row for every time of
// the rule that works, for untrained weights and for the paper's rule at the end. Frozen maps.
ByteImage draw_rate_maps(const std::vector<SurveyRow>& rows);

// Gridness and share of grid cells over time, of all rows.
slam::PlotCanvas draw_growth(const std::vector<SurveyRow>& rows);

// The preferred directions before and after training.
slam::PlotCanvas draw_ring(const slam::brain::HeadDirectionRing& untrained,
                           const slam::brain::HeadDirectionRing& trained);

}  // namespace penumbra::apps
