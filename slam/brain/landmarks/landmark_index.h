// The templates of a map, and which of them an image is most like.
//
// Comparing with all of thousands one by one takes milliseconds. So a template has a pooled vector, which
// counts all pairs of landmarks of a class in place of the best ones:
//
//   p = for each class: sum over its landmarks of sqrt(I_i) d_i,  all divided by its length     8 x 32
//   numbers p_A . p_B ~ sum over all pairs of one class of sqrt(I_i I_j) d_i . d_j
//
// The templates with the largest p_A . p_B are a shortlist; similarity() decides among those.
//
// Cost: 0.1 us a template and 2 us for each of the shortlist: 0.3 ms for 2000 templates. Memory: 1 KB and
// 160 bytes a landmark for each template. A query allocates nothing once a larger one was made.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/brain/landmarks/similarity.h"

namespace penumbra::slam::brain {

struct TemplateMatch {
  int number = 0;           // of the template
  double similarity = 0.0;  // 0..1
};

class LandmarkIndex {
 public:
  explicit LandmarkIndex(const SimilaritySettings& settings = {}, int shortlist = 40);

  // Adds a template and returns its number: 0, 1, ...
  int add(const Landmarks& landmarks);
  int size() const { return static_cast<int>(templates_.size()); }
  const Landmarks& landmarks(int number) const { return templates_[static_cast<std::size_t>(number)]; }

  // The shortlist among templates 0 to end - 1, the most similar first; equal ones by number.
  void query(const Landmarks& landmarks, int end, std::vector<TemplateMatch>& matches);

 private:
  static constexpr int kPooled = kStandingClasses * kDescriptorSize;
  using Pooled = Eigen::Matrix<float, kPooled, 1>;

  Pooled pool(const Landmarks& landmarks) const;

  SimilaritySettings settings_;
  int shortlist_;
  std::vector<Landmarks> templates_;
  std::vector<float> pooled_;    // kPooled numbers a template
  std::vector<float> products_;  // of a query
  std::vector<int> order_;
};

}  // namespace penumbra::slam::brain
