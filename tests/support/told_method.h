// SPDX-License-Identifier: MIT
// "told": a method that is no rival, in the registry alone.
#pragma once

#include "glint/method.h"

namespace glint::test {

inline void register_told_method() {
  if (Registry<MethodSpec>::all().contains("told")) return;
  MethodSpec spec;
  spec.id = "told";
  spec.title = "Told";
  spec.description = "no rival: given the true pane";
  spec.rival = false;
  Registry<MethodSpec>::add(spec, "");
}

}  // namespace glint::test
