// SPDX-License-Identifier: MIT
// NVIDIA's MPS, by which kernels of several processes run on one card at the same time: a daemon
// that processes find by the folder of its pipes (CUDA_MPS_PIPE_DIRECTORY). Processes that find
// none take turns on the card.
#pragma once

#include <optional>
#include <string>

#include "glint/core/files.h"
#include "reports/run/bench/child_process.h"

namespace glint {

// The program that begins and ends MPS, on PATH; it comes with the driver.
inline constexpr const char* kMpsControl = "nvidia-cuda-mps-control";
// Where it lies; empty: not on PATH.
fs::path mps_control();

// Where processes of this environment look for a daemon.
std::string mps_folder();
// The servers (one for each user that has come) of the daemon that this environment with `settings`
// leads to, as it lists them: numbers of processes; before the first client none. Nothing: no
// daemon answers. Takes 10 s at most.
std::optional<std::string> mps_servers(const ChildProcess::Words& settings = {});

// A daemon of this program's own, in a folder of its own. It ends with the object and also when
// this program is killed, and takes the folder with it; clients that are left then have a minute.
// Nothing else on the card is changed.
class MpsServer {
 public:
  // Errors (kEnvironment): not on PATH, cannot be started within 20 s; one line that says why.
  MpsServer();
  ~MpsServer();
  MpsServer(const MpsServer&) = delete;
  MpsServer& operator=(const MpsServer&) = delete;

  // Of the environment of its clients.
  const ChildProcess::Words& settings() const { return settings_; }
  // False: the daemon has ended by itself, or was ended.
  bool is_alive() const;

 private:
  std::string wait_until_ready();

  fs::path folder_;
  ChildProcess::Words settings_;
  std::optional<ChildProcess> keeper_;  // starts the daemon and ends it
  std::string process_;                 // of the daemon; empty: not known
};

}  // namespace glint
