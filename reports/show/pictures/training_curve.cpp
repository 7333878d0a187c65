// SPDX-License-Identifier: MIT
#include "reports/show/pictures/training_curve.h"

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "glint/core/presence.h"
#include "reports/run/records/script_text.h"

namespace glint {

namespace {

struct Step {
  double iteration = 0, seconds = 0, loss = 0, psnr = 0, num_surfels = 0;
  std::vector<std::string> terms;  // of the loss
  Json events;                     // logged since the step before: {"iteration", "text"}
};

// First and last step with something, as indices.
struct Span {
  std::size_t first = 0, last = 0;
};

// What ends in the last of this many parts of a training is taken to last until its end: a term
// of some views only need not be in the very last step.
constexpr std::size_t kEndParts = 20;

double number(const Json& json, const char* name) {
  const auto it = json.find(name);
  return it != json.end() && it->is_number() ? it->get<double>() : std::nan("");
}

std::vector<std::string> term_names(const Json& json) {
  std::vector<std::string> names;
  if (const auto terms = json.find("terms"); terms != json.end() && terms->is_object())
    for (const auto& [name, value] : terms->items()) names.push_back(name);
  return names;
}

std::vector<Step> read_steps(const fs::path& log) {
  std::vector<Step> steps;
  std::istringstream lines(read_file(log));
  for (std::string line; std::getline(lines, line);) {
    const Json json = parse_json(line);
    if (json.is_object() && json.contains("iteration"))
      steps.push_back(
          {number(json, "iteration"),
           number(json, "seconds"),
           number(json, "loss"),
           number(json, "psnr"),
           number(json, "num_surfels"),
           term_names(json),
           json.value("events", Json::array())}
      );
  }
  return steps;
}

double mean_of(
    const std::vector<Step>& steps, std::size_t begin, std::size_t end, double Step::*field
) {
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += steps[i].*field;
  return sum / static_cast<double>(end - begin);
}

std::map<std::string, Span> term_spans(const std::vector<Step>& steps) {
  std::map<std::string, Span> spans;
  for (std::size_t i = 0; i < steps.size(); ++i)
    for (const std::string& term : steps[i].terms)
      spans.emplace(term, Span{i, i}).first->second.last = i;
  return spans;
}

// Steps whose number of surfels is not that of the step before; first 0: there is none.
Span surfel_changes(const std::vector<Step>& steps) {
  Span span;
  for (std::size_t i = 1; i < steps.size(); ++i)
    if (steps[i].num_surfels != steps[i - 1].num_surfels &&
        !std::isnan(steps[i].num_surfels + steps[i - 1].num_surfels))
      span = {span.first > 0 ? span.first : i, i};
  return span;
}

Json training_events(const std::vector<Step>& steps) {
  Json events = Json::array();
  const auto add = [&](std::size_t i, const std::string& text) {
    events.push_back(
        {{"iteration", short_number(steps[i].iteration)},
         {"seconds", short_number(steps[i].seconds)},
         {"text", text}}
    );
  };
  const auto add_span = [&](Span span, const std::string& begins, const std::string& ends) {
    if (span.first > 0) add(span.first, begins);
    if (span.last + 1 + steps.size() / kEndParts < steps.size()) add(span.last, ends);
  };
  for (const Step& step : steps)
    for (const Json& event : step.events)
      if (event.is_object() && event.value("text", Json()).is_string())
        events.push_back(
            {{"iteration", short_number(number(event, "iteration"))},
             {"seconds", short_number(step.seconds)},
             {"text", event["text"]}}
        );
  for (const auto& [term, span] : term_spans(steps))
    add_span(span, term + " loss begins", term + " loss ends");
  if (const Span span = surfel_changes(steps); span.first > 0)
    add_span(span, "first change of the number of surfels", "last change of the number of surfels");
  return events;
}

}  // namespace

Json training_curve(const fs::path& log, std::size_t points) {
  if (!is_file(log)) return nullptr;
  const std::vector<Step> steps = read_steps(log);
  if (steps.empty()) return nullptr;
  Json curve = Json::object();
  const std::size_t count = std::min(points, steps.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * steps.size() / count, end = (i + 1) * steps.size() / count;
    const Step& last = steps[end - 1];
    curve["iteration"].push_back(short_number(last.iteration));
    curve["seconds"].push_back(short_number(last.seconds));
    curve["loss"].push_back(short_number(mean_of(steps, begin, end, &Step::loss)));
    curve["psnr"].push_back(short_number(mean_of(steps, begin, end, &Step::psnr)));
    curve["num_surfels"].push_back(short_number(last.num_surfels));
  }
  curve["events"] = training_events(steps);
  return curve;
}

}  // namespace glint
