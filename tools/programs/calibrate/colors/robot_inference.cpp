#include "tools/programs/calibrate/colors/robot_inference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <set>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

using Linear = std::array<double, 3>;

// Approximates the sRGB transfer function.
constexpr double kGamma = 2.2;
// Standard deviation of the logarithm of a channel, also of a color that is known only by its name, and the greatest
// contradiction of one channel in these.
constexpr double kSeenSigma = 0.25, kNamedSigma = 0.6, kMostResiduals = 4.0;
// Sensor noise and black level in linear light, which hide the ratios of dark channels.
constexpr double kNoiseFloor = 0.01;
// Greatest value of a channel at the camera's black.
constexpr double kBlack = 2.0;
// Factors and glare that are tried. Robots in shade have a third of the light; glare is at most a third of white.
constexpr double kGains[] = {0.25, 0.35, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.15, 1.35, 1.6, 2.0};
constexpr double kGlares[] = {0, 0.01, 0.02, 0.04, 0.07, 0.1, 0.14, 0.18, 0.24, 0.3};
// Of the glare on a robot, and of its difference on one of the patches.
constexpr double kGainSigma = 0.6, kGlareScale = 0.1;
// Greatest change by the light on a robot, as logarithm of its factor and as glare, at which a color can be learned
// from this robot alone.
constexpr double kUsualGain = 0.25, kUsualGlare = 0.05;
// Greatest mean square of the residuals, and least difference to another robot or color in nats.
constexpr double kMostMeanSquare = 1.6, kLeastMargin = 3.0, kLeastColorMargin = 1.0;
// Share of the brightest channel of all colors from which a channel may be clipped.
constexpr double kClipped = 0.92;
// Share of the pixels that are darker than white.
constexpr double kBrightest = 0.999;
// Least share of the pixels of a patch that have its color.
constexpr double kLeastEven = 0.5;

Linear linear(const Rgb& rgb) {
  Linear out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = std::pow(std::clamp(rgb[c], 0.0, 255.0) / 255, kGamma);
  return out;
}

double level_of(double linear) { return 255 * std::pow(std::clamp(linear, 0.0, 1.0), 1 / kGamma); }

struct Look {
  Linear color{};
  double sigma = 0;  // 0: unknown
  // A camera's color matrix makes channels of saturated paints negative; what it delivers is black, to which glare adds
  // nothing visible at first.
  std::array<bool, 3> at_black{};
};

// The light on a robot.
struct RobotLight {
  double gain = 1, glare = 0;
};

// Negative log-likelihood of a color in this light, with the glare that explains it best: glare differs from patch to
// patch.
struct Fit {
  double cost = 1e9, glare = 0;
};

// Negative log-likelihood of a color for each of kGlares.
using GlareCosts = std::array<double, std::size(kGlares)>;

GlareCosts costs_of(const Look& look, const Linear& seen, double gain, double white) {
  GlareCosts out{};
  for (std::size_t g = 0; g < out.size(); ++g) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = std::min(white, gain * look.color[c] + kGlares[g]);
      double residual = std::log((seen[c] + kNoiseFloor) / (expected + kNoiseFloor)) / look.sigma;
      if (look.at_black[c]) residual = std::max(0.0, residual);
      sum += std::min(residual * residual, kMostResiduals * kMostResiduals);
    }
    // A wide distribution is low everywhere.
    out[g] = sum / 2 + 3 * std::log(look.sigma / kSeenSigma);
  }
  return out;
}

// One lamp shines on all patches of a robot: their glare differs little.
Fit fit_of(const GlareCosts& costs, double robot_glare) {
  Fit best;
  for (std::size_t g = 0; g < costs.size(); ++g) {
    const double cost = costs[g] + std::abs(kGlares[g] - robot_glare) / kGlareScale;
    if (cost < best.cost) best = {cost, kGlares[g]};
  }
  return best;
}

Fit fit_of(const Look& look, const Linear& seen, const RobotLight& light, double white) {
  return fit_of(costs_of(look, seen, light.gain, white), light.glare);
}

// A robot at one place with its samples, the team patch first.
struct Standing {
  std::size_t team = 0, robot = 0, patch = 0;
  std::vector<PlaceSample> samples;
  double cost = 0, margin = 0;
  RobotLight light{};
  std::size_t only_here = kNone;  // the color that no other robot shows
  bool in_odd_light = false;      // with a color that no other robot shows
  bool can_undo = false;          // in_odd_light, and the light is known well enough to learn that color
};

