#include "tools/programs/calibrate/colors/detection_doubts.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

// Least difference of the negative log-likelihood to the next best assignment: a probability of 95 %.
constexpr double kMinCostMargin = 3.0;
// Largest difference from the expected appearance of a color name; the names themselves are 30 to 100 apart.
constexpr double kMaxDissimilarity = 55.0;
// Below this difference, it does not matter that another patch might have the color: the self-check would show a wrong
// choice.
constexpr double kMatchingDissimilarity = 30.0;

// Returns whether more robots contradict the team file than match it.
bool contradicts_team_file(const Assignment& assignment) { return assignment.unknown_robots > assignment.robots; }

class Doubts {
 public:
  Doubts(const AssignmentInput& input, const Assignment& assignment, const std::vector<std::string>& images,
         const std::vector<Click>& clicks)
      : input_(input), assignment_(assignment), images_(images), clicks_(clicks) {}

  std::vector<DetectionDoubt> found() {
    for (std::size_t c = 0; c < input_.colors.size(); ++c) {
      if (!input_.colors[c].clicked) examine(c);
    }
    if (contradicts_team_file(assignment_) && !is_team_clicked()) {
      out_.push_back(
          {formatted("%zu robots match the team file, %zu have colors of no robot in it (%s); is this the right team "
                     "file? If it is, take them away, or click on a team patch of your own",
                     assignment_.robots, assignment_.unknown_robots, places_of_unlisted().c_str()),
           team_click(), kNone});
    }
    return std::move(out_);
  }

  [[nodiscard]] std::string unlisted() const {
    return formatted("nothing is learned from %zu robots whose colors are those of no robot in the team file: %s",
                     assignment_.unlisted.size(), places_of_unlisted().c_str());
  }

 private:
  void examine(std::size_t c) {
    const AssignedColor& color = assignment_.colors[c];
    const WantedColor& wanted = input_.colors[c];
    const char* const name = wanted.name.c_str();
    if (const AssignedRobot* const odd = in_odd_light(c); color.patches.empty() && odd != nullptr) {
      const PixelPoint& at = input_.patches[odd->team_patch].center;
      out_.push_back(
          {formatted("%s: only robot %s %d shows it, at %.0f,%.0f of %s in glare or shade, in which it does not look "
                     "as elsewhere; "
                     "show a further picture in which this robot stands elsewhere",
                     name, odd->team == 0 ? "own" : "opponent",
                     static_cast<int>(input_.teams[odd->team].robots[odd->robot].id), static_cast<double>(at.u_px),
                     static_cast<double>(at.v_px), images_[odd->picture].c_str()) +
               beside_clicks(c),
           any_click(c), c});
    } else if (color.patches.empty()) {
      out_.push_back(
          {formatted("%s: no patch was found in %s; show a further picture in which %s, or click on %s", name,
                     searched().c_str(), wish(c).c_str(), c + 1 == input_.ball ? "it" : "one of its patches"),
           any_click(c)});
    } else if (color.dissimilarity > kMaxDissimilarity && !has_hue_of(wanted.look, color.rgb)) {
      out_.push_back(
          {formatted("%s: the remaining patches do not look like it (difference %.0f); click on one of its patches",
                     name, color.dissimilarity) +
               beside_clicks(c),
           any_click(c), c});
      // An unusual paint of the right hue raises no doubt if no other patch could have the color.
    } else if (color.margin < kMinCostMargin && !(color.same && c + 1 != input_.ball) &&
               !(color.alone && has_hue_of(wanted.look, color.rgb)) &&
               (!color.alternative.empty() || !wanted.look || color.dissimilarity > kMatchingDissimilarity)) {
      const char* const other = color.alternative.empty() ? "another patch" : color.alternative.c_str();
      if (was_clicked(c, example(c), input_.picture[color.patches.front()])) {
        out_.push_back({formatted("%s: could also be %s although %s was clicked on; show a further picture in which %s",
                                  name, other, place(c).c_str(), wish(c).c_str()),
                        "", c});
      } else {
        out_.push_back({formatted("%s: could also be %s; %s is taken for %s: click on it if that is right, otherwise "
                                  "on one that is",
                                  name, other, place(c).c_str(), name),
                        click(c), c});
      }
    }
  }

