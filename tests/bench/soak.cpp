// A live run of any length: a camera that never stops drives round a block, and what Penumbra makes of it.
//
//   soak PENUMBRA FOLDER [MINUTES [HZ]]
//
// FOLDER: a stereo drive that ends where it began, as `penumbra synth --path block` writes it. Its pairs go
// to `penumbra slam -` in real time, round and round; poses come back as they are found. Every ten seconds a
// line: the memory that the program holds, how long frames took from the camera to their pose, how many were
// located. At the end how both changed over the last two thirds, and exit code 1 where the delay grew by more
// than a frame, or memory by more than 20 MB.
// Not part of the tests: `./run soak` runs it.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "nn/base/quantile.h"
#include "nn/image/image_file.h"
#include "slam/sources/open_dataset.h"
#include "tests/bench/piped_program.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A drive's pairs as frames of a YUV4MPEG2 stream.
struct Drive {
  explicit Drive(const std::string& folder) {
    slam::DatasetOptions options;
    options.cameras = slam::DatasetCameras::grey;
    const auto dataset = slam::open_dataset(folder, options);
    camera = dataset->camera();
    for (int i = 0; i < dataset->size(); ++i) {
      const slam::StereoImages pair = dataset->load(i);
      std::string frame = "FRAME\n";
      for (int y = 0; y < camera.height; ++y) {
        for (const ByteImage* image : {&pair.left, &pair.right})
          frame.append(reinterpret_cast<const char*>(image->row(y)), static_cast<std::size_t>(camera.width));
      }
      frames.push_back(std::move(frame));
    }
  }
  slam::StereoCamera camera;
  std::vector<std::string> frames;
};

// `penumbra slam -` with a pipe on either side.
class Program {
 public:
  explicit Program(const std::vector<std::string>& command) : program_(start_piped(command)) {}
  // False where nobody reads any more.
  bool write(const std::string& bytes) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t count = ::write(program_.input, bytes.data() + done, bytes.size() - done);
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }
  void end_input() const { ::close(program_.input); }
  int output() const { return program_.output; }
  int wait() const {
    int status = 0;
    ::waitpid(program_.process, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  }
  // Megabytes that it holds; 0 where it is gone.
  double memory() const {
    std::ifstream pages(fmt::format("/proc/{}/statm", program_.process));
    double all = 0.0, resident = 0.0;
    pages >> all >> resident;
    return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
  }

 private:
  PipedProgram program_;
};

struct Sample {
  double at = 0.0, memory = 0.0, delay = 0.0;  // seconds, megabytes, seconds (median)
  double gap = 0.0;                            // seconds, the longest between two poses
};

// The slope of the least squares line, a second.
template <class Value>
double slope(const std::vector<Sample>& samples, Value value) {
  double n = 0.0, t = 0.0, v = 0.0, tt = 0.0, tv = 0.0;
  for (const Sample& sample : samples) {
    n += 1.0;
    t += sample.at;
    v += value(sample);
    tt += sample.at * sample.at;
    tv += sample.at * value(sample);
  }
  const double spread = n * tt - t * t;
  return spread > 0.0 ? (n * tv - t * v) / spread : 0.0;
}

