// SPDX-License-Identifier: MIT
// Methods as people read them: the same words in tables, figures and the page.
#pragma once

#include <string>

namespace glint {

// "2DGS"; of a variant that is named by what it lacks, with its method: "GLINT, w/o G_refl". Of
// imported renders, which no registry knows, their id.
std::string method_title(const std::string& id);

// False: it is given the truth of test views. Renders from elsewhere are rivals.
bool is_rival(const std::string& id);

}  // namespace glint
