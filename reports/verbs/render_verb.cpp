// SPDX-License-Identifier: MIT
#include <memory>

#include "reports/bench/run_stage.h"
#include "reports/bench/stage_documents.h"
#include "reports/verbs/single_run.h"

namespace glint {

namespace {

int run_render(const CommonOptions& common, const std::string& folder) {
  const SingleRun single = open_single_run(folder);
  const auto method = load_trained(single.spec);
  const std::string train_key = stage_key(finished_stage(folder, Stage::kTrain, "train").document);
  run_stage(folder, Stage::kRender, render_document(single.spec.method, train_key), [&] {
    render_stage(single.spec, single.scene, *method);
    return std::string();
  });
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
