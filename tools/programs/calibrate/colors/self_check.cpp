#include "tools/programs/calibrate/colors/self_check.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <set>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/replay/canvas.h"
#include "tools/programs/replay/field_shapes.h"

namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

// Largest distance, relative to a robot's side, at which a team patch of the pipeline and one of the calibration belong
// to the same robot; team patches of touching robots are farther apart.
constexpr float kSameRobot = 0.5F;

constexpr replay::CanvasColor kRight{0.2, 1.0, 0.3}, kUnknown{1.0, 0.65, 0.1}, kWrong{1.0, 0.15, 0.15};

std::string name_of(Team team, RobotId id) {
  return formatted("%s %d", team == Team::kOwn ? "own" : "opponent", static_cast<int>(id));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

// Joins names of robots and repeats the team only where it changes: "own 1, 2, opponent 0".
std::string joined_robots(const std::vector<std::string>& names) {
  std::string text, before;
  for (const std::string& name : names) {
    const std::size_t space = name.find(' ');
    const std::string team = name.substr(0, space);
    text += (text.empty() ? "" : ", ") + (team == before ? name.substr(space + 1) : name);
    before = team;
  }
  return text;
}

// Returns true if the pipeline gives an id to a robot that the calibration recognized as another one, or as none of the
// team file.
bool contradicts(const RobotSighting& sighting, const VisibleRobot* there) {
  if (sighting.id == kUnknownId || there == nullptr) return false;
  return !there->listed || (there->id != kUnknownId && (there->id != sighting.id || there->team != sighting.team));
}

class Checker {
 public:
  Checker(const std::string& folder, const config::Configuration& configuration)
      : folder_(folder), configuration_(configuration) {
    (void)camera_.configure(configuration.pipeline.camera);  // the pipeline has already accepted this camera model
    for (const std::size_t team : {std::size_t{0}, std::size_t{1}}) {
      if (marker().teams[team].team_color == kBackground) continue;
      for (const RobotMarking& robot : marker().teams[team].robots)
        robots_.push_back(name_of(static_cast<Team>(team), robot.id));
    }
  }

  /// Returns the names of the team file's robots.
  [[nodiscard]] const std::vector<std::string>& robots() const { return robots_; }

  CheckedPicture check(const std::string& image, const Sightings& sightings, const VisibleObjects& visible) const {
    const std::vector<VisibleRobot>& robots = visible.robots;
    CheckedPicture out;
    out.image = image;
    out.ball = sightings.ball.seen;
    out.ball_missing = visible.ball && !is_ball_at(sightings.ball, *visible.ball);
    for (const RobotSighting& sighting : sightings.robots) {
      if (!has_robots(sighting.team)) continue;
      const VisibleRobot* const there = robot_at(robots, sighting);
      if (there != nullptr && !there->listed && sighting.id == kUnknownId) {
        ++out.unlisted;
        continue;
      }
      ++out.visible;
      if (sighting.id == kUnknownId) {
        ++out.unknown;
      } else if (contradicts(sighting, there)) {
        out.wrong.push_back(name_of(sighting.team, sighting.id) + " where " +
                            (there->listed ? name_of(there->team, there->id) + " is" : "no robot of the team file is"));
      } else {
        out.explained.insert(name_of(sighting.team, sighting.id));
      }
    }
    for (const VisibleRobot& robot : robots) {
      if (!has_robots(robot.team) || !robot.listed) continue;
      const std::string name = robot.id == kUnknownId ? "" : name_of(robot.team, robot.id);
      if (out.explained.count(name) > 0) continue;
      if (!name.empty()) out.missing.push_back(name);
      // If the calibration found a patch in two parts, it counts once.
      const bool is_seen = std::any_of(sightings.robots.begin(), sightings.robots.end(),
                                       [&](const RobotSighting& one) { return distance_of(robot, one) < kSameRobot; });
      if (is_seen) continue;
      ++out.visible;
      ++out.unseen;
    }
    return out;
  }

  Result<void> draw(const CheckedPicture& result, const Frame& frame, const Sightings& sightings,
                    const std::vector<VisibleRobot>& robots, const std::string& summary) const {
    const replay::SurfacePtr surface = replay::to_surface(frame);
    const replay::ContextPtr context(cairo_create(surface.get()));
    for (const RobotSighting& sighting : sightings.robots) {
      const bool wrong = contradicts(sighting, robot_at(robots, sighting));
      const replay::CanvasColor color = sighting.id == kUnknownId ? kUnknown : wrong ? kWrong : kRight;
      const MarkerLayout& layout = marker().teams[static_cast<std::size_t>(sighting.team)].layout;
      if (sighting.has_heading) {
        replay::square_on_field(*context, camera_, sighting.pose, layout.robot_side_m, layout.height_m);
      } else {
        replay::circle_on_field(*context, camera_, sighting.pose.position, layout.robot_side_m / 2,
                                layout.robot_side_m / 2, layout.height_m);
      }
      replay::set_color(*context, color);
      cairo_set_line_width(context.get(), 2.0);
      cairo_stroke(context.get());
      const PixelPoint at = camera_.to_pixel(sighting.pose.position, layout.height_m);
      const std::string name = sighting.id == kUnknownId
                                   ? std::string(sighting.team == Team::kOwn ? "own ?" : "opponent ?")
                                   : name_of(sighting.team, sighting.id);
      constexpr double kBeside_px = 12, kTextSize = 12, kAbove_px = 12;
      // At the picture's right and upper edge the name is moved inside.
      const double right_px = frame.width_px - replay::text_width(*context, name, kTextSize) - 2;
      replay::draw_text(*context, std::min(static_cast<double>(at.u_px) + kBeside_px, right_px),
                        std::max(static_cast<double>(at.v_px) - kAbove_px, kTextSize), name, color, kTextSize);
    }
    if (sightings.ball.seen) {
      cairo_arc(context.get(), static_cast<double>(sightings.ball.center.u_px) + 0.5,
                static_cast<double>(sightings.ball.center.v_px) + 0.5, 9, 0, 6.2832);
      replay::set_color(*context, kRight);
      cairo_stroke(context.get());
    }
    replay::draw_text(*context, 6, 18, summary, {1, 1, 1}, 13);
    const std::string path = (fs::path(folder_) / (fs::path(result.image).stem().string() + "-check.png")).string();
    return replay::write_png(*surface, path);
  }

 private:
  // Returns the distance of the team patches, relative to a robot's side.
  [[nodiscard]] float distance_of(const VisibleRobot& robot, const RobotSighting& sighting) const {
    const MarkerLayout& layout = marker().teams[static_cast<std::size_t>(sighting.team)].layout;
    const FieldPoint there = camera_.to_field(robot.team_patch, layout.height_m);
    float least = 2 * kSameRobot;
    for (const PatchSighting& patch : sighting.patches) {
      if (patch.role != PatchRole::kTeam) continue;
      const FieldPoint at = camera_.to_field(patch.center, layout.height_m);
      least = std::min(least, std::hypot(there.x_m - at.x_m, there.y_m - at.y_m) / layout.robot_side_m);
    }
    return least;
  }
  [[nodiscard]] bool is_ball_at(const BallSighting& ball, PixelPoint place) const {
    const float radius_m = marker().ball.radius_m;
    const FieldPoint there = camera_.to_field(place, radius_m);
    return ball.seen && std::hypot(there.x_m - ball.position.x_m, there.y_m - ball.position.y_m) < radius_m;
  }
  // Returns the robot that the calibration found where the pipeline sees this one; nullptr if there is none.
  [[nodiscard]] const VisibleRobot* robot_at(const std::vector<VisibleRobot>& robots,
                                             const RobotSighting& sighting) const {
    const auto nearest = std::min_element(robots.begin(), robots.end(), [&](const auto& a, const auto& b) {
      return distance_of(a, sighting) < distance_of(b, sighting);
    });
    return nearest != robots.end() && distance_of(*nearest, sighting) < kSameRobot ? &*nearest : nullptr;
  }
  // Returns whether robots of the team have ids: they have none if the team file knows only the team's color.
  [[nodiscard]] bool has_robots(Team team) const {
    return !marker().teams[static_cast<std::size_t>(team)].robots.empty();
  }
  [[nodiscard]] const MarkerParameters& marker() const { return configuration_.pipeline.marker; }

  std::string folder_;
  const config::Configuration& configuration_;
  CameraModel camera_;
  std::vector<std::string> robots_;
};

std::string line_of(const CheckedPicture& picture, bool wants_ball) {
  std::string text = formatted("%s: %zu of %zu visible robots explained", fs::path(picture.image).filename().c_str(),
                               picture.explained.size(), picture.visible);
  if (!picture.missing.empty()) text += "; missing: " + joined_robots(picture.missing);
  if (!picture.wrong.empty()) text += "; wrong: " + joined(picture.wrong);
  if (picture.unknown > 0) text += formatted("; without id: %zu", picture.unknown);
  if (picture.unlisted > 0) text += formatted("; not in the team file: %zu", picture.unlisted);
  if (picture.unseen > 0) text += formatted("; not seen: %zu", picture.unseen);
  if (wants_ball && picture.ball_missing) {
    text += "; ball not recognized";
  } else if (wants_ball && !picture.ball) {
    text += "; no ball";
  }
  return text;
}

}  // namespace

