#include "tools/programs/calibrate/colors/assignment_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "tools/programs/calibrate/colors/linear_assignment.h"

namespace touchline::calibrate {
namespace {

// Costs in nats: of a recognized robot or ball (negative), of a robot in colors that no robot has, and of a missing
// color.
constexpr double kExplained = 4.0, kUnlistedRobot = 6.0, kMissing = 8.0, kForbidden = 1e4;
// Standard deviation of paints with one name, and the largest cost of a paint's appearance.
constexpr double kPaint = 12.0, kMaxPaintCost = 14.0;
// For shades of one color under uneven light: their standard deviation, the cost of a further shade, and the least
// decrease of the total cost that justifies one.
constexpr double kShade = 14.0, kFurtherShade = 0.5, kWorthAShade = 1.0;

class Solver {
 public:
  Solver(const AssignmentInput& input, const std::vector<PatchLabels>& cuts)
      : input_(input), cuts_(cuts), is_ball_(input.patches.size(), false) {
    for (const std::size_t p : input.balls) is_ball_[p] = true;
  }

  Solution solve(const Exclusion& exclusion, bool with_shades) const {
    Solution best;
    for (const PatchLabels& cut : cuts_) {
      Solution best_of_cut;
      Teams teams{kNone, kNone};
      const auto own = team_labels(cut, 0), other = team_labels(cut, 1);
      for (const std::size_t a : own) {
        for (const std::size_t b : other) {
          if (a == b && a != kNone) continue;
          Solution s = with_teams(cut, {a, b}, exclusion);
          if (s.cost >= best_of_cut.cost) continue;
          best_of_cut = std::move(s);
          teams = {a, b};
        }
      }
      if (with_shades) add_shades(cut, teams, exclusion, best_of_cut);
      if (best_of_cut.cost < best.cost) best = std::move(best_of_cut);
    }
    return best;
  }

 private:
  using Teams = std::array<std::size_t, 2>;

  // Adds clusters to colors as further shades as long as this explains more robots. Under uneven light the patches of a
  // color form several clusters, and no single distance separates all colors.
  void add_shades(PatchLabels cut, const Teams& teams, const Exclusion& exclusion, Solution& best) const {
    constexpr std::size_t kMaxShades = 8;
    for (std::size_t round = 0; round < kMaxShades; ++round) {
      std::size_t best_label = kNone, best_color = kNone;
      const double before = best.cost;
      std::set<std::size_t> assigned(best.label_of.begin(), best.label_of.end());
      const std::vector<std::size_t> label_of = best.label_of;
      for (std::size_t l = 0; l < cut.labels.size(); ++l) {
        Label& label = cut.labels[l];
        if (fixed(label) != kNone || assigned.count(l) > 0) continue;
        for (std::size_t c = 0; c < label_of.size(); ++c) {
          const std::size_t main = label_of[c] != kNone ? label_of[c] : cut.named(c);
          if (main == kNone || c + 1 == input_.ball || !is_plausible(input_.colors[c].look, label.rgb) ||
              difference(label.lab, cut.labels[main].lab) > 3 * kShade)
            continue;
          label.shade = c;
          Solution tried = with_teams(cut, teams, exclusion);
          label.shade = kNone;
          if (tried.cost >= std::min(best.cost, before - kWorthAShade)) continue;
          best = std::move(tried);
          best_label = l;
          best_color = c;
        }
      }
      if (best_label == kNone) return;
      cut.labels[best_label].shade = best_color;
    }
  }

  // Returns the labels of the most frequent team patches; only kNone if the team is not searched for or there is no
  // marker.
  std::vector<std::size_t> team_labels(const PatchLabels& cut, std::size_t team) const {
    if (input_.teams[team].team_color == kBackground) return {kNone};
    std::vector<std::size_t> count(cut.labels.size(), 0), order;
    for (const MarkerCandidate& m : input_.markers) {
      if (m.team == team) ++count[cut.label_of[m.patches[0]]];
    }
    for (std::size_t l = 0; l < count.size(); ++l) {
      if (count[l] > 0 && fixed(cut.labels[l]) == kNone) order.push_back(l);
    }
    constexpr std::size_t kTried = 7;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
    if (order.size() > kTried) order.resize(kTried);
    order.push_back(kNone);
    return order;
  }

