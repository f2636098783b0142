#include "slam/world/street_settings.h"

#include "nn/base/error.h"

namespace penumbra::slam::synthetic {

StreetSettings street_preset(const std::string& name) {
  StreetSettings settings;
  if (name == "street") return settings;
  if (name == "easy") {
    settings.parked_cars = 0.45F;
    settings.oncoming_seconds = 12.0F;
    settings.people_per_100m = 0.7F;
    settings.cyclists_per_100m = 0.3F;
    settings.car_ahead = false;
    return settings;
  }
  if (name == "crowded") {
    settings.parked_cars = 0.9F;
    settings.oncoming_seconds = 2.5F;
    settings.people_per_100m = 8.0F;
    settings.cyclists_per_100m = 3.0F;
    return settings;
  }
  if (name == "lorry" || name == "lorry-close") {
    settings.car_ahead = false;
    settings.lorry = LorryAhead{};
    if (name == "lorry-close") settings.lorry = LorryAhead{1.5F, 10.0F};
    return settings;
  }
  if (name == "alike") {
    settings.alike = true;
    settings.parked_cars = 0.0F;
    settings.traffic = 0.0F;
    settings.car_ahead = false;
    settings.lamps_per_100m = 10.0F;  // one a house
    return settings;
  }
  throw UsageError(fmt::format(
      "--preset: expected 'street', 'easy', 'crowded', 'lorry', 'lorry-close' or 'alike', found '{}'", name));
}

Light parse_light(const std::string& name) {
  if (name == "sun") return Light::sun;
  if (name == "overcast") return Light::overcast;
  if (name == "evening") return Light::evening;
  throw UsageError(fmt::format("--light: expected 'sun', 'overcast' or 'evening', found '{}'", name));
}

void StreetSettings::check() const {
  const auto within = [](const char* option, float value, float least, float most) {
    if (value >= least && value <= most) return;  // also false for NaN
    throw UsageError(fmt::format("{}: expected {} to {}, found {}", option, least, most, value));
  };
  within("--parked", parked_cars, 0.0F, 1.0F);
  within("--traffic", traffic, 0.0F, 20.0F);
  if (moving) within("--moving", *moving, 0.0F, 1.0F);
  if (lorry) {
    within("--lorry, the nearest gap", lorry->nearest, 1.0F, 100.0F);
    within("--lorry, the farthest gap", lorry->farthest, lorry->nearest, 100.0F);
  }
  within("--lamps", lamps_per_100m, 0.0F, 50.0F);
  within("--texture", texture, 0.0F, 2.0F);
  within("--exposure-change", exposure_change, 0.0F, 1.0F);
  within("--noise", noise, 0.0F, 50.0F);
  within("--motion-blur", shutter, 0.0F, 0.1F);
  within("--glare", glare, 0.0F, 1.0F);
}

}  // namespace penumbra::slam::synthetic
