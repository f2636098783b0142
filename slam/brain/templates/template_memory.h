// What the robot remembers of what it saw: a visual template for each node of the cognitive map.
//
// Two kinds: landmarks with their interest (slam/brain/landmarks) or RatSLAM's intensity profiles. Templates
// are numbered as the nodes are.
#pragma once

#include <string_view>
#include <vector>

#include "slam/brain/landmarks/landmark_index.h"
#include "slam/brain/templates/intensity_profile.h"

namespace penumbra::slam::brain {

enum class TemplateKind { landmarks, intensity };
// "landmarks" or "intensity"; throws UsageError for another name.
TemplateKind template_kind(std::string_view name);
const char* to_string(TemplateKind kind);

// What is kept of a view; one of the two is used.
struct Template {
  Landmarks landmarks;
  IntensityProfile profile{};
};

class TemplateMemory {
 public:
  TemplateMemory(TemplateKind kind, const SimilaritySettings& similarity, const ProfileSettings& profile)
      : kind_(kind), similarity_settings_(similarity), profile_settings_(profile), landmarks_(similarity) {}

  TemplateKind kind() const { return kind_; }
  int add(const Template& view);
  int size() const {
    return kind_ == TemplateKind::landmarks ? landmarks_.size() : static_cast<int>(profiles_.size());
  }
  Template at(int number) const;

  // Templates 0 to end - 1 that are most like the view, the most similar first; equal ones by number.
  // Similarity of profiles: 1 - difference, at least 0.
  void query(const Template& view, int end, std::vector<TemplateMatch>& matches);
  // Similarity of the view to one template.
  double likeness(int number, const Template& view) const;
  // The turn to the left from the template's view to this one, radians, by the shift of their profiles; `fov`
  // radians of the image's width.
  double turn_against(int number, const Template& view, double fov) const;

  std::size_t bytes() const;

 private:
  TemplateKind kind_;
  SimilaritySettings similarity_settings_;
  ProfileSettings profile_settings_;
  LandmarkIndex landmarks_;
  std::vector<IntensityProfile> profiles_;
};

}  // namespace penumbra::slam::brain
