#include "tests/calibrate/team_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "tests/results.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream all;
  all << file.rdbuf();
  return all.str();
}

const StandingRobot* robot_at(const TeamScene& scene, const FieldPoint& place) {
  for (const StandingRobot& robot : scene.robots) {
    if (std::hypot(robot.x_m - static_cast<double>(place.x_m), robot.y_m - static_cast<double>(place.y_m)) <
        static_cast<double>(scene.layout.robot_side_m) / 2)
      return &robot;
  }
  return nullptr;
}

void judge(const std::string& venue, const std::string& team_path, const DrawnTeam& team, const std::string& folder,
           TeamTrial& trial) {
  const auto configuration = std::make_unique<config::Configuration>();
  ASSERT_OK(config::load_venue_and_team({{}, venue, team_path, {}}, *configuration));
  const auto pipeline = std::make_unique<Pipeline>();
  for (std::size_t i = 0; i < team.pictures.size(); ++i) {
    const std::string path = folder + "/picture-" + std::to_string(i) + ".png";
    ASSERT_OK_AND_ASSIGN(const CameraPicture picture, CameraPicture::load(path, *format_of(team.format)));
    const Frame frame = picture.frame();
    ASSERT_OK(config::resolve({frame.format, frame.width_px, frame.height_px, path}, *configuration));
    ASSERT_TRUE(pipeline->configure(configuration->pipeline).ok());
    const Sightings& seen = pipeline->step(frame).sightings;
    const TeamScene& scene = team.pictures[i].scene;
    for (const RobotSighting& robot : seen.robots) {
      if (robot.id == kUnknownId) continue;
      const StandingRobot* const there = robot_at(scene, robot.pose.position);
      const bool right = there != nullptr && there->team == robot.team && there->id == robot.id;
      ++(right ? trial.right : trial.wrong);
    }
    trial.robots += scene.robots.size();
    ++trial.pictures;
    trial.balls += seen.ball.seen && std::hypot(static_cast<double>(seen.ball.position.x_m) - scene.ball_x_m,
                                                static_cast<double>(seen.ball.position.y_m) - scene.ball_y_m) < 0.03
                       ? 1U
                       : 0U;
  }
}

}  // namespace

TeamTrial calibrate_colors(const std::string& program, const DrawnTeam& team, const std::string& folder) {
  TeamTrial trial;
  fs::create_directories(folder);
  const std::string venue = folder + "/venue.toml", team_path = folder + "/team.toml";
  for (std::size_t i = 0; i < team.pictures.size(); ++i) {
    EXPECT_OK(hal::write_picture(folder + "/picture-" + std::to_string(i) + ".png", team.pictures[i].picture));
  }
  std::ofstream(team_path) << team.team_file;
  std::ofstream(venue) << "version = 1\n";
  EXPECT_OK(
      write_sections(venue, {section_of("picture", team.venue.picture, ""), section_of("field", team.venue.field, ""),
                             section_of("camera_model", team.venue.camera_model, "")}));
  const std::string before = text_of(venue);
  const std::string command = program + " colors --yes --venue " + venue + " --team " + team_path + " --format " +
                              team.format + " --picture " + folder + "/picture-0.png >" + folder + "/out 2>&1";
  trial.accepted = std::system(command.c_str()) == 0;  // NOLINT(cert-env33-c,concurrency-mt-unsafe): program under test
  trial.output = text_of(folder + "/out");
  trial.wrote = text_of(venue) != before;
  trial.offered = !trial.accepted && trial.output.find("--accept") != std::string::npos;
  if (trial.accepted) judge(venue, team_path, team, folder, trial);
  if (trial.offered) judge(folder + "/venue-unaccepted.toml", team_path, team, folder, trial);
  return trial;
}

}  // namespace touchline::calibrate
