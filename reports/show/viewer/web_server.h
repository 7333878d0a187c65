// SPDX-License-Identifier: MIT
// A small web server for pages of this machine's user: files by GET, messages by WebSocket. Every
// request has to carry the token of its address and to be meant for this server, so that neither
// other users nor other pages in the user's browser (DNS rebinding) get in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "glint/core/service.h"

namespace glint {

using ClientId = std::uint64_t;
// Of an address, decoded: name -> value.
using Query = std::map<std::string, std::string>;

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8", body;
};

// Called on the server's thread, one at a time; what they throw becomes status 500 or ends the
// connection.
struct WebHandlers {
  std::function<HttpAnswer(const std::string& path, const Query& query)> get;
  std::function<void(ClientId)> opened, closed;
  std::function<void(ClientId, std::string message)> text;
};

struct WebOptions {
  std::string host = "127.0.0.1";  // to listen at
  int port = 0;                    // 0: any that is free
  std::string token;
};

// Limits, for the memory of the process.
inline constexpr std::size_t kMaxClients = 16;
inline constexpr std::size_t kMaxMessageBytes = 4 << 20;  // that a client may send
inline constexpr std::size_t kMaxWaiting = 32;            // messages to a client that reads slowly

// Listens while it lives; its end closes all connections.
class WebServer {
 public:
  virtual ~WebServer() = default;
  virtual int port() const = 0;
  // For a browser on this machine, with the token.
  virtual std::string address() const = 0;
  // Any thread. Messages that a client does not read stay waiting, up to kMaxWaiting of them; what
  // comes then is dropped.
  virtual void send_text(ClientId client, std::string message) = 0;
  virtual void send_bytes(ClientId client, std::string message) = 0;
};

// Errors (kUsage): the host is none of this machine's, the port is taken.
inline constinit Service<std::unique_ptr<WebServer>(const WebOptions&, WebHandlers)>
    open_web_server{
        "serving pages to a browser", "use the full build, with Boost's headers (libboost-dev)"};

// 128 random bits, as hexadecimal digits.
std::string random_token();

// Whether a request that names this host ("localhost:8080") is meant for a server at this port:
// an address as numbers, localhost, or `own_host`.
bool is_own_host(std::string_view host, int port, std::string_view own_host);

}  // namespace glint
