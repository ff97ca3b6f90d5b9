#include "tools/programs/setup/robots_state.h"

#include <toml++/toml.h>
#include <algorithm>
#include <optional>
#include <sstream>

#include "firmware/config/layout_choice.h"
#include "firmware/config/paint_names.h"
#include "firmware/config/section_writer.h"
#include "firmware/config/standard_layouts.h"
#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"
#include "firmware/config/value_writer.h"
#include "firmware/config/wording.h"
#include "tools/programs/calibrate/colors/team_colors.h"
#include "tools/programs/calibrate/imaging/channel_image.h"
#include "tools/programs/setup/arguments.h"
#include "tools/programs/setup/key_writer.h"
#include "tools/programs/setup/page_state.h"

namespace touchline::setup {
namespace {

// Limit below which two colors look alike, as in the advice of touchline-calibrate colors.
constexpr double kLookAlike_levels = 20;
constexpr std::size_t kMaxPairs = 12;

nlohmann::json layout_json(const std::string& name, const std::string& help, const MarkerLayout& layout, bool is_own) {
  nlohmann::json patches = nlohmann::json::array();
  for (const PatchPlace& patch : layout.patches) {
    const auto number = [](float value) { return nlohmann::json::parse(config::number_text(value)); };
    patches.push_back({{"role", config::word_of(patch.role, config::kPatchRoles)},
                       {"outline", config::word_of(patch.outline, config::kPatchOutlines)},
                       {"x_m", number(patch.x_m)},
                       {"y_m", number(patch.y_m)},
                       {"length_m", number(patch.length_m)},
                       {"width_m", number(patch.width_m)},
                       {"turn_rad", number(patch.turn_rad)}});
  }
  return {{"name", name},
          {"help", help},
          {"own", is_own},
          {"robot_side_m", layout.robot_side_m},
          {"height_m", layout.height_m},
          {"body_turn_rad", config::body_turn_rad(layout)},
          {"patches", patches}};
}

// Layouts of the team file come first, because they take precedence when a team names one.
nlohmann::json layouts_json(const config::TeamFile& file) {
  nlohmann::json out = nlohmann::json::array();
  for (const config::LayoutEntry& own : file.layout) {
    if (own.patch.size() <= kMaxPatches) out.push_back(layout_json(own.name, "", config::layout_of(own), true));
  }
  for (const config::StandardLayout& standard : config::standard_layouts()) {
    out.push_back(layout_json(std::string(standard.name), std::string(standard.help), standard.layout, false));
  }
  return out;
}

// Returns the names that a person can choose, with their usual appearance until the camera has shown the real one.
nlohmann::json palette_json(const config::TeamFile& file) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& [name, rgb] : config::usual_paints()) out.push_back({{"name", name}, {"rgb", rgb}});
  std::vector<std::string> used = {file.own.color, file.opponent.color, file.ball.color};
  for (const config::TeamEntry* team : {&file.own, &file.opponent}) {
    for (const config::RobotEntry& robot : team->robot)
      used.insert(used.end(), robot.colors.begin(), robot.colors.end());
  }
  for (const std::string& name : used) {
    const auto is_name = [&](const nlohmann::json& one) { return one["name"] == name; };
    if (name.empty() || std::any_of(out.begin(), out.end(), is_name)) continue;
    const std::optional<config::Rgb> rgb = config::usual_rgb(name);
    out.push_back({{"name", name}, {"rgb", rgb ? nlohmann::json(*rgb) : nlohmann::json()}});
  }
  return out;
}

nlohmann::json team_json(const config::TeamEntry& team) {
  nlohmann::json robots = nlohmann::json::array();
  for (const config::RobotEntry& robot : team.robot) robots.push_back({{"id", robot.id}, {"colors", robot.colors}});
  return {{"layout", team.layout}, {"color", team.color}, {"robots", robots}};
}

// Returns the largest distance over the patches, which tells both robots apart best; empty if the venue lacks a color.
std::optional<double> distance_of(const config::RobotEntry& a, const config::RobotEntry& b,
                                  const config::VenueFile& venue) {
  const auto typical = [&](const std::string& name) -> std::optional<calibrate::Channels> {
    const auto color =
        std::find_if(venue.color.begin(), venue.color.end(), [&](const auto& one) { return one.name == name; });
    if (color == venue.color.end() || color->typical.size() != 3) return std::nullopt;
    return calibrate::Channels{color->typical[0], color->typical[1], color->typical[2]};
  };
  double best = 0;
  for (std::size_t i = 0; i < std::min(a.colors.size(), b.colors.size()); ++i) {
    const auto x = typical(a.colors[i]), y = typical(b.colors[i]);
    if (!x || !y) return std::nullopt;
    best = std::max(best, calibrate::color_distance(*x, *y, venue.colors.space));
  }
  return best;
}

