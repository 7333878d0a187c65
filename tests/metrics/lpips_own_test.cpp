// SPDX-License-Identifier: MIT
// All tests of LPIPS with networks of our own: this program has no others (tests/CMakeLists.txt).
#include "tests/metrics/lpips_test.cpp"

#include "metrics/feature_net_backends.h"

TEST_CASE("This program has networks of our own alone") { CHECK_FALSE(make_onednn_net.here()); }
