// A run of `penumbra slam` in a browser while it goes on (`--view`): the report's page, which asks for news.
//
//   /            the page (apps/view/report/page.html with live.html and live.js)
//   /state.json  ?since=VERSION: counts, loops, and the frames that are new or have moved since that version
//   /points.json the map's points, renewed at most once a second
//   /image.jpg   the newest left image with its features and masks
//   /report.json when the run has ended: what the report's page draws, its `run` being run.json
//
// Tracking does not wait for a browser: each frame leaves its number, state, time and position under a lock
// that is held for microseconds. While somebody looks, and four times a second at most, it also leaves the
// corrected trajectory, the image (without a copy) and its features: well below a millisecond. All else, such
// as JSON, the map's points and the JPEG, is made in the server's threads (apps/view/local_server.h); for the
// points they hold the map's lock as the tracker does, shared. The results of the run are the same with and
// without.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/view/local_server.h"
#include "apps/view/slam_report.h"
#include "nn/image/image.h"
#include "slam/pipeline/recorder.h"

namespace penumbra::apps {

class LiveView {
 public:
  // Serves from now on; `frames`: how many there will be, 0 where unknown. `record` must live longer. Throws
  // Error where the port is taken (apps/view/local_server.h says what `port` means).
  LiveView(std::optional<int> port, const SlamRun& run, int frames, const slam::Recorder& record);
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  std::string address() const { return server_.address(); }
  bool is_watched() const;  // somebody has asked during the last three seconds

  // The newest frame, which the recorder has; from the thread that calls Slam::process().
  void add(const slam::FrameResult& result, const ByteImage& left);
  // The run is over and its results are in `run_folder`. Where somebody looks it gives them two seconds to
  // fetch the report, otherwise it returns at once. Throws as report_data does.
  void finish(const std::filesystem::path& run_folder);

 private:
  using Clock = std::chrono::steady_clock;
  struct Row {
    int frame = 0;
    slam::TrackingState state = slam::TrackingState::initialising;
    double milliseconds = 0.0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, metres
    long version = 0;                                    // when it last changed
  };
  struct Picture {
    ByteImage left;
    slam::FrameView view;
  };

  Routes routes();
  void note_watcher();
  Answer page();
  Answer state(const Query& query);
  Answer points();
  Answer image();
  Answer report();
  void move_rows(const slam::Trajectory& trajectory);

  const std::string page_;
  const int frames_;
  const slam::Recorder& record_;
  std::atomic<bool> wanted_{false};  // trajectory and picture
  std::atomic<Clock::rep> asked_;    // when somebody last did
  Clock::time_point given_;          // when the tracker last gave trajectory and picture

  std::mutex mutex_;  // of what follows
  long version_ = 0;
  std::vector<Row> rows_;
  int keyframes_ = 0;
  Picture picture_;
  std::string report_;  // empty: the run goes on

  std::mutex points_mutex_;  // of what follows
  Clock::time_point points_made_;
  std::string points_;

  LocalServer server_;  // the last: its threads use the others
};

}  // namespace penumbra::apps
