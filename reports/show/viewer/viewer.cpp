// SPDX-License-Identifier: MIT
#include "reports/show/viewer/viewer.h"

#include <cstring>

#include "glint/core/stoppable.h"
#include "glint/scene/camera_path.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr auto kLongestWait = std::chrono::milliseconds(100);  // Ctrl-C is noticed then
constexpr double kTrainingShare = 0.025;  // of a training's time for those who look at rest
constexpr double kLayersShare = 0.005;    // of it for looking which layers there are
constexpr std::size_t kMaxQuestions = 8;
constexpr auto kStateInterval = std::chrono::milliseconds(500);

double seconds_since(ViewerTime start) {
  return std::chrono::duration<double>(ViewerClock::now() - start).count();
}

std::string type_of(const Json& message) {
  const Json type = message.is_object() ? message.value("type", Json()) : Json();
  return type.is_string() ? type.get<std::string>() : "";
}

Json error_message(const std::exception& error) {
  return {{"type", "error"}, {"message", error.what()}};
}

// How long the header is (32 bits, low byte first), the header, the pictures.
std::string packed_frame(const Json& header, const std::vector<std::string>& pictures) {
  const std::string text = header.dump();
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(length >> shift & 0xff);
  bytes += text;
  for (const std::string& picture : pictures) bytes += picture;
  return bytes;
}

}  // namespace

Viewer::Viewer(const ViewerOptions& options, const Scene& scene, std::vector<ViewedRun> runs)
    : options_(options), scene_(scene), runs_(std::move(runs)) {
  hello_ = hello().dump();
  WebHandlers handlers;
  handlers.get = [this](const std::string& path, const Query& query) { return get(path, query); };
  handlers.opened = [this](ClientId client) {
    const std::lock_guard lock(mutex_);
    pages_[client];
    server_->send_text(client, hello_);
  };
  handlers.closed = [this](ClientId client) {
    const std::lock_guard lock(mutex_);
    pages_.erase(client);
    if (pages_.empty()) paused_ = false;  // nobody is left who could go on
  };
  handlers.text = [this](ClientId client, const std::string& message) { receive(client, message); };
  const std::lock_guard lock(mutex_);  // nobody is served before there is a server
  server_ =
      open_web_server(WebOptions{options.host, options.port, random_token()}, std::move(handlers));
}

Viewer::~Viewer() { server_.reset(); }

void Viewer::receive(ClientId client, const std::string& message) {
  const std::lock_guard lock(mutex_);
  const auto page = pages_.find(client);
  if (page == pages_.end()) return;
  try {
    take(page->second, parse_json(message));
  } catch (const Error& error) {
    server_->send_text(client, error_message(error).dump());
  }
  wanted_.notify_one();
}

void Viewer::take(Client& page, Json message) {
  const std::string type = type_of(message);
  if (type == "look") {
    Look look = look_from_json(message, limits());
    set_camera(look);
    page.pace.looked(look.serial, ViewerClock::now());
    page.look = std::move(look);
  } else if (type == "shown") {
    const Json serial = message.value("serial", Json());
    if (serial.is_number_unsigned()) page.pace.shown(serial.get<std::uint64_t>());
  } else if (type == "pause") {
    paused_ = options_.iterations > 0 && message.value("paused", Json()) == true;
  } else if (type == "probe" || type == "pick" || type == "path") {
    if (page.questions.size() == kMaxQuestions) page.questions.pop_front();
    page.questions.push_back(std::move(message));
  } else {
    throw Error(ExitCode::kUsage, fmt::format("type: '{}' is none of this viewer's", type));
  }
}

const View* Viewer::snapped_view(const Look& look) const {
  if (!look.view) return nullptr;
  return &(look.view->test ? scene_.test : scene_.train)[look.view->index];
}

void Viewer::set_camera(Look& look) const {
  if (const View* view = snapped_view(look)) look.camera = view->camera;
}

void Viewer::serve(const std::function<bool()>& ended) {
  while (!ended())
    if (!work()) wait();
}

