#include "apps/view/local_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "apps/view/http_request.h"
#include "nn/base/error.h"

namespace penumbra::apps {

namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kHost = "127.0.0.1";
constexpr int kFirstPort = 8080, kLastPort = 8099, kWaitingConnections = 8;
constexpr std::size_t kMostRequestBytes = 16384;
constexpr int kThreads = 4;
constexpr std::chrono::milliseconds kReadTime(2000), kWriteTime(10000), kDrainTime(200), kLook(50);

constexpr std::string_view kHeaders =
    "Connection: close\r\n"
    "Cache-Control: no-store\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src 'self' data:; connect-src 'self'; frame-ancestors 'none'\r\n";

std::string response(std::string_view status, std::string_view type, std::string_view body) {
  return fmt::format("HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{}\r\n{}", status, type,
                     body.size(), kHeaders, body);
}

// A socket that is closed at its end.
class Socket {
 public:
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&&) = delete;
  ~Socket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

// A listening socket of this machine alone; none where the port is taken.
std::optional<Socket> listen_at(int port) {
  Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (socket.get() < 0) return std::nullopt;
  const int yes = 1;  // a port whose connections have just ended is free
  setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (bind(socket.get(), generic, sizeof address) != 0 || listen(socket.get(), kWaitingConnections) != 0) {
    return std::nullopt;
  }
  return socket;
}

int port_of(const Socket& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

// One request and its answer. Reads and writes no more, and for no longer, than a request of ours may take.
class Connection {
 public:
  Connection(Socket socket, const std::atomic<bool>& stopping)
      : socket_(std::move(socket)), stopping_(stopping), read_until_(Clock::now() + kReadTime) {}

  void serve(const Routes& routes) {
    const std::optional<std::string> head = read_head();
    if (!head) return;
    write(answer(*head, routes));
    drain();
  }

 private:
  static std::string answer(const std::string& head, const Routes& routes) {
    const std::optional<HttpRequest> request = parse_request(head);
    if (!request) return response("400 Bad Request", "text/plain", "");
    if (!is_local_host(request->host)) {
      return response("403 Forbidden", "text/plain", "This address is for browsers on the same machine.\n");
    }
    const auto route = routes.find(request->path);
    if (request->method != "GET" || route == routes.end()) return response("404 Not Found", "text/plain", "");
    try {
      const Answer found = route->second(request->query);
      if (found.type.empty()) return response("404 Not Found", "text/plain", found.body);
      return response("200 OK", found.type, found.body);
    } catch (const std::exception&) {
      return response("500 Internal Server Error", "text/plain", "");
    }
  }

  // Up to the empty line; none where it does not come in time or is too long.
  std::optional<std::string> read_head() {
    std::string head;
    std::array<char, 4096> piece;
    while (bytes_left_ > 0 && wait(POLLIN, read_until_)) {
      const ssize_t found = receive(piece);
      if (found <= 0) return std::nullopt;
      head.append(piece.data(), static_cast<std::size_t>(found));
      if (const std::size_t end = head.find("\r\n\r\n"); end != std::string::npos) {
        head.resize(end + 2);
        return head;
      }
    }
    return std::nullopt;
  }

  void write(std::string_view bytes) {
    const auto until = Clock::now() + kWriteTime;
    while (!bytes.empty() && wait(POLLOUT, until)) {
      const ssize_t sent = send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (sent <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }

  // Takes what the client still sends: where bytes were left unread, the answer would be lost with them.
  void drain() {
    ::shutdown(socket_.get(), SHUT_WR);
    const auto until = std::min(read_until_, Clock::now() + kDrainTime);
    std::array<char, 4096> piece;
    while (bytes_left_ > 0 && wait(POLLIN, until)) {
      if (receive(piece) <= 0) return;
    }
  }

  ssize_t receive(std::array<char, 4096>& piece) {
    const ssize_t found = recv(socket_.get(), piece.data(), std::min(piece.size(), bytes_left_), 0);
    if (found > 0) bytes_left_ -= static_cast<std::size_t>(found);
    return found;
  }

  bool wait(short events, Clock::time_point until) const {
    while (!stopping_ && Clock::now() < until) {
      pollfd descriptor{socket_.get(), events, 0};
      const int ready = poll(&descriptor, 1, static_cast<int>(kLook.count()));
      if (ready > 0) return true;
      if (ready < 0 && errno != EINTR) return false;
    }
    return false;
  }

  const Socket socket_;
  const std::atomic<bool>& stopping_;
  const Clock::time_point read_until_;
  std::size_t bytes_left_ = kMostRequestBytes;
};

}  // namespace

class LocalServer::Implementation {
 public:
  Implementation(std::optional<int> port, Routes routes) : routes_(std::move(routes)), socket_(bind(port)) {
    for (int i = 0; i < kThreads; ++i) threads_.emplace_back([this] { work(); });
  }
  ~Implementation() {
    stopping_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  int port() const { return port_of(socket_); }

 private:
  static Socket bind(std::optional<int> port) {
    for (int p = port.value_or(kFirstPort); p <= port.value_or(kLastPort); ++p) {
      if (std::optional<Socket> socket = listen_at(p)) return std::move(*socket);
    }
    throw Error(port ? fmt::format("port {} of {} cannot be had: another program may have it", *port, kHost)
                     : fmt::format("no port from {} to {} is free", kFirstPort, kLastPort));
  }

  // Each thread takes one connection after the other.
  void work() {
    while (!stopping_) {
      pollfd descriptor{socket_.get(), POLLIN, 0};
      if (poll(&descriptor, 1, static_cast<int>(kLook.count())) <= 0) continue;
      const int accepted = accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC);
      if (accepted < 0) continue;  // another thread was faster
      Connection(Socket(accepted), stopping_).serve(routes_);
    }
  }

  const Routes routes_;
  const Socket socket_;
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> threads_;
};

LocalServer::LocalServer(std::optional<int> port, Routes routes)
    : implementation_(std::make_unique<Implementation>(port, std::move(routes))) {}

LocalServer::~LocalServer() = default;

std::string LocalServer::address() const {
  return fmt::format("http://{}:{}/", kHost, implementation_->port());
}

}  // namespace penumbra::apps
