// SPDX-License-Identifier: MIT
// SHA-256 [FIPS 180-4] by nettle, to know files by their content.
#pragma once

#include <string>
#include <string_view>

namespace glint {

// 64 hexadecimal digits, of a file's bytes the same as `sha256sum` prints.
std::string sha256(std::string_view bytes);

}  // namespace glint
