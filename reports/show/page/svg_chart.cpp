// SPDX-License-Identifier: MIT
#include "reports/show/page/svg_chart.h"

#include <algorithm>
#include <cmath>

#include "reports/run/records/script_text.h"

namespace glint {
namespace {

// Pixels. The legend stands right of the axes.
constexpr double kWidth = 770, kLeast = 280, kLeft = 62, kRight = 480, kTop = 16, kBottom = 232;
constexpr double kEnd = 40;    // from the axes' ends to the first and the last tick
constexpr double kBeside = 7;  // between points of two series at one place
constexpr int kYTicks = 4;     // parts of the y axis
constexpr double kLegendLine = 18;

// Okabe and Ito, safe for colour-blind readers, without the yellow, which is faint on white.
constexpr const char* kColors[] = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#222222"};
constexpr const char* kDashes[] = {"", "6 3", "2 2", "8 3 2 3"};

std::string color_of(std::size_t index) { return kColors[index % std::size(kColors)]; }

std::string dashes_of(std::size_t index) {
  const std::string dashes = kDashes[index / std::size(kColors) % std::size(kDashes)];
  return dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes);
}

std::string line(double x1, double y1, double x2, double y2, std::string_view more) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2, more
  );
}

std::string text(double x, double y, std::string_view words, std::string_view more) {
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, more, html_text(words)
  );
}

class Painter {
 public:
  explicit Painter(const SvgChart& chart) : chart_(chart) {}

  std::string paint() const {
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
        "width=\"{0:.0f}\" "
        "height=\"{1:.0f}\" role=\"img\" aria-label=\"{2}\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
        kWidth,
        height(),
        html_text(chart_.title)
    );
    svg += band() + axes();
    for (std::size_t i = 0; i < chart_.series.size(); ++i) svg += series(i);
    return svg + legend() + "</svg>\n";
  }

 private:
  // As much as the legend needs.
  double height() const {
    const auto lines = static_cast<double>(chart_.series.size() + (chart_.band ? 1 : 0));
    return std::max(kLeast, kTop + kLegendLine * lines + 10);
  }
  double x_of(double value) const {
    if (chart_.x_ticks.size() < 2) return (kLeft + kRight) / 2;
    const double first = chart_.x_ticks.front().at, last = chart_.x_ticks.back().at;
    return kLeft + kEnd + (value - first) / (last - first) * (kRight - kLeft - 2 * kEnd);
  }
  double y_of(double value) const {
    const double share = (value - chart_.y.low) / (chart_.y.high - chart_.y.low);
    return kBottom - std::clamp(share, 0.0, 1.0) * (kBottom - kTop);
  }

  std::string band() const {
    if (!chart_.band) return "";
    const double top = y_of(chart_.band->high), bottom = y_of(chart_.band->low);
    return fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#e4e7ec\"/>\n",
        kLeft,
        top,
        kRight - kLeft,
        bottom - top
    );
  }

  std::string axes() const {
    std::string svg;
    for (int i = 0; i <= kYTicks; ++i) {
      const double value = chart_.y.low + (chart_.y.high - chart_.y.low) * i / kYTicks;
      svg += line(kLeft, y_of(value), kRight, y_of(value), "stroke=\"#c9d0da\"");
      svg += text(
          kLeft - 6,
          y_of(value) + 4,
          fmt::format("{:.{}f}", value, chart_.decimals),
          "text-anchor=\"end\""
      );
    }
    for (const SvgTick& tick : chart_.x_ticks) {
      svg += line(x_of(tick.at), kBottom, x_of(tick.at), kBottom + 5, "stroke=\"#222222\"");
      svg += text(x_of(tick.at), kBottom + 19, tick.text, "text-anchor=\"middle\"");
    }
    svg += line(kLeft, kBottom, kRight, kBottom, "stroke=\"#222222\"");
    svg += text((kLeft + kRight) / 2, kLeast - 8, chart_.x_label, "text-anchor=\"middle\"");
    return svg + text(
                     0,
                     0,
                     chart_.y_label,
                     fmt::format(
                         "text-anchor=\"middle\" transform=\"translate(16 {:.1f}) rotate(-90)\"",
                         (kTop + kBottom) / 2
                     )
                 );
  }

  std::string series(std::size_t index) const {
    const SvgSeries& all = chart_.series[index];
    const double beside =
        (static_cast<double>(index) - 0.5 * static_cast<double>(chart_.series.size() - 1)) *
        std::min(kBeside, kEnd / static_cast<double>(chart_.series.size()));
    const std::string paint =
        fmt::format("stroke=\"{}\" stroke-width=\"1.6\"{}", color_of(index), dashes_of(index));
    std::string svg, points, dots;
    for (std::size_t i = 0; i < all.y.size(); ++i) {
      if (!std::isfinite(all.y[i])) continue;
      const double x = x_of(all.x[i]) + beside, y = y_of(all.y[i]);
      points += fmt::format("{:.1f},{:.1f} ", x, y);
      dots += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.6\" fill=\"{}\"/>\n", x, y, color_of(index)
      );
      if (i < all.intervals.size() && all.intervals[i])
        svg += line(x, y_of(all.intervals[i]->low), x, y_of(all.intervals[i]->high), paint);
    }
    return svg + fmt::format("<polyline points=\"{}\" fill=\"none\" {}/>\n", points, paint) + dots;
  }

  std::string legend() const {
    std::string svg;
    double y = kTop + 8;
    for (std::size_t i = 0; i < chart_.series.size(); ++i, y += kLegendLine) {
      const std::string paint =
          fmt::format("stroke=\"{}\" stroke-width=\"2\"{}", color_of(i), dashes_of(i));
      svg += line(kRight + 14, y, kRight + 36, y, paint);
      svg += text(kRight + 42, y + 4, chart_.series[i].name, "");
    }
    if (!chart_.band) return svg;
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"22\" height=\"10\" fill=\"#e4e7ec\"/>\n",
        kRight + 14,
        y - 5
    );
    return svg + text(kRight + 42, y + 4, chart_.band_name, "");
  }

  const SvgChart& chart_;
};

}  // namespace

std::string svg_chart(const SvgChart& chart) { return Painter(chart).paint(); }

Interval range_around(const std::vector<SvgSeries>& series) {
  std::vector<double> values;
  for (const SvgSeries& one : series)
    for (const double value : one.y)
      if (std::isfinite(value)) values.push_back(value);
  if (values.empty()) return {0, 1};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double room = *high > *low ? 0.1 * (*high - *low) : std::max(1e-3, 0.05 * std::abs(*low));
  return {*low - room, *high + room};
}

}  // namespace glint
