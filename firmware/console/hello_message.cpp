#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "firmware/config/uncalibrated.h"
#include "firmware/console/messages.h"
#include "firmware/console/protocol.h"
#include "firmware/report/trace_json.h"

namespace touchline::console {
namespace {

using report::JsonWriter;
using report::kMeterStep;
using report::write_number;

// Distance of the grid's points. The page interpolates between them, with an error below a pixel on a field of 2.2 m.
constexpr double kGridStepM = 0.1;
constexpr double kMaxGridColumns = 48.0;
constexpr double kGridPixelStep = 0.1;

void write_text(JsonWriter& json, std::string_view key, std::string_view text) {
  json.key(key);
  json.string(text);
}

void write_rgb(JsonWriter& json, const std::array<std::uint8_t, 3>& rgb) {
  json.begin_array();
  for (const std::uint8_t value : rgb) json.integer(value);
  json.end_array();
}

void write_field(JsonWriter& json, const FieldParameters& field) {
  json.begin_object();
  write_number(json, "length_m", field.length_m, kMeterStep);
  write_number(json, "width_m", field.width_m, kMeterStep);
  write_number(json, "goal_width_m", field.goal_width_m, kMeterStep);
  write_number(json, "goal_depth_m", field.goal_depth_m, kMeterStep);
  write_number(json, "margin_m", field.margin_m, kMeterStep);
  write_number(json, "center_circle_m", field.center_circle_m, kMeterStep);
  write_number(json, "penalty_area_depth_m", field.penalty_area_depth_m, kMeterStep);
  write_number(json, "penalty_area_width_m", field.penalty_area_width_m, kMeterStep);
  json.end_object();
}

void write_camera(JsonWriter& json, const hal::CameraInfo& camera) {
  json.begin_object();
  json.key("width_px");
  json.integer(camera.width_px);
  json.key("height_px");
  json.integer(camera.height_px);
  write_number(json, "rate_hz", camera.rate_hz, 1e-3);
  write_text(json, "description", camera.description);
  json.end_object();
}

/// Writes the pixels of a grid of points on the field at the heights of floor and markers, so that the page needs no
/// camera model.
void write_projection(JsonWriter& json, const Scene& scene) {
  const MarkerParameters& marker = scene.configuration->pipeline.marker;
  const FieldParameters& field = marker.field;
  const double half_x = static_cast<double>(field.length_m / 2 + field.goal_depth_m + field.margin_m);
  const double half_y = static_cast<double>(field.width_m / 2 + field.margin_m);
  const double step = std::max(kGridStepM, 2 * half_x / kMaxGridColumns);
  const auto columns = static_cast<int>(std::ceil(2 * half_x / step)) + 1;
  const auto rows = static_cast<int>(std::ceil(2 * half_y / step)) + 1;
  const double x_min = -step * (columns - 1) / 2.0, y_min = -step * (rows - 1) / 2.0;
  json.begin_object();
  write_number(json, "x_min_m", x_min, kMeterStep);
  write_number(json, "y_min_m", y_min, kMeterStep);
  json.key("step_m");
  json.number(step);
  json.key("columns");
  json.integer(columns);
  json.key("rows");
  json.integer(rows);
  json.key("planes");
  json.begin_array();
  std::vector<float> heights{0.0f};
  for (const TeamMarking& team : marker.teams) {
    const float height = team.layout.height_m;
    if (std::find(heights.begin(), heights.end(), height) == heights.end()) heights.push_back(height);
  }
  for (const float height : heights) {
    json.begin_object();
    write_number(json, "height_m", height, kMeterStep);
    json.key("uv_px");
    json.begin_array();
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const FieldPoint point{static_cast<float>(x_min + step * column), static_cast<float>(y_min + step * row)};
        const PixelPoint pixel = scene.model.to_pixel(point, height);
        json.number(report::rounded(static_cast<double>(pixel.u_px), kGridPixelStep));
        json.number(report::rounded(static_cast<double>(pixel.v_px), kGridPixelStep));
      }
    }
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

std::string_view name_of(const Scene& scene, ColorId color) {
  const auto& colors = scene.configuration->venue.color;
  return color == kBackground || color > colors.size() ? std::string_view() : colors[color - 1U].name;
}

void write_patch(JsonWriter& json, const Scene& scene, const PatchPlace& place, ColorId color) {
  json.begin_object();
  write_text(json, "color", name_of(scene, color));
  json.key("rgb");
  write_rgb(json, rgb_of(scene, color));
  write_number(json, "x_m", place.x_m, kMeterStep);
  write_number(json, "y_m", place.y_m, kMeterStep);
  // The radius is that of a circle with the same area.
  write_number(json, "radius_m", std::sqrt(area_m2(place) / 3.14159265f), kMeterStep);
  json.end_object();
}

void write_robot(JsonWriter& json, const Scene& scene, Team team, const TeamMarking& marking,
                 const RobotMarking& robot) {
  json.begin_object();
  write_text(json, "team", word_of(team));
  json.key("id");
  json.integer(robot.id);
  write_text(json, "color", name_of(scene, marking.team_color));
  json.key("rgb");
  write_rgb(json, rgb_of(scene, marking.team_color));
  write_number(json, "length_m", marking.layout.robot_side_m, kMeterStep);
  write_number(json, "width_m", marking.layout.robot_side_m, kMeterStep);
  write_number(json, "height_m", marking.layout.height_m, kMeterStep);
  json.key("patches");
  json.begin_array();
  std::size_t next = 0;
  for (const PatchPlace& place : marking.layout.patches) {
    const bool is_team = place.role == PatchRole::kTeam;
    const ColorId own = !is_team && next < robot.colors.size() ? robot.colors[next++] : kBackground;
    write_patch(json, scene, place, is_team ? marking.team_color : own);
  }
  json.end_array();
  json.end_object();
}

void write_robots(JsonWriter& json, const Scene& scene) {
  json.begin_array();
  for (const Team team : {Team::kOwn, Team::kOpponent}) {
    const TeamMarking& marking = scene.configuration->pipeline.marker.teams[index_of(team)];
    for (const RobotMarking& robot : marking.robots) write_robot(json, scene, team, marking, robot);
  }
  json.end_array();
}

void write_classes(JsonWriter& json, const Scene& scene) {
  json.begin_array();
  for (const config::ColorEntry& color : scene.configuration->venue.color) {
    json.begin_object();
    write_text(json, "name", color.name);
    json.key("rgb");
    write_rgb(json, color.shown_rgb);
    json.end_object();
  }
  json.end_array();
}

void write_verdicts(JsonWriter& json) {
  json.begin_array();
  for (std::size_t i = 0; i <= static_cast<std::size_t>(Verdict::kSurplus); ++i) {
    const auto verdict = static_cast<Verdict>(i);
    json.begin_object();
    write_text(json, "text", describe(verdict));
    json.key("refused");
    json.boolean(is_refusal(verdict));
    json.end_object();
  }
  json.end_array();
}

void write_region_of_interest(JsonWriter& json, const Polygon& polygon) {
  json.begin_array();
  for (const PixelPoint& point : polygon) {
    json.begin_array();
    json.number(report::rounded(static_cast<double>(point.u_px), kGridPixelStep));
    json.number(report::rounded(static_cast<double>(point.v_px), kGridPixelStep));
    json.end_array();
  }
  json.end_array();
}

}  // namespace

std::array<std::uint8_t, 3> rgb_of(const Scene& scene, ColorId color) {
  const auto& colors = scene.configuration->venue.color;
  return color == kBackground || color > colors.size() ? std::array<std::uint8_t, 3>{128, 128, 128}
                                                       : colors[color - 1U].shown_rgb;
}

Scene scene_of(std::shared_ptr<const config::Configuration> configuration, const hal::CameraInfo& camera,
               std::string version) {
  Scene scene;
  scene.configuration = std::move(configuration);
  scene.camera = camera;
  scene.version = std::move(version);
  // cannot fail, because the model was checked when the files were read
  static_cast<void>(scene.model.configure(scene.configuration->pipeline.camera));
  const auto path = [](const config::Locations& where) {
    std::error_code unknown;
    const std::filesystem::path absolute = std::filesystem::absolute(where.file(), unknown);
    return unknown ? where.file() : absolute.lexically_normal().string();
  };
  scene.files.board = path(scene.configuration->board_where);
  scene.files.venue = path(scene.configuration->venue_where);
  scene.files.team = path(scene.configuration->team_where);
  return scene;
}

void write_hello(JsonWriter& json, const Scene& scene, bool has_setup, std::uint32_t you, double now_unix_s) {
  const config::Configuration& configuration = *scene.configuration;
  json.begin_object();
  write_text(json, "type", "hello");
  json.key("protocol");
  json.integer(kProtocol);
  write_text(json, "version", scene.version);
  write_text(json, "board", configuration.board.name);
  write_text(json, "venue", configuration.venue_where.file());
  write_text(json, "team", configuration.team_where.file());
  json.key("stop_line");
  json.boolean(true);
  json.key("you");
  json.integer(you);
  write_number(json, "time_s", now_unix_s, report::kSecondStep);
  json.key("setup");
  json.boolean(has_setup);
  json.key("field");
  write_field(json, configuration.pipeline.marker.field);
  json.key("camera");
  write_camera(json, scene.camera);
  json.key("arena");
  json.boolean(configuration.board.camera.backend == hal::CameraBackend::kMock ||
               (configuration.board.camera.backend == hal::CameraBackend::kRemote &&
                !configuration.board.camera.control.empty()));
  json.key("calibrated");
  json.boolean(scene.is_calibrated);
  write_text(json, "using", word_of_files(scene));
  json.key("projection");
  const bool has_pictures = configuration.pipeline.has_pictures;
  if (has_pictures && (scene.is_calibrated || config::has_camera_model(configuration))) {
    write_projection(json, scene);
  } else {
    json.null();
  }
  json.key("robots");
  write_robots(json, scene);
  json.key("classes");
  write_classes(json, scene);
  json.key("verdicts");
  write_verdicts(json);
  json.key("region_of_interest");
  write_region_of_interest(json, configuration.pipeline.scan.region_of_interest);
  const BallParameters& ball = configuration.pipeline.marker.ball;
  if (ball.color != kBackground) {
    json.key("ball");
    json.begin_object();
    write_text(json, "color", name_of(scene, ball.color));
    json.key("rgb");
    write_rgb(json, rgb_of(scene, ball.color));
    write_number(json, "radius_m", ball.radius_m, kMeterStep);
    json.end_object();
  }
  write_number(json, "stop_after_s", configuration.board.faults.stop_after_s, 1e-3);
  const DriveParameters& drive = configuration.pipeline.control.drive;
  write_number(json, "max_speed_mps", drive.max_speed_mps, report::kSpeedStep);
  write_number(json, "max_turn_radps", drive.max_turn_radps, report::kSpeedStep);
  json.end_object();
}

}  // namespace touchline::console
