// SPDX-License-Identifier: MIT
// The viewer with a fake method, seen by a client of its protocol.
#include "reports/show/viewer/viewer.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "glint/core/config.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"
#include "tests/support/web_client.h"

using namespace glint;
using namespace glint::test;
using Catch::Matchers::Contains;

namespace {

struct Frame {
  Json header;
  std::vector<std::string> pictures;
};

Frame frame_of(const std::string& bytes) {
  std::uint32_t length = 0;
  for (int i = 3; i >= 0; --i)
    length = length << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
  Frame frame{Json::parse(bytes.substr(4, length)), {}};
  std::size_t at = 4 + length;
  for (const Json& size : frame.header["images"]) {
    frame.pictures.push_back(bytes.substr(at, size.get<std::size_t>()));
    at += size.get<std::size_t>();
  }
  CHECK(at == bytes.size());
  return frame;
}

Json look(int serial, const char* layer = "rgb") {
  return {
      {"type", "look"},
      {"serial", serial},
      {"size", {64, 48}},
      {"camera",
       {{"world_from_cam", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}},
        {"fov_x", 60}}},
      {"panes", {{{"run", 0}, {"layer", layer}}}}};
}

// A page in a test: what it is sent, by kind.
class Page {
 public:
  explicit Page(const std::string& address) {
    const std::size_t colon = address.rfind(':'), slash = address.find('/', colon);
    port_ = std::stoi(address.substr(colon + 1, slash - colon - 1));
    query_ = address.substr(slash + 1);
    socket_ = std::make_unique<WebPage>(port_, "/ws" + query_);
  }
  Json message(const std::string& type) {
    while (auto bytes = socket_->read())
      if (socket_->was_text())
        if (Json json = Json::parse(*bytes); json["type"] == type) return json;
    FAIL("no " + type);
    return {};
  }
  Frame frame() {
    while (auto bytes = socket_->read())
      if (!socket_->was_text()) return frame_of(*bytes);
    FAIL("no frame");
    return {};
  }
  void say(const Json& json) { socket_->send(json.dump()); }
  void shown(const Frame& frame) { say({{"type", "shown"}, {"serial", frame.header["serial"]}}); }
  WebReply get(const std::string& path) const {
    return ask(port_, {path + "&" + query_.substr(1), ""});
  }
  bool quiet(double seconds) { return !socket_->read(seconds).has_value(); }

 private:
  int port_ = 0;
  std::string query_;
  std::unique_ptr<WebPage> socket_;
};

// Serves in a thread of its own while it lives.
struct Served {
  Scene scene = fake_scene("room_1");
  FakeMethod method{Json::object()};
  TempFolder folder;
  std::unique_ptr<Viewer> viewer;
  std::atomic<bool> ended{false};
  std::thread thread;

  explicit Served(int iterations = 0) {
    std::vector<ViewedRun> runs;
    runs.emplace_back(
        ViewedRun::Names{"fake (seed 0)", "fake", "fake", folder.path()},
        method,
        scene,
        iterations > 0
    );
    viewer =
        std::make_unique<Viewer>(ViewerOptions{"127.0.0.1", 0, iterations}, scene, std::move(runs));
    if (iterations == 0)
      thread = std::thread([this] { viewer->serve([this] { return ended.load(); }); });
  }
  ~Served() {
    ended = true;
    if (thread.joinable()) thread.join();
  }
};

}  // namespace

TEST_CASE("a page is told what there is") {
  const Served served;
  Page page(served.viewer->address());
  const Json hello = page.message("hello");
  CHECK(hello["scene"]["name"] == "room_1");
  CHECK(hello["size"] == Json({16, 12}));
  CHECK(hello["views"].size() == 4);
  CHECK(hello["training"].is_null());
  const Json& run = hello["runs"][0];
  CHECK(run["name"] == "fake (seed 0)");
  std::vector<std::string> layers;
  for (const Json& layer : run["layers"]) layers.push_back(layer["id"]);
  CHECK(layers == std::vector<std::string>{"rgb", "error", "depth", "transparency", "interface"});
}

TEST_CASE("a look brings a small frame, rest a whole one, and values of its pixels") {
  const Served served;
  Page page(served.viewer->address());
  page.say(look(1, "depth"));
  const Frame small = page.frame();
  CHECK(small.header["whole"] == false);
  CHECK(small.header["serial"] == 1);
  CHECK(small.pictures[0].substr(0, 2) == "\xff\xd8");
  page.shown(small);
  const Frame whole = page.frame();
  CHECK(whole.header["whole"] == true);
  CHECK(whole.header["size"] == Json({64, 48}));
  page.shown(whole);
  page.say({{"type", "probe"}, {"serial", 9}, {"x", 0.5}, {"y", 0.999}});
  const Json probe = page.message("probe");
  CHECK(probe["serial"] == 9);
  CHECK(probe["x"] == 32);
  CHECK(probe["y"] == 47);
  CHECK(probe["panes"][0]["values"]["depth"] == 2.0);
  CHECK(probe["panes"][0]["values"]["rgb"][0] == 0.5);
  CHECK(probe["truth"].is_null());
  page.say({{"type", "pick"}, {"x", 0.5}, {"y", 0.5}});
  CHECK(page.message("pick")["point"][2] == Approx(2));
}