std::vector<std::string> SelfCheck::missing() const {
  std::vector<std::string> out;
  std::copy_if(robots.begin(), robots.end(), std::back_inserter(out), [this](const std::string& robot) {
    return std::none_of(pictures.begin(), pictures.end(),
                        [&](const CheckedPicture& p) { return p.explained.count(robot) > 0; });
  });
  return out;
}

int SelfCheck::recognized() const {
  int count = 0;
  for (const CheckedPicture& picture : pictures) {
    count +=
        static_cast<int>(picture.explained.size()) + (picture.ball ? 1 : 0) - static_cast<int>(picture.wrong.size());
  }
  return count;
}

std::string SelfCheck::absent() const {
  return all_visible_explained() && ball_explained() ? joined_robots(missing()) : "";
}

bool SelfCheck::all_visible_explained() const {
  return std::all_of(pictures.begin(), pictures.end(),
                     [&](const CheckedPicture& p) { return p.explained.size() == p.visible && p.missing.empty(); });
}

bool SelfCheck::ball_explained() const {
  if (!wants_ball) return true;
  return std::any_of(pictures.begin(), pictures.end(), [](const CheckedPicture& p) { return p.ball; }) &&
         std::none_of(pictures.begin(), pictures.end(), [](const CheckedPicture& p) { return p.ball_missing; });
}