class Inference {
 public:
  Inference(AssignmentInput& input, const CameraModel& camera, const SearchedPicture& picture, Assignment& assignment)
      : input_(input), camera_(camera), picture_(picture), assignment_(assignment) {
    learn_looks();
    learn_white();
    for (std::size_t p = 0; p < input_.patches.size(); ++p) {
      if (input_.picture[p] == picture_.number && !input_.patches[p].sampled) numbers_.push_back(p);
    }
  }

  // Accepts robots; those in odd light only with `undo`. Returns those that are left.
  std::vector<AssignedRobot> run(bool undo) {
    for (;;) {
      std::vector<Standing> found;
      for (std::size_t team = 0; team < 2; ++team) search(team, found);
      const auto rank = [undo](const Standing& one) { return !one.in_odd_light ? 0 : undo && one.can_undo ? 1 : 2; };
      const auto best = std::min_element(found.begin(), found.end(), [&](const Standing& a, const Standing& b) {
        return rank(a) != rank(b) ? rank(a) < rank(b) : a.cost < b.cost;
      });
      if (best == found.end() || rank(*best) == 2) {
        std::vector<AssignedRobot> left;
        left.reserve(found.size());
        for (const Standing& one : found) left.push_back({picture_.number, one.team, one.robot, one.patch, {}});
        return left;
      }
      accept(*best);
    }
  }

 private:
  // A color without a patch is expected to look like its name in this light.
  void learn_looks() {
    looks_.resize(input_.colors.size());
    const Rgb gain = light_gain(input_, assignment_);
    for (std::size_t c = 0; c < input_.colors.size(); ++c) {
      if (!assignment_.colors[c].patches.empty()) {
        looks_[c] = look_of(assignment_.colors[c].rgb);
      } else if (input_.colors[c].look) {
        Rgb rgb = *input_.colors[c].look;
        for (std::size_t k = 0; k < 3; ++k) rgb[k] = std::min(255.0, rgb[k] * gain[k]);
        looks_[c] = {linear(rgb), kNamedSigma, {}};
      }
    }
  }

  static Look look_of(const Rgb& rgb) {
    Look out{linear(rgb), kSeenSigma, {}};
    for (std::size_t k = 0; k < 3; ++k) out.at_black[k] = rgb[k] <= kBlack;
    return out;
  }

  // The value at which the camera clips.
  void learn_white() {
    std::vector<std::uint8_t> values;
    values.reserve(picture_.picture.image.pixels.size());
    for (std::size_t i = 0; i < picture_.picture.image.pixels.size(); ++i) {
      if (picture_.picture.inside[i] == 0) continue;
      const Channels rgb = to_rgb8(picture_.picture.image.pixels[i], picture_.picture.image.space);
      values.push_back(*std::max_element(rgb.begin(), rgb.end()));
    }
    if (values.empty()) return;
    const auto top = values.begin() + static_cast<std::ptrdiff_t>(kBrightest * static_cast<double>(values.size()));
    std::nth_element(values.begin(), top, values.end());
    const auto value = static_cast<double>(*top);
    for (const Look& look : looks_) {
      if (look.sigma > 0 && look.sigma <= kSeenSigma)
        brightest_ = std::max({brightest_, look.color[0], look.color[1], look.color[2]});
    }
    white_ = linear({value, value, value})[0];
    for (const Look& look : looks_) white_ = std::max({white_, look.color[0], look.color[1], look.color[2]});
    white_ = std::min(white_, 1.0);
  }

  // Adds the best missing robot of the team at each place.
  void search(std::size_t team, std::vector<Standing>& found) const {
    const TeamMarking& marking = input_.teams[team];
    if (marking.team_color == kBackground || looks_[marking.team_color - 1U].sigma <= 0) return;
    std::vector<std::size_t> missing;
    for (std::size_t r = 0; r < marking.robots.size(); ++r) {
      const bool known = std::any_of(assignment_.named.begin(), assignment_.named.end(), [&](const AssignedRobot& n) {
        return n.picture == picture_.number && n.team == team && n.robot == r;
      });
      if (!known) missing.push_back(r);
    }
    if (missing.empty()) return;
    const LayoutView view{marking.layout, camera_, picture_.picture};
    for (const std::size_t patch : numbers_) {
      if (!view.fits(input_.patches[patch], 0) || is_taken(view, patch)) continue;
      std::vector<Standing> here;
      for (const double heading : view.headings(input_.patches, numbers_, patch)) {
        std::vector<PlaceSample> samples = samples_of(view, patch, heading);
        if (samples.empty()) continue;
        for (const std::size_t r : missing) {
          Standing standing{team, r, patch, samples};
          if (explains(standing)) here.push_back(std::move(standing));
        }
      }
      keep_certain(here, found);
    }
  }

