#include "slam/evaluation/place_index_evaluation.h"

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/quantile.h"
#include "nn/base/stopwatch.h"

namespace penumbra::slam {

namespace {

struct Answer {
  double score = 0.0;
  bool correct = false;
};

void draw_curve(std::vector<Answer> answers, PlaceIndexEvaluation& result) {
  std::stable_sort(answers.begin(), answers.end(),
                   [](const Answer& a, const Answer& b) { return a.score > b.score; });
  int given = 0, correct = 0;
  double last_recall = 0.0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    ++given;
    correct += answers[i].correct;
    if (i + 1 < answers.size() && answers[i + 1].score == answers[i].score) continue;
    const double precision = static_cast<double>(correct) / given;
    const double recall = result.revisits == 0 ? 0.0 : static_cast<double>(correct) / result.revisits;
    result.curve.push_back({answers[i].score, precision, recall});
    result.average_precision += precision * (recall - last_recall);
    last_recall = recall;
    if (correct == given) result.recall_at_full_precision = recall;
  }
}

}  // namespace

PlaceIndexEvaluation evaluate_place_index(const Map& map, const Trajectory& truth, int first_frame,
                                          const PlaceIndexSettings& index_settings, int candidates,
                                          const RevisitSettings& settings) {
  const auto pose_of = [&](const KeyFrame& keyframe) -> const SE3& {
    const int at = keyframe.frame_index - first_frame;
    if (at < 0 || at >= static_cast<int>(truth.size())) {
      throw InputError("place index evaluation",
                       fmt::format("keyframes of frames {} to {}, as in the ground truth", first_frame,
                                   first_frame + static_cast<int>(truth.size()) - 1),
                       fmt::format("one of frame {}", keyframe.frame_index));
    }
    return truth[static_cast<std::size_t>(at)].T_wc;
  };
  PlaceIndex index(index_settings);
  PlaceIndexEvaluation result;
  result.recall_at.assign(static_cast<std::size_t>(std::max(candidates, 1)), 0.0);
  std::vector<Answer> answers;
  std::vector<double> times;
  std::size_t known = 0;  // keyframes in the index
  for (const KeyFrame* keyframe : map.keyframes()) {
    const SE3& here = pose_of(*keyframe);
    while (keyframe->frame_index - map.keyframes()[known]->frame_index >= settings.fewest_frames_apart) {
      index.insert(map.keyframes()[known++]);
    }
    if (known == 0) continue;
    ++result.queries;
    const auto is_right = [&](const KeyFrame& k) { return is_same_place(here, pose_of(k), settings); };
    const bool revisits =
        std::any_of(map.keyframes().begin(), map.keyframes().begin() + static_cast<std::ptrdiff_t>(known),
                    [&](const KeyFrame* k) { return is_right(*k); });
    result.revisits += revisits;
    const Stopwatch watch;
    const std::vector<PlaceCandidate> found = index.query(*keyframe->features, std::max(candidates, 1));
    times.push_back(watch.milliseconds());
    if (found.empty()) continue;
    answers.push_back({found.front().score, is_right(*found.front().keyframe)});
    bool right = false;
    for (std::size_t k = 0; k < result.recall_at.size(); ++k) {
      right = right || (k < found.size() && is_right(*found[k].keyframe));
      result.recall_at[k] += right;
    }
  }
  for (double& recall : result.recall_at) recall = result.revisits == 0 ? 1.0 : recall / result.revisits;
  draw_curve(std::move(answers), result);
  for (; known < map.keyframes().size(); ++known) index.insert(map.keyframes()[known]);
  result.descriptors = index.descriptors();
  result.bytes = index.bytes();
  result.median_query_ms = quantile_of(times, 0.5);
  return result;
}

}  // namespace penumbra::slam
