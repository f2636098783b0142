#include "apps/view/http_request.h"

#include <algorithm>
#include <charconv>

#include "nn/base/text.h"

namespace penumbra::apps {

namespace {

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// %41 is A; in queries + is a blank.
std::string decoded(std::string_view text, bool is_query) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += is_query && text[i] == '+' ? ' ' : text[i];
    }
  }
  return out;
}

Query parse_query(std::string_view text) {
  Query query;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(text.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (pair.empty()) continue;
    query.emplace(decoded(pair.substr(0, equals), true),
                  equals == std::string_view::npos ? "" : decoded(pair.substr(equals + 1), true));
  }
  return query;
}

// The next line without its CR LF; none where there is no more.
std::optional<std::string_view> next_line(std::string_view& head) {
  const std::size_t end = head.find("\r\n");
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = head.substr(0, end);
  head.remove_prefix(end + 2);
  return line;
}

}  // namespace

std::optional<HttpRequest> parse_request(std::string_view head) {
  const std::optional<std::string_view> line = next_line(head);
  if (!line) return std::nullopt;
  const std::size_t first = line->find(' '), last = line->rfind(' ');
  if (first == std::string_view::npos || first == 0 || last == first) return std::nullopt;
  if (!line->substr(last + 1).starts_with("HTTP/1.")) return std::nullopt;
  const std::string_view target = line->substr(first + 1, last - first - 1);
  if (target.find(' ') != std::string_view::npos) return std::nullopt;

  HttpRequest request;
  request.method = line->substr(0, first);
  const std::size_t question = target.find('?');
  request.path = decoded(target.substr(0, question), false);
  if (question != std::string_view::npos) request.query = parse_query(target.substr(question + 1));
  int hosts = 0;
  while (const std::optional<std::string_view> header = next_line(head)) {
    const std::size_t colon = header->find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    if (lower_case(header->substr(0, colon)) != "host") continue;
    request.host = without_blanks(header->substr(colon + 1));
    ++hosts;
  }
  if (hosts != 1) request.host.clear();
  return request;
}

bool is_local_host(std::string_view host) {
  const std::string_view name = host.substr(0, host.find(':'));
  return name == "127.0.0.1" || name == "localhost";
}

}  // namespace penumbra::apps