  // Returns the color that a label has in every assignment, or kNone.
  static std::size_t fixed(const Label& label) { return label.named != kNone ? label.named : label.shade; }

  bool has_team_color(const PatchLabels& cut, const Teams& teams, std::size_t team, std::size_t label) const {
    return label == teams[team] ||
           (fixed(cut.labels[label]) != kNone && fixed(cut.labels[label]) + 1 == input_.teams[team].team_color);
  }

  // Selects markers whose team patch has the team color and whose other patches do not, without using a patch twice:
  // robots of the team file first (`color_of`, if known), then the best fits.
  std::vector<const MarkerCandidate*> choose(const PatchLabels& cut, const Teams& teams,
                                             const std::vector<std::size_t>* color_of) const {
    struct Fitting {
      const MarkerCandidate* marker;
      bool known;
    };
    std::vector<Fitting> fitting;
    for (const MarkerCandidate& m : input_.markers) {
      if (!has_team_color(cut, teams, m.team, cut.label_of[m.patches[0]])) continue;
      const bool others = std::none_of(m.patches.begin() + 1, m.patches.end(), [&](std::size_t p) {
        return has_team_color(cut, teams, 0, cut.label_of[p]) || has_team_color(cut, teams, 1, cut.label_of[p]);
      });
      if (others) fitting.push_back({&m, color_of != nullptr && robot(m, cut, *color_of) != kNone});
    }
    std::sort(fitting.begin(), fitting.end(), [](const Fitting& a, const Fitting& b) {
      return a.known != b.known ? a.known : a.marker->residual_m < b.marker->residual_m;
    });
    std::vector<bool> taken(input_.patches.size(), false);
    std::vector<const MarkerCandidate*> out;
    for (const Fitting& f : fitting) {
      const std::vector<std::size_t>& patches = f.marker->patches;
      if (std::any_of(patches.begin(), patches.end(), [&](std::size_t p) { return taken[p]; })) continue;
      for (const std::size_t p : patches) taken[p] = true;
      out.push_back(f.marker);
    }
    return out;
  }

  double unlikely(std::size_t color, const Label& label, const std::vector<std::optional<Lab>>& expected,
                  const Exclusion& exclusion) const {
    if (fixed(label) != kNone) return kForbidden;  // the label already has its color
    if (exclusion.color == color && difference(label.lab, exclusion.lab) < kSame) return kForbidden;
    if (!expected[color]) return kMaxPaintCost / 2;
    if (!is_plausible(input_.colors[color].look, label.rgb)) return kMaxPaintCost;
    const double d = dissimilarity(label.lab, *expected[color]) / kPaint;
    return std::min(kMaxPaintCost, d * d / 2);
  }

  // Cost of a label as the ball; its ball candidates are the patches that no marker uses. A single candidate in a
  // picture counts as a recognized ball.
  double ball_cost(const std::vector<bool>& in_markers, const Label& label) const {
    std::map<std::size_t, int> alone;
    double cost = 0;
    for (const std::size_t p : label.patches) {
      if (in_markers[p]) {
        cost += kUnlistedRobot;
      } else if (is_ball_[p]) {
        ++alone[input_.picture[p]];
      }
    }
    for (const auto& [picture, count] : alone) cost += count == 1 ? -kExplained : kExplained * (count - 2);
    return alone.empty() ? cost + kMissing : cost;
  }

  // Returns the index of the robot that a marker shows with this assignment; kNone: unknown robot.
  std::size_t robot(const MarkerCandidate& m, const PatchLabels& cut, const std::vector<std::size_t>& color_of) const {
    const TeamMarking& team = input_.teams[m.team];
    for (std::size_t r = 0; r < team.robots.size(); ++r) {
      bool same = true;
      for (std::size_t k = 1; same && k < m.patches.size(); ++k) {
        same = color_of[cut.label_of[m.patches[k]]] + 1 == team.robots[r].colors[k - 1];
      }
      if (same) return r;
    }
    return kNone;
  }

