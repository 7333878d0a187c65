// SPDX-License-Identifier: MIT
#include "tests/support/web_client.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>

namespace glint::test {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;

tcp::endpoint at(int port) {
  return {asio::ip::make_address("127.0.0.1"), static_cast<unsigned short>(port)};
}

std::string own_host(int port) { return "127.0.0.1:" + std::to_string(port); }

}  // namespace

WebReply ask(int port, const WebRequest& wanted) {
  asio::io_context context;
  tcp::socket socket(context);
  socket.connect(at(port));
  http::request<http::empty_body> request{http::string_to_verb(wanted.method), wanted.target, 11};
  request.set(http::field::host, wanted.host.empty() ? own_host(port) : wanted.host);
  if (!wanted.origin.empty()) request.set(http::field::origin, wanted.origin);
  http::write(socket, request);
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(64 << 20);
  http::read(socket, buffer, parser);
  const auto& reply = parser.get();
  return {
      static_cast<int>(reply.result_int()),
      std::string(reply[http::field::content_type]),
      reply.body()};
}

struct WebPage::State {
  asio::io_context context;
  websocket::stream<beast::tcp_stream> stream{context};
  beast::flat_buffer buffer;
};

int WebPage::try_open(int port, const WebRequest& wanted) {
  State state;
  beast::get_lowest_layer(state.stream).connect(at(port));
  state.stream.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    if (!wanted.host.empty()) request.set(http::field::host, wanted.host);
    if (!wanted.origin.empty()) request.set(http::field::origin, wanted.origin);
  }));
  beast::error_code error;
  state.stream.handshake(own_host(port), wanted.target, error);
  return error ? ask(port, wanted).status : 101;
}

WebPage::WebPage(int port, const std::string& target) : state_(std::make_unique<State>()) {
  beast::get_lowest_layer(state_->stream).connect(at(port));
  state_->stream.handshake(own_host(port), target);
  state_->stream.read_message_max(64 << 20);
}

WebPage::~WebPage() = default;

void WebPage::send(const std::string& text) {
  state_->stream.text(true);
  state_->stream.write(asio::buffer(text));
}

void WebPage::send_raw(const std::string& bytes) {
  asio::write(beast::get_lowest_layer(state_->stream).socket(), asio::buffer(bytes));
}

std::optional<std::string> WebPage::read(double seconds) {
  state_->buffer.consume(state_->buffer.size());
  std::optional<beast::error_code> end;
  state_->stream.async_read(state_->buffer, [&](beast::error_code error, std::size_t) {
    end = error;
  });
  state_->context.restart();
  state_->context.run_for(std::chrono::milliseconds(static_cast<int>(1e3 * seconds)));
  if (!end) {  // the read that waits goes with the connection
    beast::get_lowest_layer(state_->stream).close();
    state_->context.run();
  }
  if (*end) return {};
  return beast::buffers_to_string(state_->buffer.data());
}

bool WebPage::was_text() const { return state_->stream.got_text(); }

}  // namespace glint::test
