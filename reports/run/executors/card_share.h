// SPDX-License-Identifier: MIT
// How the cells of a pool share the GPU: side by side by MPS, where it is to be had, else one after
// the other.
#pragma once

#include <memory>

#include "reports/run/executors/executor.h"
#include "reports/run/executors/mps_server.h"

namespace glint {

// What a short-lived process finds. Whoever asks CUDA itself holds a part of the card until it
// ends, or all of it where the card serves one process at a time, which a pool must not.
struct CardState {
  bool usable = false;
  std::string why_not;    // one line
  std::string name;       // "NVIDIA H100 80GB HBM3"
  double free_bytes = 0;  // of its memory; 0: not known
  std::string said;       // beside that, in lines: warnings
};
// By the words of ExecutorOptions::look_at_card. `settings`: of the process's environment.
CardState look_at_card(
    const std::vector<std::string>& words, const ChildProcess::Words& settings = {}
);

class CardShare {
 public:
  // Looks where `how` asks for a GPU (--device cuda, or auto). Errors (kEnvironment): --device cuda
  // without one.
  explicit CardShare(const ExecutorOptions& how);

  // Before the first cell: by MPS, or in turn; one line says what came of it.
  void begin();

  bool on_gpu() const { return card_.usable; }  // cells that find no GPU then fail
  const std::string& name() const { return card_.name; }
  int jobs() const { return jobs_; }  // cells at a time
  // Of the card, before the first cell; 0: not known.
  double free_bytes() const { return card_.free_bytes; }
  ChildProcess::Words settings() const;  // of the environment of cells
  void heed_end_of_mps();                // if its daemon has ended, cells take turns

 private:
  std::string share_by_mps();
  void take_turns(const std::string& why);

  const ExecutorOptions& how_;
  CardState card_;
  int jobs_;
  std::unique_ptr<MpsServer> server_;  // null: none, or one that was there already
};

}  // namespace glint
