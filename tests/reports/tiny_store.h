// SPDX-License-Identifier: MIT
// Results and data of a small profile, which `all` makes once in a test program.
#pragma once

#include "glint/core/config.h"
#include "glint/core/progress.h"
#include "tests/reports/run_words.h"

namespace glint::test {

// A copy of a small profile's results and data: one run of 2DGS in a room of its own.
class TinyStore {
 public:
  TinyStore() {
    fs::copy(original() / "out", folder_ / "out", fs::copy_options::recursive);
    fs::copy(original() / "data", folder_ / "data", fs::copy_options::recursive);
    edit_json(cell() / "config.json", [&](Json& json) {
      json["dataset_folder"] = room().string();
    });
  }

  fs::path cell() const { return profile() / "runs/room_1/2dgs/0"; }
  fs::path profile() const { return folder_ / "out/tiny"; }
  fs::path room() const {
    for (const auto& entry : fs::directory_iterator(folder_ / "data/glassroom"))
      return entry.path();
    return {};
  }

  static void edit_json(const fs::path& file, const std::function<void(Json&)>& edit) {
    Json json = read_json_object(file);
    edit(json);
    write_file(file, json.dump(1) + "\n");
  }
  fs::path profile_file() const { return original() / "tiny.toml"; }
  fs::path path() const { return folder_.path(); }

 private:
  static const fs::path& original() {
    static const TempFolder folder;
    static const bool made = [] {
      set_quiet(true);
      write_file(
          folder / "tiny.toml",
          "iterations = 3\nmethods = [\"2dgs\"]\ntiming_frames = 1\ntiming_warmup = 0\n"
          "scenes = [\"room_1\"]\n[defaults]\nwidth = 48\nheight = 27\nviews = 16\nspp = 4\n"
          "[mesh]\nvoxel = 0.1\n[mesh_metrics]\nnum_samples = 5000\n"
      );
      const std::string text = captured(1, [] {
        REQUIRE(
            run(
                {"all",
                 "--executor",
                 "inline",
                 "--profile",
                 folder / "tiny.toml",
                 "--out",
                 folder / "out",
                 "--data",
                 folder / "data",
                 "--quiet"}
            ) == 0
        );
      });
      return !text.empty();
    }();
    REQUIRE(made);
    return folder.path();
  }

  TempFolder folder_;
};

}  // namespace glint::test