void Viewer::between_steps(int iteration) {
  iteration_ = iteration;
  {
    const std::lock_guard lock(mutex_);
    if (pages_.empty()) return;
    for (auto& [client, page] : pages_) page.pace.model_changed(kTrainingShare, ViewerClock::now());
  }
  find_new_layers();
  tell_state(iteration);
  while (work()) {
  }
  while (is_paused() && !is_interrupted()) {
    tell_state(iteration);
    if (!work()) wait();
  }
}

bool Viewer::is_paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

// As often as costs little; every page is told.
void Viewer::find_new_layers() {
  if (seconds_since(layers_found_at_) * kLayersShare < layers_seconds_) return;
  layers_found_at_ = ViewerClock::now();
  bool changed = false;
  for (ViewedRun& run : runs_) changed = run.find_layers() || changed;
  layers_seconds_ = seconds_since(layers_found_at_);
  if (!changed) return;
  const Json message = hello();
  {
    const std::lock_guard lock(mutex_);
    hello_ = message.dump();
  }
  tell_all(message);
}

bool Viewer::work() { return render_frame() || answer_question() || go_on_with_path(); }

bool Viewer::go_on_with_path() {
  if (!recorder_.busy()) return false;
  try {
    tell_all(recorder_.step());
  } catch (const Error& error) {
    tell_all(error_message(error));
  }
  return true;
}

void Viewer::wait() {
  std::unique_lock lock(mutex_);
  ViewerTime until = ViewerClock::now() + kLongestWait;
  for (const auto& [client, page] : pages_) {
    if (!page.questions.empty() || page.pace.due(ViewerClock::now()) != FrameKind::kNone) return;
    if (const auto at = page.pace.whole_at()) until = std::min(until, *at);
  }
  wanted_.wait_until(lock, until);
}

// Those who move first, in turn.
std::optional<Viewer::FrameJob> Viewer::next_frame() {
  const std::lock_guard lock(mutex_);
  const ViewerTime now = ViewerClock::now();
  for (const FrameKind kind : {FrameKind::kMoving, FrameKind::kWhole}) {
    auto at = pages_.upper_bound(last_served_);
    for (std::size_t i = 0; i < pages_.size(); ++i, ++at) {
      if (at == pages_.end()) at = pages_.begin();
      const auto& [client, page] = *at;
      if (page.pace.due(now) != kind) continue;
      last_served_ = client;
      FrameJob job{client, kind, *page.look, page.look->camera};
      if (kind == FrameKind::kMoving)
        job.camera = resized(job.camera, page.pace.moving_size(job.camera.size()));
      return job;
    }
  }
  return {};
}

std::vector<LayerMaps> Viewer::layers_of(const FrameJob& job) {
  const bool whole = job.kind == FrameKind::kWhole;
  std::vector<LayerMaps> layers;
  for (const LookPane& pane : job.look.panes) {
    const bool again = !layers.empty() && pane.run == job.look.panes[0].run;
    ViewedRun& run = runs_[pane.run];
    if (again && (whole || layers[0].contains(pane.layer)))
      layers.push_back(layers[0]);
    else if (whole)
      layers.push_back(run.layers(job.look, job.camera, snapped_view(job.look)));
    else
      layers.push_back(run.layers_for(pane.layer, job.look, job.camera));
  }
  return layers;
}

std::string Viewer::frame_bytes(
    const FrameJob& job, const std::vector<LayerMaps>& layers, double seconds
) {
  const bool whole = job.kind == FrameKind::kWhole;
  const ImageSize size = job.camera.size();
  std::vector<std::string> pictures;
  std::size_t surfels = 0;
  Json lengths = Json::array();
  for (std::size_t i = 0; i < layers.size(); ++i) {
    ViewedRun& run = runs_[job.look.panes[i].run];
    const Image picture = run.picture(layers[i], job.look.panes[i].layer, size);
    pictures.push_back(jpeg_bytes(to_bytes(picture), whole ? kWholeQuality : kMovingQuality));
    lengths.push_back(pictures.back().size());
    surfels = std::max(surfels, run.method().num_surfels());
  }
  Json header = {
      {"type", "frame"},
      {"serial", job.look.serial},
      {"whole", whole},
      {"size", {size.width, size.height}},
      {"ms", 1e3 * seconds},
      {"pixels_per_second", static_cast<double>(size.num_pixels()) / std::max(seconds, 1e-6)},
      {"images", lengths},
      {"surfels", surfels},
      {"iteration", iteration_ ? Json(*iteration_) : Json()}};
  return packed_frame(header, pictures);
}

