// SPDX-License-Identifier: MIT
#include "reports/show/viewer/web_server.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "glint/core/error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/web_client.h"

using namespace glint;
using namespace glint::test;
using Catch::Matchers::Contains;

namespace {

const std::string kToken = "0123456789abcdef";

// Answers a GET with what it was asked, a message with itself.
struct EchoServer {
  std::atomic<int> opened{0}, closed{0};
  std::unique_ptr<WebServer> server;

  explicit EchoServer(std::string host = "127.0.0.1") {
    WebHandlers handlers;
    handlers.get = [](const std::string& path, const Query& query) {
      if (path == "/throw") throw std::runtime_error("on purpose");
      std::string text = path;
      for (const auto& [name, value] : query) text += " " + name + "=" + value;
      return HttpAnswer{200, "text/plain", text};
    };
    handlers.opened = [this](ClientId) { ++opened; };
    handlers.closed = [this](ClientId) { ++closed; };
    handlers.text = [this](ClientId client, const std::string& text) {
      if (text == "throw") throw std::runtime_error("on purpose");
      server->send_text(client, text);
    };
    server = open_web_server(WebOptions{std::move(host), 0, kToken}, std::move(handlers));
  }
  int port() const { return server->port(); }
  WebReply get(const std::string& path) const {
    return ask(port(), {path + "?token=" + kToken, ""});
  }
};

template <class F>
bool soon(F&& happened) {
  for (int i = 0; i < 500 && !happened(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return happened();
}

}  // namespace

TEST_CASE("a request with the token is answered") {
  const EchoServer echo;
  const WebReply reply = ask(echo.port(), {"/a%20b?name=x%26y+z&token=" + kToken, ""});
  CHECK(reply.status == 200);
  CHECK(reply.body == "/a b name=x&y z token=" + kToken);
  CHECK_THAT(echo.server->address(), Contains("/?token=" + kToken));
}

TEST_CASE("without the right token nothing is told") {
  const EchoServer echo;
  const std::vector<std::string> targets = {
      "/", "/?token=", "/?token=" + kToken + "0", "/?token=" + kToken.substr(1), "/?tok=" + kToken};
  for (const std::string& target : targets) CHECK(ask(echo.port(), {target, ""}).status == 403);
  CHECK(WebPage::try_open(echo.port(), {"/ws?token=wrong", ""}) == 403);
  CHECK(echo.opened == 0);
}

TEST_CASE("other hosts and other pages are refused") {
  const EchoServer echo;
  const std::string port = std::to_string(echo.port()), target = "/ws?token=" + kToken;
  const auto status = [&](const std::string& host, const std::string& origin) {
    return WebPage::try_open(echo.port(), {target, host, origin});
  };
  CHECK(status("127.0.0.1:" + port, "http://127.0.0.1:" + port) == 101);
  CHECK(status("localhost:" + port, "http://localhost:" + port) == 101);
  CHECK(status("evil.example:" + port, "") == 403);  // DNS rebinding
  CHECK(status("127.0.0.1:1", "") == 403);
  CHECK(status("127.0.0.1:" + port, "http://evil.example") == 403);
  CHECK(status("127.0.0.1:" + port, "null") == 403);
  CHECK(ask(echo.port(), {"/?token=" + kToken, "evil.example:" + port}).status == 403);
}

TEST_CASE("hosts are addresses, localhost or the server's own") {
  CHECK(is_own_host("127.0.0.1:80", 80, "127.0.0.1"));
  CHECK(is_own_host("[::1]:80", 80, "127.0.0.1"));
  CHECK(is_own_host("10.1.2.3:80", 80, "0.0.0.0"));
  CHECK_FALSE(is_own_host("127.0.0.1", 80, "127.0.0.1"));
  CHECK_FALSE(is_own_host("127.0.0.1.evil.example:80", 80, "0.0.0.0"));
  CHECK_FALSE(is_own_host("", 80, "0.0.0.0"));
}

TEST_CASE("only GET, and what fails is said") {
  const EchoServer echo;
  CHECK(ask(echo.port(), {"/?token=" + kToken, "", "", "POST"}).status == 405);
  const WebReply reply = echo.get("/throw");
  CHECK(reply.status == 500);
  CHECK_THAT(reply.body, Contains("on purpose"));
  CHECK(echo.get("/still").status == 200);
}

TEST_CASE("messages go both ways, and an end is noticed") {
  EchoServer echo;
  {
    WebPage page(echo.port(), "/ws?token=" + kToken);
    page.send("hello");
    CHECK(page.read() == "hello");
    CHECK(page.was_text());
    CHECK(echo.opened == 1);
  }
  CHECK(soon([&] { return echo.closed == 1; }));
}

TEST_CASE("malformed and oversized messages end their connection alone") {
  EchoServer echo;
  WebPage good(echo.port(), "/ws?token=" + kToken);
  {
    WebPage bad(echo.port(), "/ws?token=" + kToken);
    bad.send_raw(std::string("\xff\xff\xff\xff", 4) + std::string(64, '\0'));
    CHECK_FALSE(bad.read().has_value());
  }
  {
    WebPage large(echo.port(), "/ws?token=" + kToken);
    large.send(std::string(kMaxMessageBytes + 1, 'x'));
    CHECK_FALSE(large.read().has_value());
  }
  {
    WebPage thrower(echo.port(), "/ws?token=" + kToken);
    thrower.send("throw");
    CHECK_FALSE(thrower.read().has_value());
  }
  good.send("still here");
  CHECK(good.read() == "still here");
}

TEST_CASE("a client that does not read costs a bounded number of messages") {
  EchoServer echo;
  WebPage page(echo.port(), "/ws?token=" + kToken);
  page.send("first");
  REQUIRE(page.read() == "first");
  const std::string large(1 << 20, 'y');
  for (int i = 0; i < 500; ++i) echo.server->send_bytes(1, large);
  int got = 0;
  while (page.read(1).has_value()) ++got;
  CHECK(got >= static_cast<int>(kMaxWaiting));
  CHECK(got < 200);  // kMaxWaiting, and what the system's buffers hold
  WebPage other(echo.port(), "/ws?token=" + kToken);
  other.send("alive");
  CHECK(other.read() == "alive");
}

TEST_CASE("so many clients and no more") {
  EchoServer echo;
  std::vector<std::unique_ptr<WebPage>> pages;
  for (std::size_t i = 0; i < kMaxClients; ++i)
    pages.push_back(std::make_unique<WebPage>(echo.port(), "/ws?token=" + kToken));
  REQUIRE(soon([&] { return echo.opened == static_cast<int>(kMaxClients); }));
  CHECK(WebPage::try_open(echo.port(), {"/ws?token=" + kToken, ""}) != 101);
  pages.pop_back();
  REQUIRE(soon([&] { return echo.closed == 1; }));
  CHECK(WebPage::try_open(echo.port(), {"/ws?token=" + kToken, ""}) == 101);
}

TEST_CASE("a port that is taken and a host that is none are errors that say so") {
  const EchoServer echo;
  CHECK_THAT(
      error_of(
          ExitCode::kUsage,
          [&] {
            open_web_server(WebOptions{"127.0.0.1", echo.port(), kToken}, {});
          }
      ),
      Contains("choose another --port")
  );
  CHECK_THAT(
      error_of(ExitCode::kUsage, [] { EchoServer("no.such.host"); }),
      Contains("expected an address")
  );
}

TEST_CASE("tokens are long and differ") {
  CHECK(random_token().size() == 32);
  CHECK(random_token() != random_token());
}
