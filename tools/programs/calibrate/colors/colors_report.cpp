#include "tools/programs/calibrate/colors/colors_report.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {

void print_detected(const DetectedColors& found) {
  std::printf("%zu patches, %zu robots in %zu pictures\n%-12s %-15s %7s %-12s %s\n", found.input.patches.size(),
              found.assignment.robots, found.images.size(), "color", "R G B", "patches", "next best", "confidence");
  for (std::size_t c = 0; c < found.input.colors.size(); ++c) {
    const WantedColor& wanted = found.input.colors[c];
    const AssignedColor& color = found.assignment.colors[c];
    const std::string rgb =
        color.patches.empty() ? "-" : formatted("%3.0f %3.0f %3.0f", color.rgb[0], color.rgb[1], color.rgb[2]);
    std::printf("%-12s %-15s %7zu %-12s %s\n", wanted.name.c_str(), rgb.c_str(), color.patches.size(),
                color.alternative.empty() ? "-" : color.alternative.c_str(),
                wanted.clicked ? "clicked" : formatted("%.1f %%", 100 * color.confidence()).c_str());
  }
}

void print_unused(const std::vector<Click>& clicks, const std::vector<ClickUse>& uses) {
  const auto used = std::count_if(uses.begin(), uses.end(), [](const ClickUse& use) { return use.used; });
  if (!uses.empty()) std::printf("%td of %zu clicks used\n", used, uses.size());
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i].used) continue;
    std::printf("click %s is not used: %s\n", describe_click(i, clicks[i]).c_str(), uses[i].reason.c_str());
  }
}

void print_report(const ColorFitInput& input, const ColorFit& fit) {
  for (std::size_t i = 0; i < fit.clicks.size(); ++i) {
    const Click& click = input.clicks[i];
    const ClickResult& result = fit.clicks[i];
    if (result.area_px == 0) {
      std::printf("click %s is not used: %s\n", describe_click(i, click).c_str(), result.reason.c_str());
    } else if (!click.usual.empty()) {
      std::printf(
          "%s is learned from the patch at %.0f,%.0f of %s, corrected for the odd light there; a picture in which the "
          "robot stands elsewhere would be more reliable\n",
          click.color.c_str(), click.u_px, click.v_px, click.image.c_str());
    } else if (result.recognized < 0.5) {
      std::printf("%s, the %s patch at %.0f,%.0f: only %.0f %% of its %zu pixels are recognized\n", click.image.c_str(),
                  click.color.c_str(), click.u_px, click.v_px, 100 * result.recognized, result.area_px);
    }
  }
  std::size_t width = 10;
  for (const std::string& name : fit.names) width = std::max(width, name.size() + 1);
  const auto column = static_cast<int>(width);
  std::printf("classification of the patches, %% of pixels (row: clicked on, column: classified as)\n%*s%*s", column,
              "", column, "none");
  for (const std::string& name : fit.names) std::printf("%*s", column, name.c_str());
  std::printf("%*s\n", column, "boxes");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    std::printf("%-*s", column, fit.names[c].c_str());
    // The pixels of a patch in odd light do not have the color that was learned from the patch.
    const bool has_pixels = std::any_of(input.clicks.begin(), input.clicks.end(), [&](const Click& click) {
      return click.color == fit.names[c] && click.usual.empty();
    });
    for (const double share : fit.confusion[c]) {
      std::printf("%*s", column, has_pixels ? formatted("%.1f", 100 * share).c_str() : "-");
    }
    const auto boxes = std::count_if(fit.learned.boxes.begin(), fit.learned.boxes.end(),
                                     [&](const ColorBox& b) { return b.color == c + 1; });
    std::printf("%*td\n", column, boxes);
  }
  std::printf("background classified as a color, %%:");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    std::printf(" %s %.4f", fit.names[c].c_str(), 100 * fit.background_share[c]);
  }
  std::printf(
      "\nmargin of each pair: levels between their cores in the channel that separates them best (negative: "
      "overlap)\n");
  std::vector<std::vector<int>> margin(fit.names.size(), std::vector<int>(fit.names.size(), 0));
  for (const PairMargin& m : fit.learned.margins)
    margin[std::max(m.first, m.second)][std::min(m.first, m.second)] = m.levels;
  for (std::size_t c = 1; c < fit.names.size(); ++c) {
    std::printf("%-*s", column, fit.names[c].c_str());
    for (std::size_t other = 0; other < c; ++other) std::printf("%*d", column, margin[c][other]);
    std::printf("\n");
  }
  std::printf("%*s", column, "");
  for (std::size_t c = 0; c + 1 < fit.names.size(); ++c) std::printf("%*s", column, fit.names[c].c_str());
  std::printf("\n");
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    if (fit.learned.cut_share[c] > 0.05) {
      std::printf("%s: lost %.0f %% of its pixels to other colors; replace it if possible\n", fit.names[c].c_str(),
                  100 * fit.learned.cut_share[c]);
    }
  }
  for (const ColorReplacement& e : fit.advice.replacements) {
    std::printf("%s and %s are only %d levels apart: replace %s if possible; %s would be %d levels from all others\n",
                fit.names[e.first].c_str(), fit.names[e.second].c_str(), e.levels, fit.names[e.replaced].c_str(),
                e.suggestion.name.c_str(), e.suggestion.levels);
  }
  std::printf("best additional color: %s, %d levels from all others and from the background\n",
              fit.advice.additional.name.c_str(), fit.advice.additional.levels);
  std::vector<StrayRegion> strays = fit.strays;
  std::sort(strays.begin(), strays.end(),
            [](const StrayRegion& a, const StrayRegion& b) { return a.area_px > b.area_px; });
  constexpr std::size_t kShown = 8;
  for (std::size_t i = 0; i < std::min(kShown, strays.size()); ++i) {
    const StrayRegion& stray = strays[i];
    std::printf("%s: %u pixels of %s at %.0f,%.0f without a click: a patch or clutter\n", stray.image.c_str(),
                stray.area_px, fit.names[stray.color].c_str(), static_cast<double>(stray.center.u_px),
                static_cast<double>(stray.center.v_px));
  }
  if (strays.size() > kShown) std::printf("and %zu smaller ones\n", strays.size() - kShown);
}

}  // namespace touchline::calibrate
