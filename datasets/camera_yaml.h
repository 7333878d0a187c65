// SPDX-License-Identifier: MIT
// The YAML of camera files, as OpenCV and EasyVolcap write it, by yaml-cpp: fields, lists and
// matrices. One document, no aliases. OpenCV's own reader hangs on 20 wrong bytes.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace glint {

// Numbers, texts, lists and objects; null where nothing stands behind a colon or dash. Tags are
// passed over; of a field that comes twice, the first counts. Errors (kBadReference): `path` and
// the line; also, more than 50 levels, something behind the document.
nlohmann::json parse_camera_yaml(std::string_view text, const std::string& path);

}  // namespace glint
