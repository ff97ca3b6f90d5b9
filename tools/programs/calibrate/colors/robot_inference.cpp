#include "tools/programs/calibrate/colors/robot_inference.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>

#include "tools/programs/calibrate/colors/robot_light.h"

namespace touchline::calibrate {
namespace {

// Largest mean square of the residuals, and least difference to another robot or color in nats.
constexpr double kMaxMeanSquare = 1.6, kMinMargin = 3.0, kMinColorMargin = 1.0;
// Quantile of the pixels' values that is taken as white.
constexpr double kBrightest = 0.999;
// Least share of the pixels of a patch that have its color.
constexpr double kMinEven = 0.5;

// Hypothesis of a robot at one position with its samples, the team patch first.
struct Standing {
  std::size_t team = 0, robot = 0, patch = 0;
  std::vector<PlaceSample> samples;
  double cost = 0, margin = 0;
  RobotLight light{};
  std::size_t only_here = kNone;  // color that no other robot shows
  bool in_odd_light = false;      // the robot is in odd light and has a color that no other robot shows
  bool can_undo = false;          // in_odd_light, and the light is known well enough to learn this color
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

  // Accepts robots; robots in odd light only if `undo` is set. Returns the robots that remain.
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
  // Learns the appearances; a color without a patch is expected to look like its name in this light.
  void learn_looks() {
    looks_.resize(input_.colors.size());
    const Rgb gain = light_gain(input_, assignment_);
    for (std::size_t c = 0; c < input_.colors.size(); ++c) {
      if (!assignment_.colors[c].patches.empty()) {
        looks_[c] = seen_look(assignment_.colors[c].rgb);
      } else if (input_.colors[c].look) {
        Rgb rgb = *input_.colors[c].look;
        for (std::size_t k = 0; k < 3; ++k) rgb[k] = std::min(255.0, rgb[k] * gain[k]);
        looks_[c] = named_look(rgb);
      }
    }
  }

  // Learns the value at which the camera clips.
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
    double white = linear({value, value, value})[0];
    for (const Look& look : looks_) {
      const double greatest = *std::max_element(look.color.begin(), look.color.end());
      if (look.was_seen()) brightness_.most = std::max(brightness_.most, greatest);
      white = std::max(white, greatest);
    }
    brightness_.white = std::min(white, 1.0);
  }

  // Adds the best missing robot of the team at each position.
  void search(std::size_t team, std::vector<Standing>& found) const {
    const TeamMarking& marking = input_.teams[team];
    if (marking.team_color == kBackground || !looks_[marking.team_color - 1U].is_known()) return;
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

  // Returns whether the patch is on a recognized robot.
  [[nodiscard]] bool is_taken(const LayoutView& view, std::size_t patch) const {
    const auto at = view.on_field(input_.patches[patch].center);
    return std::any_of(assignment_.named.begin(), assignment_.named.end(),
                       [&](const AssignedRobot& n) { return n.picture == picture_.number && is_at(view, n, at); });
  }

  // Returns whether a robot's team patch is at a position, where no other robot's can be.
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
      if (!sample || !sample->on_top || sample->even < kMinEven) return {};
      out.push_back(std::move(*sample));
    }
    return out;
  }