  // On a robot that is recognized.
  [[nodiscard]] bool is_taken(const LayoutView& view, std::size_t patch) const {
    const auto at = view.on_field(input_.patches[patch].center);
    return std::any_of(assignment_.named.begin(), assignment_.named.end(),
                       [&](const AssignedRobot& n) { return n.picture == picture_.number && is_at(view, n, at); });
  }

  // Whether a robot's team patch is at a place, which no other robot's can be.
  [[nodiscard]] bool is_at(const LayoutView& view, const AssignedRobot& robot, std::complex<double> at) const {
    return std::abs(view.on_field(input_.patches[robot.team_patch].center) - at) <
           0.6 * static_cast<double>(view.layout.robot_side_m);
  }

  std::vector<PlaceSample> samples_of(const LayoutView& view, std::size_t patch, double heading) const {
    const auto turn = std::polar(1.0, heading);
    const auto center = view.on_field(input_.patches[patch].center) - turn * place_of(view.layout.patches[0]);
    std::vector<PlaceSample> out;
    for (std::size_t k = 0; k < view.layout.patches.size(); ++k) {
      auto sample = sample_place(view, k, center + turn * place_of(view.layout.patches[k]), turn);
      if (!sample || !sample->on_top || sample->even < kLeastEven) return {};
      out.push_back(std::move(*sample));
    }
    return out;
  }