nlohmann::json similar_json(const config::TeamFile& file, const config::VenueFile& venue) {
  nlohmann::json pairs = nlohmann::json::array();
  const std::pair<const char*, const config::TeamEntry*> teams[] = {{"own", &file.own}, {"opponent", &file.opponent}};
  for (const auto& [name, team] : teams) {
    for (std::size_t i = 0; i < team->robot.size(); ++i) {
      for (std::size_t j = i + 1; j < team->robot.size(); ++j) {
        const auto levels = distance_of(team->robot[i], team->robot[j], venue);
        if (!levels) continue;
        pairs.push_back({{"a", {{"team", name}, {"id", team->robot[i].id}}},
                         {"b", {{"team", name}, {"id", team->robot[j].id}}},
                         {"levels", *levels}});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
    return a.at("levels").template get<double>() < b.at("levels").template get<double>();
  });
  if (pairs.size() > kMaxPairs) pairs.erase(pairs.begin() + kMaxPairs, pairs.end());
  return pairs;
}

// Returns the entry of robot `id`, or an empty one. `robots` may be null.
toml::table robot_of(const toml::array* robots, std::int64_t id) {
  for (std::size_t i = 0; robots != nullptr && i < robots->size(); ++i) {
    const toml::table* const entry = robots->get(i)->as_table();
    if (entry != nullptr && (*entry)["id"].value<std::int64_t>() == id) return *entry;
  }
  return {};
}

}  // namespace

nlohmann::json robots_state(const std::string& team_path, const calibrate::VenueDraft& venue) {
  config::TeamFile file;
  config::Locations where;
  static_cast<void>(config::read_toml(team_path, "", {}, file, where).ok());
  nlohmann::json problems = nlohmann::json::array();
  std::istringstream lines(calibrate::read_team_colors(team_path).text());
  for (std::string line; std::getline(lines, line);) {
    // Remove the draft's folder, because it means nothing to a person.
    const std::size_t folder = line.rfind('/', line.find(": "));
    problems.push_back(folder == std::string::npos ? line : line.substr(folder + 1));
  }
  nlohmann::json out = {{"done", false},
                        {"layouts", layouts_json(file)},
                        {"palette", palette_json(file)},
                        {"own", team_json(file.own)},
                        {"opponent", team_json(file.opponent)},
                        {"ball", file.ball.color},
                        {"ball_radius_m", nlohmann::json::parse(config::number_text(file.ball.radius_m))},
                        {"similar", similar_json(file, venue.file)}};
  if (!problems.empty()) {
    out["quality"] = quality("bad", problems[0].get_ref<const std::string&>());
  } else if (out["similar"].empty()) {
    out["quality"] = quality("none", "the colors are not found yet");
  } else {
    const double levels = out["similar"][0]["levels"].get<double>();
    out["quality"] = quality(levels < kLookAlike_levels ? "warning" : "ok",
                             levels < kLookAlike_levels ? "two robots look alike" : "all robots can be told apart",
                             levels, "levels");
  }
  out["problems"] = problems;
  return out;
}