  [[nodiscard]] Linear seen(const PlaceSample& sample) const {
    const Channels rgb = to_rgb8(sample.median, picture_.picture.image.space);
    return linear({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])});
  }

  // Returns the colors of the robot's patches, in the order of the layout.
  [[nodiscard]] std::vector<std::size_t> colors_of(const Standing& standing) const {
    const TeamMarking& marking = input_.teams[standing.team];
    std::vector<std::size_t> colors = {marking.team_color - std::size_t{1}};
    for (const ColorId color : marking.robots[standing.robot].colors) colors.push_back(color - std::size_t{1});
    return colors;
  }

  // Returns whether a patch of this color was found elsewhere in any picture.
  [[nodiscard]] bool is_known_elsewhere(std::size_t color, const PlaceSample& sample) const {
    if (!looks_[color].was_seen()) return false;
    const std::vector<std::size_t>& patches = assignment_.colors[color].patches;
    return std::any_of(patches.begin(), patches.end(), [&](std::size_t p) {
      const PixelPoint& at = input_.patches[p].center;
      return input_.picture[p] != picture_.number ||
             std::hypot(at.u_px - sample.middle.u_px, at.v_px - sample.middle.v_px) >
                 static_cast<float>(sample.radius_px);
    });
  }

  // Returns the robot's patches, except those of color `except`.
  [[nodiscard]] std::vector<ShownPatch> shown_by(const Standing& standing, std::size_t except = kNone) const {
    const std::vector<std::size_t> colors = colors_of(standing);
    std::vector<ShownPatch> out;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      if (colors[k] != except) out.push_back({looks_[colors[k]], seen(standing.samples[k])});
    }
    return out;
  }

  // Fits the light of the robot; returns false if it does not explain the samples, or if another color explains a
  // sample better. One of the colors may be known only by its name, or only from this robot.
  bool explains(Standing& standing) const {
    const std::vector<std::size_t> colors = colors_of(standing);
    std::set<std::size_t> only_here;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      if (!looks_[colors[k]].is_known()) return false;
      if (!is_known_elsewhere(colors[k], standing.samples[k])) only_here.insert(colors[k]);
    }
    if (only_here.size() > 1) return false;
    const std::vector<ShownPatch> patches = shown_by(standing);
    const FittedLight fitted = fit_light(patches, brightness_);
    standing.light = fitted.light;
    standing.cost = fitted.cost;
    if (2 * standing.cost > kMaxMeanSquare * 3 * static_cast<double>(colors.size())) return false;
    if (!only_here.empty()) {
      standing.only_here = *only_here.begin();
      standing.in_odd_light = is_odd(standing.light, shown_by(standing, standing.only_here), brightness_);
    }
    standing.can_undo = standing.in_odd_light;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      const double own = explain(patches[k], standing.light, brightness_).cost;
      for (std::size_t c = 0; c < looks_.size(); ++c) {
        if (c == colors[k] || !looks_[c].was_seen() || c + 1 == input_.ball) continue;
        const ShownPatch other{looks_[c], patches[k].seen};
        const double margin = explain(other, standing.light, brightness_).cost - own;
        if (margin >= kMinColorMargin) continue;
        // In odd light, only the color that is learned must be certain.
        if (colors[k] == standing.only_here) standing.can_undo = false;
        if (!standing.in_odd_light || margin < -kMinMargin) return false;
      }
    }
    return true;
  }

  // Keeps the best of the robots at one position if no other robot is nearly as good.
  static void keep_certain(std::vector<Standing>& here, std::vector<Standing>& found) {
    if (here.empty()) return;
    std::sort(here.begin(), here.end(), [](const Standing& a, const Standing& b) { return a.cost < b.cost; });
    Standing& best = here.front();
    best.margin = 1e9;
    for (const Standing& other : here) {
      if (other.robot != best.robot) best.margin = std::min(best.margin, other.cost - best.cost);
    }
    if (best.margin >= kMinMargin) found.push_back(std::move(best));
  }

  // A color has no patches in odd light, except patches that a click names.
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
        looks_[colors[k]] = seen_look(color.rgb);
      }
      input_.patches.push_back(std::move(patch));
      input_.picture.push_back(picture_.number);
      input_.named.push_back(kNone);
    }
    assignment_.named.push_back({picture_.number, standing.team, standing.robot, patches[0], patches});
    ++assignment_.robots;
    // In unusual light, this robot may have looked like a robot that the team file does not list.
    const LayoutView view{input_.teams[standing.team].layout, camera_, picture_.picture};
    const auto at = view.on_field(input_.patches[patches[0]].center);
    const auto is_it = [&](const AssignedRobot& one) { return one.picture == picture_.number && is_at(view, one, at); };
    assignment_.unknown_robots -= std::erase_if(assignment_.unlisted, is_it);
  }

  // Finds the colors that the patch would have in the light of other robots: several for each pixel, because the glare
  // on it is not exactly known.
  void undo_light(const Standing& standing, FoundPatch& patch) const {
    const ChannelImage& image = picture_.picture.image;
    const LightRemoval removal{standing.light, shown_by(standing, standing.only_here), brightness_};
    for (const std::size_t pixel : patch.pixels) {
      const Channels seen = to_rgb8(image.pixels[pixel], image.space);
      const Rgb rgb{static_cast<double>(seen[0]), static_cast<double>(seen[1]), static_cast<double>(seen[2])};
      for (std::size_t which = 0; which < LightRemoval::kCount; ++which)
        patch.usual.push_back(channels_of(removal.without_light(rgb, which), image.space));
    }
    patch.rgb = removal.without_light(patch.rgb, LightRemoval::kMean);
    patch.lab = lab_of(patch.rgb);
  }

  AssignmentInput& input_;
  const CameraModel& camera_;
  const SearchedPicture& picture_;
  Assignment& assignment_;
  std::vector<Look> looks_;  // for each color
  Brightness brightness_;
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
  // If no robot is recognized, nothing is known about the light.
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
  // A color that is seen in usual light anywhere is not learned from odd light, so robots in odd light come last.
  while (run(false)) {
  }
  while (!assignment.in_odd_light.empty() && run(true)) {
  }
}

}  // namespace touchline::calibrate
