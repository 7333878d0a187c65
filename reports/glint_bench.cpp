// SPDX-License-Identifier: MIT
// glint-bench: makes scenes, trains methods, scores them and prints the tables.
#include "reports/verbs/command_line.h"

int main(int argc, char** argv) { return glint::run_command_line(argc, argv); }
