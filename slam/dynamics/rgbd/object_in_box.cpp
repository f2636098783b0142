#include "slam/dynamics/rgbd/object_in_box.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace penumbra::slam {

namespace {

using Place = BoxCell::Place;

constexpr double kLeastKnown = 0.05;      // share of the box with depth, below which the box stays
constexpr double kLeastRingKnown = 0.05;  // of the ring
constexpr double kOutliers = 0.02;        // share of a run's cells on each side of its extent
constexpr double kNearerThanRun = 0.5, kFartherThanRun = 0.15;  // metres, that may still be the object
constexpr double kLeastDepth = 0.2, kMostDepth = 1.2;           // metres, that a run may be deep
constexpr double kPastSlack = 0.3;                              // metres between two frames
constexpr double kLeastArea = 0.03;                             // of the box

constexpr double kTie = 1e-9;  // between the paper's scores, which often are equal but for rounding

void keep_box(const Rect& box, ObjectMask& found) {
  found.mask.create(box.width, box.height);
  found.mask.fill(255);
  found.depth = 0.0;
}

// The clusters' numbers by bin of the histogram: between two clusters, the nearer one's in depth.
void number_bins(const std::vector<DepthCluster>& clusters,
                 std::array<std::int8_t, DepthHistogram::kBins>& numbers) {
  numbers.fill(-1);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    int end = clusters[c].last + 1;
    if (c + 1 < clusters.size())
      end = DepthHistogram::bin_of(static_cast<float>(0.5 * (clusters[c].mean + clusters[c + 1].mean)));
    end = std::max(end, clusters[c].last + 1);
    if (c + 1 < clusters.size()) end = std::min(end, clusters[c + 1].first);
    const int begin = c == 0 ? clusters[c].first : 0;
    for (int bin = begin; bin < end; ++bin) {
      std::int8_t& number = numbers[static_cast<std::size_t>(bin)];
      if (number < 0 && (c == 0 || bin > clusters[c - 1].last)) number = static_cast<std::int8_t>(c);
    }
  }
}

// Metres, between neighbouring cells of different things.
float least_jump(float metres) { return 0.06F + 0.012F * metres * metres; }

}  // namespace

void ObjectInBox::find(const ByteView& image, const FloatImage& depth, const Rect& box,
                       std::optional<double> past, ObjectMask& found) {
  if (settings_.mode == ClusterMode::paper) return find_as_paper(depth, box, found);
  cut_into_clusters(image, depth, box);
  int known = 0, cells = 0;
  for (const BoxCell& cell : cells_.cells) {
    if (cell.place != Place::box) continue;
    ++cells;
    known += cell.depth > 0.0F;
  }
  if (known < kLeastKnown * cells || known < 4) return keep_box(box, found);
  find_contour();
  const Run run = best_run(box, past);
  if (run.score < settings_.least_score) return keep_box(box, found);
  const double nearest = clusters_[static_cast<std::size_t>(run.first)].mean - kNearerThanRun;
  const double farthest =
      DepthHistogram::depth_of(clusters_[static_cast<std::size_t>(run.last)].last) + kFartherThanRun;
  growth_.grow(cells_, {run.first, run.last, nearest, farthest});
  double sum = 0.0;
  int area = 0, with_depth = 0;
  for (const BoxCell& cell : cells_.cells) {
    if (cell.place != Place::box || !cell.is_object) continue;
    ++area;
    with_depth += cell.depth > 0.0F;
    sum += static_cast<double>(cell.depth);
  }
  if (area < kLeastArea * cells || with_depth == 0) return keep_box(box, found);
  paint(depth, box, found);
  found.depth = sum / with_depth;
}

void ObjectInBox::find_as_paper(const FloatImage& depth, const Rect& box, ObjectMask& found) {
  histogram_.clear();
  for (int y = box.y; y < box.y + box.height; ++y) {
    const float* z = depth.row(y);
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (is_depth(z[x])) histogram_.add(z[x]);
    }
  }
  const std::vector<DepthCluster>& clusters = kmeans_.cluster(histogram_, settings_.clusters);
  if (clusters.empty()) return keep_box(box, found);
  const auto by_count = [](const DepthCluster& a, const DepthCluster& b) { return a.count < b.count; };
  const auto [fewest, most] = std::minmax_element(clusters.begin(), clusters.end(), by_count);
  const double depths = clusters.back().mean - clusters.front().mean, counts = most->count - fewest->count;
  const DepthCluster* best = nullptr;
  double best_score = 0.0;
  for (const DepthCluster& cluster : clusters) {
    const double score = 0.5 * (counts > 0.0 ? cluster.count / counts : 0.0) -
                         0.5 * (depths > 0.0 ? cluster.mean / depths : 0.0);
    if (best != nullptr && score <= best_score + kTie) continue;
    best = &cluster;
    best_score = score;
  }
  found.mask.create(box.width, box.height);
  found.depth = best->mean;
  for (int y = 0; y < box.height; ++y) {
    const float* z = depth.row(box.y + y) + box.x;
    std::uint8_t* mask = found.mask.row(y);
    for (int x = 0; x < box.width; ++x) {
      const int bin = is_depth(z[x]) ? DepthHistogram::bin_of(z[x]) : -1;
      mask[x] = bin >= best->first && bin <= best->last ? 255 : 0;
    }
  }
}

