// SPDX-License-Identifier: MIT
#include "reports/run/code/source_tree.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

#include "reports/run/code/stage_sources.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

using Files = std::vector<std::string>;

// Two methods of one renderer with two implementations, a loss that only one of them uses.
class SmallTree {
 public:
  SmallTree() {
    write("glint/render/rays.h", "struct Rays {};");
    write("glint/render/rays.cpp", "#include \"glint/render/rays.h\"\nint rays;");
    write("glint/render/draw.h", "#include \"glint/render/rays.h\"\nvoid draw();");
    write("glint/render/draw_fast.cpp", "#include \"glint/render/draw.h\"\nvoid draw() {}");
    write("glint/train/loss.h", "int loss();");
    write("glint/train/loss.cpp", "#include \"glint/train/loss.h\"\nint loss() { return 1; }");
    write("baselines/a.cpp", "#include \"glint/render/draw.h\"\nGLINT_REGISTER(a())");
    write(
        "baselines/b.cpp",
        "#include \"glint/render/draw.h\"\n#include \"glint/train/loss.h\"\nbool r = "
        "register_methods<B>();"
    );
    write("reports/run/bench/run.cpp", "#include \"glint/train/loss.h\"\nint run;");
  }

  void write(const std::string& file, const std::string& text) const {
    write_file(folder_.path() / file, text);
  }
  SourceTree read() const { return SourceTree(folder_.path()); }
  // The hashes that the files behind `root` have now.
  std::vector<std::string> hashes(const std::string& root) const {
    const SourceTree tree = read();
    std::vector<std::string> all;
    for (const std::string& file : tree.closure({root})) all.push_back(tree.hash_of(file));
    return all;
  }

 private:
  test::TempFolder folder_;
};

}  // namespace

TEST_CASE("a file depends on what it includes and on what implements those headers") {
  const SmallTree sources;
  CHECK(
      sources.read().closure({"baselines/a.cpp"}) ==
      Files{
          "baselines/a.cpp",
          "glint/render/draw.h",
          "glint/render/draw_fast.cpp",
          "glint/render/rays.cpp",
          "glint/render/rays.h"}
  );
  CHECK(sources.read().registering() == Files{"baselines/a.cpp", "baselines/b.cpp"});
}

TEST_CASE("of files that drive a computation only those that are named count") {
  const SmallTree sources;
  CHECK(
      sources.read().closure({"reports/run/bench/run.cpp"}) == Files{"reports/run/bench/run.cpp"}
  );
}

TEST_CASE("a change of code reaches who depends on it, a comment nobody") {
  const SmallTree sources;
  const auto a = sources.hashes("baselines/a.cpp"), b = sources.hashes("baselines/b.cpp");
  sources.write(
      "glint/train/loss.cpp", "#include \"glint/train/loss.h\"\nint loss() { return 2; }"
  );
  CHECK(sources.hashes("baselines/a.cpp") == a);
  CHECK(sources.hashes("baselines/b.cpp") != b);
  sources.write(
      "glint/train/loss.cpp",
      "// two?\n#include \"glint/train/loss.h\"\n\n  int loss() { return 1; }\r\n"
  );
  CHECK(sources.hashes("baselines/b.cpp") == b);
  sources.write("baselines/a.cpp", "#include \"glint/render/draw.h\"\nGLINT_REGISTER(c())");
  CHECK(sources.hashes("baselines/a.cpp") != a);
  CHECK(sources.hashes("baselines/b.cpp") == b);
  sources.write("glint/render/rays.cpp", "#include \"glint/render/rays.h\"\nlong rays;");
  CHECK(sources.hashes("baselines/b.cpp") != b);
}

TEST_CASE("a pattern without a file is an error that says where it stands") {
  const SmallTree sources;
  CHECK_THROWS_WITH(
      sources.read().matching("metrics/gone.cpp"), Catch::Contains("stage_sources.cpp")
  );
}

// What no root reaches would change results without changing a key.
TEST_CASE("every source of this project that results depend on is behind some key") {
  const SourceTree tree(".");
  Files roots = tree.registering();
  for (const StageSources& stage : stage_sources())
    for (const std::string& pattern : stage.patterns)
      for (const std::string& file : tree.matching(pattern)) roots.push_back(file);
  const Files reached = tree.closure(roots);
  const std::set<std::string> all(reached.begin(), reached.end());
  const std::set<std::string> moves_no_number = {
      "glint/core/file_lock.cpp",           // one process at a time
      "glint/core/interrupt.cpp",           // ends a run
      "glint/core/process.cpp",             // how programs start and end
      "glint/core/rows.cpp",                // listings for people
      "glint/scene/image_files_depth.cpp",  // of others, who are read anew each time
      "glint/scene/camera_path.cpp",        // frames for people
      "glint/scene/camera_path_file.cpp",   // frames for people
      "datasets/check.cpp",                 // finds fault with data
      "datasets/check_geometry.cpp",        // finds fault with data
      "datasets/check_views.cpp"};          // finds fault with data
  for (const char* folder : {"glint/*", "datasets/*", "baselines/*", "metrics/*"})
    for (const std::string& file : tree.matching(std::string(folder) + ".cpp")) {
      const bool is_shown = file.starts_with("glint/drawing/");           // pictures for people
      const bool is_for_others = file.starts_with("datasets/exchange/");  // for other renderers
      if (is_shown || is_for_others || file.starts_with("metrics/tools/") ||
          moves_no_number.contains(file))
        continue;
      INFO(file);
      CHECK(all.contains(file));
    }
}

TEST_CASE("a method's key goes by its own file, not by another method's or a table's") {
  const SourceTree tree(".");
  const Files files = tree.closure({"baselines/2dgs.cpp"});
  const auto has = [&](const char* file) {
    return std::find(files.begin(), files.end(), file) != files.end();
  };
  for (const char* file :
       {"baselines/2dgs.cpp",
        "glint/render/rasterize_cpu.cpp",
        "glint/render/blend.h",
        "glint/train/adam.cpp",
        "glint/train/trainer.cpp"}) {
    INFO(file);
    CHECK(has(file));
  }
  for (const std::string& file : files) {
    INFO(file);
    CHECK_FALSE(file.starts_with("reports/"));
    CHECK_FALSE(file.starts_with("glint/glint"));
    CHECK_FALSE((file.starts_with("baselines/") && file != "baselines/2dgs.cpp"));
  }
}
