// SPDX-License-Identifier: MIT
// `audit` passes a method that trains to the same bytes, and finds those that do not.
#include <catch2/catch.hpp>

#include "glint/core/parallel.h"
#include "reports/provenance/audit.h"
#include "tests/reports/fake_method.h"
#include "tests/reports/run_words.h"
#include "tests/support/small_room.h"

using namespace glint;

namespace {

// Renders one grey; which one, depends on what it should not.
class GreyMethod final : public Method {
 public:
  explicit GreyMethod(std::function<float()> grey) : grey_of_(std::move(grey)) {}
  void initialize(const Scene&, const RunOptions&) override { grey_ = grey_of_(); }
  StepStats step(int iteration) override {
    StepStats stats;
    stats.iteration = iteration;
    return stats;
  }
  MapSet render(const Camera& camera) override {
    MapSet output;
    output["rgb"] = Image(camera.width, camera.height, 3, grey_);
    output["depth"] = Image(camera.width, camera.height, 1, 2.0f);
    return output;
  }
  void save(const std::string& folder) const override {
    write_file(fs::path(folder) / "grey.txt", fmt::format("{}", grey_));
  }
  void load(const std::string&) override {}
  Json config() const override { return Json::object(); }
  void check_finite() const override {}
  std::size_t num_surfels() const override { return 1; }

 private:
  std::function<float()> grey_of_;
  float grey_ = 0;
};

void register_grey(const std::string& id, std::function<float()> grey) {
  MethodSpec spec;
  spec.id = spec.title = id;
  spec.create = [grey](const Json&) { return std::make_unique<GreyMethod>(grey); };
  Registry<MethodSpec>::add(spec, "");
}

void register_grey_methods() {
  static bool registered = false;
  if (std::exchange(registered, true)) return;
  static int trainings = 0;
  register_grey("grey/steady", [] { return 0.5f; });
  register_grey("grey/drifting", [] {
    return 0.5f + 0.125f * static_cast<float>(trainings++ % 2);
  });
  register_grey("grey/threads", [] { return num_threads() == 1 ? 0.25f : 0.5f; });
  register_grey("grey/failing", []() -> float { throw std::runtime_error("no such luck"); });
}

struct Audit {
  Audit() { register_grey_methods(); }

  AuditedMethod of(const std::string& method) {
    AuditOptions options;
    options.run.iterations = 2;
    options.folder = folder.path();
    return audit_method(method, Json::object(), fake_scene("room_1"), options);
  }

  test::TempFolder folder;
};

}  // namespace

TEST_CASE("a method that trains to the same bytes passes") {
  const AuditedMethod found = Audit().of("grey/steady");
  CHECK(found.same_bytes());
  REQUIRE(found.runs.size() >= 2);  // again, and with another number of threads
  CHECK(found.runs[0].files > 3);
  CHECK(found.runs[0].maps.empty());
  CHECK(found.spread.empty());
}

TEST_CASE("a method that drifts is found, with how far its maps and metrics are apart") {
  const AuditedMethod found = Audit().of("grey/drifting");
  CHECK_FALSE(found.same_bytes());
  const AuditedRun& again = found.runs.at(0);
  CHECK(again.name == "again");
  CHECK(
      std::find(again.differing.begin(), again.differing.end(), "grey.txt") != again.differing.end()
  );
  REQUIRE(again.maps.contains("rgb"));
  CHECK(again.maps.at("rgb").max == 0.125);
  CHECK(again.maps.at("rgb").rms == Approx(0.125));
  CHECK_FALSE(again.maps.contains("depth"));
  CHECK(found.spread.contains("psnr"));
}

TEST_CASE("a method whose result depends on the threads is found, and they are set back") {
  const int threads = num_threads();
  set_num_threads(2);
  const AuditedMethod found = Audit().of("grey/threads");
  CHECK(num_threads() == 2);
  set_num_threads(threads);
  CHECK(found.runs.at(0).differing.empty());
  CHECK(found.runs.at(1).name == "1 thread");
  CHECK_FALSE(found.runs.at(1).differing.empty());
}

TEST_CASE("a method that cannot be trained says so") {
  const AuditedMethod found = Audit().of("grey/failing");
  CHECK_FALSE(found.same_bytes());
  CHECK(found.failure == "no such luck");
}

TEST_CASE("the verb exits with 4 where bytes differ") {
  register_grey_methods();
  int code = 0;
  const auto audit = [&](const std::string& methods) {
    return parse_json(test::captured(1, [&] {
      code = test::run(
          {"audit",
           "--methods",
           methods,
           "--iterations",
           "2",
           "--dataset",
           test::small_room_folder(),
           "--json",
           "--quiet",
           "--device",
           "cpu"}
      );
    }));
  };
  const Json good = audit("grey/steady,2dgs");
  CHECK(code == 0);
  CHECK(good["methods"].size() == 2);
  CHECK(good["methods"][0]["verdict"] == "ok");
  const Json bad = audit("grey/steady,grey/drifting,grey/failing");
  CHECK(code == 4);
  CHECK(bad["methods"][1]["verdict"] == "BAD");
  CHECK(bad["methods"][1]["runs"][0]["maps"]["rgb"]["max"] == 0.125);
  CHECK(bad["methods"][2]["failure"] == "no such luck");
  audit("nosuch");
  CHECK(code == 1);
}
