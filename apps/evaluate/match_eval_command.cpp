// penumbra match-eval: feature matching with and without the mismatch filter against the true motion.

#include "apps/evaluate/match_eval_command.h"

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/dataset_arguments.h"
#include "apps/common/finite_number.h"
#include "apps/common/progress_bar.h"
#include "nn/base/error.h"
#include "slam/evaluation/matching_evaluation.h"
#include "slam/evaluation/matching_plot.h"
#include "slam/sources/kitti.h"
#include "slam/sources/open_dataset.h"
#include "slam/sources/prefetcher.h"

namespace penumbra::apps {

namespace {

constexpr const char* kMatchEvalExamples = R"(Examples:
  penumbra match-eval kitti                                  every sequence that has ground truth
  penumbra match-eval kitti --sequence 00 --sequence 06 --frames 0:50 --json
  penumbra match-eval V1_01_easy --step 2 --plot removed.svg

Each image is matched with the one before it: each other's nearest descriptors, without prediction. A pair is
effective if each of its points is within --threshold pixels of the other's epipolar line under the true motion.
The compensated filter knows the features' stereo depth and
predicts that the camera goes on as it did in the true path up to the image before. Time is for features of one
image, matching and filter, without the stereo matching. The filters are described in
docs/slam/mismatch-filter.md.)";

struct MatchEvalOptions {
  DatasetArguments dataset;
  std::string plot;
  std::vector<std::string> sequences;
  slam::MatchingSettings matching;
  std::string baseline_name;  // empty: none
  bool no_baseline = false, json = false;
};

// Averages over a sequence's pairs of images.
struct Row {
  double pairs = 0.0, effective = 0.0, rate = 0.0, ms = 0.0, filter_ms = 0.0;
};
constexpr double Row::*kColumns[] = {&Row::pairs, &Row::effective, &Row::rate, &Row::ms, &Row::filter_ms};

struct Sequence {
  std::string name;
  int images = 0;  // pairs of images
  std::array<Row, slam::kMatchingMethods.size()> rows;
  std::array<slam::DisplacementHistogram, slam::kMatchingMethods.size()> histograms;
};

Row average(const slam::MatchingCounts& c) {
  const double n = std::max(1, c.images);
  return {c.pairs / n, c.effective / n, c.rate(), (c.extract_ms + c.match_ms + c.filter_ms) / n,
          c.filter_ms / n};
}

Sequence evaluate(const slam::StereoDataset& dataset, const slam::MatchingSettings& settings) {
  if (!dataset.ground_truth()) {
    throw InputError(dataset.name(), "ground truth, which says which pairs are right", "none");
  }
  const slam::Trajectory& truth = *dataset.ground_truth();
  slam::MatchingEvaluation evaluation(dataset.camera(), settings);
  ProgressBar progress("Matching", dataset.size());
  slam::Prefetcher frames(dataset);
  std::size_t at = 0;
  for (int i = 0; frames.has_next(); ++i) {
    const slam::StereoImages images = frames.next();
    progress.update(i + 1);
    while (at < truth.size() && truth[at].timestamp < images.timestamp) ++at;
    if (at == truth.size() || truth[at].timestamp != images.timestamp) continue;
    evaluation.add(images, truth[at].T_wc);
  }
  Sequence result;
  result.name = dataset.name();
  for (const slam::MatchingMethod method : slam::kMatchingMethods) {
    const std::size_t m = static_cast<std::size_t>(method);
    result.rows[m] = average(evaluation.counts(method));
    result.histograms[m] = evaluation.histogram(method);
    result.images = std::max(result.images, evaluation.counts(method).images);
  }
  if (result.images == 0) throw InputError(dataset.name(), "two frames with ground truth", "fewer");
  return result;
}

Row mean_of(const std::vector<Sequence>& sequences, std::size_t method) {
  Row mean;
  for (const auto column : kColumns) {
    for (const Sequence& s : sequences)
      mean.*column += s.rows[method].*column / static_cast<double>(sequences.size());
  }
  return mean;
}

// Over the sequences, with n - 1 below; 0 for a single one.
Row variance_of(const std::vector<Sequence>& sequences, std::size_t method) {
  const Row mean = mean_of(sequences, method);
  Row variance;
  if (sequences.size() < 2) return variance;
  for (const auto column : kColumns) {
    for (const Sequence& s : sequences) {
      const double difference = s.rows[method].*column - mean.*column;
      variance.*column += difference * difference / static_cast<double>(sequences.size() - 1);
    }
  }
  return variance;
}

bool is_shown(slam::MatchingMethod method, const MatchEvalOptions& options) {
  return method != slam::MatchingMethod::baseline || options.matching.baseline;
}

std::string shown_name(slam::MatchingMethod method, const MatchEvalOptions& options) {
  return method == slam::MatchingMethod::baseline ? options.baseline_name : name_of(method);
}

nlohmann::json to_json(const Row& row) {
  return {{"pairs", row.pairs},
          {"effective_pairs", row.effective},
          {"effective_rate_percent", row.rate},
          {"ms", row.ms},
          {"filter_ms", row.filter_ms}};
}

void print_json(const std::vector<Sequence>& sequences, const MatchEvalOptions& options) {
  nlohmann::json json;
  json["threshold_px"] = options.matching.threshold;
  json["orb_features"] = options.matching.orb_features;
  json["sequences"] = nlohmann::json::array();
  for (const Sequence& s : sequences) {
    nlohmann::json methods;
    for (const slam::MatchingMethod method : slam::kMatchingMethods) {
      if (is_shown(method, options))
        methods[shown_name(method, options)] = to_json(s.rows[static_cast<std::size_t>(method)]);
    }
    json["sequences"].push_back({{"name", s.name}, {"image_pairs", s.images}, {"methods", methods}});
  }
  for (const slam::MatchingMethod method : slam::kMatchingMethods) {
    if (!is_shown(method, options)) continue;
    const std::size_t m = static_cast<std::size_t>(method);
    json["mean"][shown_name(method, options)] = to_json(mean_of(sequences, m));
    json["variance"][shown_name(method, options)] = to_json(variance_of(sequences, m));
  }
  fmt::print("{}\n", json.dump(2));
}

void print_row(const std::string& name, const std::string& method, const Row& row) {
  fmt::print("{:<22} {:<22} {:8.1f} {:10.1f} {:9.1f} {:9.2f} {:10.4f}\n", name, method, row.pairs,
             row.effective, row.rate, row.ms, row.filter_ms);
}

void print_table(const std::vector<Sequence>& sequences, const MatchEvalOptions& options) {
  fmt::print("effective: within {:g} px of the epipolar lines of the true motion\n",
             options.matching.threshold);
  fmt::print("{:<22} {:<22} {:>8} {:>10} {:>9} {:>9} {:>10}\n", "sequence", "method", "pairs", "effective",
             "rate %", "time ms", "filter ms");
  const auto print_all = [&](const std::string& name, const auto& row_of) {
    for (const slam::MatchingMethod method : slam::kMatchingMethods) {
      if (is_shown(method, options))
        print_row(name, shown_name(method, options), row_of(static_cast<std::size_t>(method)));
    }
  };
  for (const Sequence& s : sequences) print_all(s.name, [&](std::size_t m) { return s.rows[m]; });
  if (sequences.size() < 2) return;
  print_all("mean", [&](std::size_t m) { return mean_of(sequences, m); });
  print_all("variance", [&](std::size_t m) { return variance_of(sequences, m); });
}

void write_plot(const std::vector<Sequence>& sequences, const MatchEvalOptions& options) {
  std::vector<slam::HistogramPanel> panels;
  for (const slam::MatchingMethod method :
       {slam::MatchingMethod::orb_paper, slam::MatchingMethod::orb_adaptive,
        slam::MatchingMethod::orb_compensated}) {
    slam::HistogramPanel panel;
    panel.title = name_of(method);
    for (const Sequence& s : sequences) {
      const auto& bins = s.histograms[static_cast<std::size_t>(method)].bins;
      for (std::size_t b = 0; b < bins.size(); ++b) {
        auto& sum = panel.histogram.bins[b];
        sum.effective_kept += bins[b].effective_kept;
        sum.effective_removed += bins[b].effective_removed;
        sum.wrong_kept += bins[b].wrong_kept;
        sum.wrong_removed += bins[b].wrong_removed;
      }
    }
    panels.push_back(panel);
  }
  const std::string title =
      sequences.size() == 1 ? sequences.front().name : fmt::format("{} sequences", sequences.size());
  slam::write_plot(options.plot,
                   slam::draw_displacements("What the histogram filter removes: " + title, panels));
}

void run_match_eval(MatchEvalOptions options) {
  if (options.no_baseline) options.matching.baseline = {};
  slam::DatasetOptions from = dataset_options(options.dataset);
  const std::string& folder = options.dataset.folder;
  if (options.sequences.empty()) options.sequences = slam::kitti_sequences(folder);
  if (options.sequences.empty()) options.sequences = {""};
  std::vector<Sequence> sequences;
  for (const std::string& name : options.sequences) {
    from.sequence = name;
    sequences.push_back(evaluate(*slam::open_dataset(folder, from), options.matching));
  }
  if (options.json) {
    print_json(sequences, options);
  } else {
    print_table(sequences, options);
  }
  if (!options.plot.empty()) write_plot(sequences, options);
}

}  // namespace

