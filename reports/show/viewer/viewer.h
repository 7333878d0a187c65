// SPDX-License-Identifier: MIT
// The viewer: pages in browsers look at runs of one scene, whose frames are rendered here, on the
// thread that calls serve() or between_steps(). The page is reports/show/viewer/web.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/interrupt.h"
#include "reports/show/viewer/frame_pace.h"
#include "reports/show/viewer/path_recorder.h"
#include "reports/show/viewer/viewed_run.h"
#include "reports/show/viewer/web_server.h"

namespace glint {

struct ViewerOptions {
  std::string host = "127.0.0.1";
  int port = 0;        // 0: any that is free
  int iterations = 0;  // of the training that is watched; 0: none
};

class Viewer {
 public:
  // Borrowed: `scene`, whose views are shown, and the runs' methods. Errors: WebServer's.
  Viewer(const ViewerOptions& options, const Scene& scene, std::vector<ViewedRun> runs);
  ~Viewer();

  std::string address() const { return server_->address(); }
  // Until the program is interrupted, or as `ended` says, which is asked ten times a second.
  void serve(const std::function<bool()>& ended = is_interrupted);
  // What is wanted after a step of a training: nothing where nobody looks, a frame for each who
  // moves, and for those at rest a new one as often as costs a twenty-fifth of the time. Waits
  // while somebody has paused the training.
  void between_steps(int iteration);

 private:
  // A page.
  struct Client {
    FramePace pace;
    std::optional<Look> look;
    std::deque<Json> questions;     // "probe", "pick", "path": oldest first
    std::vector<LayerMaps> layers;  // of the last whole frame, a pane each
    std::optional<Look> whole;      // what that frame is of
  };
  struct FrameJob {
    ClientId client;
    FrameKind kind;
    Look look;
    Camera camera;  // of the frame
  };

  HttpAnswer get(const std::string& path, const Query& query) const;
  HttpAnswer photo(const Query& query) const;
  HttpAnswer video(const Query& query) const;
  Json hello() const;
  Json scene_json() const;
  void receive(ClientId client, const std::string& message);
  void take(Client& page, Json message);
  void set_camera(Look& look) const;

  LookLimits limits() const { return {runs_.size(), scene_.train.size(), scene_.test.size()}; }
  const View* snapped_view(const Look& look) const;
  bool work();  // one thing that is wanted; false: nothing is
  void wait();
  bool is_paused() const;
  std::optional<FrameJob> next_frame();
  bool answer_question();
  bool go_on_with_path();
  bool render_frame();
  std::vector<LayerMaps> layers_of(const FrameJob& job);
  std::vector<LayerMaps> unless_moved(const FrameJob& job);
  std::string frame_bytes(
      const FrameJob& job, const std::vector<LayerMaps>& layers, double seconds
  );
  void sent(const FrameJob& job, std::vector<LayerMaps> layers, double seconds);
  Json answer(ClientId client, const Json& question);
  Json of_pixel(ClientId client, const Json& question) const;
  Json probe(const Client& page, const Json& question) const;
  Json pick(const Client& page, const Json& question) const;
  void tell_all(const Json& message);
  void tell_state(int iteration);
  void find_new_layers();

  ViewerOptions options_;
  const Scene& scene_;
  std::vector<ViewedRun> runs_;
  PathRecorder recorder_;
  std::optional<int> iteration_;  // of the training
  ViewerTime state_told_at_, layers_found_at_;
  double layers_seconds_ = 0;  // that it took to look for them

  mutable std::mutex mutex_;  // of what follows
  std::string hello_;
  std::condition_variable wanted_;
  std::map<ClientId, Client> pages_;
  ClientId last_served_ = 0;
  bool paused_ = false;
  std::unique_ptr<WebServer> server_;  // last: its thread ends first
};

}  // namespace glint
