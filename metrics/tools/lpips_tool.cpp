// SPDX-License-Identifier: MIT
#include "metrics/tools/tool.h"

int main(int argc, char** argv) { return glint::run_tool(glint::make_lpips_tool(), argc, argv); }