  // Returns the cost of all markers; `color_of` gives the color of a label, or kNone.
  double marker_cost(const PatchLabels& cut, const std::vector<std::size_t>& color_of, Solution& out) const {
    double cost = 0;
    out.robots = out.unknown_robots = 0;
    out.named.clear();
    out.unlisted.clear();
    std::set<std::array<std::size_t, 3>> seen;
    for (const MarkerCandidate* m : out.markers) {
      if (input_.teams[m->team].robots.empty()) {
        cost -= kExplained;
        ++out.robots;
        continue;
      }
      if (std::any_of(m->patches.begin() + 1, m->patches.end(),
                      [&](std::size_t p) { return color_of[cut.label_of[p]] == kNone; })) {
        cost += 1.0;
        continue;
      }
      const std::size_t r = robot(*m, cut, color_of);
      const bool explained = r != kNone && seen.insert({m->picture, m->team, r}).second;
      cost += explained ? -kExplained : kUnlistedRobot;
      if (explained) out.named.push_back({m->picture, m->team, r, m->patches[0], m->patches});
      if (r == kNone) out.unlisted.push_back({m->picture, m->team, kNone, m->patches[0], m->patches});
      ++(explained ? out.robots : out.unknown_robots);
    }
    return cost;
  }

  std::vector<std::size_t> colors_of(const PatchLabels& cut, const std::vector<std::size_t>& label_of) const {
    std::vector<std::size_t> out(cut.labels.size(), kNone);
    for (std::size_t c = 0; c < label_of.size(); ++c) {
      if (label_of[c] != kNone) out[label_of[c]] = c;
    }
    for (std::size_t l = 0; l < out.size(); ++l) {
      if (fixed(cut.labels[l]) != kNone) out[l] = fixed(cut.labels[l]);
    }
    return out;
  }

  // Returns the cost of each label as each identification color, without the appearance: each patch contributes its
  // part of a marker. A label that shows no robot of the team file costs as much as a missing color. A label that also
  // shows unlisted robots may still cost less, so that robots of other teams do not take a color away.
  std::vector<std::vector<double>> roles(const PatchLabels& cut,
                                         const std::vector<const MarkerCandidate*>& markers) const {
    std::vector<std::vector<double>> cost(input_.colors.size(), std::vector<double>(cut.labels.size(), 0.0));
    std::vector<std::vector<bool>> explains(input_.colors.size(), std::vector<bool>(cut.labels.size(), false));
    std::map<std::array<std::size_t, 4>, int> seen;  // number of markers by picture, team, position, label
    for (const MarkerCandidate* m : markers) {
      const TeamMarking& team = input_.teams[m->team];
      for (std::size_t k = 1; k < m->patches.size(); ++k) {
        const std::size_t label = cut.label_of[m->patches[k]];
        const auto part = static_cast<double>(m->patches.size() - 1);
        const int before = seen[{m->picture, m->team, k, label}]++;
        for (std::size_t c = 0; c < cost.size(); ++c) {
          if (fixed(cut.labels[label]) != kNone) continue;
          const auto robots = std::count_if(team.robots.begin(), team.robots.end(),
                                            [&](const RobotMarking& r) { return r.colors[k - 1] == c + 1; });
          cost[c][label] += (before < robots ? -kExplained : kUnlistedRobot) / part;
          explains[c][label] = explains[c][label] || before < robots;
        }
      }
    }
    for (std::size_t c = 0; c < cost.size(); ++c) {
      for (std::size_t l = 0; l < cost[c].size(); ++l) {
        if (!explains[c][l]) cost[c][l] = kMissing;
      }
    }
    return cost;
  }

