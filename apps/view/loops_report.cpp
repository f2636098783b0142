#include "apps/view/loops_report.h"

#include <fmt/core.h>

#include "nn/base/counted.h"

namespace penumbra::apps {

namespace {

using nlohmann::ordered_json;

// A share of `count` things: none where there are none.
ordered_json share(double value, std::size_t count) {
  return count == 0 ? ordered_json(nullptr) : ordered_json(value);
}

// The same for a table: "precision  100.0 %".
std::string shown_share(const char* name, double value, std::size_t count) {
  return count == 0 ? fmt::format("{:9} nothing to find", name)
                    : fmt::format("{:9} {:6.1f} %", name, 100.0 * value);
}

}  // namespace

ordered_json loops_json(const slam::LoopEvaluation& e, const std::vector<int>& frames) {
  const auto frame = [&](int row) { return frames[static_cast<std::size_t>(row)]; };
  ordered_json json;
  json["loops"] = e.loops.size();
  json["correct_loops"] = e.correct_loops();
  json["precision"] = share(e.precision(), e.loops.size());
  json["regions"] = ordered_json::array();
  for (const slam::RevisitRegion& r : e.regions) {
    json["regions"].push_back({{"first_frame", frame(r.begin)},
                               {"last_frame", frame(r.end - 1)},
                               {"earlier_frame", frame(r.earlier)},
                               {"closed", r.closed}});
  }
  json["closed_regions"] = e.closed_regions();
  json["region_recall"] = share(e.region_recall(), e.regions.size());
  json["revisited_keyframes"] = e.revisited_keyframes;
  json["tied_keyframes"] = e.tied_keyframes;
  json["keyframe_recall"] = share(e.keyframe_recall(), e.revisited_keyframes);
  json["wrong_loops"] = ordered_json::array();
  for (const slam::LoopEvaluation::Loop& loop : e.loops) {
    if (loop.correct) continue;
    json["wrong_loops"].push_back({{"frame", frame(loop.frames.frame)},
                                   {"earlier_frame", frame(loop.frames.earlier)},
                                   {"distance_m", loop.distance},
                                   {"turn_deg", loop.turn * kDegrees}});
  }
  return json;
}

ordered_json recognition_json(const slam::RecognitionEvaluation& e) {
  return {{"places", e.places},
          {"right_places", e.right_places},
          {"precision", share(e.precision(), e.places)},
          {"recognised_keyframes", e.recognised_keyframes},
          {"recall", share(e.recall(), e.revisited_keyframes)}};
}

ordered_json index_json(const slam::PlaceIndexEvaluation& e) {
  ordered_json json;
  json["queries"] = e.queries;
  json["revisits"] = e.revisits;
  const bool nothing = e.revisits == 0;
  json["recall_at"] = nothing ? ordered_json(nullptr) : ordered_json(e.recall_at);
  json["recall_at_full_precision"] =
      nothing ? ordered_json(nullptr) : ordered_json(e.recall_at_full_precision);
  json["average_precision"] = nothing ? ordered_json(nullptr) : ordered_json(e.average_precision);
  json["descriptors"] = e.descriptors;
  json["bytes"] = e.bytes;
  json["median_query_ms"] = e.median_query_ms;
  json["curve"] = ordered_json::array();
  for (const slam::PrecisionRecall& p : e.curve)
    json["curve"].push_back({p.threshold, p.precision, p.recall});
  return json;
}

void print_loops(const slam::LoopEvaluation& e, const std::vector<int>& frames) {
  const auto frame = [&](int row) { return frames[static_cast<std::size_t>(row)]; };
  fmt::print("loops closed         {:4} of which right {:4}   {}\n", e.loops.size(), e.correct_loops(),
             shown_share("precision", e.precision(), e.loops.size()));
  fmt::print("stretches revisited  {:4} with a loop   {:4}   {}\n", e.regions.size(), e.closed_regions(),
             shown_share("recall", e.region_recall(), e.regions.size()));
  fmt::print("keyframes there      {:4} tied together {:4}   {}\n", e.revisited_keyframes, e.tied_keyframes,
             shown_share("recall", e.keyframe_recall(), e.revisited_keyframes));
  if (e.loops.empty() && e.regions.empty()) {
    fmt::print("no loop was closed, and the path comes to no place twice: there was nothing to find\n");
  }
  for (const slam::RevisitRegion& r : e.regions) {
    fmt::print("  frames {:5} to {:5} go where {:5} went: {}\n", frame(r.begin), frame(r.end - 1),
               frame(r.earlier), r.closed ? "closed" : "not closed");
  }
  for (const slam::LoopEvaluation::Loop& loop : e.loops) {
    if (loop.correct) continue;
    fmt::print("  wrong: frames {} and {} are {:.1f} m and {:.0f} degrees apart\n", frame(loop.frames.frame),
               frame(loop.frames.earlier), loop.distance, loop.turn * kDegrees);
  }
}

void print_recognition(const slam::RecognitionEvaluation& e) {
  if (e.places == 0) return;
  fmt::print("places proven        {:4} of which right {:4}   precision {:6.1f} %\n", e.places,
             e.right_places, 100.0 * e.precision());
  fmt::print("keyframes there      {:4} proven        {:4}   {}\n", e.revisited_keyframes,
             e.recognised_keyframes, shown_share("recall", e.recall(), e.revisited_keyframes));
}

void print_index(const slam::PlaceIndexEvaluation& e) {
  fmt::print("\nplace index by itself: {}, {}; {}, {:.1f} MB, {:.2f} ms a query\n",
             counted(e.queries, "query", "queries"), counted(e.revisits, "revisit"),
             counted(e.descriptors, "descriptor"), static_cast<double>(e.bytes) / 1048576.0,
             e.median_query_ms);
  if (e.revisits == 0) {
    fmt::print("  no keyframe shows an earlier place: there was nothing to find\n");
    return;
  }
  for (std::size_t k = 0; k < e.recall_at.size(); ++k) {
    fmt::print("  right among the best {}: {:5.1f} %\n", k + 1, 100.0 * e.recall_at[k]);
  }
  fmt::print("  recall at precision 100 %: {:.1f} %; average precision {:.3f}\n",
             100.0 * e.recall_at_full_precision, e.average_precision);
  // About ten points of the curve.
  fmt::print("  score      precision    recall\n");
  double next = 0.1;
  for (const slam::PrecisionRecall& p : e.curve) {
    if (p.recall < next && &p != &e.curve.back()) continue;
    fmt::print("  {:8.3f}   {:7.1f} %  {:6.1f} %\n", p.threshold, 100.0 * p.precision, 100.0 * p.recall);
    while (next <= p.recall) next += 0.1;
  }
}

}  // namespace penumbra::apps
