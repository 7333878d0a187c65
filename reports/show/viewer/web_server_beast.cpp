// SPDX-License-Identifier: MIT
// The web server by Boost.Beast, whose headers take long to compile: nothing else includes them.
#include "reports/show/viewer/web_server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <charconv>
#include <deque>
#include <optional>
#include <random>
#include <thread>

#include "glint/core/error.h"
#include "glint/core/progress.h"

namespace glint {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

constexpr auto kRequestTime = std::chrono::seconds(30);
constexpr std::size_t kMaxRequestBytes = 16 << 10;

// Takes as long for any wrong token.
bool is_token(std::string_view given, std::string_view token) {
  unsigned char different = given.size() != token.size();
  for (std::size_t i = 0; i < std::min(given.size(), token.size()); ++i)
    different |= static_cast<unsigned char>(given[i] ^ token[i]);
  return different == 0;
}

std::string decoded(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    int code = 0;
    const char* digits = text.data() + i + 1;
    const bool coded = text[i] == '%' && i + 2 < text.size() &&
                       std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
    plain += coded ? static_cast<char>(code) : text[i] == '+' ? ' ' : text[i];
    if (coded) i += 2;
  }
  return plain;
}

struct Target {
  std::string path;
  Query query;
};

Target target_of(std::string_view text) {
  Target target;
  const std::size_t mark = text.find('?');
  target.path = decoded(text.substr(0, mark));
  std::string_view rest = mark == std::string_view::npos ? "" : text.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos)
      target.query[decoded(pair.substr(0, equals))] = decoded(pair.substr(equals + 1));
  }
  return target;
}

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

// A page's WebSocket.
class Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(beast::tcp_stream stream, ClientId id, WebHandlers& handlers)
      : stream_(std::move(stream)), id_(id), handlers_(handlers) {}

  void open(Request request) {
    request_ = std::move(request);
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.read_message_max(kMaxMessageBytes);
    stream_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
      if (error) return self->end();
      self->handlers_.opened(self->id_);
      self->opened_ = true;
      self->read();
    });
  }

  void send(std::string message, bool text) {
    if (waiting_.size() >= kMaxWaiting) return;
    waiting_.push_back({std::move(message), text});
    if (waiting_.size() == 1) write();
  }

 private:
  struct Message {
    std::string bytes;
    bool text;
  };

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->end();
      std::string message = beast::buffers_to_string(self->buffer_.data());
      self->buffer_.consume(self->buffer_.size());
      try {
        if (self->stream_.got_text()) self->handlers_.text(self->id_, std::move(message));
      } catch (const std::exception& failure) {
        log::warn(fmt::format("view: {}", failure.what()));
        return self->end();
      }
      self->read();
    });
  }

  void write() {
    stream_.text(waiting_.front().text);
    stream_.async_write(
        asio::buffer(waiting_.front().bytes),
        [self = shared_from_this()](beast::error_code error, std::size_t) {
          if (error) return self->end();
          self->waiting_.pop_front();
          if (!self->waiting_.empty()) self->write();
        }
    );
  }

  void end() {
    if (ended_) return;
    ended_ = true;
    beast::error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
    if (opened_) handlers_.closed(id_);
  }

  websocket::stream<beast::tcp_stream> stream_;
  ClientId id_;
  WebHandlers& handlers_;
  Request request_;
  beast::flat_buffer buffer_;
  std::deque<Message> waiting_;  // the first is being written
  bool opened_ = false, ended_ = false;
};

// Members from the context on are of its thread.
class BeastServer final : public WebServer {
 public:
  BeastServer(const WebOptions& options, WebHandlers handlers);
  ~BeastServer() override;

  int port() const override { return port_; }
  std::string address() const override;
  void send_text(ClientId client, std::string message) override {
    send(client, std::move(message), true);
  }
  void send_bytes(ClientId client, std::string message) override {
    send(client, std::move(message), false);
  }

  // Of requests. Why it is refused; none: it is not.
  std::optional<HttpAnswer> refusal(const Request& request, const Target& target) const;
  HttpAnswer answer(const Request& request, const Target& target) const;
  void open_socket(beast::tcp_stream stream, Request request);

 private:
  void listen();
  void accept();
  void send(ClientId client, std::string message, bool text);

  WebOptions options_;
  WebHandlers handlers_;
  int port_ = 0;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  std::map<ClientId, std::weak_ptr<Socket>> clients_;
  ClientId last_client_ = 0;
  std::thread thread_;
};

