// SPDX-License-Identifier: MIT
#include "reports/run/executors/card_share.h"

#include <sstream>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/progress.h"
#include "glint/cuda/card_lock.h"

namespace glint {
namespace {

constexpr double kLookSeconds = 120;  // drivers that were not loaded yet take a while

// The last line that says something; without "error: " in front.
std::string last_words(const std::string& output) {
  std::istringstream lines(output);
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) last = line;
  constexpr std::string_view kError = "error: ";
  return last.starts_with(kError) ? last.substr(kError.size()) : last;
}

// From the document that `doctor --card --json` prints, whatever its exit code; warnings stand in
// front of it.
CardState state_in(const std::string& output) {
  const std::size_t begin = output.find('{');
  const Json json = parse_json(begin == std::string::npos ? "" : output.substr(begin));
  const Json card = json.is_object() ? json.value("cuda", Json::object()) : Json();
  if (!card.is_object()) {
    const std::string last = last_words(output);
    return {false, last.empty() ? "the process that looked at it ended without a word" : last};
  }
  return {
      card.value("usable", false),
      card.value("why_not", ""),
      card.value("name", ""),
      card.value("free_bytes", 0.0),
      output.substr(0, begin)};
}

}  // namespace

CardState look_at_card(const std::vector<std::string>& words, const ChildProcess::Words& settings) {
  const auto result = run_command(words, settings, kLookSeconds);
  return result ? state_in(result->output) : CardState{false, words.at(0) + " cannot be started"};
}

CardShare::CardShare(const ExecutorOptions& how) : how_(how), jobs_(how.jobs) {
  if (how.look_at_card.empty()) return;
  card_ = look_at_card(how.look_at_card);
  GLINT_CHECK(
      card_.usable || !how.on_gpu,
      kEnvironment,
      "--device cuda: {}; use --device cpu",
      card_.why_not
  );
}

void CardShare::begin() {
  if (jobs_ == 1) return;  // the cell will say what there is to say
  log::text(card_.said);
  if (!on_gpu() && !card_.why_not.empty()) log::info("on the CPU: " + card_.why_not);
  if (!on_gpu()) return;
  const std::string why = share_by_mps();
  if (!why.empty()) take_turns(why);
}

// Why not; empty: it is shared.
std::string CardShare::share_by_mps() try {
  const bool was_there = mps_servers().has_value();
  if (!was_there) server_ = std::make_unique<MpsServer>();
  // A client that finds no daemon goes on without, so it is the daemon that knows.
  const CardState card = look_at_card(how_.look_at_card, settings());
  if (!card.usable) return "the first process of MPS found no card: " + card.why_not;
  const auto servers = mps_servers(settings());
  if (!servers || servers->empty()) return "MPS does not serve this card";
  card_.free_bytes = card.free_bytes;
  log::info(fmt::format(
      "{} cells at a time on one GPU, by MPS{}",
      jobs_,
      was_there ? fmt::format(" (the daemon of {})", mps_folder()) : ""
  ));
  return "";
} catch (const Error& error) {
  return error.what();
}

void CardShare::take_turns(const std::string& why) {
  server_.reset();
  jobs_ = 1;
  log::warn(fmt::format("--jobs {}: cells take turns on the GPU: {}", how_.jobs, why));
}

ChildProcess::Words CardShare::settings() const {
  ChildProcess::Words all;
  if (server_) all = server_->settings();
  if (on_gpu() && jobs_ > 1) all.push_back(fmt::format("{}={}", gpu::kCardJobs, jobs_));
  return all;
}

void CardShare::heed_end_of_mps() {
  if (server_ && !server_->is_alive()) take_turns("the daemon of MPS has ended");
}

}  // namespace glint
