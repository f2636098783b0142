#include "slam/world/office_settings.h"

#include "nn/base/error.h"
#include "slam/world/sequence.h"

namespace penumbra::slam::synthetic {

namespace {

// Nothing for a name that is none.
std::optional<OfficeSettings> find_preset(const std::string& name) {
  OfficeSettings settings;
  if (name == "desk" || name == "twolaps") {
    settings.people = People::none;
    settings.path = name;
    return settings;
  }
  const std::size_t dash = name.find('-');
  const std::string people = name.substr(0, dash),
                    path = dash == std::string::npos ? "" : name.substr(dash + 1);
  const bool known = (people == "walking" || people == "sitting") &&
                     (path == "static" || path == "xyz" || path == "rpy" || path == "halfsphere");
  if (!known) return std::nullopt;
  settings.people = parse_people(people);
  settings.path = path == "static" ? "still" : path;
  return settings;
}

}  // namespace

bool is_office_preset(const std::string& name) { return find_preset(name).has_value(); }

OfficeSettings office_preset(const std::string& name) {
  const std::optional<OfficeSettings> settings = find_preset(name);
  if (settings) return *settings;
  throw UsageError(fmt::format(
      "--preset: expected walking- or sitting- with xyz, static, rpy or halfsphere, or desk or twolaps, "
      "found '{}'",
      name));
}

People parse_people(const std::string& name) {
  if (name == "walking") return People::walking;
  if (name == "sitting") return People::sitting;
  if (name == "none") return People::none;
  throw UsageError(fmt::format("--people: expected 'walking', 'sitting' or 'none', found '{}'", name));
}

void OfficeSettings::check() const {
  const auto within = [](const char* option, float value, float least, float most) {
    if (value >= least && value <= most) return;  // also false for NaN
    throw UsageError(fmt::format("{}: expected {} to {}, found {}", option, least, most, value));
  };
  check_extent(size, frames);
  within("--exposure-change", exposure_change, 0.0F, 1.0F);
  within("--noise", noise, 0.0F, 50.0F);
  within("--motion-blur", shutter, 0.0F, 1.0F / 30.0F);
  within("--rolling-shutter", readout, 0.0F, 1.0F / 30.0F);
  within("--depth-delay", 1000.0F * depth_delay, -30.0F, 30.0F);
  within("--texture", texture, 0.0F, 2.0F);
}

}  // namespace penumbra::slam::synthetic
