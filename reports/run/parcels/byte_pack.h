// SPDX-License-Identifier: MIT
// Bytes made smaller without loss: a zlib stream, with Adler-32 of what is in it.
#pragma once

#include <string>
#include <string_view>

namespace glint {

// `level`: 1 (fast) to 12 (small).
std::string pack_bytes(std::string_view bytes, int level = 12);

// `bytes`: how many there are; nothing is allocated before the stream could hold so many. Errors
// (kBadPrediction, naming `where`): another number of bytes, damage.
std::string unpack_bytes(std::string_view packed, std::size_t bytes, std::string_view where);

}  // namespace glint
