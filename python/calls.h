// SPDX-License-Identifier: MIT
// How Python calls what may take long: without the interpreter's lock (GIL), so that its other
// threads run. Warnings of the code (log::warn) become warnings of Python, Ctrl-C a
// KeyboardInterrupt as soon as the call ends.
#pragma once

#include <pybind11/pybind11.h>

#include <utility>

namespace glint::python {

// Where log::warn goes from now on.
void collect_warnings();
// Those since the last call, as warnings.warn(text, GlintWarning). Throws where Python is to treat
// them as errors.
void emit_warnings();
void forget_warnings() noexcept;
// One of them, by hand.
void warn(const std::string& text);

// Ctrl-C and other signals that Python has seen: throws what their handlers raise. Only the main
// thread is told.
void check_signals();

// f() without the lock; it must not touch Python's objects.
template <class F>
auto without_gil(F&& f) {
  const auto unlocked = [&] {
    const pybind11::gil_scoped_release release;
    try {
      return f();
    } catch (...) {
      forget_warnings();  // the error says more
      throw;
    }
  };
  auto result = unlocked();
  emit_warnings();
  check_signals();
  return result;
}

// Every error of glint becomes a GlintError of the package (glint_bench/_errors.py).
void register_errors();

}  // namespace glint::python
