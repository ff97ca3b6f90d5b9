#include "tools/programs/calibrate/colors/color_advice.h"

#include <algorithm>
#include <cmath>

#include "tools/programs/calibrate/colors/color_names.h"
#include "tools/programs/calibrate/colors/initial_boxes.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

constexpr std::size_t kNoColor = static_cast<std::size_t>(-1);

// Returns the distance between a color and a box: the largest over all channels; 0 inside.
int distance(const std::array<int, 3>& color, const ColorBox& box) {
  int largest = 0;
  for (std::size_t c = 0; c < 3; ++c) largest = std::max({largest, box.low[c] - color[c], color[c] - box.high[c]});
  return largest;
}

class Adviser {
 public:
  Adviser(const LearningInput& input, const LearningRules& rules, const std::vector<Channels>& shown_rgb)
      : input_(input) {
    std::vector<int> spreads;
    for (std::size_t i = 0; i < input.colors.size(); ++i) {
      cores_.push_back(core_of(input.colors[i].pixels, static_cast<ColorId>(i + 1), rules.core_tail));
      for (std::size_t c = 0; c < 3; ++c) spreads.push_back((cores_[i].high[c] - cores_[i].low[c]) / 2);
    }
    spread_ = statistics::median(spreads);
    fit_gains(shown_rgb);
    const double least = rules.background_share * total(input.background);
    for (const ColorCount& count : input.background) {
      if (count.count > least) background_.push_back({0, count.value, count.value});
    }
  }

  // Finds the paint that is farthest from all colors except color `without`, which it replaces.
  [[nodiscard]] PaintSuggestion additional(std::size_t without) const {
    PaintSuggestion best;
    for (const auto& [name, rgb] : usual_paints()) {
      if (is_there(name)) continue;
      const std::array<int, 3> color = in_this_light(rgb);
      int nearest = 255;
      for (std::size_t i = 0; i < cores_.size(); ++i) {
        if (i != without) nearest = std::min(nearest, distance(color, cores_[i]));
      }
      for (const ColorBox& value : background_) nearest = std::min(nearest, distance(color, value));
      if (best.name.empty() || nearest - spread_ > best.levels) best = {std::string(name), nearest - spread_};
    }
    return best;
  }

 private:
  [[nodiscard]] bool is_there(std::string_view name) const {
    return std::any_of(input_.colors.begin(), input_.colors.end(),
                       [&](const ColorSamples& c) { return std::string_view(c.name) == name; });
  }

  void fit_gains(const std::vector<Channels>& shown_rgb) {
    Rgb sum{};
    double count = 0;
    for (std::size_t i = 0; i < shown_rgb.size(); ++i) {
      const auto look = usual_rgb(input_.colors[i].name);
      if (!look) continue;
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] += std::log((shown_rgb[i][c] + kRatioOffset) / ((*look)[c] + kRatioOffset));
      count += 1;
    }
    for (std::size_t c = 0; c < 3; ++c) gain_[c] = count > 0 ? std::exp(sum[c] / count) : 1.0;
  }

  [[nodiscard]] std::array<int, 3> in_this_light(const Rgb& paint) const {
    std::array<float, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<float>(std::min(255.0, gain_[c] * paint[c]));
    const std::array<float, 3> value = from_rgb(rgb, input_.space);
    return {static_cast<int>(value[0]), static_cast<int>(value[1]), static_cast<int>(value[2])};
  }

  const LearningInput& input_;
  std::vector<ColorBox> cores_, background_;
  Rgb gain_{1, 1, 1};
  int spread_ = 0;
};

}  // namespace

ColorAdvice advise(const LearningInput& input, const LearningRules& rules, const std::vector<Channels>& shown_rgb,
                   const std::vector<PairMargin>& margins, int least_levels) {
  const Adviser adviser(input, rules, shown_rgb);
  ColorAdvice advice;
  advice.additional = adviser.additional(kNoColor);
  std::vector<bool> replaced(input.colors.size(), false);
  for (const PairMargin& pair : margins) {
    if (pair.levels >= least_levels || replaced[pair.first] || replaced[pair.second]) continue;
    ColorReplacement replacement{pair.first, pair.second, pair.levels, pair.first, adviser.additional(pair.first)};
    const PaintSuggestion other = adviser.additional(pair.second);
    if (other.levels > replacement.suggestion.levels) {
      replacement.replaced = pair.second;
      replacement.suggestion = other;
    }
    replaced[replacement.replaced] = true;
    advice.replacements.push_back(std::move(replacement));
  }
  return advice;
}

}  // namespace touchline::calibrate
