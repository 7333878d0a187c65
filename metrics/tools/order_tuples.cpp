// SPDX-License-Identifier: MIT
#include "metrics/tools/order_tuples.h"

#include <map>
#include <sstream>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

constexpr int kMostSide = 1 << 20;  // pixels
constexpr int kMostLayer = 64;

[[noreturn]] void fail(const std::string& where, const Json& found) {
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: {} is no tuple; expected two to four points [x, y, layer], layers from 1",
          where,
          found.dump().substr(0, 80)
      )
  );
}

LayerPoint point_of(const Json& json, const std::string& where) {
  const bool good =
      json.is_array() && json.size() == 3 &&
      std::all_of(json.begin(), json.end(), [](const Json& n) { return n.is_number(); });
  if (!good) fail(where, json);
  const auto x = json[0].get<double>(), y = json[1].get<double>(), layer = json[2].get<double>();
  if (!(x >= 0 && y >= 0 && x < kMostSide && y < kMostSide && layer >= 1 && layer <= kMostLayer))
    fail(where, json);
  return {static_cast<int>(x), static_cast<int>(y), static_cast<int>(layer)};
}

// Of an array of points, or of an object with p1, p2, ...
AnnotatedTuple tuple_of(const Json& json, const std::string& where) {
  AnnotatedTuple tuple;
  if (json.is_object()) {
    for (int k = 1; k <= 4 && json.contains(fmt::format("p{}", k)); ++k)
      tuple.points.push_back(point_of(json[fmt::format("p{}", k)], where));
    const Json real = json.value("is_real", Json(true));
    tuple.is_real = !real.is_boolean() || real.get<bool>();
  } else if (json.is_array()) {
    for (const Json& point : json) tuple.points.push_back(point_of(point, where));
  }
  const std::size_t least = tuple.is_real ? 2 : 1;
  if (tuple.points.size() < least || tuple.points.size() > 4) fail(where, json);
  return tuple;
}

Json parsed(const std::string& text, const std::string& where) {
  const Json json = parse_json(text);
  GLINT_CHECK(!json.is_discarded(), kBadReference, "{}: no JSON; write it again", where);
  return json;
}

void read_lines(const fs::path& path, std::vector<AnnotatedTuple>& tuples) {
  std::istringstream lines(read_file(path));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string where = fmt::format("{}: line {}", path.string(), ++number);
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    tuples.push_back(tuple_of(parsed(line, where), where));
  }
}

void read_object(
    const fs::path& path, const std::string& subset, std::vector<AnnotatedTuple>& tuples
) {
  const Json json = read_json_object(path, ExitCode::kBadReference);
  const Json& of_subset = json.contains(subset) ? json[subset] : json;
  for (const char* size : {"pairs", "trips", "quads"}) {
    const std::string where = fmt::format("{}: {}.{}", path.string(), subset, size);
    const Json list = of_subset.is_object() ? of_subset.value(size, Json::array()) : Json();
    GLINT_CHECK(list.is_array(), kBadReference, "{}: expected a list of tuples", where);
    for (const Json& tuple : list) tuples.push_back(tuple_of(tuple, where));
  }
}

}  // namespace

std::vector<AnnotatedImage> read_order_tuples(const fs::path& path, const std::string& subset) {
  check_exists(path);
  std::map<std::string, AnnotatedImage> images;
  std::vector<fs::path> files{path};
  if (is_folder(path)) files = list_files_below(path);
  for (const fs::path& file : files) {
    const std::string extension = file.extension().string();
    if (extension != ".jsonl" && extension != ".json") continue;
    AnnotatedImage& image = images[file.stem().string()];
    image.name = file.stem().string();
    image.path = file;
    if (extension == ".jsonl")
      read_lines(file, image.tuples);
    else
      read_object(file, subset, image.tuples);
  }
  GLINT_CHECK(
      !images.empty(),
      kBadReference,
      "{}: no tuples; expected NAME.jsonl or NAME.json, one an image",
      path.string()
  );
  std::vector<AnnotatedImage> list;
  for (auto& [name, image] : images) list.push_back(std::move(image));
  return list;
}

}  // namespace glint
