// SPDX-License-Identifier: MIT
#include <cstring>

#include "datasets/map_codes.h"
#include "datasets/packed_reader.h"
#include "datasets/view_maps.h"
#include "glint/core/parallel.h"

namespace glint::packed {
namespace {

// Of version 1.
void read_plain_maps(Reader& reader, const std::string& prefix, View& view) {
  const ImageSize size = view.camera.size();
  for_each_map(view, [&](const std::string& name, Image& map, const MapRow& row) {
    if (!reader.has(prefix + name)) return;
    auto values = reader.read_floats(prefix + name, shape_of(size, row.channels()));
    if (row.kind == MapKind::kMask)
      for (float& value : values) value = value != 0 ? 1.0f : 0.0f;
    map = Image(size.width, size.height, row.channels());
    std::copy(values.begin(), values.end(), map.data());
  });
}

// A tensor of maps that are coded together, and where they go.
struct CodedMaps {
  std::string name;
  MapKind kind = MapKind::kColor;
  std::string text;  // read already
  std::vector<Image*> maps;
};

std::size_t num_samples(
    const std::vector<Image*>& maps, std::span<const ImageSize> sizes, int channels
) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < maps.size(); ++i)
    count += sizes[i].num_pixels() * static_cast<std::size_t>(channels);
  return count;
}

// All maps that the view may have, in the order of for_each_map().
std::vector<Image*> places_of(View& view) {
  std::vector<Image*> places;
  for_each_map(view, [&](const std::string&, Image& map, const MapRow&) {
    places.push_back(&map);
  });
  return places;
}

// Makes room for the maps that the tensor of a group says it has.
CodedMaps announced_maps(
    Reader& reader,
    const std::string& name,
    const MapRow& row,
    std::span<View> group,
    std::size_t place  // of places_of()
) {
  CodedMaps coded{name, row.kind, reader.read_text(name), {}};
  const unsigned present = coded.text.empty() ? 0 : static_cast<unsigned char>(coded.text[0]);
  if (present == 0 || present >> group.size() != 0)
    reader.fail(name, fmt::format("it names maps of views that are not there ({:#x})", present));
  std::vector<ImageSize> sizes;
  for (std::size_t i = 0; i < group.size(); ++i)
    if ((present >> i & 1) != 0) {
      coded.maps.push_back(places_of(group[i])[place]);
      sizes.push_back(group[i].camera.size());
    }
  const std::size_t samples = num_samples(coded.maps, sizes, row.channels());
  if (!can_hold(coded.text.size(), samples))
    reader.fail(name, fmt::format("{} bytes for {} values", coded.text.size(), samples));
  for (std::size_t i = 0; i < sizes.size(); ++i)
    *coded.maps[i] = Image(sizes[i].width, sizes[i].height, row.channels());
  return coded;
}

void read_coded_maps(Reader& reader, const std::string& split, std::vector<View>& views) {
  std::vector<CodedMaps> tensors;
  for (std::size_t first = 0; first < views.size(); first += kViewsTogether) {
    const std::size_t count = std::min(kViewsTogether, views.size() - first);
    const std::span<View> group(&views[first], count);
    std::size_t place = 0;
    for_each_map(group[0], [&](const std::string& map, Image&, const MapRow& row) {
      const std::string name = maps_name(split, map, first / kViewsTogether);
      if (reader.has(name)) tensors.push_back(announced_maps(reader, name, row, group, place));
      ++place;
    });
  }
  std::vector<std::string> problems(tensors.size());
  parallel_for(tensors.size(), 1, [&](std::size_t i) {
    const CodedMaps& tensor = tensors[i];
    problems[i] = decode_maps(std::string_view(tensor.text).substr(1), tensor.kind, tensor.maps);
  });
  for (std::size_t i = 0; i < tensors.size(); ++i)
    if (!problems[i].empty()) reader.fail(tensors[i].name, problems[i]);
}

std::vector<Vec3f> vectors_of(std::span<const float> values) {
  std::vector<Vec3f> vectors(values.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return vectors;
}

// A picture of one row behind the number of its pixels.
std::vector<Vec3f> read_coded_vectors(Reader& reader, const std::string& name) {
  const std::string text = reader.read_text(name);
  std::uint64_t count = 0;
  if (text.size() < sizeof count) reader.fail(name, "too few bytes");
  std::memcpy(&count, text.data(), sizeof count);
  if (count == 0) return {};
  if (count > std::numeric_limits<int>::max() / 3 || !can_hold(text.size(), 3 * count))
    reader.fail(name, fmt::format("{} bytes for {} points", text.size(), count));
  Image row(static_cast<int>(count), 1, 3);
  Image* rows[] = {&row};
  const std::string problem =
      decode_maps(std::string_view(text).substr(sizeof count), kPointKind, rows);
  if (!problem.empty()) reader.fail(name, problem);
  return vectors_of(row.values());
}

}  // namespace

Shape shape_of(ImageSize size, int channels) {
  return {
      static_cast<std::size_t>(size.height),
      static_cast<std::size_t>(size.width),
      static_cast<std::size_t>(channels)};
}

void read_maps(Reader& reader, const std::string& split, std::vector<View>& views) {
  if (!reader.is_first_version()) return read_coded_maps(reader, split, views);
  for (std::size_t i = 0; i < views.size(); ++i)
    read_plain_maps(reader, view_prefix(split, i), views[i]);
}

std::vector<Vec3f> read_vectors(Reader& reader, const std::string& name, std::size_t count) {
  return vectors_of(reader.read_floats(name, {count, 3}));
}

PointCloud read_points(Reader& reader) {
  const std::size_t count = reader.count("points.positions");
  const auto read = [&](const std::string& name) {
    return reader.is_first_version() ? read_vectors(reader, name, count)
                                     : read_coded_vectors(reader, name);
  };
  PointCloud points;
  points.positions = read("points.positions");
  points.colors = read("points.colors");
  if (reader.has("points.normals")) points.normals = read("points.normals");
  return points;
}

}  // namespace glint::packed
