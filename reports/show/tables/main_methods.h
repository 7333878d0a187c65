// SPDX-License-Identifier: MIT
// The methods that pictures of a few columns show: what each is a step beyond the one before.
#pragma once

#include <string>
#include <vector>

namespace glint {

// Ids, in the order of the columns: 2DGS, EnvGS, TSGS, GLINT, GLINT+.
const std::vector<std::string>& main_methods();

bool is_main_method(const std::string& id);

}  // namespace glint
