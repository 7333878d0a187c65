// SPDX-License-Identifier: MIT
// A browser for tests, by Boost.Beast: one request, or a WebSocket.
#pragma once

#include <memory>
#include <optional>
#include <string>

namespace glint::test {

struct WebReply {
  int status = 0;
  std::string type, body;
};
// GET with these headers; an empty one is not sent.
struct WebRequest {
  std::string target, host, origin = "", method = "GET";
};
WebReply ask(int port, const WebRequest& request);

class WebPage {
 public:
  // Status 101, or that of a plain request where it is declined.
  static int try_open(int port, const WebRequest& request);

  WebPage(int port, const std::string& target);
  ~WebPage();
  void send(const std::string& text);
  void send_raw(const std::string& bytes);  // past the protocol
  // The next message; none: the connection ended, or nothing came in time.
  std::optional<std::string> read(double seconds = 20);
  bool was_text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace glint::test
