// Pages in a browser without a window.
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <string>

namespace penumbra::test {

constexpr const char* kNoBrowser = "no Chromium: apt-get install chromium-headless-shell";

// What `command` prints; empty where it fails.
inline std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  return pclose(pipe) == 0 ? text : "";
}

// A Chromium; empty where there is none.
inline std::string find_browser() {
  for (const char* name : {"chromium-headless-shell", "chromium", "google-chrome"}) {
    const std::string path = output_of(fmt::format("command -v {}", name));
    if (!path.empty()) return path.substr(0, path.find('\n'));
  }
  return {};
}

// The page as it is after `milliseconds` of the page's own time; empty where the browser did not show it.
inline std::string dump_dom(const std::string& browser, const std::string& url, int milliseconds = 10000) {
  return output_of(fmt::format(
      "timeout 100 '{}' --headless --no-sandbox --enable-unsafe-swiftshader --virtual-time-budget={} "
      "--dump-dom '{}' 2>/dev/null",
      browser, milliseconds, url));
}

// Whether the element says that it shows something (apps/view/report/page.js).
inline bool is_drawn(const std::string& dom, const std::string& id) {
  const std::size_t at = dom.find("id=\"" + id + "\"");
  if (at == dom.npos) return false;
  return dom.substr(at, dom.find('>', at) - at).find("data-drawn=\"") != std::string::npos;
}

}  // namespace penumbra::test
