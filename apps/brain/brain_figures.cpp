#include "apps/brain/brain_figures.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "apps/view/run_truth.h"

namespace penumbra::apps {

namespace {

double mean_of(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  if (begin >= end) return 0.0;
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                         values.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
         static_cast<double>(end - begin);
}

void add_path(const slam::Trajectory& truth, const slam::Trajectory& found, nlohmann::json& figures) {
  const slam::Evaluation evaluation = evaluate_run({truth, found}).value();
  figures["ate_m"] = evaluation.ape.rmse;
  figures["rpe_percent"] = evaluation.kitti.overall.translation;
  figures["rpe_deg_per_100m"] = evaluation.kitti.overall.rotation;
}

void add_times(const std::vector<double>& ms, nlohmann::json& figures) {
  const std::size_t part = std::min<std::size_t>(500, ms.size() / 10);
  figures["ms"] = mean_of(ms, 0, ms.size());
  figures["ms_first"] = mean_of(ms, 0, part);
  figures["ms_last"] = mean_of(ms, ms.size() - part, ms.size());
}

void add_recalls(const slam::Trajectory& truth, const std::vector<slam::FramePair>& places,
                 const std::vector<int>& keyframes, nlohmann::json& figures) {
  const slam::RecognitionEvaluation recognition = slam::evaluate_recognition(truth, places, keyframes);
  std::set<int> found;
  for (const slam::FramePair& pair : places) found.insert(pair.frame);
  const std::vector<int> revisits = slam::find_revisits(truth);
  nlohmann::json missed = nlohmann::json::array();
  for (const int frame : keyframes) {
    const int earlier = revisits[static_cast<std::size_t>(frame)];
    if (earlier >= 0 && found.count(frame) == 0) missed.push_back({frame, earlier});
  }
  figures["recalls"] = recognition.places;
  figures["right_recalls"] = recognition.right_places;
  figures["precision"] = recognition.precision();
  figures["revisits"] = recognition.revisited_keyframes;
  figures["recall"] = recognition.recall();
  figures["missed"] = missed;
  figures["keyframes"] = keyframes.size();
}

}  // namespace

std::vector<slam::FramePair> recalled_pairs(const slam::brain::BrainRecorder& record) {
  std::vector<slam::FramePair> pairs;
  for (const slam::brain::Recall& recall : record.recalls()) {
    if (!recall.loaded) pairs.push_back({recall.frame, recall.earlier_frame});
  }
  return pairs;
}

SimilarityCurve similarity_curve(const slam::Trajectory& truth, const slam::brain::BrainRecorder& record,
                                 const slam::brain::CognitiveMap& map,
                                 const slam::RevisitSettings& settings) {
  struct Query {
    double similarity;
    bool right;
  };
  std::vector<Query> queries;
  int revisits = 0;
  const std::vector<int> revisited = slam::find_revisits(truth, settings);
  for (const slam::brain::BrainResult& result : record.results()) {
    if (!result.keyframe) continue;
    const std::size_t i = static_cast<std::size_t>(result.frame);
    revisits += revisited[i] >= 0;
    if (result.most_similar < 0) continue;
    const int earlier = map.node(result.most_similar).frame;
    queries.push_back(
        {result.similarity,
         result.frame - earlier >= settings.fewest_frames_apart &&
             slam::is_same_place(truth[i].T_wc, truth[static_cast<std::size_t>(earlier)].T_wc, settings)});
  }
  SimilarityCurve curve;
  if (revisits == 0) return curve;
  // Of equal similarities a wrong one comes first: the threshold cannot part them.
  std::sort(queries.begin(), queries.end(), [](const Query& a, const Query& b) {
    return a.similarity != b.similarity ? a.similarity > b.similarity : a.right < b.right;
  });
  int right = 0;
  bool all_right = true;
  for (const Query& query : queries) {
    all_right = all_right && query.right;
    right += query.right;
    if (!all_right) continue;
    curve.recall_at_full_precision = right / static_cast<double>(revisits);
    curve.threshold = query.similarity;
  }
  curve.recall = right / static_cast<double>(revisits);
  return curve;
}

nlohmann::json brain_figures(const slam::Trajectory& truth, const slam::brain::Brain& brain,
                             const slam::brain::BrainRecorder& record) {
  nlohmann::json figures;
  add_path(truth, record.trajectory(brain.map()), figures);
  add_times(record.milliseconds(), figures);
  add_recalls(truth, recalled_pairs(record), record.keyframes(), figures);
  const SimilarityCurve curve = similarity_curve(truth, record, brain.map());
  figures["curve"] = {{"recall_at_full_precision", curve.recall_at_full_precision},
                      {"threshold", curve.threshold},
                      {"recall", curve.recall}};
  figures["blurred"] = std::count_if(record.results().begin(), record.results().end(),
                                     [](const slam::brain::BrainResult& r) { return r.blurred; });
  figures["nodes"] = brain.map().size();
  figures["links"] = brain.map().links().size();
  figures["map_mb"] = static_cast<double>(brain.bytes()) / 1e6;
  return figures;
}

nlohmann::json geometric_figures(const slam::Trajectory& truth, const slam::Recorder& record,
                                 const std::vector<double>& milliseconds) {
  const slam::Slam& slam = record.slam();
  std::vector<slam::FramePair> places;
  for (const slam::RecognisedPlace& place : slam.recognised_places())
    places.push_back({place.frame, place.earlier_frame});
  std::vector<int> keyframes;
  for (const slam::KeyFrame* keyframe : slam.map().keyframes()) keyframes.push_back(keyframe->frame_index);
  nlohmann::json figures;
  add_path(truth, record.trajectory(), figures);
  add_times(milliseconds, figures);
  add_recalls(truth, places, keyframes, figures);
  figures["nodes"] = keyframes.size();
  std::size_t features = 0;
  for (const slam::KeyFrame* keyframe : slam.map().keyframes())
    features += static_cast<std::size_t>(keyframe->features->size());
  constexpr std::size_t kFeatureBytes = sizeof(slam::Keypoint) + sizeof(slam::Descriptor) + 2 * sizeof(float);
  figures["map_mb"] =
      static_cast<double>(features * kFeatureBytes + slam.map().points().size() * sizeof(slam::MapPoint)) /
      1e6;
  return figures;
}

}  // namespace penumbra::apps
