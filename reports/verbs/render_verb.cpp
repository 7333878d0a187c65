// SPDX-License-Identifier: MIT
#include <memory>

#include "reports/verbs/single_run.h"

namespace glint {

namespace {

int run_render(const CommonOptions& common, const std::string& folder) {
  const SingleRun single = open_single_run(folder);
  const auto method = load_trained(single.spec);
  render_stage(single.spec, single.scene, *method);
  const std::string renders = (single.spec.folder / "renders").string();
  if (common.json)
    print_json({{"renders", renders}, {"views", single.scene.test.size()}});
  else
    print_text(fmt::format("{}: {} test views\n", renders, single.scene.test.size()));
  return 0;
}

void add_render_verb(CommandLine& line) {
  auto folder = std::make_shared<std::string>();
  line.add_verb(
          line.app,
          "render",
          "render the test views of a trained run",
          [&line, folder] { return run_render(line.common, *folder); }
  )
      ->add_option("--run", *folder, "run folder")
      ->required();
}

}  // namespace

GLINT_REGISTER(Verb, {"render", add_render_verb})

}  // namespace glint