int soak(const std::string& penumbra, const std::string& folder, double minutes, double rate) {
  std::signal(SIGPIPE, SIG_IGN);
  const Drive drive(folder);
  const std::filesystem::path out =
      std::filesystem::temp_directory_path() / fmt::format("soak_{}", ::getpid());
  std::filesystem::create_directories(out);
  const std::string rig = (out / "rig.yaml").string();
  std::ofstream(rig) << fmt::format("fx: {}\nfy: {}\ncx: {}\ncy: {}\nbaseline: {}\nwidth: {}\nheight: {}\n",
                                    drive.camera.fx, drive.camera.fy, drive.camera.cx, drive.camera.cy,
                                    drive.camera.baseline, drive.camera.width, drive.camera.height);
  const Program program(
      {penumbra, "slam", "-", "--camera", rig, "--poses", "-", "--out", (out / "run").string()});
  std::mutex mutex;
  std::vector<double> delays;  // since the last line
  double gap = 0.0;            // the longest between two poses, likewise
  std::atomic<int> located{0};
  program.write(fmt::format("YUV4MPEG2 W{} H{} F{}:1000 Ip Cmono\n", 2 * drive.camera.width,
                            drive.camera.height, static_cast<int>(1000.0 * rate)));
  const Clock::time_point start = Clock::now();
  std::thread reader([&] {
    FILE* const lines = ::fdopen(program.output(), "r");
    std::array<char, 512> line{};
    double before = 0.0;
    while (std::fgets(line.data(), static_cast<int>(line.size()), lines) != nullptr) {
      const double timestamp = std::atof(line.data());
      const std::lock_guard lock(mutex);
      gap = std::max(gap, timestamp - std::exchange(before, timestamp));
      delays.push_back(seconds_since(start) - timestamp);
      ++located;
    }
    std::fclose(lines);
  });
  std::atomic<bool> done{false};
  std::atomic<int> sent{0};
  std::vector<Sample> samples;
  std::thread watcher([&] {
    for (double next = 10.0; !done; next += 10.0) {
      while (!done && seconds_since(start) < next)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      if (done) break;
      Sample sample{seconds_since(start), program.memory(), 0.0, 0.0};
      double worst = 0.0;
      {
        const std::lock_guard lock(mutex);
        worst = quantile_of(delays, 1.0);
        sample.delay = quantile_of(std::exchange(delays, {}), 0.5);
        sample.gap = std::exchange(gap, 0.0);
      }
      fmt::print(
          "{:6.0f} s  {:7.1f} MB  delay {:5.1f} ms (most {:6.1f})  longest gap {:.0f} ms  {} frames, {} "
          "located\n",
          sample.at, sample.memory, 1e3 * sample.delay, 1e3 * worst, 1e3 * sample.gap, sent.load(),
          located.load());
      std::fflush(stdout);
      if (sample.at > 60.0 * minutes / 3.0) samples.push_back(sample);  // the map is made in the first laps
    }
  });
  const int count = static_cast<int>(60.0 * minutes * rate);
  for (int i = 0; i < count; ++i) {
    std::this_thread::sleep_until(
        start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(i / rate)));
    if (!program.write(drive.frames[static_cast<std::size_t>(i) % drive.frames.size()])) break;
    ++sent;
  }
  done = true;
  watcher.join();
  program.end_input();
  reader.join();
  const int code = program.wait();
  const double growth = 3600.0 * slope(samples, [](const Sample& s) { return s.memory; });
  const double drift = 3600.0 * slope(samples, [](const Sample& s) { return s.delay; });
  const double widening = 3600.0 * slope(samples, [](const Sample& s) { return s.gap; });
  const double hours = samples.empty() ? 0.0 : (samples.back().at - samples.front().at) / 3600.0;
  const double a_frame = growth / (3600.0 * rate);
  fmt::print(
      "{} of {} frames located; memory {:+.1f} MB an hour, {:.2f} kB a frame; delay {:+.1f} ms an hour, "
      "longest gap of ten seconds {:+.1f} ms; exit code {}\n",
      located.load(), sent.load(), growth, 1e3 * a_frame, 1e3 * drift, 1e3 * widening, code);
  std::filesystem::remove_all(out);
  constexpr double kMostMemory = 20.0;  // megabytes: caches fill, nothing else
  return code == 0 && growth * hours < kMostMemory && drift * hours < 1.0 / rate &&
                 widening * hours < 2.0 / rate
             ? 0
             : 1;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: soak PENUMBRA FOLDER [MINUTES [HZ]]\n");
    return 2;
  }
  return penumbra::soak(argv[1], argv[2], argc > 3 ? std::atof(argv[3]) : 60.0,
                        argc > 4 ? std::atof(argv[4]) : 30.0);
}