  Solution with_teams(const PatchLabels& cut, const Teams& teams, const Exclusion& exclusion) const {
    const std::size_t colors = input_.colors.size(), labels = cut.labels.size();
    Solution out;
    out.labels.insert(out.labels.end(), cut.labels.begin(), cut.labels.end());
    out.markers = choose(cut, teams, nullptr);
    std::vector<std::size_t> wanted;  // colors other than team colors
    std::vector<std::size_t> label_of(colors, kNone);
    for (std::size_t c = 0; c < colors; ++c) {
      bool is_team = false;
      for (std::size_t team = 0; team < 2; ++team) {
        if (input_.teams[team].team_color != c + 1) continue;
        is_team = true;
        label_of[c] = teams[team];
      }
      if (!is_team) wanted.push_back(c);
    }
    std::vector<double> ball(labels, 0.0);

    Rgb gain{1, 1, 1};
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      if (round > 0) {
        const std::vector<std::size_t> color_of = colors_of(cut, label_of);
        out.markers = choose(cut, teams, &color_of);
      }
      std::vector<bool> in_markers(input_.patches.size(), false);
      for (const MarkerCandidate* m : out.markers) {
        for (const std::size_t p : m->patches) in_markers[p] = true;
      }
      const auto role = roles(cut, out.markers);
      for (std::size_t l = 0; l < labels && input_.ball != kBackground; ++l)
        ball[l] = ball_cost(in_markers, cut.labels[l]);
      out.expected = expected_looks(cut, gain);
      std::vector<std::vector<double>> cost;
      std::vector<bool> is_useful(labels, false);
      for (const std::size_t c : wanted) {
        std::vector<double> row(labels, kForbidden);
        const bool is_id = is_identification(c);
        for (std::size_t l = 0; l < labels; ++l) {
          if (l == teams[0] || l == teams[1]) continue;
          double place = is_id ? role[c][l] : 0.0;
          if (c + 1 == input_.ball) place += ball[l];
          if (place >= kMissing) continue;  // a missing color costs less, whatever this label looks like
          row[l] = place + unlikely(c, cut.labels[l], out.expected, exclusion);
          is_useful[l] = is_useful[l] || row[l] < kForbidden / 2;
        }
        cost.push_back(std::move(row));
      }
      assign_useful(cut, wanted, cost, is_useful, label_of);
      improve(cut, wanted, teams, exclusion, ball, out, label_of);
      if (round + 1 < kRounds) gain = fitted_gain(cut, label_of);
    }
    out.cost = total(cut, label_of, exclusion, ball, out);
    for (const double g : gain) out.cost += std::pow(std::log(g) / 0.35, 2) / 2;
    out.label_of = label_of;
    return out;
  }

  // Assigns labels to colors. On a textured floor most labels suit no color; leaving them out saves work and does not
  // change the result.
  static void assign_useful(const PatchLabels& cut, const std::vector<std::size_t>& wanted,
                            const std::vector<std::vector<double>>& cost, const std::vector<bool>& is_useful,
                            std::vector<std::size_t>& label_of) {
    std::vector<std::size_t> useful;
    for (std::size_t l = 0; l < is_useful.size(); ++l) {
      if (is_useful[l]) useful.push_back(l);
    }
    std::vector<std::vector<double>> reduced;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      std::vector<double>& row = reduced.emplace_back();
      for (const std::size_t l : useful) row.push_back(cost[i][l]);
      row.resize(useful.size() + wanted.size(), missing(cut, wanted[i]));  // the last columns mean "not found"
    }
    const std::vector<std::size_t> column = assign(reduced);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      label_of[wanted[i]] = column[i] < useful.size() ? useful[column[i]] : kNone;
  }

  // Returns the cost of a missing color; a color with a click is not missing if no other label has it.
  static double missing(const PatchLabels& cut, std::size_t color) {
    return cut.named(color) == kNone ? kMissing : 0.0;
  }

  bool is_identification(std::size_t color) const {
    for (const TeamMarking& team : input_.teams) {
      for (const RobotMarking& robot : team.robots) {
        if (std::find(robot.colors.begin(), robot.colors.end(), color + 1) != robot.colors.end()) return true;
      }
    }
    return false;
  }

