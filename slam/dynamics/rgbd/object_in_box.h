// Which pixels of a detector's box belong to the object, by their depths.
//
// Mode `paper` (Fang et al., equations 1 to 5). The known depths in the box form k clusters by K-means; with
// D_i a cluster's mean depth and count_i its size,
//
//   Dn_i = D_i / (D_max - D_min),   cn_i = count_i / (count_max - count_min)                             (4)
//   score_i = theta1 cn_i + theta2 Dn_i,   theta1 = 0.5, theta2 = -0.5                                   (5)
//
// and the cluster with the highest score is the object. Where a denominator is 0 (all sizes are equal, or
// there is one cluster) its term says nothing and counts as 0; of equal scores the nearest cluster wins.
//
// Mode `grown`, by small squares of pixels (cells):
//
//   1. k = 8 clusters. The object is a run i..j of neighbours among them, no deeper than it is wide (or half
//      as deep as high), with the largest
//        in - ring + extent / 2 + 0.15 (hides - hidden - goes on) / (w + h) + 0.2 [holds the object's depth
//        in the frame before]
//      in: share of the cells in the box with depth; ring: share of those in a ring around it, 15 % of its
//      sides wide: a desk, a floor or a wall goes on outside the box, the object does not. extent: overlap
//      (IoU) of the box with the smallest rectangle around the run's cells, outliers aside: the box was drawn
//      around the object. hides, hidden: pairs of neighbouring cells with a jump in depth where the run's is
//      the nearer or the farther one: an outline belongs to what is in front. goes on: such pairs without a
//      jump on the border of the box. w, h: the box in cells.
//   2. That depth belongs to other things as well, to the desk beside a person: the cells are shared out
//      between the object and what is outside (cell_growth.h).
//   3. Pixels of cells at the edge of what was found go to the side whose depth is nearer to their own.
//
// Where no depths stand out in the box, as with a keyboard on a desk, the whole box is the object; so it is
// where the box has hardly any depths. Cost: docs/benchmarks.md.
// Source: Fang, Zhang, Wang (see depth_repair.h); the second mode is ours.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "nn/image/image.h"
#include "slam/dynamics/rgbd/box_cells.h"
#include "slam/dynamics/rgbd/cell_growth.h"
#include "slam/dynamics/rgbd/depth_kmeans.h"

namespace penumbra::slam {

enum class ClusterMode { paper, grown };

struct ObjectInBoxSettings {
  ClusterMode mode = ClusterMode::grown;
  int clusters = 8;          // k; the paper does not say, 2 or 3 are usual
  double ring_share = 0.15;  // of the box's sides
  double extent_weight = 0.5;
  double contour_weight = 0.15;
  double past_weight = 0.2;
  double least_score = 0.25;  // below which nothing stands out
};

struct ObjectMask {
  ByteImage mask;      // of the box's part in the image; 255 inside
  double depth = 0.0;  // metres, median; 0: the mask is the box, whose depths tell nothing
};

// Keeps its memory from box to box; for one thread at a time.
class ObjectInBox {
 public:
  // `focal_length`: pixels; tells how wide an object is.
  ObjectInBox(double focal_length, const ObjectInBoxSettings& settings)
      : focal_length_(focal_length), settings_(settings) {}

  // `image`: 8-bit grey or BGR, of the size of `depth` (metres, 0 where unknown); `box`: inside the image,
  // not empty. `past`: depth of the object in an earlier frame, metres.
  void find(const ByteView& image, const FloatImage& depth, const Rect& box, std::optional<double> past,
            ObjectMask& found);

 private:
  static constexpr int kMostClusters = 16;
  struct Run {
    int first = 0, last = 0;  // clusters
    double score = -1.0;
  };
  struct Contour {
    std::array<std::array<int, kMostClusters + 1>, kMostClusters + 1> nearer{};  // [nearer one][farther one]
    std::array<int, kMostClusters> goes_on{};                                    // into the ring
  };
  void find_as_paper(const FloatImage& depth, const Rect& box, ObjectMask& found);
  void cut_into_clusters(const ByteView& image, const FloatImage& depth, const Rect& box);
  void find_contour();
  Run best_run(const Rect& box, std::optional<double> past);
  void paint(const FloatImage& depth, const Rect& box, ObjectMask& found) const;

  const double focal_length_;
  const ObjectInBoxSettings settings_;
  DepthHistogram histogram_;
  DepthKmeans kmeans_;
  std::vector<DepthCluster> clusters_;
  BoxCells cells_;  // of the box and the ring
  Contour contour_;
  std::vector<int> in_columns_, in_rows_;  // [cluster][column or row]: cells in the box
  CellGrowth growth_;
};

}  // namespace penumbra::slam
