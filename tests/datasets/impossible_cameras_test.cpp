// SPDX-License-Identifier: MIT
// Poses and lenses that cannot be are told, whatever file they come from.
#include <catch2/catch.hpp>
#include <functional>

#include "datasets/dataset.h"
#include "datasets/findings.h"
#include "glint/core/config.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

// A capture of pictures alone: nothing but its file says where its cameras are.
struct Capture : TempFolder {
  Capture() { write_nerfstudio(path(), box_room_views(8, {48, 36})); }

  std::string error_after(const std::function<void(Json&)>& edit) const {
    const fs::path file = path() / "transforms.json";
    const std::string text = read_file(file);
    Json json = parse_json(text);
    edit(json);
    write_file(file, json.dump());
    const std::string error = bad_reference([&] { load_scene(path(), {}); });
    CHECK_FALSE(check_dataset(path()).empty());
    write_file(file, text);
    return error;
  }
};

Json transposed(const Json& matrix) {
  Json result = matrix;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) result[i][j] = matrix[j][i];
  return result;
}

}  // namespace

TEST_CASE("matrices of another form are errors that name the frame and say what was found") {
  const Capture capture;
  const auto error_of_matrix = [&](const std::function<void(Json&)>& edit) {
    return capture.error_after([&](Json& json) { edit(json["frames"][2]["transform_matrix"]); });
  };
  const std::string error = error_of_matrix([](Json& matrix) { matrix = transposed(matrix); });
  CHECK_THAT(error, Contains("frame 2") && Contains("transposed?") && Contains("last row is"));
  CHECK_THAT(
      error_of_matrix([](Json& matrix) {
        matrix.push_back({0, 0, 0, 1});
      }),
      Contains("4 x 4")
  );
  CHECK_THAT(error_of_matrix([](Json& matrix) { matrix[3][3] = 2; }), Contains("0 0 0 1"));
}

TEST_CASE("fields of another type are errors, not fields that are not there") {
  const Capture capture;
  const auto error_with = [&](const char* key, const Json& value) {
    return capture.error_after([&](Json& json) { json[key] = value; });
  };
  CHECK_THAT(error_with("ply_file_path", 5), Contains("ply_file_path is 5, expected a text"));
  CHECK_THAT(error_with("camera_model", 3), Contains("camera_model: expected a text"));
  CHECK_THAT(
      capture.error_after([](Json& json) {
        for (Json& frame : json["frames"]) frame["fl_x"] = 0;
      }),
      Contains("fl_x is 0, expected pixels above 0")
  );
}

TEST_CASE("focal lengths that no lens has are found in every file") {
  Camera camera = box_room_views(2, {48, 36})[0].camera;
  CHECK_FALSE(camera_problem(camera, "here"));
  for (const double focal : {1e-30, 0.5, 1e4}) {
    camera.fx = camera.fy = focal;
    const auto problem = camera_problem(camera, "here");
    REQUIRE(problem);
    CHECK_THAT(problem->message, Contains("field of view"));
  }
}

TEST_CASE("cameras that all stand in one point are found") {
  const Capture capture;
  const fs::path file = capture.path() / "transforms.json";
  Json json = parse_json(read_file(file));
  for (Json& frame : json["frames"])
    for (std::size_t i = 0; i < 3; ++i) frame["transform_matrix"][i][3] = 1;
  write_file(file, json.dump());
  const std::vector<Finding> findings = check_dataset(capture.path());
  CHECK(std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.message.find("all 8 cameras stand in one point") != std::string::npos;
  }));
}
