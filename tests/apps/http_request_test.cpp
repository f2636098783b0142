#include "apps/view/http_request.h"

#include <gtest/gtest.h>

namespace penumbra::apps {
namespace {

TEST(HttpRequest, IsTakenApart) {
  const auto request = parse_request(
      "GET /state%2Ejson?since=4&name=a+b%26c&=&x HTTP/1.1\r\nhOsT:  localhost:80 \r\nA: b\r\n");
  ASSERT_TRUE(request.has_value());
  EXPECT_EQ(request->method, "GET");
  EXPECT_EQ(request->path, "/state.json");
  EXPECT_EQ(request->host, "localhost:80");
  EXPECT_EQ(request->query, (Query{{"since", "4"}, {"name", "a b&c"}, {"", ""}, {"x", ""}}));
}

TEST(HttpRequest, HalfCodesStayAsTheyAre) {
  const auto request = parse_request("GET /100%?a=%4 HTTP/1.0\r\nHost: x\r\n");
  ASSERT_TRUE(request.has_value());
  EXPECT_EQ(request->path, "/100%");
  EXPECT_EQ(request->query, (Query{{"a", "%4"}}));
}

TEST(HttpRequest, WhatIsNoneIsRefused) {
  for (const char* head : {"", "GET\r\n", "GET / HTTP/2\r\n", "GET /\r\n", " / HTTP/1.1\r\n",
                           "GET /a b HTTP/1.1\r\n", "GET / HTTP/1.1", "GET / HTTP/1.1\r\nno colon\r\n"}) {
    EXPECT_FALSE(parse_request(head).has_value()) << head;
  }
}

TEST(HttpRequest, OnlyThisMachineIsLocal) {
  for (const char* host : {"localhost", "127.0.0.1", "localhost:8080", "127.0.0.1:1"}) {
    EXPECT_TRUE(is_local_host(host)) << host;
  }
  for (const char* host : {"", "localhost.example", "127.0.0.1.example:80", "10.0.0.1", ":80"}) {
    EXPECT_FALSE(is_local_host(host)) << host;
  }
  const auto none = parse_request("GET / HTTP/1.1\r\n"),
             two = parse_request("GET / HTTP/1.1\r\nHost: a\r\nHost: localhost\r\n");
  ASSERT_TRUE(none && two);
  EXPECT_TRUE(none->host.empty());
  EXPECT_TRUE(two->host.empty());
}

}  // namespace
}  // namespace penumbra::apps
