#include "apps/view/live_view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/common/rounded.h"
#include "apps/view/frame_picture.h"
#include "apps/view/frames_report.h"
#include "apps/view/report_page.h"
#include "nn/image/jpeg_codec.h"

namespace penumbra::apps {

namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds kBetweenPictures(250), kBetweenPoints(1000), kLookingOn(3000),
    kTimeForReport(2000);
constexpr double kMoved = 0.01;  // metres, of a frame, that are worth telling

Answer json_answer(const json& value) {
  return {"application/json", value.dump(-1, ' ', false, json::error_handler_t::replace)};
}

long since_of(const Query& query) {
  const auto text = query.find("since");
  long since = 0;
  if (text != query.end())
    std::from_chars(text->second.data(), text->second.data() + text->second.size(), since);
  return since;
}

}  // namespace

LiveView::LiveView(std::optional<int> port, const SlamRun& run, int frames, const slam::Recorder& record)
    : page_(make_live_page(run.dataset)),
      frames_(frames),
      record_(record),
      asked_((Clock::now() - 2 * kLookingOn).time_since_epoch().count()),
      server_(port, routes()) {}

Routes LiveView::routes() {
  return {{"/",
           [this](const Query&) {
             return Answer{"text/html; charset=utf-8", page_};
           }},
          {"/state.json", [this](const Query& query) { return state(query); }},
          {"/points.json", [this](const Query&) { return points(); }},
          {"/image.jpg", [this](const Query&) { return image(); }},
          {"/report.json", [this](const Query&) { return report(); }}};
}

bool LiveView::is_watched() const {
  return Clock::now() - Clock::time_point(Clock::duration(asked_)) < kLookingOn;
}

void LiveView::add(const slam::FrameResult& result, const ByteImage& left) {
  slam::Trajectory trajectory;
  Picture picture;
  if (Clock::now() - given_ >= kBetweenPictures && wanted_.exchange(false)) {
    given_ = Clock::now();
    trajectory = record_.trajectory();
    picture = {left, record_.slam().newest_view()};
  }
  const std::lock_guard lock(mutex_);
  ++version_;
  rows_.push_back(
      {result.index, result.tracking.state, result.milliseconds, result.T_wc.translation, version_});
  keyframes_ += result.keyframe;
  move_rows(trajectory);
  if (!picture.left.empty()) std::swap(picture_, picture);
}

void LiveView::move_rows(const slam::Trajectory& trajectory) {
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Eigen::Vector3d& position = trajectory[i].T_wc.translation;
    if ((position - rows_[i].position).norm() < kMoved) continue;
    rows_[i].position = position;
    rows_[i].version = version_;
  }
}

void LiveView::finish(const std::filesystem::path& run_folder) {
  if (!is_watched()) return;
  Answer answer = json_answer(report_data(run_folder, kMostPagePoints));
  {
    const std::lock_guard lock(mutex_);
    report_ = std::move(answer.body);
  }
  std::this_thread::sleep_for(kTimeForReport);
}

void LiveView::note_watcher() { asked_ = Clock::now().time_since_epoch().count(); }

Answer LiveView::page() {
  note_watcher();
  return {"text/html; charset=utf-8", page_};
}

Answer LiveView::state(const Query& query) {
  note_watcher();
  wanted_ = true;
  const long since = since_of(query);
  json json;
  std::vector<Row> changed;
  {
    const std::lock_guard lock(mutex_);
    const auto from =
        std::find_if(rows_.begin(), rows_.end(), [since](const Row& row) { return row.version > since; });
    changed.assign(from, rows_.end());
    json["from"] = from - rows_.begin();
    json["version"] = version_;
    json["keyframes"] = keyframes_;
    json["finished"] = !report_.empty();
    json["picture"] = !picture_.left.empty();
  }
  json["total"] = frames_;
  json["loops"] = revisits_json(record_.slam().loops(), record_.slam().settings().loops);
  nlohmann::json& rows = json["rows"];
  for (const char* key : {"index", "state", "ms", "position"}) rows[key] = nlohmann::json::array();
  for (const Row& row : changed) {
    rows["index"].push_back(row.frame);
    rows["state"].push_back(name_of(row.state));
    rows["ms"].push_back(to_a_thousandth(row.milliseconds));
    rows["position"].push_back({to_a_thousandth(row.position.x()), to_a_thousandth(row.position.y()),
                                to_a_thousandth(row.position.z())});
  }
  return json_answer(json);
}

Answer LiveView::points() {
  const std::lock_guard lock(points_mutex_);
  if (points_.empty() || Clock::now() - points_made_ >= kBetweenPoints) {
    points_ = points_json(slam::point_cloud_of(record_.slam().map()).vertices, kMostPagePoints).dump();
    points_made_ = Clock::now();
  }
  return {"application/json", points_};
}

Answer LiveView::image() {
  Picture picture;
  {
    const std::lock_guard lock(mutex_);
    picture = picture_;
  }
  if (picture.left.empty()) return {};
  return {"image/jpeg", nn::encode_jpeg(draw_frame(picture.left, picture.view))};
}

Answer LiveView::report() {
  const std::lock_guard lock(mutex_);
  if (report_.empty()) return {};
  return {"application/json", report_};
}

}  // namespace penumbra::apps