  [[nodiscard]] Linear seen(const PlaceSample& sample) const {
    const Channels rgb = to_rgb8(sample.median, picture_.picture.image.space);
    return linear({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])});
  }

  // Of the robot's patches, in the order of the layout.
  [[nodiscard]] std::vector<std::size_t> colors_of(const Standing& standing) const {
    const TeamMarking& marking = input_.teams[standing.team];
    std::vector<std::size_t> colors = {marking.team_color - std::size_t{1}};
    for (const ColorId color : marking.robots[standing.robot].colors) colors.push_back(color - std::size_t{1});
    return colors;
  }

  // Whether a patch of this color was found elsewhere in any picture.
  [[nodiscard]] bool is_known_elsewhere(std::size_t color, const PlaceSample& sample) const {
    if (looks_[color].sigma > kSeenSigma) return false;
    const std::vector<std::size_t>& patches = assignment_.colors[color].patches;
    return std::any_of(patches.begin(), patches.end(), [&](std::size_t p) {
      const PixelPoint& at = input_.patches[p].center;
      return input_.picture[p] != picture_.number ||
             std::hypot(at.u_px - sample.middle.u_px, at.v_px - sample.middle.v_px) >
                 static_cast<float>(sample.radius_px);
    });
  }

  // Fits the light of the robot; false if it does not explain the samples, or if another color explains one better. One
  // of its colors may be known by its name alone, or by this robot.
  bool explains(Standing& standing) const {
    const std::vector<std::size_t> colors = colors_of(standing);
    std::set<std::size_t> only_here;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      if (looks_[colors[k]].sigma <= 0) return false;
      if (!is_known_elsewhere(colors[k], standing.samples[k])) only_here.insert(colors[k]);
    }
    if (only_here.size() > 1) return false;
    fit_light(colors, standing);
    if (2 * standing.cost > kMostMeanSquare * 3 * static_cast<double>(colors.size())) return false;
    if (!only_here.empty()) standing.only_here = *only_here.begin();
    standing.in_odd_light = !only_here.empty() && is_odd(colors, standing, standing.only_here);
    standing.can_undo = standing.in_odd_light;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      const Linear color = seen(standing.samples[k]);
      const double own = fit_of(looks_[colors[k]], color, standing.light, white_).cost;
      for (std::size_t c = 0; c < looks_.size(); ++c) {
        if (c == colors[k] || looks_[c].sigma <= 0 || looks_[c].sigma > kSeenSigma || c + 1 == input_.ball) continue;
        const double margin = fit_of(looks_[c], color, standing.light, white_).cost - own;
        if (margin >= kLeastColorMargin) continue;
        // In odd light only the color that is learned must be certain.
        if (colors[k] == standing.only_here) standing.can_undo = false;
        if (!standing.in_odd_light || margin < -kLeastMargin) return false;
      }
    }
    return true;
  }

  // Finds the light that explains the robot's samples best.
  void fit_light(const std::vector<std::size_t>& colors, Standing& standing) const {
    standing.cost = 1e9;
    for (const double gain : kGains) {
      std::vector<GlareCosts> costs;
      for (std::size_t k = 0; k < colors.size(); ++k)
        costs.push_back(costs_of(looks_[colors[k]], seen(standing.samples[k]), gain, white_));
      for (const double glare : kGlares) {
        double cost = std::pow(std::log(gain) / kGainSigma, 2) / 2 + glare / kGlareScale;
        for (const GlareCosts& of_patch : costs) cost += fit_of(of_patch, glare).cost;
        if (cost >= standing.cost) continue;
        standing.cost = cost;
        standing.light = {gain, glare};
      }
    }
  }

  // Whether the light on the robot differs from that on others, as its patches of other colors than `color` show.
  [[nodiscard]] bool is_odd(const std::vector<std::size_t>& colors, const Standing& standing, std::size_t color) const {
    if (std::abs(std::log(standing.light.gain)) > kUsualGain) return true;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      const Fit fit = fit_of(looks_[colors[k]], seen(standing.samples[k]), standing.light, white_);
      if (colors[k] != color && fit.glare > kUsualGlare) return true;
    }
    return false;
  }

  // Keeps the best robot of one place if no other one is nearly as good.
  static void keep_certain(std::vector<Standing>& here, std::vector<Standing>& found) {
    if (here.empty()) return;
    std::sort(here.begin(), here.end(), [](const Standing& a, const Standing& b) { return a.cost < b.cost; });
    Standing& best = here.front();
    best.margin = 1e9;
    for (const Standing& other : here) {
      if (other.robot != best.robot) best.margin = std::min(best.margin, other.cost - best.cost);
    }
    if (best.margin >= kLeastMargin) found.push_back(std::move(best));
  }

  // Without those that a click names, a color has no patches in odd light.
  void leave_unlearned(std::size_t color) {
    AssignedColor& assigned = assignment_.colors[color];
    const auto unnamed = std::stable_partition(assigned.patches.begin(), assigned.patches.end(),
                                               [&](std::size_t p) { return input_.named[p] == color; });
    assigned.others.insert(assigned.others.end(), unnamed, assigned.patches.end());
    assigned.patches.erase(unnamed, assigned.patches.end());
  }

  void accept(Standing& standing) {
    const std::vector<std::size_t> colors = colors_of(standing);
    if (standing.in_odd_light) leave_unlearned(standing.only_here);
    std::vector<std::size_t> patches;
    for (std::size_t k = 0; k < standing.samples.size(); ++k) {
      patches.push_back(input_.patches.size());
      FoundPatch patch = sampled_patch(picture_.picture.image, standing.samples[k]);
      AssignedColor& color = assignment_.colors[colors[k]];
      if (standing.in_odd_light && colors[k] == standing.only_here) undo_light(standing, patch);
      (standing.in_odd_light && colors[k] != standing.only_here ? color.others : color.patches)
          .push_back(patches.back());
      if (colors[k] == standing.only_here && color.patches.size() == 1) {
        color.rgb = patch.rgb;
        color.margin = standing.margin;
        looks_[colors[k]] = look_of(color.rgb);
      }
      input_.patches.push_back(std::move(patch));
      input_.picture.push_back(picture_.number);
      input_.named.push_back(kNone);
    }
    assignment_.named.push_back({picture_.number, standing.team, standing.robot, patches[0], patches});
    ++assignment_.robots;
    // In unusual light, it may have looked like a robot that the team file does not list.
    const LayoutView view{input_.teams[standing.team].layout, camera_, picture_.picture};
    const auto at = view.on_field(input_.patches[patches[0]].center);
    const auto is_it = [&](const AssignedRobot& one) { return one.picture == picture_.number && is_at(view, one, at); };
    assignment_.unknown_robots -= std::erase_if(assignment_.unlisted, is_it);
  }

  // Glare on the other patches of a robot, as the channels show it that are neither black without it nor clipped with
  // it: least, mean and greatest.
  [[nodiscard]] std::array<double, 3> glare_beside(const Standing& standing, double gain) const {
    const std::vector<std::size_t> colors = colors_of(standing);
    std::vector<double> glares;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      if (colors[k] == standing.only_here) continue;
      const Look& look = looks_[colors[k]];
      const Linear value = seen(standing.samples[k]);
      for (std::size_t c = 0; c < 3; ++c) {
        if (!look.at_black[c] && value[c] < kClipped * brightest_)
          glares.push_back(std::max(0.0, value[c] - gain * look.color[c]));
      }
    }
    if (glares.empty()) {
      // Black and clipped channels show how much glare there is at least.
      const double least = standing.light.glare;
      return {least, least + kGlareScale / 2, least + kGlareScale};
    }
    const auto [least, most] = std::minmax_element(glares.begin(), glares.end());
    return {*least, statistics::mean(glares), *most};
  }

  // Finds what colors the patch would have in the light of other robots. Each pixel gives three: with the least, the
  // mean and the greatest glare that the robot's other patches show. A channel that may be clipped may have any greater
  // value.
  void undo_light(const Standing& standing, FoundPatch& patch) const {
    const ChannelImage& image = picture_.picture.image;
    const double gain = std::min(1.0, standing.light.gain);  // what is brighter is glare
    const std::array<double, 3> glares = glare_beside(standing, gain);
    const auto undone = [&](const Rgb& rgb, std::size_t glare) {
      const Linear value = linear(rgb);
      Rgb out{};
      for (std::size_t c = 0; c < 3; ++c) {
        double usual = (value[c] - glares[glare]) / gain;
        if (value[c] >= kClipped * brightest_)
          usual += std::max(0.0, brightest_ - usual) * (1 - static_cast<double>(glare) / (glares.size() - 1));
        out[c] = level_of(usual);
      }
      return out;
    };
    for (const std::size_t pixel : patch.pixels) {
      const Channels seen = to_rgb8(image.pixels[pixel], image.space);
      for (std::size_t glare = 0; glare < glares.size(); ++glare) {
        const Rgb rgb{static_cast<double>(seen[0]), static_cast<double>(seen[1]), static_cast<double>(seen[2])};
        patch.usual.push_back(channels_of(undone(rgb, glare), image.space));
      }
    }
    patch.rgb = undone(patch.rgb, 1);
    patch.lab = lab_of(patch.rgb);
  }

  AssignmentInput& input_;
  const CameraModel& camera_;
  const SearchedPicture& picture_;
  Assignment& assignment_;
  std::vector<Look> looks_;           // per color
  double white_ = 1;                  // linear value at which the camera clips
  double brightest_ = 0;              // greatest channel of the colors that patches have
  std::vector<std::size_t> numbers_;  // patches of the picture that were grown
};

}  // namespace

