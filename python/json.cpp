// SPDX-License-Identifier: MIT
#include "python/json.h"

namespace glint::python {

namespace py = pybind11;

namespace {

py::object list_of(const Json& json) {
  py::list list;
  for (const Json& item : json) list.append(to_python(item));
  return list;
}

py::object dict_of(const Json& json) {
  py::dict dict;
  for (const auto& [name, value] : json.items()) dict[text_to_python(name)] = to_python(value);
  return dict;
}

}  // namespace

py::object to_python(const Json& json) {
  switch (json.type()) {
    case Json::value_t::boolean:
      return py::bool_(json.get<bool>());
    case Json::value_t::number_integer:
      return py::int_(json.get<std::int64_t>());
    case Json::value_t::number_unsigned:
      return py::int_(json.get<std::uint64_t>());
    case Json::value_t::number_float:
      return py::float_(json.get<double>());
    case Json::value_t::string:
      return text_to_python(json.get_ref<const std::string&>());
    case Json::value_t::array:
      return list_of(json);
    case Json::value_t::object:
      return dict_of(json);
    default:
      return py::none();
  }
}

py::str text_to_python(std::string_view text) {
  PyObject* decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

py::list texts_to_python(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& text : texts) list.append(text_to_python(text));
  return list;
}

}  // namespace glint::python
