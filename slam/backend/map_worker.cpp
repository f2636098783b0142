#include "slam/backend/map_worker.h"

#include <algorithm>
#include <shared_mutex>
#include <utility>

namespace penumbra::slam {

MapWorker::MapWorker(Map& map, LocalMapper& mapper, LoopCloser& loop_closer,
                     const FullBundleSettings& full_bundle, bool threaded)
    : map_(map),
      mapper_(mapper),
      loop_closer_(loop_closer),
      full_bundle_(full_bundle),
      threaded_(threaded),
      due_keyframes_(std::max(kFirstDue, 2 * map.keyframes().size())) {
  if (threaded_) thread_ = std::thread([this] { run(); });
}

MapWorker::~MapWorker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    queue_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  stop_adjustment();
}

std::ptrdiff_t MapWorker::waiting_keyframes() const {
  return std::count_if(queue_.begin(), queue_.end(),
                       [](const Task& task) { return task.keyframe != nullptr; });
}

void MapWorker::submit(MapWork work) {
  Task task{nullptr, std::move(work.edits)};
  const bool has_keyframe = work.keyframe != nullptr;
  if (threaded_) {
    std::unique_lock lock(mutex_);
    const auto has_room = [&] { return failure_ || waiting_keyframes() < kLongestQueue; };
    if (has_keyframe) changed_.wait_for(lock, kLongestPause, has_room);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  if (has_keyframe) task.keyframe = insert(std::move(work));
  if (!threaded_) {
    process(task);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(task));
    hurry_ = waiting_keyframes() >= kHurry;
  }
  changed_.notify_all();
}

void MapWorker::finish() {
  std::unique_lock lock(mutex_);
  const auto done = [&] { return failure_ || (queue_.empty() && !working_ && !adjusting_); };
  while (!changed_.wait_for(lock, kLongestWait, done)) stop_adjustment_ = true;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void MapWorker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ending_ || adjusted_ || !queue_.empty(); });
    if (ending_) return;
    working_ = true;
    const bool apply = std::exchange(adjusted_, false);
    Task task;
    if (!apply) {
      task = std::move(queue_.front());
      queue_.pop_front();
      hurry_ = waiting_keyframes() >= kHurry;
    }
    lock.unlock();
    std::exception_ptr failure;
    try {
      if (apply) {
        apply_adjustment();
      } else {
        process(task);
      }
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) failure_ = failure;
    working_ = false;
    adjusting_ = adjustment_ != nullptr;
    changed_.notify_all();
  }
}

StageTimer MapWorker::take_times() {
  StageTimer times;
  for (StageTimer* timer : {&timer_, &insertion_timer_, &adjustment_timer_}) times.merge(timer->take());
  return times;
}

KeyFrame* MapWorker::insert(MapWork work) {
  const auto scope = insertion_timer_.measure("keyframe_insertion");
  const std::unique_lock lock(map_.mutex());
  KeyFrame* keyframe = work.keyframe.get();
  if (work.reference != nullptr) {
    // Since it was located the sub-map may have become part of another.
    const KeyFrame* stand_in = work.reference;
    while (stand_in->erased) stand_in = stand_in->stand_in;
    keyframe->submap = stand_in->submap;
    const SE3 now = current_pose(*work.reference);
    if (now.rotation != work.reference_T_cw.rotation || now.translation != work.reference_T_cw.translation) {
      keyframe->T_cw = keyframe->T_cw * work.reference_T_cw.inverse() * now;
    }
  }
  for (MapPoint*& point : work.tracked) point = present(point);
  map_.insert_keyframe(std::move(work.keyframe));
  mapper_.insert(keyframe, work.tracked, work.aligned);
  return keyframe;
}

void MapWorker::process(const Task& task) {
  take_out(task.edits.moving);
  note(task.edits.objects);
  if (task.keyframe == nullptr) return;
  KeyFrame* keyframe = task.keyframe;
  {
    const auto scope = timer_.measure("mapping");
    mapper_.process(keyframe, threaded_ ? &hurry_ : nullptr, timer_);
  }
  std::optional<ClosedLoop> closed;
  {
    const auto scope = timer_.measure("loops");
    closed = loop_closer_.process(keyframe);
  }
  if (closed || whole_map_is_due()) adjust_whole_map(keyframe->submap);
  collect_erased();
}

// The points go altogether: a thing that moves has no place in the map.
void MapWorker::take_out(const std::vector<MovingFeatures>& moving) {
  if (moving.empty()) return;
  const std::unique_lock lock(map_.mutex());
  for (const auto& [keyframe, features] : moving) {
    if (keyframe->erased) continue;
    for (const int feature : features) {
      keyframe->movable[static_cast<std::size_t>(feature)] = 1;
      MapPoint* point = keyframe->points[static_cast<std::size_t>(feature)];
      if (point != nullptr) map_.erase_point(point);
    }
  }
}

void MapWorker::note(const std::vector<KeyframeObjects>& objects) {
  if (objects.empty()) return;
  const std::unique_lock lock(map_.mutex());
  for (const KeyframeObjects& seen : objects) {
    if (!seen.keyframe->erased) seen.keyframe->objects = seen.objects;
  }
}

void MapWorker::collect_erased() {
  if (adjustment_) return;  // refers to points that may have been erased since
  const std::unique_lock lock(map_.mutex());
  map_.collect_erased();
}

bool MapWorker::whole_map_is_due() const {
  if (adjustment_) return false;
  const std::shared_lock lock(map_.mutex());
  return map_.keyframes().size() >= due_keyframes_;
}

void MapWorker::adjust_whole_map(int submap) {
  stop_adjustment();
  {
    const std::shared_lock lock(map_.mutex());
    due_keyframes_ = 2 * map_.keyframes().size();
    adjustment_ = std::make_unique<FullBundleAdjustment>(map_, submap, full_bundle_);
  }
  if (!threaded_) {
    const auto scope = adjustment_timer_.measure("full_bundle");
    adjustment_->solve();
    apply_adjustment();
    return;
  }
  adjuster_ = std::thread([this] {
    std::exception_ptr failure;
    try {
      const auto scope = adjustment_timer_.measure("full_bundle");
      adjustment_->solve(&stop_adjustment_);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    if (failure) failure_ = failure;
    adjusted_ = true;
    changed_.notify_all();
  });
}

void MapWorker::apply_adjustment() {
  if (adjuster_.joinable()) adjuster_.join();
  const std::unique_lock lock(map_.mutex());
  adjustment_->apply(map_);
  adjustment_.reset();
  stop_adjustment_ = false;
}

void MapWorker::stop_adjustment() {
  if (!adjustment_) return;
  stop_adjustment_ = true;
  if (adjuster_.joinable()) adjuster_.join();
  stop_adjustment_ = false;
  {
    const std::lock_guard lock(mutex_);
    adjusted_ = false;
  }
  adjustment_.reset();
}

}  // namespace penumbra::slam
