// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace glint {

// What is wrong with a JSON text or a field of it, without the library's words about itself:
// "line 3, column 7: unexpected ']'; expected string literal", "key 'fx' not found".
std::string json_error(const nlohmann::json::exception& error);

}  // namespace glint
