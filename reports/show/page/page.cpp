// SPDX-License-Identifier: MIT
#include "reports/show/page/page.h"

#include <functional>
#include <regex>
#include <set>

#include "glint/core/file_lock.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/replace_folder.h"
#include "reports/run/records/embedded.h"
#include "reports/run/records/script_text.h"
#include "reports/show/page/mesh_part.h"
#include "reports/show/page/page_scenes.h"
#include "reports/show/page/page_summary.h"

namespace glint {

namespace {

// Scripts that the page loads at once, in this order; every other one comes when it is needed.
constexpr const char* kFirstScripts[] = {"data.js", "report.js"};

std::string_view page_file(const std::string& name) {
  return embedded_files().at("show/page/dist/" + name);
}

void replace_mark(std::string& text, std::string_view mark, const std::string& by) {
  const std::size_t at = text.find(mark);
  GLINT_CHECK(at != std::string::npos, kEnvironment, "show/page/dist/index.html has no {}", mark);
  text.replace(at, mark.size(), by);
}

std::string index_html(
    const PageOptions& options, const std::string& styles, const std::string& scripts
) {
  std::string html(page_file("index.html"));
  const std::string profile = fs::path(options.profile).stem().string();
  replace_mark(html, "<!--TITLE-->", html_text("GLINT Bench: " + profile));
  replace_mark(html, "<!--STYLES-->", styles);
  replace_mark(html, "<!--SCRIPTS-->", scripts);
  return html;
}

std::string linked_page(const PageOptions& options) {
  std::string scripts;
  for (const char* name : kFirstScripts)
    scripts += fmt::format("<script defer src=\"assets/{}\"></script>\n", name);
  return index_html(options, "<link rel=\"stylesheet\" href=\"assets/report.css\">", scripts);
}

// Pictures become data URIs in window.GLINT_ASSETS; scripts keep their order, report.js is last.
std::string inlined_page(const PageOptions& options, const fs::path& assets) {
  std::string scripts, pictures = "window.GLINT_ASSETS={";
  const auto add = [&](const fs::path& file) {
    scripts += fmt::format("<script>{}</script>\n", inline_text(read_file(file)));
  };
  const std::vector<fs::path> files = list_files_below(assets);
  Progress progress("report: into one file", files.size());
  for (const fs::path& file : files) {
    progress.advance();
    const std::string name = file.lexically_relative(assets).generic_string();
    if (file.extension() == ".png")
      pictures +=
          fmt::format("\"{}\":\"data:image/png;base64,{}\",\n", name, base64(read_file(file)));
    else if (file.extension() == ".js" && name != "report.js")
      add(file);
  }
  scripts += fmt::format("<script>{}}};</script>\n", pictures);
  add(assets / "report.js");
  const std::string styles = fmt::format("<style>{}</style>", inline_text(page_file("report.css")));
  const std::string html = index_html(options, styles, scripts);
  if (html.size() > kLargePageBytes)
    log::warn(
        "report: so large a file opens slowly; leave out --single-file, or give meshes fewer faces "
        "(--faces)"
    );
  return html;
}

void write_assets(
    const PageOptions& options, const std::vector<Table>& tables, const fs::path& assets
) {
  for (const char* name : {"report.js", "mesh3d.js", "report.css", "LICENSES.txt"})
    write_file(assets / name, page_file(name));
  const auto records =
      chosen_records(read_records(options.folder / "records.jsonl"), options.filter);
  const auto scenes = page_scenes(records, options.folder);
  std::size_t steps = 0;
  for (const PageScene& scene : scenes) steps += scene_steps(scene);
  {
    Progress progress("report", steps);
    for (std::size_t i = 0; i < scenes.size(); ++i)
      write_scene(scenes[i], i, options, assets, progress);
  }
  const Json summary = page_summary(options, tables, records, scenes);
  write_file(assets / "data.js", fmt::format("window.GLINT_REPORT={};\n", script_json(summary)));
}

std::uintmax_t bytes_below(const fs::path& folder) {
  std::uintmax_t bytes = 0;
  for (const fs::path& file : list_files_below(folder)) bytes += fs::file_size(file);
  return bytes;
}

// Names that write_assets() and write_scene() give, of earlier pages too.
bool is_of_a_page(const std::string& name) {
  static const std::regex ours(
      R"((report|mesh3d|data|scene_\d+|probe_\d+_\d+|mesh_\d+_[tr]\d+[ab]?)\.js|report\.css|)"
      R"(LICENSES\.txt|pictures/s\d+/v\d+_[tr]\d*_\w+\.(png|js))"
  );
  return std::regex_match(name, ours);
}

std::set<std::string> own_names(const fs::path& assets, const fs::path&) {
  std::set<std::string> names = leaves_below(assets);
  std::erase_if(names, std::not_fn(is_of_a_page));
  return names;
}

// What others put there stays, also where a page in a single file needs no folder.
void replace_assets(const fs::path& fresh, const fs::path& assets) {
  const bool is_empty = list_entries(fresh).empty();
  for (const std::string& name : replace_folder(fresh, assets, own_names))
    log::warn(fmt::format("{}: of no page, left as it is", (assets / name).string()));
  std::error_code code;
  if (is_empty) fs::remove(assets, code);  // fails where something of others is left
}

// Each `all` on a folder writes the page at its end: the pages come one after the other.
FileLock wait_for_page(const fs::path& report) {
  return FileLock::wait_for(FileLock::file_beside(report), [&](const std::string& holder) {
    log::info(fmt::format("{}: waiting for {}, which writes it", report.string(), holder));
  });
}

void empty_folder(const fs::path& folder) {
  std::error_code code;
  for (const fs::path& path : list_entries(folder)) fs::remove_all(path, code);
}

}  // namespace

std::size_t mesh_faces(const PageOptions& options) {
  if (options.faces > 0) return options.faces;
  return options.single_file ? kSingleFileFaces : kPageFaces;
}

fs::path write_page(const PageOptions& options, const std::vector<Table>& tables) {
  const fs::path report = options.folder / "report", assets = absolute_folder(report / "assets");
  const UnfinishedFolder fresh(assets);  // an error leaves the page before as it was
  write_assets(options, tables, fresh.path());
  const std::string html =
      options.single_file ? inlined_page(options, fresh.path()) : linked_page(options);
  if (options.single_file) empty_folder(fresh.path());
  const std::uintmax_t bytes = html.size() + bytes_below(fresh.path());
  const FileLock lock = wait_for_page(report);
  replace_assets(fresh.path(), assets);
  write_file(report / "index.html", html);
  log::info(fmt::format(
      "report: {:.1f} MB in {}, meshes of at most {} faces",
      static_cast<double>(bytes) / 1e6,
      options.single_file ? "one file" : "a folder",
      mesh_faces(options)
  ));
  return report / "index.html";
}

}  // namespace glint