void Viewer::sent(const FrameJob& job, std::vector<LayerMaps> layers, double seconds) {
  const std::lock_guard lock(mutex_);
  const auto page = pages_.find(job.client);
  if (page == pages_.end()) return;
  page->second.pace.sent(job.kind, job.look.serial, job.camera.size(), seconds, ViewerClock::now());
  if (job.kind != FrameKind::kWhole) return;
  page->second.layers = std::move(layers);
  page->second.whole = job.look;
}

// A whole frame gives way to a move.
std::vector<LayerMaps> Viewer::unless_moved(const FrameJob& job) {
  const std::function<bool()> moved = [&] {
    const std::lock_guard lock(mutex_);
    const auto page = pages_.find(job.client);
    return page == pages_.end() || page->second.look->serial != job.look.serial;
  };
  std::optional<StoppableLoops> stoppable;
  if (job.kind == FrameKind::kWhole) stoppable.emplace(moved);
  return layers_of(job);
}

bool Viewer::render_frame() {
  const auto job = next_frame();
  if (!job) return false;
  const auto start = ViewerClock::now();
  try {
    std::vector<LayerMaps> layers = unless_moved(*job);
    std::string frame = frame_bytes(*job, layers, seconds_since(start));
    // Counted with colours and JPEG, for these take their time, too.
    sent(*job, std::move(layers), seconds_since(start));
    server_->send_bytes(job->client, std::move(frame));
  } catch (const LoopsStopped&) {  // the look that came is due
  } catch (const Error& error) {
    sent(*job, {}, seconds_since(start));
    server_->send_text(job->client, error_message(error).dump());
    const std::lock_guard lock(mutex_);
    if (const auto page = pages_.find(job->client); page != pages_.end())
      page->second.pace.shown(job->look.serial);
  }
  return true;
}

bool Viewer::answer_question() {
  std::optional<std::pair<ClientId, Json>> asked;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [client, page] : pages_) {
      if (page.questions.empty()) continue;
      asked.emplace(client, std::move(page.questions.front()));
      page.questions.pop_front();
      break;
    }
  }
  if (!asked) return false;
  Json told;
  try {
    told = answer(asked->first, asked->second);
  } catch (const Error& error) {
    told = error_message(error);
  }
  server_->send_text(asked->first, told.dump());
  return true;
}

Json Viewer::answer(ClientId client, const Json& question) {
  if (type_of(question) != "path") return of_pixel(client, question);
  GLINT_CHECK(options_.iterations == 0, kUsage, "path: after the training");
  const Json run = question.value("run", Json(0u));
  GLINT_CHECK(
      run.is_number_unsigned() && run.get<std::size_t>() < runs_.size(),
      kUsage,
      "run: {}, expected one of {}",
      run.dump(),
      runs_.size()
  );
  return recorder_.begin(question, runs_[run.get<std::size_t>()], scene_);
}

Json Viewer::of_pixel(ClientId client, const Json& question) const {
  const std::lock_guard lock(mutex_);
  const auto page = pages_.find(client);
  const bool any = page != pages_.end() && page->second.whole && !page->second.layers.empty();
  GLINT_CHECK(any, kUsage, "{}: no whole frame yet", type_of(question));
  return type_of(question) == "probe" ? probe(page->second, question)
                                      : pick(page->second, question);
}

void Viewer::tell_all(const Json& message) {
  const std::lock_guard lock(mutex_);
  for (const auto& [client, page] : pages_) server_->send_text(client, message.dump());
}

void Viewer::tell_state(int iteration) {
  const ViewerTime now = ViewerClock::now();
  if (now - state_told_at_ < kStateInterval) return;
  state_told_at_ = now;
  tell_all({{"type", "state"}, {"iteration", iteration}, {"paused", is_paused()}});
}

}  // namespace glint
