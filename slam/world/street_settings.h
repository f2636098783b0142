// All that can be chosen about a street and the camera that films it; presets are values of one struct.
#pragma once

#include <optional>
#include <string>

namespace penumbra::slam::synthetic {

enum class Light { sun, overcast, evening };

// A lorry that keeps ahead of the camera, swinging between two gaps (from the camera to its rear, metres).
struct LorryAhead {
  float nearest = 6.0F, farthest = 12.0F;
};

struct StreetSettings {
  // What stands and moves. Densities are those of the drive's surroundings.
  float parked_cars = 0.6F;        // share of the parking places that are taken
  float oncoming_seconds = 6.0F;   // between two oncoming cars
  float people_per_100m = 2.0F;    // walking on the pavements
  float cyclists_per_100m = 1.0F;  // riding between lane and parked cars
  float lorries = 0.05F;           // share of lorries among parked and oncoming cars
  bool car_ahead = true;           // a car drives ahead of the camera and slowly away from it
  float traffic = 1.0F;            // multiplies oncoming cars, people and cyclists
  std::optional<float> moving;     // share of all cars that move; empty: as the numbers above make it
  std::optional<LorryAhead> lorry;
  float lamps_per_100m = 0.0F;  // equal lamp posts at equal distances along both pavements
  // The same house front again and again, and nothing else but the lamps: every place looks like others.
  bool alike = false;

  // How it looks.
  float texture = 1.0F;  // contrast of the noise on all surfaces; 0: plain colours
  Light light = Light::sun;

  // The camera.
  float exposure_change = 0.1F;  // the exposure hunts by about this share around the automatic one
  float noise = 1.3F;            // sigma, grey levels
  float shutter = 0.0F;          // seconds that the shutter is open; 0: no motion blur
  float glare = 0.0F;            // share of the light of sun and sky that strays over the image

  // Throws UsageError, naming the option, for values outside their range.
  void check() const;
};

// "easy", "street", "crowded", "lorry", "lorry-close" or "alike"; throws UsageError for another name.
StreetSettings street_preset(const std::string& name);
// "sun", "overcast" or "evening"; throws UsageError for another name.
Light parse_light(const std::string& name);

}  // namespace penumbra::slam::synthetic
