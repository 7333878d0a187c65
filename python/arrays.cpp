// SPDX-License-Identifier: MIT
#include "python/arrays.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "glint/core/nearest.h"
#include "glint/core/vec.h"

namespace glint::python {

namespace py = pybind11;

namespace {

std::string type_name(py::handle object) {
  const py::handle type = py::type::handle_of(object);
  return py::cast<std::string>(type.attr("__module__")) + "." +
         py::cast<std::string>(type.attr("__qualname__"));
}

py::array array_in(py::handle object, const std::string& name) {
  if (py::isinstance<py::array>(object)) return py::reinterpret_borrow<py::array>(object);
  const char* cure = py::hasattr(object, "detach")  // PyTorch
                         ? "{0}: {1}; expected a NumPy array: give {0}.detach().cpu().numpy()"
                         : "{0}: {1}; expected a NumPy array: give numpy.asarray({0})";
  throw py::type_error(fmt::format(fmt::runtime(cure), name, type_name(object)));
}

void check_float(const py::array& array, const std::string& name) {
  if (py::isinstance<py::array_t<float>>(array)) return;
  const std::string found = py::cast<std::string>(py::str(array.dtype()));
  throw py::type_error(
      found == "uint8"
          ? fmt::format(
                "{0}: dtype uint8; expected float32 in [0, 1]: give "
                "{0}.astype(numpy.float32) / 255",
                name
            )
          : fmt::format(
                "{0}: dtype {1}; expected float32: give {0}.astype(numpy.float32)", name, found
            )
  );
}

std::string shape_text(const py::array& array) {
  return py::cast<std::string>(py::str(array.attr("shape")));
}

bool is_image(const py::array& array, int channels) {
  const bool flat = array.ndim() == 2 && channels == 1;
  return flat || (array.ndim() == 3 && array.shape(2) == channels);
}

// What to do about a shape that is none.
std::string shape_cure(const py::array& array, const std::string& name, int channels) {
  if (array.ndim() == 4) return fmt::format("several images are a list: give list({})", name);
  if (array.ndim() == 3 && array.shape(0) == channels)
    return fmt::format("channels come last: give numpy.moveaxis({}, 0, -1)", name);
  if (array.ndim() == 3 && array.shape(2) == 4 && channels == 3)
    return fmt::format("without alpha: give {}[..., :3]", name);
  if (array.ndim() == 2 && channels == 3)
    return fmt::format("grey to three channels: give numpy.stack([{}] * 3, axis=-1)", name);
  return "give one image, its rows first";
}

void check_shape(const py::array& array, const std::string& name, int channels) {
  if (!is_image(array, channels))
    throw py::value_error(fmt::format(
        "{}: shape {}; expected [H][W][{}]; {}",
        name,
        shape_text(array),
        channels,
        shape_cure(array, name, channels)
    ));
  constexpr py::ssize_t kMost = std::numeric_limits<int>::max();
  if (array.size() == 0 || array.shape(0) > kMost || array.shape(1) > kMost)
    throw py::value_error(fmt::format("{}: shape {}; expected pixels", name, shape_text(array)));
}

int extent(const py::array& array, int axis) { return static_cast<int>(array.shape(axis)); }

// `T` is the array's type; rows that are not in C order are copied into it first.
template <class T>
py::array_t<T, py::array::c_style> in_order(const py::array& array) {
  return py::array_t<T, py::array::c_style>::ensure(array);
}

MaskImage bytes_to_mask(const py::array& array) {
  const auto bytes = in_order<unsigned char>(array);
  MaskImage mask(extent(array, 1), extent(array, 0), 1);
  std::transform(bytes.data(), bytes.data() + bytes.size(), mask.data(), [](unsigned char value) {
    return static_cast<unsigned char>(value != 0 ? 255 : 0);
  });
  return mask;
}

py::array view_of(const Image& image, py::handle owner, bool writable) {
  py::array array(
      py::dtype::of<float>(),
      std::vector<py::ssize_t>{image.height(), image.width(), image.channels()},
      image.data(),
      owner
  );
  if (!writable) py::setattr(array.attr("flags"), "writeable", py::bool_(false));
  return array;
}

py::dict views_of(const MapSet& maps, py::handle owner, bool writable) {
  py::dict dict;
  maps.for_each([&](const MapRow& row, const Image& map) {
    dict[py::str(std::string(row.id))] = view_of(map, owner, writable);
  });
  return dict;
}

}  // namespace

Image image_of(py::handle object, const std::string& name, int channels) {
  const py::array array = array_in(object, name);
  check_float(array, name);
  check_shape(array, name, channels);
  const auto values = in_order<float>(array);
  return {
      extent(array, 1),
      extent(array, 0),
      channels,
      FloatArray(values.data(), values.data() + values.size())};
}

MaskImage mask_of(py::handle object, const std::string& name) {
  if (object.is_none()) return {};
  const py::array array = array_in(object, name);
  const bool bytes =
      py::isinstance<py::array_t<bool>>(array) || py::isinstance<py::array_t<unsigned char>>(array);
  if (!bytes) return mask_of_map(image_of(object, name, 1));
  check_shape(array, name, 1);
  return bytes_to_mask(array);
}

template <class Row>
std::vector<Row> rows_of(py::handle object, const std::string& name) {
  constexpr py::ssize_t kColumns = sizeof(Row) / sizeof(float);
  const py::array array = array_in(object, name);
  check_float(array, name);
  if (array.ndim() != 2 || array.shape(1) != kColumns)
    throw py::value_error(
        fmt::format("{}: shape {}; expected [N][{}]", name, shape_text(array), kColumns)
    );
  const auto values = in_order<float>(array);
  std::vector<Row> rows(static_cast<std::size_t>(array.shape(0)));
  std::memcpy(static_cast<void*>(rows.data()), values.data(), rows.size() * sizeof(Row));
  return rows;
}
template std::vector<Vec3f> rows_of(py::handle, const std::string&);

MapSet maps_of(const py::dict& dict, const std::string& name) {
  MapSet set;
  for (const auto& [key, value] : dict) {
    const auto id = py::cast<std::string>(key);
    const MapRow* row = find_map(id);
    if (row == nullptr) {
      std::vector<std::string> known;
      for (const MapRow& map : maps()) known.emplace_back(map.id);
      throw py::value_error(fmt::format(
          "{}: no map is called '{}'; {}there are: {}",
          name,
          id,
          did_you_mean(id, known),
          comma_list(known)
      ));
    }
    set[*row] = image_of(value, fmt::format("{}['{}']", name, id), row->channels());
  }
  return set;
}

py::array array_of(const Image& image, py::handle owner) { return view_of(image, owner, false); }

py::dict arrays_of(const MapSet& maps, py::handle owner) { return views_of(maps, owner, false); }

py::dict arrays_of(MapSet&& maps) {
  auto kept = std::make_unique<MapSet>(std::move(maps));
  const MapSet& set = *kept;
  const py::capsule owner(kept.release(), [](void* held) { delete static_cast<MapSet*>(held); });
  return views_of(set, owner, true);
}

}  // namespace glint::python