void add_match_eval_command(CLI::App& app, slam::BaselineMaker baseline) {
  const auto options = std::make_shared<MatchEvalOptions>();
  options->matching.baseline = std::move(baseline);
  if (options->matching.baseline) options->baseline_name = options->matching.baseline()->name();
  CLI::App* command =
      app.add_subcommand("match-eval", "Compare feature matching, with and without the mismatch filter");
  command->footer(kMatchEvalExamples);
  add_dataset_arguments(*command, options->dataset, "folder of the dataset, with ground truth");
  command->add_option("--sequence", options->sequences,
                      "which ones of a KITTI root; all where none is given");
  command->add_option("--threshold", options->matching.threshold, "pixels up to which a pair is effective")
      ->check(number_above_zero())
      ->capture_default_str();
  command->add_option("--features", options->matching.orb_features, "ORB features per image")
      ->check(CLI::Range(10, 20000))
      ->capture_default_str();
  // Without a baseline the flag has nothing to leave out, but scripts may have it.
  command->add_flag("--no-sift", options->no_baseline, "leave SIFT out")
      ->group(options->matching.baseline ? "Options" : "");
  command->add_flag("--json", options->json, "print JSON");
  command->add_option("--plot", options->plot,
                      "SVG (or PNG) of the displacements that the filters keep and remove");
  command->callback([options] { run_match_eval(*options); });
}

void add_match_eval_command(CLI::App& app) { add_match_eval_command(app, {}); }

}  // namespace penumbra::apps
