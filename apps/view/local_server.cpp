#include "apps/view/local_server.h"

#include <fmt/core.h>
#include <httplib.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <semaphore>
#include <thread>

#include "nn/base/error.h"

namespace penumbra::apps {

namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kHost = "127.0.0.1";
constexpr int kFirstPort = 8080, kLastPort = 8099;
constexpr std::size_t kMostRequestBytes = 16384, kThreads = 4;
constexpr int kMostConnections = 8;
constexpr std::chrono::milliseconds kReadTime(2000), kWriteTime(10000), kDrainTime(200), kLook(50);

// A connection that reads and writes no more, and for no longer, than a request of ours may take.
class BoundedStream : public httplib::Stream {
 public:
  BoundedStream(socket_t socket, const std::atomic<bool>& stopping)
      : socket_(socket), stopping_(stopping), read_until_(Clock::now() + kReadTime) {}

  bool is_readable() const override { return wait(POLLIN, read_until_); }
  bool is_writable() const override { return wait(POLLOUT, write_until()); }
  socket_t socket() const override { return socket_; }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip = kHost, port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip = kHost, port = 0; }

  ssize_t read(char* bytes, std::size_t size) override {
    if (at_ == filled_) {
      if (bytes_left_ == 0 || !wait(POLLIN, read_until_)) return -1;
      const ssize_t found = recv(socket_, buffer_.data(), std::min(buffer_.size(), bytes_left_), 0);
      if (found <= 0) return found;
      at_ = 0;
      filled_ = static_cast<std::size_t>(found);
      bytes_left_ -= filled_;
    }
    const std::size_t taken = std::min(size, filled_ - at_);
    std::copy_n(buffer_.data() + at_, taken, bytes);
    at_ += taken;
    return static_cast<ssize_t>(taken);
  }

  ssize_t write(const char* bytes, std::size_t size) override {
    for (std::size_t done = 0; done < size;) {
      if (!wait(POLLOUT, write_until())) return -1;
      const ssize_t sent = send(socket_, bytes + done, size - done, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (sent <= 0) return -1;
      done += static_cast<std::size_t>(sent);
    }
    return static_cast<ssize_t>(size);
  }

  // Takes what the client still sends: where bytes were left unread, the answer would be lost with them.
  void drain() {
    ::shutdown(socket_, SHUT_WR);
    const auto until = std::min(read_until_, Clock::now() + kDrainTime);
    while (bytes_left_ > 0 && wait(POLLIN, until)) {
      const ssize_t found = recv(socket_, buffer_.data(), std::min(buffer_.size(), bytes_left_), 0);
      if (found <= 0) return;
      bytes_left_ -= static_cast<std::size_t>(found);
    }
  }

 private:
  Clock::time_point write_until() const { return read_until_ + kWriteTime; }

  bool wait(short events, Clock::time_point until) const {
    while (!stopping_ && Clock::now() < until) {
      pollfd descriptor{socket_, events, 0};
      const int ready = poll(&descriptor, 1, static_cast<int>(kLook.count()));
      if (ready > 0) return true;
      if (ready < 0 && errno != EINTR) return false;
    }
    return false;
  }

  const socket_t socket_;
  const std::atomic<bool>& stopping_;
  const Clock::time_point read_until_;
  std::array<char, 4096> buffer_{};
  std::size_t at_ = 0, filled_ = 0, bytes_left_ = kMostRequestBytes;
};

// Connections beyond the first few are not accepted before others are done: no client can use up the files
// that the program may have open.
class FewConnections : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> job) override {
    places_.acquire();
    pool_.enqueue([this, job = std::move(job)] {
      job();
      places_.release();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::counting_semaphore<kMostConnections> places_{kMostConnections};
  httplib::ThreadPool pool_{kThreads};
};

bool is_local(const httplib::Request& request) {
  if (request.get_header_value_count("Host") != 1) return false;
  const std::string host = request.get_header_value("Host");
  const std::string name = host.substr(0, host.find(':'));
  return name == kHost || name == "localhost";
}

class Server : public httplib::Server {
 public:
  explicit Server(Routes routes) : routes_(std::move(routes)) {
    new_task_queue = [] { return new FewConnections; };
    // httplib's default, SO_REUSEPORT, would let a second program share the port.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_default_headers({{"Cache-Control", "no-store"},
                         {"X-Content-Type-Options", "nosniff"},
                         {"Cross-Origin-Resource-Policy", "same-origin"},
                         {"Content-Security-Policy",
                          "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                          "img-src 'self' data:; connect-src 'self'; frame-ancestors 'none'"}});
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
      return HandlerResponse::Handled;  // nothing of httplib's own routing
    });
    set_exception_handler([](const httplib::Request&, httplib::Response& response,
                             const std::exception_ptr&) { response.status = 500; });
  }
  void cut() { stopping_ = true; }

 private:
  void answer(const httplib::Request& request, httplib::Response& response) const {
    if (!is_local(request)) {
      response.status = 403;
      response.set_content("This address is for browsers on the same machine.\n", "text/plain");
      return;
    }
    const auto route = routes_.find(request.path);
    Answer answer;
    if (request.method == "GET" && route != routes_.end()) answer = route->second(request.params);
    response.status = answer.type.empty() ? 404 : 200;
    response.set_content(answer.body, answer.type.empty() ? "text/plain" : answer.type);
  }

  bool process_and_close_socket(socket_t socket) override {
    BoundedStream stream(socket, stopping_);
    bool closed = false;
    // Compressing would take the processor from the tracker, and there is no use for parts of an answer.
    const bool done = process_request(stream, /*close_connection=*/true, closed, [](httplib::Request& r) {
      r.headers.erase("Accept-Encoding");
      r.ranges.clear();
    });
    stream.drain();
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return done;
  }

  const Routes routes_;
  std::atomic<bool> stopping_{false};
};

}  // namespace

class LocalServer::Implementation {
 public:
  Implementation(std::optional<int> port, Routes routes) : server_(std::move(routes)), port_(bind(port)) {
    if (port_ <= 0) {
      throw Error(port ? fmt::format("port {} of {} cannot be had: another program may have it", *port, kHost)
                       : fmt::format("no port from {} to {} is free", kFirstPort, kLastPort));
    }
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();  // stop() does nothing before
  }
  ~Implementation() {
    server_.cut();
    server_.stop();
    thread_.join();
  }
  int port() const { return port_; }

 private:
  int bind(std::optional<int> port) {
    if (port && *port == 0) return server_.bind_to_any_port(kHost);
    for (int p = port.value_or(kFirstPort); p <= port.value_or(kLastPort); ++p) {
      if (server_.bind_to_port(kHost, p)) return p;
    }
    return 0;
  }

  Server server_;
  const int port_;
  std::thread thread_;
};

LocalServer::LocalServer(std::optional<int> port, Routes routes)
    : implementation_(std::make_unique<Implementation>(port, std::move(routes))) {}

LocalServer::~LocalServer() = default;

std::string LocalServer::address() const {
  return fmt::format("http://{}:{}/", kHost, implementation_->port());
}

}  // namespace penumbra::apps