Result<std::string> replace_layout(const std::string& text, const nlohmann::json& layout) {
  if (!layout.is_object()) return Error{ErrorCode::kInconsistent, "\"layout\" must be an object"};
  const Arguments members(layout);
  TOUCHLINE_TRY_ASSIGN(const std::string name, members.text("name"));
  if (name.empty()) return Error{ErrorCode::kInconsistent, "the layout needs a name"};
  TOUCHLINE_TRY_ASSIGN(const double side_m, members.number("robot_side_m", 0.02, 0.4));
  TOUCHLINE_TRY_ASSIGN(const double height_m, members.number("height_m", 0.0, 0.5));
  if (!members.has("patches") || !members["patches"].is_array() || members["patches"].empty()) {
    return Error{ErrorCode::kInconsistent, "the layout needs patches"};
  }
  // Text of a number rounded to single precision, as everywhere in these files.
  const auto short_number = [](double value) { return std::stod(config::number_text(static_cast<float>(value))); };
  toml::array patches;
  for (const nlohmann::json& one : members["patches"]) {
    if (!one.is_object()) return Error{ErrorCode::kInconsistent, "a patch must be an object"};
    const Arguments patch(one);
    toml::table entry;
    for (const char* word : {"role", "outline"}) {
      TOUCHLINE_TRY_ASSIGN(const std::string value, patch.text(word));
      entry.insert(word, value);
    }
    for (const char* key : {"x_m", "y_m", "length_m", "width_m", "turn_rad"}) {
      TOUCHLINE_TRY_ASSIGN(const double value, patch.number(key, -6.3, 6.3, 0.0));
      if (value != 0.0 || std::string_view(key) != "turn_rad") entry.insert(key, short_number(value));
    }
    patches.push_back(std::move(entry));
  }
  toml::table entry{{"name", name}, {"robot_side_m", short_number(side_m)}, {"height_m", short_number(height_m)}};
  entry.insert("patch", std::move(patches));
  const std::string content = text.empty() ? config::kNewFile : text;
  try {
    const toml::table file = toml::parse(content);
    toml::array layouts;
    if (const toml::array* former = file["layout"].as_array()) {
      for (const toml::node& other : *former) {
        const toml::table* const table = other.as_table();
        if (table != nullptr && (*table)["name"].value_or(std::string()) != name) layouts.push_back(*table);
      }
    }
    layouts.push_back(std::move(entry));
    std::ostringstream section;
    section << toml::table{{"layout", std::move(layouts)}} << "\n";
    return config::replace_section(content, "layout", section.str());
  } catch (const toml::parse_error& fault) {
    return failure(ErrorCode::kInconsistent, "line %u: %s", fault.source().begin.line,
                   std::string(fault.description()).c_str());
  }
}

Result<std::string> replace_ball(const std::string& text, const nlohmann::json& ball) {
  if (!ball.is_object()) return Error{ErrorCode::kInconsistent, "\"ball\" must be an object"};
  std::string content = text;
  for (const char* key : {"color", "radius_m"}) {
    if (!ball.contains(key)) continue;
    TOUCHLINE_TRY_ASSIGN(const std::string value, toml_of(ball.at(key)));
    TOUCHLINE_TRY_ASSIGN(content, replace_key(content, std::string("ball.") + key, value));
  }
  return content;
}

Result<std::string> replace_team(const std::string& text, const std::string& name, const nlohmann::json& table) {
  if (!table.is_object()) return failure(ErrorCode::kInconsistent, "\"%s\" must be an object", name.c_str());
  const Arguments members(table);
  std::string content = text.empty() ? config::kNewFile : text;
  for (const char* key : {"layout", "color"}) {
    if (!members.has(key)) continue;
    TOUCHLINE_TRY_ASSIGN(const std::string value, members.text(key));
    TOUCHLINE_TRY_ASSIGN(content, replace_key(content, name + "." + key, config::toml_string(value)));
  }
  if (!members.has("robots")) return content;
  if (!members["robots"].is_array()) return Error{ErrorCode::kInconsistent, "\"robots\" must be a list"};
  try {
    const toml::table file = toml::parse(content);
    toml::table team;
    if (const toml::table* former = file[name].as_table()) team = *former;
    const toml::array* const former_robots = team["robot"].as_array();
    toml::array robots;
    for (const nlohmann::json& one : members["robots"]) {
      if (!one.is_object()) return Error{ErrorCode::kInconsistent, "a robot must be an object"};
      const Arguments robot(one);
      TOUCHLINE_TRY_ASSIGN(const double id, robot.number("id", 0, 127));
      TOUCHLINE_TRY_ASSIGN(const std::vector<std::string> colors, robot.texts("colors"));
      toml::array names;
      for (const std::string& color : colors) names.push_back(color);
      // The page does not show keys such as address and wheel_gain, which stay with the robot.
      toml::table entry = robot_of(former_robots, static_cast<std::int64_t>(id));
      entry.insert_or_assign("id", static_cast<std::int64_t>(id));
      entry.insert_or_assign("colors", std::move(names));
      robots.push_back(std::move(entry));
    }
    team.insert_or_assign("robot", std::move(robots));
    std::ostringstream section;
    section << toml::table{{name, std::move(team)}} << "\n";
    return config::replace_section(content, name, section.str());
  } catch (const toml::parse_error& fault) {
    return failure(ErrorCode::kInconsistent, "line %u: %s", fault.source().begin.line,
                   std::string(fault.description()).c_str());
  }
}

}  // namespace touchline::setup
