// Another engine in a Python of its own (peers.py), which runs a network when it is asked to.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace penumbra {

class Peer {
 public:
  // `command` and its arguments. Waits for its first line, which facts() has; where the engine is not
  // installed or does not start, that says what is "missing".
  explicit Peer(const std::vector<std::string>& command);
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  ~Peer();

  const nlohmann::ordered_json& facts() const { return facts_; }
  bool runs(const std::string& what) const;  // "backbone" or "full"
  // Of the processor, for one run. Throws Error where the process has ended, if this one ignores SIGPIPE.
  double seconds(const std::string& what);

 private:
  std::string read_line();

  pid_t process_ = -1;
  std::FILE* questions_ = nullptr;
  std::FILE* answers_ = nullptr;
  nlohmann::ordered_json facts_;
};

}  // namespace penumbra
