// Processor time a frame of the library alone, for python_beside_cpp.py:
//   bench_library FX FY CX CY BASELINE LEFT_FOLDER RIGHT_FOLDER
// reads all pairs first, follows the camera, and prints the frames, the seconds of the processor and those of
// the clock that track() and finish() took, and the last x, y, z.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <set>

#include "penumbra/image_file.h"
#include "penumbra/slam.h"

namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 8) {
    std::fprintf(stderr, "usage: bench_library FX FY CX CY BASELINE LEFT_FOLDER RIGHT_FOLDER\n");
    return 2;
  }
  const std::filesystem::path folders[] = {argv[6], argv[7]};
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(folders[0]))
    names.insert(file.path().filename());
  std::vector<penumbra::ImageFile> left, right;
  for (const std::string& name : names) {
    left.push_back(penumbra::read_image(folders[0] / name));
    right.push_back(penumbra::read_image(folders[1] / name));
  }
  if (left.empty()) throw std::runtime_error("no images in " + folders[0].string());
  const auto number = [&](int argument) { return std::atof(argv[argument]); };
  penumbra::Slam slam(penumbra::Rig::stereo(
      {number(1), number(2), number(3), number(4), left[0].width, left[0].height}, number(5)));
  const double processor = processor_seconds();
  const auto begin = std::chrono::steady_clock::now();
  penumbra::TrackResult found;
  for (std::size_t i = 0; i < left.size(); ++i)
    found = slam.track(
        {.timestamp = 0.1 * static_cast<double>(i), .left = left[i].view(), .right = right[i].view()});
  slam.finish();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  const auto& [x, y, z] = found.T_world_camera.translation;
  std::printf("%zu %.6f %.6f %.4f %.4f %.4f\n", left.size(), processor_seconds() - processor, seconds.count(),
              x, y, z);
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_library: %s\n", error.what());
  return 1;
}
