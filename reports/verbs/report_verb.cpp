// SPDX-License-Identifier: MIT
#include "reports/verbs/report_verb.h"

#include <memory>

#include "datasets/dataset.h"
#include "glint/core/progress.h"
#include "reports/verbs/result_tables.h"

namespace glint {

namespace {

int run_report(const CommonOptions& common, const PageForm& form) {
  const fs::path folder = folder_with_records(common);
  const fs::path index =
      write_report(common, folder, result_tables(folder, {}, common.filter()), form);
  print_result(
      common,
      {{"page", index.string()}, {"index_bytes", fs::file_size(index)}},
      index.string() + "\n"
  );
  return 0;
}

}  // namespace

fs::path folder_with_records(const CommonOptions& common) {
  load_profile(common.profile);  // has the message where there is none
  return folder_with_records(common.out, common.profile);
}

Scene load_run_data(const RunSpec& spec) {
  LoadOptions options;
  options.max_pixels = spec.max_pixels;
  options.image_ratio = spec.image_ratio;
  options.with_priors = false;
  return load_scene(spec.dataset_folder, options);
}

fs::path write_report(
    const CommonOptions& common,
    const fs::path& folder,
    const std::vector<Table>& tables,
    const PageForm& form
) {
  PageOptions options;
  options.folder = folder;
  options.profile = common.profile;
  options.out = common.out;
  options.data = common.data;
  options.filter = common.filter();
  options.single_file = form.single_file;
  options.faces = form.faces;
  options.load = load_run_data;
  return write_page(options, tables);
}

namespace {
void add_report_verb(CommandLine& line) {
  auto form = std::make_shared<PageForm>();
  CLI::App* verb = line.add_verb(
      line.app,
      "report",
      "write OUT/PROFILE/report/index.html, a page with all results",
      [&line, form] { return run_report(line.common, *form); },
      kFolderOptions | kDataOption | kThreadsOption
  );
  verb->add_flag("--single-file", form->single_file, "everything inside index.html");
  verb->add_option(
          "--faces",
          form->faces,
          "faces of each mesh at most (default: 300000, in a single file 30000)"
  )
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
}
}  // namespace

GLINT_REGISTER(Verb, {"report", add_report_verb})

}  // namespace glint
