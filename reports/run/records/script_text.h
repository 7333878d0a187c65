// SPDX-License-Identifier: MIT
// Data as script files: a page opened from file:// may load scripts, but fetch nothing.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "glint/core/config.h"

namespace glint {

// JSON that may stand inside a <script> element: ASCII, and no '<' that could close the element.
// Text that is not UTF-8 gets replacement characters.
std::string script_json(const Json& json);

// The script that leaves `json` as window.GLINT_PARTS[name].
std::string part_script(const std::string& name, const Json& json);

// Program text for a <script> or <style> element: nothing in it closes the element.
std::string inline_text(std::string_view text);

// Text for an element or an attribute.
std::string html_text(std::string_view text);

std::string base64(std::string_view bytes);

// zlib stream (RFC 1950) in base64; the page inflates it with DecompressionStream("deflate").
std::string packed(std::span<const std::uint8_t> bytes);

// Six digits, which is more than a page shows; null where not finite.
Json short_number(double value);

// A word of a shell command: quoted unless every character is harmless.
std::string shell_word(const std::string& text);

}  // namespace glint