// Cuts the box and the ring into cells, and the box's depths into clusters.
void ObjectInBox::cut_into_clusters(const ByteView& image, const FloatImage& depth, const Rect& box) {
  cells_.cut(image, depth, box, settings_.ring_share);
  histogram_.clear();
  for (const BoxCell& cell : cells_.cells) {
    if (cell.place == Place::box && cell.depth > 0.0F) histogram_.add(cell.depth);
  }
  clusters_ = kmeans_.cluster(histogram_, std::min(settings_.clusters, kMostClusters));
  std::array<std::int8_t, DepthHistogram::kBins> numbers;
  number_bins(clusters_, numbers);
  for (BoxCell& cell : cells_.cells) {
    if (cell.depth > 0.0F)
      cell.cluster = numbers[static_cast<std::size_t>(DepthHistogram::bin_of(cell.depth))];
  }
}

// Which clusters hide which, and which go on outside the box.
void ObjectInBox::find_contour() {
  contour_ = {};
  const int width = cells_.grid.width;
  const auto number = [](const BoxCell& cell) {
    return static_cast<std::size_t>(cell.cluster < 0 ? kMostClusters : cell.cluster);
  };
  const auto compare = [&](const BoxCell& a, const BoxCell& b) {
    if (a.place == Place::outside || b.place == Place::outside || a.depth == 0.0F || b.depth == 0.0F) return;
    if (a.place == Place::ring && b.place == Place::ring) return;
    const float jump = b.depth - a.depth, least = least_jump(std::min(a.depth, b.depth));
    if (std::abs(jump) > least) {
      const BoxCell& near = jump > 0.0F ? a : b;
      const BoxCell& far = jump > 0.0F ? b : a;
      const std::size_t n = near.place == Place::ring ? kMostClusters : number(near);
      const std::size_t f = far.place == Place::ring ? kMostClusters : number(far);
      if (n != f) ++contour_.nearer[n][f];
    } else if (a.place != b.place) {
      const BoxCell& in = a.place == Place::box ? a : b;
      if (in.cluster >= 0) ++contour_.goes_on[static_cast<std::size_t>(in.cluster)];
    }
  };
  for (int row = 0; row < cells_.grid.height; ++row) {
    const BoxCell* cells = cells_.cells.data() + static_cast<std::ptrdiff_t>(row) * width;
    for (int column = 0; column < width; ++column) {
      if (column + 1 < width) compare(cells[column], cells[column + 1]);
      if (row + 1 < cells_.grid.height) compare(cells[column], cells[column + width]);
    }
  }
}

