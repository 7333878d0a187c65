// SPDX-License-Identifier: MIT
#include "python/calls.h"

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "python/json.h"

namespace glint::python {

namespace py = pybind11;

namespace {

std::mutex warnings_mutex;
std::vector<std::string> warnings;  // any thread adds, without the lock of Python

void keep_warning(std::string_view message) {
  const std::lock_guard lock(warnings_mutex);
  warnings.emplace_back(message);
}

std::vector<std::string> take_warnings() {
  const std::lock_guard lock(warnings_mutex);
  return std::exchange(warnings, {});
}

py::object of_package(const char* name) {
  return py::module_::import("glint_bench._errors").attr(name);
}

void raise_glint_error(const char* message, ExitCode code) {
  const py::object type = of_package("GlintError");
  const py::object error = type(text_to_python(message), static_cast<int>(code));
  PyErr_SetObject(type.ptr(), error.ptr());
}

void translate(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const Error& glint_error) {
    raise_glint_error(glint_error.what(), glint_error.code());
  } catch (const Interrupted&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  }
}

}  // namespace

void collect_warnings() { log::send_warnings_to(keep_warning); }

void forget_warnings() noexcept { take_warnings(); }

void warn(const std::string& text) {
  // The caller's line: a function of the package stands between.
  if (PyErr_WarnEx(
          of_package("GlintWarning").ptr(), py::cast<std::string>(text_to_python(text)).c_str(), 2
      ) != 0)
    throw py::error_already_set();
}

void emit_warnings() {
  for (const std::string& text : take_warnings()) warn(text);
}

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void register_errors() { py::register_exception_translator(translate); }

}  // namespace glint::python
