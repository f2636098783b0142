#include "apps/slam/pose_output.h"

#include <fmt/core.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "apps/common/log.h"
#include "nn/base/error.h"

namespace penumbra::apps {

namespace {

constexpr std::string_view kUnix = "unix:";

int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    throw UsageError(fmt::format("--poses: expected unix:PATH of at most {} bytes, found '{}'",
                                 sizeof address.sun_path - 1, path));
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0 ||
      ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const std::string reason = std::strerror(errno);
    if (descriptor >= 0) ::close(descriptor);
    throw Error(fmt::format("{}: nobody listens there: {}", path, reason));
  }
  return descriptor;
}

int standard_output() {
  const int descriptor = ::dup(STDOUT_FILENO);
  if (descriptor < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    throw Error(fmt::format("standard output: {}", std::strerror(errno)));
  return descriptor;
}

}  // namespace

PoseOutput::PoseOutput(const std::string& target, std::optional<slam::Mounting> body)
    : target_(target), body_(std::move(body)) {
  if (target.empty()) return;
  std::signal(SIGPIPE, SIG_IGN);  // a reader that is gone is an error of the write
  if (target == "-") {
    descriptor_ = standard_output();
  } else if (target.starts_with(kUnix)) {
    descriptor_ = connect_to(target.substr(kUnix.size()));
  } else {
    throw UsageError(fmt::format("--poses: expected - or unix:PATH, found '{}'", target));
  }
}

PoseOutput::~PoseOutput() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void PoseOutput::add(const slam::FrameResult& frame) {
  if (descriptor_ < 0 || frame.tracking.state != slam::TrackingState::tracking) return;
  const slam::SE3 pose = body_ ? slam::pose_of_body(*body_, frame.T_wc) : frame.T_wc;
  const Eigen::Quaterniond q(pose.rotation);
  const Eigen::Vector3d& t = pose.translation;
  const std::string line = fmt::format("{:.9f} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n",
                                       frame.timestamp, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t count = ::write(descriptor_, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      log_warning("poses to {} end here: {}", target_, std::strerror(errno));
      ::close(std::exchange(descriptor_, -1));
      return;
    }
    done += static_cast<std::size_t>(count);
  }
}

}  // namespace penumbra::apps
