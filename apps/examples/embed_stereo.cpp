// Follows a stereo camera through two folders of images: embed_stereo calibration.yaml LEFT RIGHT
#include <penumbra/image_file.h>
#include <penumbra/slam.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <set>

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: embed_stereo calibration.yaml LEFT_FOLDER RIGHT_FOLDER\n");
    return 2;
  }
  const std::filesystem::path left(argv[2]), right(argv[3]);
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(left)) names.insert(file.path().filename());

  penumbra::Slam slam(penumbra::Rig::read(argv[1]));
  slam.on_map_changed([](const penumbra::Pose&) { std::puts("# the map has moved"); });
  double time = 0.0;
  for (const std::string& name : names) {
    const penumbra::ImageFile l = penumbra::read_image(left / name), r = penumbra::read_image(right / name);
    const penumbra::TrackResult found = slam.track({.timestamp = time, .left = l.view(), .right = r.view()});
    const auto& [x, y, z] = found.T_world_camera.translation;
    if (found.state == penumbra::State::tracking)
      std::printf("%s %.3f %.3f %.3f\n", name.c_str(), x, y, z);
    else
      std::printf("# %s: %s\n", name.c_str(), found.why_lost.c_str());
    time += 0.1;
  }
  slam.finish();
  std::printf("# %zu points\n", slam.snapshot().points.size());
} catch (const std::exception& error) {
  std::fprintf(stderr, "embed_stereo: %s\n", error.what());
  return 1;
}
