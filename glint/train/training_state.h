// SPDX-License-Identifier: MIT
// What a training is made of between two steps, by name: one text (`visit_state`) says it for
// writing and for reading. Buffers that a step fills before it reads them are no state.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <concepts>
#include <functional>
#include <string>
#include <type_traits>

#include "glint/core/error.h"
#include "glint/scene/safetensors.h"
#include "glint/scene/surfels.h"

namespace glint {

class TrainingState {
 public:
  virtual ~TrainingState() = default;
  virtual bool reading() const = 0;

  // A number; an array, which gets the file's length when it is read; or a part of several, whose
  // visit_state(TrainingState&) names each. Names within a part differ. Arrays are borrowed until
  // all is written: they must outlive the visit. Errors when it is read (kBadReference): the file
  // has no such thing, or another type of it.
  template <class T>
  void operator()(const std::string& name, T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      number(name, value);
    } else if constexpr (requires { value.visit_state(*this); }) {
      part(name, [&] { value.visit_state(*this); });
    } else {
      values(name, value);
    }
  }
  // A cloud with the names of its channels. Errors: also, arrays of different lengths.
  void operator()(const std::string& name, SurfelCloud& cloud);
  void operator()(const std::string& name, std::string& text) { exchange(path_ + name, text); }

 private:
  virtual void exchange(const std::string& name, std::string& text) = 0;
  // `place(count)`: where `count` values lie, or are to be put.
  virtual void exchange(
      const std::string& name,
      TensorType type,
      std::size_t count,
      const std::function<void*(std::size_t count)>& place
  ) = 0;

  template <class F>
  void part(const std::string& name, F&& visit) {
    const std::string before = path_;
    path_ += name + ".";
    visit();
    path_ = before;
  }
  template <class T>
  void number(const std::string& name, T& value);
  template <class V>
  void values(const std::string& name, V& values) {
    exchange(
        path_ + name,
        kTensorTypeOf<typename V::value_type>,
        values.size(),
        [&values](std::size_t count) -> void* {
          if (values.size() != count) values.resize(count);
          return values.data();
        }
    );
  }

  std::string path_;  // of the part that is visited: "interface.adam."
};

// Numbers are text with all their digits. Errors (kBadReference): text that is no such number.
template <class T>
void TrainingState::number(const std::string& name, T& value) {
  std::string text = fmt::format("{}", value);
  exchange(path_ + name, text);
  if (!reading()) return;
  bool good = false;
  if constexpr (std::is_same_v<T, bool>) {
    value = text == "true";
    good = value || text == "false";
  } else {
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    good = end.ec == std::errc{} && end.ptr == text.data() + text.size();
  }
  GLINT_CHECK(good, kBadReference, "{}{} is '{}', which is no such number", path_, name, text);
}

}  // namespace glint
