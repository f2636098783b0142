// Serves pages to browsers on this machine, and to nobody else: HTTP on 127.0.0.1.
//
// Only GET of the paths that it was given is answered, everything else is 404; there is no way to the file
// system. A request whose Host is not 127.0.0.1 or localhost is refused (403): a page from elsewhere whose
// name was made to lead here (DNS rebinding) has its own name in it. A request may have 16 KiB and 2 seconds,
// an answer 10 seconds to be taken; one request a connection.
//
// Threads: four, each of which takes one connection after the other, so the routes must be safe to be called
// from several threads. Who connects beyond that waits in the kernel's queue. Idle it costs a look each 50
// ms.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "apps/view/http_request.h"

namespace penumbra::apps {

struct Answer {
  std::string type;  // such as "text/html"; empty: there is nothing there (404)
  std::string body;
};
using Routes = std::map<std::string, std::function<Answer(const Query&)>>;

class LocalServer {
 public:
  // Serves from now on. `port` 0: any that is free; none: the first free one from 8080 to 8099. Throws Error
  // where the port is taken.
  LocalServer(std::optional<int> port, Routes routes);
  // Cuts what is still being sent.
  ~LocalServer();
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;

  std::string address() const;  // such as "http://127.0.0.1:8080/"

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace penumbra::apps