bool SelfCheck::most_visible_explained() const {
  // One in ten robots may stay unknown, because robots of other games may be in the pictures.
  constexpr double kMinExplainedShare = 0.9;
  std::size_t visible = 0, explained = 0;
  for (const CheckedPicture& picture : pictures) {
    if (!picture.wrong.empty()) return false;
    visible += picture.visible;
    explained += picture.explained.size();
  }
  return static_cast<double>(explained) >= kMinExplainedShare * static_cast<double>(visible);
}

std::size_t SelfCheck::robots_explained() const {
  std::size_t count = 0;
  for (const CheckedPicture& picture : pictures) count += picture.explained.size();
  return count;
}

const OtherLightResult* SelfCheck::fragile_in() const {
  // One in four robots may stand at the edge of a lamp's light; if more are lost, the boxes have no tolerance.
  constexpr double kMin = 0.75;
  const auto worst = std::min_element(other_light.begin(), other_light.end(),
                                      [](const auto& a, const auto& b) { return a.robots < b.robots; });
  const double least = kMin * static_cast<double>(robots_explained());
  return worst != other_light.end() && static_cast<double>(worst->robots) < least ? &*worst : nullptr;
}

bool SelfCheck::passed() const {
  return missing().empty() && most_visible_explained() && ball_explained() && fragile_in() == nullptr;
}

std::string SelfCheck::text() const {
  std::string text;
  std::size_t balls = 0;
  for (const CheckedPicture& picture : pictures) {
    text += line_of(picture, wants_ball) + "\n";
    balls += picture.ball ? 1U : 0U;
  }
  const std::vector<std::string> never = missing();
  text += formatted("self-check: %zu of %zu robots explained", robots.size() - never.size(), robots.size());
  if (!never.empty()) text += "; missing: " + joined_robots(never);
  if (wants_ball) text += formatted("; ball in %zu of %zu pictures", balls, pictures.size());
  text += "\n";
  std::string lights;
  for (const OtherLightResult& one : other_light)
    lights += formatted("%s%zu %s", lights.empty() ? "" : ", ", one.robots, one.light.c_str());
  if (!lights.empty()) text += formatted("of %zu robots in the pictures: %s\n", robots_explained(), lights.c_str());
  return text;
}

Result<SelfCheck> self_check(const std::string& venue, const std::string& team,
                             const std::map<std::string, CameraPicture>& pictures, const VisibleByPicture& visible,
                             const std::string& folder) {
  const auto configuration = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load_venue_and_team({{}, venue, team, {}}, *configuration));
  const Frame first = pictures.begin()->second.frame();
  TOUCHLINE_TRY(
      config::resolve({first.format, first.width_px, first.height_px, pictures.begin()->first}, *configuration));
  const auto pipeline = std::make_unique<Pipeline>();
  const StepInputs inputs = observing_inputs();
  SelfCheck out;
  out.wants_ball = configuration->pipeline.marker.ball.color != kBackground;
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  static const VisibleObjects nothing;
  for (const auto& [image, picture] : pictures) {
    // The pipeline is configured anew for each picture, so that no picture profits from an earlier one.
    if (const Status status = pipeline->configure(configuration->pipeline); !status.ok()) {
      return failure(status.code(), "%s and %s cannot be used together: %s", venue.c_str(), team.c_str(),
                     describe(status.code()));
    }
    const Checker checker(folder, *configuration);
    const auto found = visible.find(image);
    const VisibleObjects& known = found == visible.end() ? nothing : found->second;
    const Frame frame = picture.frame();
    const Sightings& sightings = pipeline->step(frame, inputs).sightings;
    out.robots = checker.robots();
    out.pictures.push_back(checker.check(image, sightings, known));
    if (folder.empty()) continue;
    TOUCHLINE_TRY(checker.draw(out.pictures.back(), frame, sightings, known.robots,
                               line_of(out.pictures.back(), out.wants_ball)));
  }
  return out;
}

}  // namespace touchline::calibrate