// One request and its answer; the connection ends with it.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, BeastServer& server)
      : stream_(std::move(socket)), server_(server) {
    parser_.body_limit(kMaxRequestBytes);
    parser_.header_limit(kMaxRequestBytes);
  }

  void read() {
    stream_.expires_after(kRequestTime);
    const auto done = [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (!error) self->serve();
    };
    http::async_read(stream_, buffer_, parser_, done);
  }

 private:
  void serve() {
    Request request = parser_.release();
    const Target target = target_of(view_of(request.target()));
    const auto refused = server_.refusal(request, target);
    if (!refused && target.path == "/ws" && websocket::is_upgrade(request))
      return server_.open_socket(std::move(stream_), std::move(request));
    write(refused ? *refused : server_.answer(request, target));
  }

  void write(HttpAnswer answer) {
    response_.result(static_cast<unsigned>(answer.status));
    response_.set(http::field::content_type, answer.type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");  // the address has the token
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("X-Frame-Options", "DENY");
    response_.body() = std::move(answer.body);
    response_.keep_alive(false);
    response_.prepare_payload();
    stream_.expires_after(kRequestTime);
    const auto done = [self = shared_from_this()](beast::error_code, std::size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    };
    http::async_write(stream_, response_, done);
  }

  beast::tcp_stream stream_;
  BeastServer& server_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  Response response_;
};

asio::ip::address address_of(const std::string& host) {
  boost::system::error_code error;
  const asio::ip::address address =
      asio::ip::make_address(host == "localhost" ? "127.0.0.1" : host, error);
  GLINT_CHECK(
      !error,
      kUsage,
      "--host {}: expected an address of this machine as numbers, such as 127.0.0.1 or 0.0.0.0 "
      "(all of them)",
      host
  );
  return address;
}

void BeastServer::listen() {
  const tcp::endpoint endpoint(
      address_of(options_.host), static_cast<unsigned short>(options_.port)
  );
  boost::system::error_code error;
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  GLINT_CHECK(
      !error,
      kUsage,
      "{}:{}: cannot listen there ({}); choose another --port or --host",
      options_.host,
      options_.port,
      error.message()
  );
  port_ = acceptor_.local_endpoint().port();
}

void BeastServer::accept() {
  acceptor_.async_accept([this](boost::system::error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) std::make_shared<Connection>(std::move(socket), *this)->read();
    accept();
  });
}

void BeastServer::open_socket(beast::tcp_stream stream, Request request) {
  std::erase_if(clients_, [](const auto& client) { return client.second.expired(); });
  if (clients_.size() >= kMaxClients) return;  // closed with the stream
  const auto socket = std::make_shared<Socket>(std::move(stream), ++last_client_, handlers_);
  clients_[last_client_] = socket;
  socket->open(std::move(request));
}

void BeastServer::send(ClientId client, std::string message, bool text) {
  asio::post(context_, [this, client, text, message = std::move(message)]() mutable {
    const auto found = clients_.find(client);
    const auto socket = found == clients_.end() ? nullptr : found->second.lock();
    if (socket != nullptr) socket->send(std::move(message), text);
  });
}

std::optional<HttpAnswer> BeastServer::refusal(const Request& request, const Target& target) const {
  const std::string host(view_of(request[http::field::host]));
  if (!is_own_host(host, port_, options_.host))
    return HttpAnswer{403, "text/plain; charset=utf-8", "403: not the address of this server\n"};
  const auto origin = view_of(request[http::field::origin]);
  if (!origin.empty() && origin != "http://" + host)
    return HttpAnswer{403, "text/plain; charset=utf-8", "403: from another page\n"};
  const auto token = target.query.find("token");
  if (token == target.query.end() || !is_token(token->second, options_.token))
    return HttpAnswer{
        403,
        "text/plain; charset=utf-8",
        "403: the token is wrong; open the whole address that glint-bench printed\n"};
  return {};
}

HttpAnswer BeastServer::answer(const Request& request, const Target& target) const {
  if (request.method() != http::verb::get)
    return {405, "text/plain; charset=utf-8", "405: only GET\n"};
  try {
    return handlers_.get(target.path, target.query);
  } catch (const std::exception& error) {
    log::warn(fmt::format("view: {}: {}", target.path, error.what()));
    return {500, "text/plain; charset=utf-8", fmt::format("500: {}\n", error.what())};
  }
}

BeastServer::BeastServer(const WebOptions& options, WebHandlers handlers)
    : options_(options), handlers_(std::move(handlers)) {
  listen();
  accept();
  thread_ = std::thread([this] { context_.run(); });
}

BeastServer::~BeastServer() {
  context_.stop();
  thread_.join();
}

std::string BeastServer::address() const {
  const std::string& host = options_.host;
  const bool any = host == "0.0.0.0" || host == "::", six = host.find(':') != std::string::npos;
  const std::string name = any ? "127.0.0.1" : six ? "[" + host + "]" : host;
  return fmt::format("http://{}:{}/?token={}", name, port_, options_.token);
}

std::unique_ptr<WebServer> open_beast_server(const WebOptions& options, WebHandlers handlers) {
  return std::make_unique<BeastServer>(options, std::move(handlers));
}

}  // namespace

GLINT_PROVIDE(open_web_server, open_beast_server)

}  // namespace glint
