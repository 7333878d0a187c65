// SPDX-License-Identifier: MIT
// docs/results/index.html: the committed results (results_page.h) as a page that opens from the
// repository. The figure of the order of methods, which RESULTS.md shows, too.
#pragma once

#include "reports/show/tables/order_by_length.h"

namespace glint {

inline constexpr const char* kResultsPage = "docs/results/index.html";

// Of a project's folder. Errors: results_sections()'s, order_by_length()'s.
std::string results_html(const fs::path& root);

// tau of each table by steps, with the band of chance.
std::string order_figure(const OrderByLength& order);

}  // namespace glint
