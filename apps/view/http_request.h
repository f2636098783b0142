// The head of an HTTP/1.x request, as far as the live page needs it.
//
//   METHOD PATH[?KEY=VALUE&...] HTTP/1.x
//   Host: NAME[:PORT]
//   ...
//
// Source: RFC 9112 (HTTP/1.1), sections 3 and 5; RFC 3986, section 2.1 (%-encoding).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace penumbra::apps {

using Query = std::multimap<std::string, std::string>;  // what follows the `?`

struct HttpRequest {
  std::string method, path;
  std::string host;  // empty unless the request names exactly one
  Query query;
};

// `head` is the request's lines, each ended by CR LF. None where they are no such request, or have not
// exactly one Host.
std::optional<HttpRequest> parse_request(std::string_view head);

// Whether `host`, with or without a port, is this machine under one of its usual names.
bool is_local_host(std::string_view host);

}  // namespace penumbra::apps