TEST_CASE("a snapped view has its own size, its truth, and what its mask changes") {
  const Served served;
  Page page(served.viewer->address());
  Json snapped = look(1, "error");
  snapped["view"] = {{"split", "test"}, {"index", 0}};
  page.say(snapped);
  page.shown(page.frame());
  const Frame whole = page.frame();
  CHECK(whole.header["size"] == Json({16, 12}));
  page.shown(whole);
  page.say({{"type", "probe"}, {"serial", 1}, {"x", 0.1}, {"y", 0.1}});
  const Json probe = page.message("probe");
  CHECK(probe["panes"][0]["values"]["error"] == Approx(0.1));
  CHECK(probe["panes"][0]["values"]["transparency"] == Approx(FakeMethod::kTransparencyOfViews));
  CHECK(probe["truth"]["depth"] == 2.5);
  const WebReply photo = page.get("/photo?split=test&index=0");
  CHECK(photo.status == 200);
  CHECK(photo.type == "image/jpeg");
  CHECK(page.get("/photo?split=test&index=9").status == 404);
  CHECK(page.get("/photo?split=test&index=-1").status == 404);
  CHECK(page.get("/none?x=1").status == 404);
}

TEST_CASE("a page that draws nothing gets nothing more, others do") {
  const Served served;
  Page slow(served.viewer->address()), fast(served.viewer->address());
  slow.message("hello");
  for (int serial = 1; serial <= 50; ++serial) slow.say(look(serial));
  slow.frame();
  for (int serial = 51; serial <= 100; ++serial) slow.say(look(serial));
  fast.say(look(1));
  fast.shown(fast.frame());
  CHECK(fast.frame().header["whole"] == true);
  CHECK(slow.quiet(0.5));
}

TEST_CASE("what cannot be understood is answered, and the page goes on") {
  const Served served;
  Page page(served.viewer->address());
  for (const Json& bad :
       {Json{{"type", "fly"}},
        Json{{"type", "look"}},
        Json::array(),
        Json{{"type", "look"}, {"serial", "x"}},
        Json{{"type", "probe"}, {"x", 0}, {"y", 0}},
        Json{{"type", "path"}, {"name", "../x"}, {"cameras", Json::array()}},
        Json{{"type", "path"}, {"name", "x"}, {"run", 7}}}) {
    page.say(bad);
    CHECK_FALSE(page.message("error")["message"].get<std::string>().empty());
  }
  page.say(look(1));
  CHECK(page.frame().header["serial"] == 1);
}

TEST_CASE("a path becomes a file that render reads") {
  const Served served;
  Page page(served.viewer->address());
  const Json camera = camera_to_json(served.scene.train[0].camera);
  page.say(
      {{"type", "path"}, {"name", "tour"}, {"run", 0}, {"fps", 12}, {"cameras", {camera, camera}}}
  );
  const Json told = page.message("path");
  CHECK_THAT(told["command"].get<std::string>(), Contains("glint-bench render --run"));
  const CameraPath path = read_camera_path(told["file"].get<std::string>(), {});
  CHECK(path.cameras.size() == 2);
  CHECK(path.fps == 12);
}

TEST_CASE("a video is made between other frames, and without ffmpeg its reason is told") {
  const Served served;
  Page page(served.viewer->address());
  const Json camera = camera_to_json(served.scene.train[0].camera);
  page.say(
      {{"type", "path"}, {"name", "tour"}, {"video", true}, {"cameras", {camera, camera, camera}}}
  );
  Json told;
  do told = page.message("video");
  while (told["file"].is_null() && told["error"].is_null());
  CHECK(told["done"] == 3);
  CHECK(fs::exists(served.folder / "paths/tour/rgb/0002.png"));
  if (told["error"].is_null()) CHECK(page.get("/video?name=tour").status == 200);
}

TEST_CASE("a training is watched between its steps, and paused") {
  Served served(100);
  served.viewer->between_steps(1);  // nobody looks
  std::thread training([&] {
    for (int step = 2; !served.ended; ++step) {
      served.viewer->between_steps(step);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  {
    Page page(served.viewer->address());
    CHECK(page.message("hello")["training"]["iterations"] == 100);
    page.say(look(1));
    Frame frame = page.frame();
    page.shown(frame);
    const int first = frame.header["iteration"];
    do page.shown(frame = page.frame());
    while (frame.header["iteration"] <= first);
    CHECK(frame.header["whole"] == true);
    page.say({{"type", "pause"}, {"paused", true}});
    Json state;
    do state = page.message("state");
    while (state["paused"] != true);
    page.say({{"type", "pause"}, {"paused", false}});
    do state = page.message("state");
    while (state["paused"] != false);
    page.say({{"type", "path"}, {"name", "x"}});
    CHECK_THAT(page.message("error")["message"].get<std::string>(), Contains("after the training"));
    page.say({{"type", "pause"}, {"paused", true}});
  }
  served.ended = true;  // a page that leaves lets the training go on
  training.join();
}
