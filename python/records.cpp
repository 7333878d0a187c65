// SPDX-License-Identifier: MIT
#include "reports/run/records/records.h"

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "python/calls.h"
#include "python/json.h"
#include "python/metrics.h"

namespace glint::python {

namespace py = pybind11;

namespace {

// Objects inside become "timings.train"; metrics have their ids alone: no field is called so.
void add_flat(const Json& json, const std::string& prefix, py::dict& row) {
  for (const auto& [name, value] : json.items()) {
    if (value.is_object())
      add_flat(value, prefix.empty() && name == "metrics" ? "" : prefix + name + ".", row);
    else
      row[text_to_python(prefix + name)] = to_python(value);
  }
}

py::list rows_of_file(const std::string& path) {
  const std::vector<Record> records = without_gil([&] {
    check_exists(path);  // no file means no records, elsewhere
    return read_records(path);
  });
  py::list rows;
  for (const Record& record : records) {
    py::dict row;
    add_flat(record_to_json(record), "", row);
    rows.append(row);
  }
  return rows;
}

}  // namespace

void add_records(py::module_& module) {
  module.def("read_records", &rows_of_file, py::arg("path"));
}

}  // namespace glint::python
