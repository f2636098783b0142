#include "slam/brain/templates/template_memory.h"

#include <algorithm>

#include "nn/base/error.h"

namespace penumbra::slam::brain {

TemplateKind template_kind(std::string_view name) {
  if (name == "landmarks") return TemplateKind::landmarks;
  if (name == "intensity") return TemplateKind::intensity;
  throw UsageError(fmt::format("templates: expected landmarks or intensity, found '{}'", name));
}

const char* to_string(TemplateKind kind) {
  return kind == TemplateKind::landmarks ? "landmarks" : "intensity";
}

int TemplateMemory::add(const Template& view) {
  if (kind_ == TemplateKind::landmarks) return landmarks_.add(view.landmarks);
  profiles_.push_back(view.profile);
  return size() - 1;
}

Template TemplateMemory::at(int number) const {
  Template view;
  if (kind_ == TemplateKind::landmarks) {
    view.landmarks = landmarks_.landmarks(number);
  } else {
    view.profile = profiles_[static_cast<std::size_t>(number)];
  }
  return view;
}

void TemplateMemory::query(const Template& view, int end, std::vector<TemplateMatch>& matches) {
  if (kind_ == TemplateKind::landmarks) {
    landmarks_.query(view.landmarks, end, matches);
    return;
  }
  constexpr std::size_t kMost = 40;
  matches.clear();
  for (int i = 0; i < end; ++i) matches.push_back({i, likeness(i, view)});
  const auto better = [](const TemplateMatch& a, const TemplateMatch& b) {
    return a.similarity != b.similarity ? a.similarity > b.similarity : a.number < b.number;
  };
  const std::size_t kept = std::min(kMost, matches.size());
  std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(kept), matches.end(),
                    better);
  matches.resize(kept);
}

double TemplateMemory::likeness(int number, const Template& view) const {
  if (kind_ == TemplateKind::landmarks)
    return similarity(landmarks_.landmarks(number), view.landmarks, similarity_settings_);
  const ProfileDifference difference = compare_profiles(profiles_[static_cast<std::size_t>(number)],
                                                        view.profile, profile_settings_.largest_shift);
  return std::max(0.0, 1.0 - static_cast<double>(difference.difference));
}

double TemplateMemory::turn_against(int number, const Template& view, double fov) const {
  if (kind_ == TemplateKind::landmarks) return 0.0;
  const ProfileDifference difference = compare_profiles(profiles_[static_cast<std::size_t>(number)],
                                                        view.profile, profile_settings_.largest_shift);
  // What the template shows in column x is in column x + shift now: moved to the right, the camera turned
  // left.
  return difference.shift * fov / kProfileWidth;
}

std::size_t TemplateMemory::bytes() const {
  if (kind_ == TemplateKind::intensity) return profiles_.size() * sizeof(IntensityProfile);
  std::size_t bytes = 0;
  for (int i = 0; i < landmarks_.size(); ++i)
    bytes += landmarks_.landmarks(i).size() * sizeof(Landmark) + sizeof(Landmarks) +
             4 * kStandingClasses * kDescriptorSize;
  return bytes;
}

}  // namespace penumbra::slam::brain