  // Returns a robot with this color that was recognized, but from which no color was learned; nullptr if there is none.
  [[nodiscard]] const AssignedRobot* in_odd_light(std::size_t c) const {
    const auto& robots = assignment_.in_odd_light;
    const auto found = std::find_if(robots.begin(), robots.end(), [&](const AssignedRobot& one) {
      const auto& colors = input_.teams[one.team].robots[one.robot].colors;
      return std::find(colors.begin(), colors.end(), c + 1) != colors.end();
    });
    return found == robots.end() ? nullptr : &*found;
  }
  [[nodiscard]] std::string searched() const {
    return images_.size() == 1 ? images_.front() : formatted("any of the %zu pictures", images_.size());
  }
  // Says what a picture must show so that this color is found.
  [[nodiscard]] std::string wish(std::size_t c) const {
    if (c + 1 == input_.ball) return "the ball lies elsewhere, alone on the field";
    std::string robots;
    std::size_t count = 0, all = 0;
    for (std::size_t t = 0; t < 2; ++t) {
      const TeamMarking& team = input_.teams[t];
      if (team.team_color == kBackground) continue;
      all += team.robots.size();
      for (const RobotMarking& robot : team.robots) {
        if (std::find(robot.colors.begin(), robot.colors.end(), c + 1) == robot.colors.end()) continue;
        robots +=
            formatted("%s%s %d", count == 0 ? "" : " or ", t == 0 ? "own" : "opponent", static_cast<int>(robot.id));
        ++count;
      }
    }
    if (count > 0) return "robot " + robots + " stands elsewhere, apart from all others and out of glare and shade";
    if (all == 0) return "robots of this team stand elsewhere, apart from all others and out of glare and shade";
    return formatted("all %zu robots stand elsewhere, apart and out of glare and shade", all);
  }

  // Returns whether a person has named the team's color, and so knows which robots are meant.
  [[nodiscard]] bool is_team_clicked() const {
    return std::any_of(input_.teams.begin(), input_.teams.end(), [&](const TeamMarking& team) {
      return team.team_color != kBackground && input_.colors[team.team_color - 1U].clicked;
    });
  }
  [[nodiscard]] std::string team_click() const {
    for (const TeamMarking& team : input_.teams) {
      if (team.team_color != kBackground) return any_click(team.team_color - std::size_t{1});
    }
    return "";
  }
  [[nodiscard]] std::string places_of_unlisted() const {
    std::string text;
    for (const AssignedRobot& robot : assignment_.unlisted) {
      const PixelPoint& at = input_.patches[robot.team_patch].center;
      text += formatted("%s%.0f,%.0f of %s", text.empty() ? "at " : ", ", static_cast<double>(at.u_px),
                        static_cast<double>(at.v_px), images_[robot.picture].c_str());
    }
    return text.empty() ? "twice in a picture" : text;
  }

  // Returns the first of the patches that are taken for this color.
  [[nodiscard]] const FoundPatch& example(std::size_t c) const {
    return input_.patches[assignment_.colors[c].patches.front()];
  }
  [[nodiscard]] std::string place(std::size_t c) const {
    const FoundPatch& patch = example(c);
    return formatted("the patch at %.0f,%.0f%s", static_cast<double>(patch.center.u_px),
                     static_cast<double>(patch.center.v_px), of_picture(c, " of ").c_str());
  }
  [[nodiscard]] std::string any_click(std::size_t c) const { return "--click " + input_.colors[c].name + ",U,V"; }
  // Returns whether the person has already named this color on this patch.
  [[nodiscard]] bool was_clicked(std::size_t c, const FoundPatch& patch, std::size_t picture) const {
    return std::any_of(clicks_.begin(), clicks_.end(), [&](const Click& one) {
      return one.color == input_.colors[c].name && one.image == images_[picture] &&
             std::hypot(one.u_px - static_cast<double>(patch.center.u_px),
                        one.v_px - static_cast<double>(patch.center.v_px)) <= patch.radius_px;
    });
  }
  // Returns the words that ask for another click, because the clicks on this color did not help.
  [[nodiscard]] std::string beside_clicks(std::size_t c) const {
    std::string places;
    for (const Click& one : clicks_) {
      if (one.color == input_.colors[c].name) places += formatted(" %.0f,%.0f", one.u_px, one.v_px);
    }
    return places.empty() ? "" : "; clicks at" + places + " were not used, see above: click elsewhere";
  }
  // Returns the option for a click on the patch that is taken for this color.
  [[nodiscard]] std::string click(std::size_t c) const {
    const FoundPatch& patch = example(c);
    return formatted("--click %s,%.0f,%.0f%s", input_.colors[c].name.c_str(), static_cast<double>(patch.center.u_px),
                     static_cast<double>(patch.center.v_px), of_picture(c, ",").c_str());
  }
  // Returns the picture's name if there are several pictures.
  [[nodiscard]] std::string of_picture(std::size_t c, const std::string& before) const {
    if (images_.size() < 2) return "";
    return before + images_[input_.picture[assignment_.colors[c].patches.front()]];
  }

  const AssignmentInput& input_;
  const Assignment& assignment_;
  const std::vector<std::string>& images_;
  const std::vector<Click>& clicks_;
  std::vector<DetectionDoubt> out_;
};

}  // namespace

std::vector<DetectionDoubt> detection_doubts(const AssignmentInput& input, const Assignment& assignment,
                                             const std::vector<std::string>& images, const std::vector<Click>& clicks) {
  return Doubts(input, assignment, images, clicks).found();
}

std::string describe_unlisted(const AssignmentInput& input, const Assignment& assignment,
                              const std::vector<std::string>& images) {
  if (assignment.unlisted.empty() || contradicts_team_file(assignment)) return "";
  return Doubts(input, assignment, images, {}).unlisted();
}

}  // namespace touchline::calibrate