ObjectInBox::Run ObjectInBox::best_run(const Rect& box, std::optional<double> past) {
  const int k = static_cast<int>(clusters_.size());
  const int width = cells_.grid.width, height = cells_.grid.height;
  in_columns_.assign(static_cast<std::size_t>(k * width), 0);
  in_rows_.assign(static_cast<std::size_t>(k * height), 0);
  std::array<int, 128> in_box{}, in_ring{};
  int box_cells = 0, box_known = 0, ring_cells = 0, ring_known = 0;
  Rect box_grid;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const BoxCell& cell = cells_.cells[static_cast<std::size_t>(row * width + column)];
      if (cell.place == Place::outside) continue;
      const bool is_box = cell.place == Place::box;
      (is_box ? box_cells : ring_cells) += 1;
      if (is_box) box_grid = bounding(box_grid, {column, row, 1, 1});
      if (cell.depth == 0.0F) continue;
      (is_box ? box_known : ring_known) += 1;
      if (cell.cluster < 0) continue;
      ++(is_box ? in_box : in_ring)[static_cast<std::size_t>(cell.cluster)];
      if (!is_box) continue;
      ++in_columns_[static_cast<std::size_t>(cell.cluster * width + column)];
      ++in_rows_[static_cast<std::size_t>(cell.cluster * height + row)];
    }
  }
  const bool ring_tells = ring_known > kLeastRingKnown * ring_cells && ring_known > 0;

  // The first and last column or row of a run, but for outliers.
  const auto extent = [&](const std::vector<int>& counts, int length, int first, int last, int total) {
    const double outliers = kOutliers * total;
    const auto at = [&](int n) {
      int sum = 0;
      for (int c = first; c <= last; ++c) sum += counts[static_cast<std::size_t>(c * length + n)];
      return sum;
    };
    int begin = 0, end = length;
    for (int sum = 0; begin < end && (sum += at(begin)) <= outliers;) ++begin;
    for (int sum = 0; end > begin && (sum += at(end - 1)) <= outliers;) --end;
    return std::pair(begin, end - begin);
  };
  Run best;
  for (int first = 0; first < k; ++first) {
    int in = 0, around = 0;
    for (int last = first; last < k; ++last) {
      const double nearest = clusters_[static_cast<std::size_t>(first)].mean;
      const double farthest = clusters_[static_cast<std::size_t>(last)].mean;
      const double wide = std::max<double>(box.width, 0.5 * box.height) * nearest / focal_length_;
      if (last > first && farthest - nearest > std::clamp(wide, kLeastDepth, kMostDepth)) break;
      in += in_box[static_cast<std::size_t>(last)];
      around += in_ring[static_cast<std::size_t>(last)];
      const auto [x, w] = extent(in_columns_, width, first, last, in);
      const auto [y, h] = extent(in_rows_, height, first, last, in);
      // The extent lies in the box.
      const double overlap = static_cast<double>(w) * h / box_grid.area();
      double score = static_cast<double>(in) / box_known + settings_.extent_weight * overlap;
      if (ring_tells) score -= static_cast<double>(around) / ring_known;
      int hides = 0, hidden = 0, goes_on = 0;
      for (int a = first; a <= last; ++a) {
        const auto own = static_cast<std::size_t>(a);
        goes_on += contour_.goes_on[own];
        for (int b = 0; b <= kMostClusters; ++b) {
          if (b >= first && b <= last) continue;
          hides += contour_.nearer[own][static_cast<std::size_t>(b)];
          hidden += contour_.nearer[static_cast<std::size_t>(b)][own];
        }
      }
      score += settings_.contour_weight * (hides - hidden - goes_on) / (box_grid.width + box_grid.height);
      if (past && *past > nearest - kPastSlack && *past < farthest + kPastSlack)
        score += settings_.past_weight;
      if (score > best.score) best = {first, last, score};
    }
  }
  return best;
}

// Step 3.
void ObjectInBox::paint(const FloatImage& depth, const Rect& box, ObjectMask& found) const {
  found.mask.create(box.width, box.height);
  const int width = cells_.grid.width;
  for (int row = 0; row < cells_.grid.height; ++row) {
    for (int column = 0; column < width; ++column) {
      const BoxCell& cell = cells_.cells[static_cast<std::size_t>(row * width + column)];
      if (cell.place != Place::box) continue;
      float own = 0.0F, other = 0.0F;  // sums of depths around
      int owns = 0, others = 0;
      for (int y = std::max(0, row - 1); y <= std::min(cells_.grid.height - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(width - 1, column + 1); ++x) {
          const BoxCell& near = cells_.cells[static_cast<std::size_t>(y * width + x)];
          if (near.depth == 0.0F) continue;
          (near.is_object ? own : other) += near.depth;
          ++(near.is_object ? owns : others);
        }
      }
      const Rect pixels = intersection(
          {cells_.grid.x + column * cells_.side, cells_.grid.y + row * cells_.side, cells_.side, cells_.side},
          box);
      const bool is_edge = owns > 0 && others > 0;
      const float own_depth = own / static_cast<float>(std::max(1, owns));
      const float other_depth = other / static_cast<float>(std::max(1, others));
      for (int y = pixels.y; y < pixels.y + pixels.height; ++y) {
        const float* z = depth.row(y);
        std::uint8_t* mask = found.mask.row(y - box.y) - box.x;
        for (int x = pixels.x; x < pixels.x + pixels.width; ++x) {
          bool inside = cell.is_object;
          if (is_edge && is_depth(z[x])) inside = std::abs(z[x] - own_depth) < std::abs(z[x] - other_depth);
          mask[x] = inside ? 255 : 0;
        }
      }
    }
  }
}

}  // namespace penumbra::slam
