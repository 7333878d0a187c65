// SPDX-License-Identifier: MIT
// A function that a library of its own brings: what a program links decides whether it has it.
// Declared where the function would be,
//
//   inline constinit Service<Image(ImageView, ImageSize)> resize_image{"resizing", "what to do"};
//
// called like one, and brought by a file of that library (glint_add_library(... REGISTERS ...)):
//
//   GLINT_PROVIDE(resize_image, resize_by_opencv)
#pragma once

#include <utility>

#include "glint/core/error.h"

namespace glint {

template <class Signature>
class Service;

template <class Result, class... Arguments>
class Service<Result(Arguments...)> {
 public:
  using Function = Result (*)(Arguments...);

  // `what` opens the message of a program without it, `instead` closes it.
  constexpr Service(const char* what, const char* instead) : what_(what), instead_(instead) {}

  bool here() const { return function_ != nullptr; }
  // Errors (kEnvironment): no library of this program brings it.
  void require() const {
    GLINT_CHECK(here(), kEnvironment, "{}: this lean build cannot; {}", what_, instead_);
  }
  // Errors: those of require() and of the function.
  Result operator()(Arguments... arguments) const {
    require();
    return function_(std::forward<Arguments>(arguments)...);
  }

  // Errors (kEnvironment): two libraries bring it.
  bool provide(Function function) {
    GLINT_CHECK(!here(), kEnvironment, "{}: two libraries of this program bring it", what_);
    function_ = function;
    return true;
  }

 private:
  const char *what_, *instead_;
  Function function_ = nullptr;
};

}  // namespace glint

#define GLINT_PROVIDE(service, function)                                       \
  namespace {                                                                  \
  [[maybe_unused]] const bool service##_provided = service.provide(&function); \
  }
