// penumbra eval-coco: how good a detector's boxes and masks are, as COCO counts it.

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/finite_number.h"
#include "apps/common/log.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/evaluation/coco_evaluation.h"

namespace penumbra::apps {

namespace {

constexpr const char* kEvalCocoExamples = R"(Examples:
  penumbra segment --coco-images val2017 --annotations instances_val2017.json --weights w.safetensors --out found
  penumbra eval-coco --annotations instances_val2017.json --results found/results.json
  penumbra eval-coco --annotations instances_val2017.json --results boxes.json --type bbox --json
  penumbra eval-coco --annotations street/annotations/instances.json --results found/results.json --occlusion 0,0.3,0.6,0.9

The numbers are those of the official COCO evaluation; see docs/coco_evaluation.md.)";

struct EvalCocoOptions {
  std::string annotations, results, type = "auto", rules = "official";
  std::vector<double> occlusion;  // bounds of ranges
  bool json = false;
};

struct OcclusionReport {
  nn::OcclusionRange range;
  std::size_t objects = 0;
  std::optional<nn::CocoNumbers> boxes, masks;
};

struct CocoReport {
  std::size_t images = 0, annotations = 0, crowds = 0, results = 0;
  std::optional<nn::CocoNumbers> boxes, masks;
  std::vector<OcclusionReport> by_occlusion;
};

std::vector<nn::OcclusionRange> occlusion_ranges(const std::vector<double>& bounds) {
  std::vector<nn::OcclusionRange> ranges;
  for (std::size_t k = 0; k + 1 < bounds.size(); ++k) {
    if (!(bounds[k] < bounds[k + 1])) break;
    ranges.push_back({bounds[k], bounds[k + 1]});
  }
  if (!bounds.empty() && (ranges.empty() || ranges.size() + 1 != bounds.size())) {
    throw UsageError("--occlusion: expected at least two rising numbers such as 0,0.3,0.6,0.9");
  }
  return ranges;
}

template <class Entries>
bool any_has_segmentation(const Entries& entries) {
  return std::any_of(entries.begin(), entries.end(),
                     [](const auto& entry) { return !entry.segmentation.is_missing(); });
}

// What the numbers leave out or count in a way that surprises.
void warn_of_coco_rules(const nn::CocoAnnotations& annotations, const nn::CocoResults& results,
                        nn::CocoRules rules) {
  const auto left_out = [](const std::string& file, std::size_t count, const char* what, const char* of) {
    if (count > 0) {
      log_warning("{}: left out, as the official tool does: {} of {}", file, counted(count, what), of);
    }
  };
  left_out(annotations.file, annotations.of_unknown_images, "annotation", "images that it does not list");
  left_out(annotations.file, annotations.of_unknown_categories, "annotation",
           "categories that it does not list");
  left_out(results.file, results.of_unknown_categories, "result",
           "categories that the annotations do not list");
  if (rules == nn::CocoRules::sensible) return;
  const auto with_id_0 =
      std::count_if(annotations.annotations.begin(), annotations.annotations.end(),
                    [](const auto& object) { return object.has_id_0 && !object.is_crowd; });
  if (with_id_0 > 0) {
    log_warning(
        "{}: {} annotation has the id 0, and the official tool counts each hit of it as a miss; --rules "
        "sensible counts it as a hit",
        annotations.file, with_id_0);
  }
  if (results.with_boxes > 0 && results.with_boxes < results.results.size()) {
    log_warning(
        "{}: with a bbox: {} of {}; the first has {}, so by the official tool's rule the size of {} "
        "is that of {} (APs, APm, APl); --rules sensible takes each by what it has",
        results.file, results.with_boxes, counted(results.results.size(), "result"),
        results.first_has_box ? "one" : "none", results.first_has_box ? "those" : "all",
        results.first_has_box ? "their boxes" : "their masks");
  }
}

struct CocoRegions {
  bool boxes = true, masks = true;
};

// For "auto" what both files have; what cannot be compared is said and left out where the other can.
CocoRegions choose_regions(const std::string& type, const nn::CocoAnnotations& annotations,
                           const nn::CocoResults& results) {
  if (type != "auto") return {type != "segm", type != "bbox"};
  CocoRegions regions;
  regions.masks = any_has_segmentation(annotations.annotations) && any_has_segmentation(results.results);
  const auto problem = [&](std::optional<InputError> nn::CocoProblems::*kind) {
    return annotations.problems.*kind ? annotations.problems.*kind : results.problems.*kind;
  };
  const std::optional<InputError> of_boxes = problem(&nn::CocoProblems::boxes),
                                  of_masks = problem(&nn::CocoProblems::masks);
  if (regions.masks && of_masks) {
    log_warning("masks are not compared: {}", of_masks->what());
    regions.masks = false;
  }
  if (regions.masks && of_boxes) {
    log_warning("boxes are not compared: {}", of_boxes->what());
    regions.boxes = false;
  }
  return regions;
}

CocoReport evaluate(const EvalCocoOptions& options) {
  const std::vector<nn::OcclusionRange> ranges = occlusion_ranges(options.occlusion);
  const nn::CocoAnnotations annotations = nn::read_coco_annotations(options.annotations);
  const nn::CocoRules rules = options.rules == "sensible" ? nn::CocoRules::sensible : nn::CocoRules::official;
  const nn::CocoResults results = nn::read_coco_results(options.results, annotations, rules);
  warn_of_coco_rules(annotations, results, rules);
  CocoReport report;
  report.images = annotations.images.size();
  report.annotations = annotations.annotations.size();
  report.crowds = static_cast<std::size_t>(
      std::count_if(annotations.annotations.begin(), annotations.annotations.end(),
                    [](const nn::CocoAnnotation& annotation) { return annotation.is_crowd; }));
  report.results = results.results.size();
  const auto [boxes, masks] = choose_regions(options.type, annotations, results);
  const auto numbers = [&](nn::CocoRegion region, const std::optional<nn::OcclusionRange>& range) {
    return nn::evaluate_coco(annotations, results, region, range, rules);
  };
  if (boxes) report.boxes = numbers(nn::CocoRegion::boxes, std::nullopt);
  if (masks) report.masks = numbers(nn::CocoRegion::masks, std::nullopt);
  for (const nn::OcclusionRange& range : ranges) {
    OcclusionReport& part = report.by_occlusion.emplace_back();
    part.range = range;
    part.objects = static_cast<std::size_t>(std::count_if(
        annotations.annotations.begin(), annotations.annotations.end(),
        [&](const auto& a) { return !a.is_crowd && a.occlusion && range.contains(*a.occlusion); }));
    if (boxes) part.boxes = numbers(nn::CocoRegion::boxes, range);
    if (masks) part.masks = numbers(nn::CocoRegion::masks, range);
  }
  return report;
}

const char* meaning(std::string_view name) {
  if (name == "AP") return "IoU 0.50:0.95";
  if (name == "AP50") return "IoU 0.50";
  if (name == "AP75") return "IoU 0.75";
  if (name == "AR1") return "best 1 an image";
  if (name == "AR10") return "best 10 an image";
  if (name == "AR100") return "best 100 an image";
  return name.ends_with('s') ? "small" : name.ends_with('m') ? "medium" : "large";
}

std::string table(const CocoReport& report) {
  std::string text = fmt::format("{}, {} and {}, {}\n\n{:<26}", counted(report.images, "image"),
                                 counted(report.annotations - report.crowds, "object"),
                                 counted(report.crowds, "crowd"), counted(report.results, "detection"), "");
  const auto out = std::back_inserter(text);
  if (report.boxes) fmt::format_to(out, "{:>10}", "boxes");
  if (report.masks) fmt::format_to(out, "{:>10}", "masks");
  const auto append = [&](const std::optional<nn::CocoNumbers>& numbers, std::string_view name) {
    if (!numbers) return;
    const double value = (*numbers)[name];
    fmt::format_to(out, "{:>10}", value == nn::kNoObjects ? "-" : fmt::format("{:.4f}", value));
  };
  for (const std::string_view name : nn::kCocoNumberNames) {
    fmt::format_to(out, "\n{:<8}{:<18}", name, meaning(name));
    append(report.boxes, name);
    append(report.masks, name);
  }
  if (!report.by_occlusion.empty()) fmt::format_to(out, "\n\nAP by the hidden share of an object");
  for (const OcclusionReport& part : report.by_occlusion) {
    const std::string range = fmt::format("{:g} to {:g}", part.range.from, part.range.to);
    fmt::format_to(out, "\n{:<12}{:<14}", range, counted(part.objects, "object"));
    append(part.boxes, "AP");
    append(part.masks, "AP");
  }
  return text + "\n";
}

nlohmann::ordered_json numbers_json(const nn::CocoNumbers& numbers) {
  nlohmann::ordered_json json;
  for (const std::string_view name : nn::kCocoNumberNames) {
    const double value = numbers[name];
    json[std::string(name)] =
        value == nn::kNoObjects ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(value);
  }
  return json;
}

nlohmann::ordered_json to_json(const CocoReport& report) {
  nlohmann::ordered_json json = {{"images", report.images},
                                 {"objects", report.annotations - report.crowds},
                                 {"crowds", report.crowds},
                                 {"detections", report.results}};
  if (report.boxes) json["bbox"] = numbers_json(*report.boxes);
  if (report.masks) json["segm"] = numbers_json(*report.masks);
  for (const OcclusionReport& part : report.by_occlusion) {
    nlohmann::ordered_json entry = {
        {"from", part.range.from}, {"to", part.range.to}, {"objects", part.objects}};
    if (part.boxes) entry["bbox"] = numbers_json(*part.boxes);
    if (part.masks) entry["segm"] = numbers_json(*part.masks);
    json["occlusion"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace

void add_eval_coco_command(CLI::App& app) {
  const auto options = std::make_shared<EvalCocoOptions>();
  CLI::App* command = app.add_subcommand(
      "eval-coco", "Compare detections with ground truth: COCO's AP and AR of boxes and masks");
  command->footer(kEvalCocoExamples);
  command->add_option("--annotations", options->annotations, "ground truth, COCO's instances format")
      ->required();
  command->add_option("--results", options->results, "detections, COCO's results format")->required();
  command
      ->add_option("--type", options->type,
                   "what to compare; auto: boxes, and masks where both files have segmentations")
      ->check(CLI::IsMember({"auto", "bbox", "segm", "both"}))
      ->capture_default_str();
  command
      ->add_option("--occlusion", options->occlusion,
                   "also count objects by their hidden share: bounds of ranges, such as 0,0.3,0.6,0.9; the "
                   "annotations need \"occlusion\"")
      ->delimiter(',')
      ->check(number_from(0.0, 1.0, "a share from 0 to 1"));
  command
      ->add_option("--rules", options->rules,
                   "official: the official tool's number, always; sensible: also where its code counts an "
                   "object of id 0 as never found, or sizes by the first result's kind")
      ->check(CLI::IsMember({"official", "sensible"}))
      ->capture_default_str();
  command->add_flag("--json", options->json,
                    "print JSON instead of a table; null where there is no object of a kind");
  command->callback([options] {
    const CocoReport report = evaluate(*options);
    fmt::print("{}", options->json ? to_json(report).dump(2) + "\n" : table(report));
  });
}

}  // namespace penumbra::apps