  double total(const PatchLabels& cut, const std::vector<std::size_t>& label_of, const Exclusion& exclusion,
               const std::vector<double>& ball, Solution& out) const {
    double cost = marker_cost(cut, colors_of(cut, label_of), out);
    for (std::size_t c = 0; c < label_of.size(); ++c) {
      if (label_of[c] == kNone) {
        cost += missing(cut, c);
        continue;
      }
      cost += unlikely(c, cut.labels[label_of[c]], out.expected, exclusion);
      if (c + 1 == input_.ball) cost += ball[label_of[c]];
    }
    for (const Label& label : cut.labels) {
      if (label.shade == kNone) continue;
      const std::size_t main = label_of[label.shade] != kNone ? label_of[label.shade] : cut.named(label.shade);
      const double d = main == kNone ? 0.0 : difference(label.lab, cut.labels[main].lab) / kShade;
      cost += main == kNone ? kForbidden : kFurtherShade + std::min(kMaxPaintCost, d * d / 2);
    }
    return cost;
  }

  // Swaps pairs of labels as long as the cost decreases, because the colors of robots with several identification
  // patches depend on each other.
  void improve(const PatchLabels& cut, const std::vector<std::size_t>& wanted, const Teams& teams,
               const Exclusion& exclusion, const std::vector<double>& ball, Solution& out,
               std::vector<std::size_t>& label_of) const {
    if (std::none_of(out.markers.begin(), out.markers.end(), [](const auto* m) { return m->patches.size() > 2; }))
      return;
    double best = total(cut, label_of, exclusion, ball, out);
    for (bool better = true; better;) {
      better = false;
      for (const std::size_t c : wanted) {
        for (std::size_t l = 0; l < cut.labels.size(); ++l) {
          if (l == teams[0] || l == teams[1] || l == label_of[c]) continue;
          std::vector<std::size_t> tried = label_of;
          for (const std::size_t other : wanted) {
            if (tried[other] == l) tried[other] = label_of[c];
          }
          tried[c] = l;
          const double cost = total(cut, tried, exclusion, ball, out);
          if (cost < best - 1e-9) {
            best = cost;
            label_of = std::move(tried);
            better = true;
          }
        }
      }
    }
  }

  // Returns the expected appearances: a color looks like the patch that was clicked on, or like its name in this light.
  std::vector<std::optional<Lab>> expected_looks(const PatchLabels& cut, const Rgb& gain) const {
    std::vector<std::optional<Lab>> out(input_.colors.size());
    for (std::size_t color = 0; color < out.size(); ++color) {
      if (const std::size_t clicked = cut.named(color); clicked != kNone) {
        out[color] = cut.labels[clicked].lab;
      } else if (std::optional<Rgb> rgb = input_.colors[color].look) {
        for (std::size_t c = 0; c < 3; ++c) (*rgb)[c] = std::min(255.0, (*rgb)[c] * gain[c]);
        out[color] = lab_of(*rgb);
      }
    }
    return out;
  }

  // Fits exposure and white balance relative to the table of names: one gain per channel with a prior of 1.
  Rgb fitted_gain(const PatchLabels& cut, const std::vector<std::size_t>& label_of) const {
    constexpr double kPriorWeight = 4.0;
    Rgb sum{};
    double count = kPriorWeight;
    for (std::size_t c = 0; c < label_of.size(); ++c) {
      const std::size_t clicked = cut.named(c), label = clicked == kNone ? label_of[c] : clicked;
      if (label == kNone || !input_.colors[c].look) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        sum[k] += std::log((cut.labels[label].rgb[k] + kRatioOffset) / ((*input_.colors[c].look)[k] + kRatioOffset));
      }
      count += 1;
    }
    Rgb gain{};
    for (std::size_t k = 0; k < 3; ++k) gain[k] = std::clamp(std::exp(sum[k] / count), 0.4, 1.6);
    return gain;
  }

  const AssignmentInput& input_;
  const std::vector<PatchLabels>& cuts_;
  std::vector<bool> is_ball_;  // for each patch
};

}  // namespace

Solution solve_assignment(const AssignmentInput& input, const std::vector<PatchLabels>& cuts,
                          const Exclusion& exclusion, bool with_shades) {
  return Solver(input, cuts).solve(exclusion, with_shades);
}

}  // namespace touchline::calibrate
