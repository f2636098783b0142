// How well a place index alone, by looks and without geometry, finds the places that a map shows twice.
//
// The map's keyframes are gone through in their order, as in a run: each asks the index, which knows the
// keyframes that are at least fewest_frames_apart older, for its best candidates. Where the best one's score
// is at least t it counts as given out. Over all thresholds t:
//
//   precision(t) = given out and of the same place / given out
//   recall(t)    = given out and of the same place / keyframes that revisit a place (loop_evaluation.h)
//
// Only keyframes whose place the index can know count as revisits: one of its keyframes is of the same place.
#pragma once

#include <vector>

#include "slam/evaluation/loop_evaluation.h"
#include "slam/map/map.h"
#include "slam/place/place_index.h"

namespace penumbra::slam {

struct PrecisionRecall {
  double threshold = 0.0, precision = 0.0, recall = 0.0;
};

struct PlaceIndexEvaluation {
  int queries = 0, revisits = 0;
  std::vector<PrecisionRecall> curve;  // thresholds fall, recall rises
  std::vector<double>
      recall_at;  // entry k: revisits of which one of the best k + 1 candidates is right / revisits
  double recall_at_full_precision = 0;     // the largest recall with precision 1
  double average_precision = 0.0;          // area under the curve
  std::size_t descriptors = 0, bytes = 0;  // of the index, all keyframes in
  double median_query_ms = 0.0;
};

// `truth`: the true pose of every frame; the keyframes' frame_index counts its entries, from `first_frame`
// on.
PlaceIndexEvaluation evaluate_place_index(const Map& map, const Trajectory& truth, int first_frame,
                                          const PlaceIndexSettings& index = {}, int candidates = 3,
                                          const RevisitSettings& settings = {});

}  // namespace penumbra::slam