Rgb light_gain(const AssignmentInput& input, const Assignment& assignment) {
  constexpr double kBright = 100.0, kPrior = 1.0;
  Rgb out{};
  for (std::size_t k = 0; k < 3; ++k) {
    double sum = 0, count = kPrior;
    for (std::size_t c = 0; c < input.colors.size(); ++c) {
      if (assignment.colors[c].patches.empty() || !input.colors[c].look || (*input.colors[c].look)[k] < kBright)
        continue;
      sum += std::log((assignment.colors[c].rgb[k] + kRatioOffset) / ((*input.colors[c].look)[k] + kRatioOffset));
      count += 1;
    }
    out[k] = std::exp(sum / count);
  }
  return out;
}

void infer_robots(AssignmentInput& input, const CameraModel& camera, const std::vector<SearchedPicture>& pictures,
                  Assignment& assignment) {
  // Without a single robot, nothing is known about the light.
  if (assignment.robots == 0) return;
  const auto run = [&](bool undo) {
    const std::size_t before = assignment.robots;
    assignment.in_odd_light.clear();
    for (const SearchedPicture& picture : pictures) {
      for (AssignedRobot& robot : Inference(input, camera, picture, assignment).run(undo))
        assignment.in_odd_light.push_back(std::move(robot));
    }
    return assignment.robots > before;
  };
  // A color that is seen in usual light anywhere is not learned from odd light.
  while (run(false)) {
  }
  while (!assignment.in_odd_light.empty() && run(true)) {
  }
}

}  // namespace touchline::calibrate
