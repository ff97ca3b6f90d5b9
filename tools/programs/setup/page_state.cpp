#include "tools/programs/setup/page_state.h"

#include <algorithm>
#include <memory>

#include "firmware/config/configuration.h"
#include "firmware/config/packet_text.h"
#include "firmware/config/radio_presets.h"
#include "firmware/config/resolve_radio.h"
#include "firmware/config/wording.h"
#include "hal/linux/serial/serial_list.h"
#include "tools/programs/calibrate/colors/team_colors.h"
#include "tools/programs/calibrate/field/field_drawing.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/setup/described_keys.h"
#include "tools/programs/setup/robots_state.h"

namespace touchline::setup {
namespace {

bool is_confirmed(const DraftState& draft, const char* step) {
  const auto measured = draft.measured.find(step);
  return measured != draft.measured.end() && measured->value("done", false);
}

// Combines values derived from the files with the step's measurements.
nlohmann::json with_measured(const DraftState& draft, const char* step, nlohmann::json values) {
  const auto measured = draft.measured.find(step);
  if (measured != draft.measured.end()) values.update(*measured);
  if (!values.contains("quality")) {
    values["quality"] =
        is_confirmed(draft, step) ? quality("ok", "checked") : quality("none", "not measured in this draft");
  }
  if (!values.contains("notes")) values["notes"] = nlohmann::json::array();
  return values;
}

nlohmann::json field_values(const calibrate::VenueDraft& venue) {
  nlohmann::json presets = nlohmann::json::array();
  for (const calibrate::FieldPreset& preset : calibrate::field_presets()) {
    presets.push_back({{"name", std::string(preset.name)},
                       {"length_m", preset.drawing.field.length_m},
                       {"width_m", preset.drawing.field.width_m}});
  }
  const DescribedKeys field = DescribedKeys::of(venue.file.field);
  const bool is_done = calibrate::has_camera_model(venue);
  const bool has_height = is_done && venue.file.camera_model.kind == CameraModelKind::kFull;
  return {
      {"done", is_done},
      {"values", field.values()},
      {"keys", field.keys()},
      {"presets", presets},
      {"camera_height_m", has_height ? nlohmann::json(venue.file.camera_model.full.position_m[2]) : nlohmann::json()}};
}

nlohmann::json color_values(const calibrate::VenueDraft& venue, const Result<calibrate::TeamColors>& team) {
  nlohmann::json names = nlohmann::json::array(), wanted = nlohmann::json::array();
  for (const config::ColorEntry& color : venue.file.color) {
    nlohmann::json boxes = nlohmann::json::array();
    for (const config::ColorBoxEntry& box : color.box) boxes.push_back({{"low", box.low}, {"high", box.high}});
    names.push_back({{"name", color.name}, {"shown_rgb", color.shown_rgb}, {"boxes", boxes}});
  }
  if (team.ok()) {
    for (const std::string& name : team.value().names) {
      const auto has_name = [&](const config::ColorEntry& color) { return color.name == name && !color.box.empty(); };
      if (std::none_of(venue.file.color.begin(), venue.file.color.end(), has_name)) wanted.push_back(name);
    }
  }
  const nlohmann::json needed = team.ok() ? nlohmann::json(team.value().names) : nlohmann::json::array();
  return {{"done", !names.empty() && wanted.empty()}, {"names", names}, {"wanted", wanted}, {"needed", needed}};
}

// What the robots understand: the format of the team file, all formats, and a sample of the packets.
nlohmann::json format_values(const std::string& team_path, config::Configuration& configuration) {
  static_cast<void>(config::read_toml(team_path, "", {}, configuration.team, configuration.team_where).ok());
  nlohmann::json formats = nlohmann::json::array();
  formats.push_back({{"name", "touchline"}, {"about", "Touchline's own packet"}});
  for (const config::RadioPreset& preset : config::radio_presets()) {
    config::RadioEntry entry;
    config::read_radio_preset(preset.name, entry);
    formats.push_back({{"name", preset.name}, {"about", entry.about}});
  }
  configuration.pipeline.control = configuration.team.control;
  const Result<void> resolved =
      config::resolve_radio(configuration.team, configuration.team_where, configuration.pipeline);
  // A person knows the files by their names; their folder is the draft's.
  std::string remarks = resolved.ok() ? config::radio_warnings(configuration) : resolved.text();
  const std::string folder = team_path.substr(0, team_path.rfind('/') + 1);
  for (std::size_t at = 0; (at = remarks.find(folder)) != std::string::npos;) remarks.erase(at, folder.size());
  return {{"format", configuration.team.radio.format},
          {"formats", formats},
          {"sample", resolved.ok() ? config::sample_packet_text(configuration.pipeline) : ""},
          {"remarks", remarks}};
}

nlohmann::json radio_values(const config::BoardFile& board) {
  const DescribedKeys radio = DescribedKeys::of(board.radio);
  nlohmann::json devices = nlohmann::json::array();
  std::vector<hal::SerialPortNode> ports;
  hal::list_serial_ports(ports);
  for (const hal::SerialPortNode& port : ports) devices.push_back(port.path);
  return {{"done", false}, {"values", radio.values()}, {"keys", radio.keys()}, {"devices", devices}};
}

// Marks steps as not done if they were calibrated for another camera or another mode: the firmware ignores their
// results.
void require_same_picture(const hal::CameraSettings& camera, const config::VenueFile& venue, nlohmann::json& steps) {
  const auto repeat = [&steps](const char* step, const std::string& reason) {
    if (!steps[step]["done"]) return;
    steps[step]["done"] = false;
    steps[step]["quality"] = quality("bad", reason);
  };
  const auto size = [](int width_px, int height_px) {
    return std::to_string(width_px) + " x " + std::to_string(height_px);
  };
  if (venue.picture.width_px != camera.width_px || venue.picture.height_px != camera.height_px) {
    repeat("field", "found for pictures of " + size(venue.picture.width_px, venue.picture.height_px) +
                        " pixels, but the camera is set to " + size(camera.width_px, camera.height_px) +
                        "; find the field again");
  }
  const ColorSpace space = color_space(hal::pixel_format(camera.format));
  if (venue.colors.space != space) {
    repeat("colors", "found in " + std::string(config::word_of(venue.colors.space, config::kColorSpaceWords)) +
                         ", but the camera is set to " + std::string(config::word_of(space, config::kColorSpaceWords)) +
                         "; find the colors again");
  }
}

}  // namespace

nlohmann::json quality(const char* level, const std::string& text) {
  return {{"level", level}, {"text", text}, {"number", nullptr}, {"unit", ""}};
}

nlohmann::json quality(const char* level, const std::string& text, double number, const char* unit) {
  return {{"level", level}, {"text", text}, {"number", number}, {"unit", unit}};
}

nlohmann::json steps_of(const DraftState& draft, const std::string& folder) {
  const auto path = [&](const std::string& name) { return folder + "/" + name; };
  // Wrong values are replaced by their defaults; `problems` in the answer of "differences" reports them.
  const auto configuration = std::make_unique<config::Configuration>();
  static_cast<void>(config::load_board(path(draft.files.board), {}, *configuration).ok());
  const Result<calibrate::VenueDraft> read = calibrate::read_draft(path(draft.files.venue));
  const calibrate::VenueDraft venue = read.ok() ? read.value() : calibrate::VenueDraft{};
  const Result<calibrate::TeamColors> team = calibrate::read_team_colors(path(draft.files.team));

  const DescribedKeys camera = DescribedKeys::of(configuration->board.camera);
  nlohmann::json steps;
  steps["camera"] =
      with_measured(draft, "camera", {{"done", false}, {"values", camera.values()}, {"keys", camera.keys()}});
  steps["field"] = with_measured(draft, "field", field_values(venue));
  steps["light"] =
      with_measured(draft, "light", {{"done", !venue.file.light.map.empty()}, {"surface", venue.file.light.surface}});
  steps["colors"] = with_measured(draft, "colors", color_values(venue, team));
  steps["robots"] = with_measured(draft, "robots", robots_state(path(draft.files.team), venue));
  // Only a person can compare the drawings with the robots: until then, colors that differ are not enough for a tick.
  if (steps["robots"]["quality"]["level"] == "none" && is_confirmed(draft, "robots")) {
    steps["robots"]["quality"] = quality("ok", "compared with the robots; their colors are found in the next step");
  } else if (steps["robots"]["quality"]["level"] == "ok" && !is_confirmed(draft, "robots")) {
    steps["robots"]["quality"] = quality("none", "the colors can be told apart; not compared with the robots yet");
  }
  nlohmann::json radio = radio_values(configuration->board);
  radio.update(format_values(path(draft.files.team), *configuration));
  steps["radio"] = with_measured(draft, "radio", radio);
  require_same_picture(configuration->board.camera, venue.file, steps);
  return steps;
}

Result<void> check_file(const SetupFiles& files, const std::string& name, const std::string& folder) {
  const std::string path = folder + "/" + name;
  if (name == files.board) {
    const auto configuration = std::make_unique<config::Configuration>();
    return config::load_board(path, {}, *configuration);
  }
  if (name == files.team) {
    config::TeamFile team;
    config::Locations where;
    return config::read_toml(path, "", {}, team, where);
  }
  const Result<calibrate::VenueDraft> venue = calibrate::read_draft(path);
  return venue.ok() ? Result<void>() : Result<void>(venue.error());
}

std::string problems_of(const SetupFiles& files, const std::string& folder) {
  const auto configuration = std::make_unique<config::Configuration>();
  return config::load({folder + "/" + files.board, "", "", {}}, *configuration).text();
}

}  // namespace touchline::setup
