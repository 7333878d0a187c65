// SPDX-License-Identifier: MIT
#include "glint/core/sha256.h"

#include <nettle/sha2.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

namespace glint {

std::string sha256(std::string_view bytes) {
  sha256_ctx context;
  sha256_init(&context);
  sha256_update(&context, bytes.size(), reinterpret_cast<const unsigned char*>(bytes.data()));
  std::array<unsigned char, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&context, digest.size(), digest.data());
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

}  // namespace glint
