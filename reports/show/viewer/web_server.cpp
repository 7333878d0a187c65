// SPDX-License-Identifier: MIT
#include "reports/show/viewer/web_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <random>

namespace glint {

namespace {

bool is_address(const std::string& text) {
  in6_addr address{};
  return ::inet_pton(AF_INET, text.c_str(), &address) == 1 ||
         ::inet_pton(AF_INET6, text.c_str(), &address) == 1;
}

}  // namespace

std::string random_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

bool is_own_host(std::string_view host, int port, std::string_view own_host) {
  const std::size_t colon = host.rfind(':');
  if (colon == std::string_view::npos || host.substr(colon + 1) != std::to_string(port))
    return false;
  std::string_view name = host.substr(0, colon);
  if (name == "localhost" || name == own_host) return true;
  if (name.starts_with('[') && name.ends_with(']')) name = name.substr(1, name.size() - 2);
  return is_address(std::string(name));
}

}  // namespace glint
