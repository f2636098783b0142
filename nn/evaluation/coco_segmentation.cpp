#include "nn/evaluation/coco_segmentation.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "nn/base/error.h"
#include "nn/evaluation/coco_rle.h"
#include "nn/evaluation/polygon_raster.h"

namespace penumbra::nn {

namespace {

using nlohmann::json;

constexpr const char* kKey = "segmentation";

std::vector<double> read_polygon(const JsonFields& fields, const json& list, std::size_t part) {
  const auto fail = [&](std::string_view expected, std::string_view found) {
    fields.fail(fmt::format("{}, polygon {}", kKey, part).c_str(), expected, found);
  };
  if (!list.is_array()) fail("a list of numbers x0, y0, x1, y1, ...", describe(list));
  const std::size_t fewest = part == 0 ? 6 : 4;
  if (list.size() < fewest || list.size() % 2 != 0) {
    fail(fmt::format("an even count of {} or more numbers", fewest), fmt::format("{}", list.size()));
  }
  std::vector<double> xy;
  xy.reserve(list.size());
  for (const json& number : list) {
    if (!number.is_number()) fail("numbers", describe(number));
    xy.push_back(number.get<double>());
    if (!(std::abs(xy.back()) <= kLargestCoordinate)) {
      fail(fmt::format("coordinates within +-{:g} pixels", kLargestCoordinate), describe(number));
    }
  }
  return xy;
}

int read_side(const JsonFields& fields, const json& side) {
  const std::optional<std::int64_t> number = whole_number(side);
  if (!number || *number < 1 || *number > kLargestImageSide) {
    fields.fail("segmentation, size", fmt::format("whole numbers of 1..{}", kLargestImageSide),
                describe(side));
  }
  return static_cast<int>(*number);
}

std::vector<std::uint32_t> read_counts(const JsonFields& fields, const json& counts, std::uint64_t pixels) {
  constexpr const char* kPlace = "segmentation, counts";
  if (counts.is_string()) {
    try {
      return decode_runs(counts.get_ref<const std::string&>(), pixels);
    } catch (const InputError& error) {
      fields.fail(kPlace, "text of COCO's run-length code", fmt::format("damage ({})", error.what()));
    }
  }
  if (!counts.is_array()) fields.fail(kPlace, "a list or a text", describe(counts));
  std::vector<std::uint32_t> runs;
  runs.reserve(counts.size());
  for (const json& run : counts) {
    const std::optional<std::int64_t> number = whole_number(run);
    if (!number || *number < 0 || *number > std::numeric_limits<std::uint32_t>::max()) {
      fields.fail(kPlace, "whole numbers >= 0 and below 2^32", describe(run));
    }
    runs.push_back(static_cast<std::uint32_t>(*number));
  }
  return runs;
}

RunMask read_run_mask(const JsonFields& fields, const json& value) {
  const auto size = value.find("size"), counts = value.find("counts");
  if (size == value.end() || counts == value.end()) {
    fields.fail(kKey, "the keys \"size\" and \"counts\"", "only some of them");
  }
  if (!size->is_array() || size->size() != 2) {
    fields.fail("segmentation, size", "[height, width]", describe(*size));
  }
  const int height = read_side(fields, (*size)[0]), width = read_side(fields, (*size)[1]);
  const auto pixels = static_cast<std::uint64_t>(height) * static_cast<std::uint64_t>(width);
  const std::vector<std::uint32_t> runs = read_counts(fields, *counts, pixels);
  std::uint64_t total = 0;
  for (const std::uint32_t run : runs) total += run;
  if (total != pixels) {
    fields.fail("segmentation, counts",
                fmt::format("runs of {} pixels in all ({} x {})", pixels, width, height),
                fmt::format("{}", total));
  }
  return mask_from_counts(runs, width, height);
}

}  // namespace

CocoSegmentation read_segmentation(const JsonFields& fields) {
  CocoSegmentation segmentation;
  if (!fields.has(kKey)) return segmentation;
  const json& value = fields.at(kKey);
  if (value.is_object()) {
    segmentation.mask = read_run_mask(fields, value);
  } else if (value.is_array()) {
    segmentation.polygons.reserve(value.size());
    for (const json& polygon : value) {
      segmentation.polygons.push_back(read_polygon(fields, polygon, segmentation.polygons.size()));
    }
  } else {
    fields.fail(kKey, "a list of polygons or an object of size and counts", describe(value));
  }
  return segmentation;
}

RunMask to_mask(const CocoSegmentation& segmentation, int width, int height) {
  return segmentation.polygons.empty() ? segmentation.mask
                                       : rasterise_polygons(segmentation.polygons, width, height);
}

}  // namespace penumbra::nn
