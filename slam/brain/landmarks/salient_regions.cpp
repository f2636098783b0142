#include "slam/brain/landmarks/salient_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra::slam::brain {

namespace {

using EmbeddingView = std::span<const float, kDescriptorSize>;

EmbeddingView embedding_of(const ImageCells& cells, std::uint32_t cell) {
  return cells.embeddings.subspan(std::size_t{cell} * kDescriptorSize).first<kDescriptorSize>();
}

float dot(EmbeddingView a, const Descriptor& b) {
  float sum = 0.0F;
  for (std::size_t k = 0; k < kDescriptorSize; ++k) sum += a[k] * b[k];
  return sum;
}

void add(Descriptor& sum, float weight, EmbeddingView e) {
  for (std::size_t k = 0; k < kDescriptorSize; ++k) sum[k] += weight * e[k];
}

float length_of(const Descriptor& d) { return std::sqrt(dot(EmbeddingView(d), d)); }

}  // namespace

void SalientRegions::classify(const ImageCells& cells) {
  const auto count = static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height);
  class_of_.assign(count, kNothing);
  probability_of_.assign(count, 0.0F);
  seeds_.clear();
  seeds_.reserve(count);
  region_.reserve(count);
  for (std::size_t cell = 0; cell < count; ++cell) {
    const std::span<const float> p = cells.probabilities.subspan(cell * kLandmarkClasses, kLandmarkClasses);
    const auto best = std::max_element(p.begin(), p.end());
    const auto landmark_class = static_cast<int>(best - p.begin());
    if (!stands(landmark_class) || !(*best >= settings_.least_probability)) continue;
    if (p[kPerson] + p[kVehicle] > settings_.most_moving) continue;
    class_of_[cell] = static_cast<std::int8_t>(landmark_class);
    probability_of_[cell] = *best;
    seeds_.push_back(static_cast<std::uint32_t>(cell));
  }
  std::sort(seeds_.begin(), seeds_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return probability_of_[a] != probability_of_[b] ? probability_of_[a] > probability_of_[b] : a < b;
  });
}

void SalientRegions::grow(const ImageCells& cells, std::uint32_t seed) {
  const std::int8_t wanted = class_of_[seed];
  const auto width = static_cast<std::uint32_t>(cells.width);
  Descriptor sum{};
  region_.clear();
  const auto take = [&](std::uint32_t cell) {
    if (class_of_[cell] != wanted) return;
    const EmbeddingView e = embedding_of(cells, cell);
    if (!region_.empty() && !(dot(e, sum) >= settings_.least_cosine * length_of(sum))) return;
    class_of_[cell] = kNothing;
    add(sum, 1.0F, e);
    region_.push_back(cell);
  };
  take(seed);
  for (std::size_t k = 0; k < region_.size(); ++k) {
    const std::uint32_t cell = region_[k], x = cell % width;
    if (x > 0) take(cell - 1);
    if (x + 1 < width) take(cell + 1);
    if (cell >= width) take(cell - width);
    if (cell + width < class_of_.size()) take(cell + width);
  }
}

Landmark SalientRegions::landmark(const ImageCells& cells, int landmark_class) const {
  Landmark made;
  made.landmark_class = landmark_class;
  const auto width = static_cast<std::uint32_t>(cells.width);
  std::uint32_t x0 = width, x1 = 0, y0 = std::numeric_limits<std::uint32_t>::max(), y1 = 0;
  for (const std::uint32_t cell : region_) {
    const std::uint32_t x = cell % width, y = cell / width;
    x0 = std::min(x0, x);
    x1 = std::max(x1, x + 1);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y + 1);
    made.score += probability_of_[cell];
    add(made.descriptor, probability_of_[cell], embedding_of(cells, cell));
  }
  made.score /= static_cast<float>(region_.size());
  const float length = length_of(made.descriptor);
  for (float& value : made.descriptor) value = length > 0.0F ? value / length : 0.0F;
  const auto inside = [&](std::uint32_t at, float first, int extent) {
    return std::clamp(first + static_cast<float>(at) * cells.size, 0.0F, static_cast<float>(extent));
  };
  made.x0 = inside(x0, cells.left, cells.image_width);
  made.x1 = inside(x1, cells.left, cells.image_width);
  made.y0 = inside(y0, cells.top, cells.image_height);
  made.y1 = inside(y1, cells.top, cells.image_height);
  return made;
}

void SalientRegions::operator()(const ImageCells& cells, Landmarks& landmarks) {
  classify(cells);
  found_.clear();
  const auto least = static_cast<std::size_t>(std::max(settings_.least_cells, 1));
  found_.reserve(class_of_.size() / least);
  for (const std::uint32_t seed : seeds_) {
    const int landmark_class = class_of_[seed];
    if (landmark_class == kNothing) continue;
    grow(cells, seed);
    if (region_.size() >= least) found_.push_back(landmark(cells, landmark_class));
  }
  rate(found_, settings_.interest);
  landmarks.reserve(kMostLandmarks);
  landmarks.assign(found_.begin(), found_.end());
}

}  // namespace penumbra::slam::brain
