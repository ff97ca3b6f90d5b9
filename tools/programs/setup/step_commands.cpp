#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>

#include "tools/programs/setup/color_step.h"
#include "tools/programs/setup/field_step.h"
#include "tools/programs/setup/key_writer.h"
#include "tools/programs/setup/light_step.h"
#include "tools/programs/setup/noise_step.h"
#include "tools/programs/setup/radio_step.h"
#include "tools/programs/setup/robots_state.h"
#include "tools/programs/setup/setup_program.h"

// Commands of the six steps.
namespace touchline::setup {
namespace {

using Answer = Result<nlohmann::json>;

// Averaging four frames halves the noise.
constexpr std::size_t kFieldFrames = 4;

// Few frames suffice, because the noise of a picture is small against that of the cells' medians; pictures of a game
// must be many.
constexpr std::size_t kLightFrames = 3, kMovingFrames = 16;
constexpr double kMovingInterval_s = 0.5;
// From 100 samples, a standard deviation is known to 7 %; they take five seconds, so slow changes of the light show as
// well.
constexpr std::size_t kNoiseFrames = 100;
constexpr double kNoiseInterval_s = 0.05;
// Each picture takes up to 15 MB.
constexpr std::size_t kMaxColorPictures = 8;

Job color_job(const std::string& command, const std::string& undo_name, const ColorRequest& request,
              const DraftState& draft) {
  Job job;
  job.command = command;
  job.text = "the colors are being learned";
  job.step = "colors";
  job.undo_name = undo_name;
  // Takes a picture only the first time; colors.picture takes further ones.
  job.frame_count = draft.color_frames.empty() ? 1 : 0;
  job.keeps_frames = job.frame_count > 0;
  job.work = [request, is_new = job.keeps_frames](const JobInput& input, const JobOutput& output) -> Result<void> {
    TOUCHLINE_TRY(learn_colors(request, input, output));
    return is_new ? show_color_picture(input, output) : Result<void>();
  };
  return job;
}

// Returns the ids of the pictures that the colors were learned from.
nlohmann::json color_pictures(const DraftState& draft) {
  const auto colors = draft.measured.find("colors");
  if (colors == draft.measured.end() || !colors->contains("pictures")) return nlohmann::json::array();
  return colors->at("pictures");
}

// The ranges are those of touchline-calibrate field's options.
Result<FieldRequest> field_request(const Arguments& arguments) {
  FieldRequest request;
  TOUCHLINE_TRY_ASSIGN(request.choice.preset, arguments.text("preset", ""));
  TOUCHLINE_TRY_ASSIGN(const bool ignores_lines, arguments.flag("ignore_lines", false));
  if (ignores_lines) request.choice.drawing = calibrate::kNoDrawing;
  TOUCHLINE_TRY_ASSIGN(request.choice.length_m, arguments.number("length_m", 0.1, 30.0, 0.0));
  TOUCHLINE_TRY_ASSIGN(request.choice.width_m, arguments.number("width_m", 0.1, 30.0, 0.0));
  TOUCHLINE_TRY_ASSIGN(request.choice.camera_height_m, arguments.number("camera_height_m", 0.0, 20.0, 0.0));
  return request;
}

Job field_job(const char* command, const char* undo_name, const FieldRequest& request) {
  Job job;
  job.command = command;
  job.text = "pictures of the field are being taken";
  job.step = "field";
  job.undo_name = undo_name;
  job.frame_count = kFieldFrames;
  job.work = [request](const JobInput& input, const JobOutput& output) { return find_field(request, input, output); };
  return job;
}

// Returns whether a key such as own.robot[2].wheel_gain belongs to robot `id`.
bool is_robot_of(const std::string& key, int id, const config::TeamFile& team) {
  const std::size_t index = std::strtoul(key.c_str() + key.find('[') + 1, nullptr, 10);
  return index < team.own.robot.size() && team.own.robot[index].id == id;
}

}  // namespace

const std::vector<SetupProgram::Command>& SetupProgram::commands() {
  using P = SetupProgram;
  static const std::vector<Command> all = {
      // Name, handler, whether it needs a draft, whether it is allowed during long work.
      {"state", &P::state, false, true},
      {"begin", &P::begin, false, false},
      {"discard", &P::discard, true, false},
      {"undo", &P::undo, true, false},
      {"redo", &P::redo, true, false},
      {"cancel", &P::cancel, false, true},
      {"differences", &P::differences, true, false},
      {"save", &P::save, true, false},
      {"export", &P::export_setup, true, false},
      {"import", &P::import_setup, true, false},
      {"picture", &P::picture, true, true},
      {"use", &P::use_files, true, false},
      {"drive", &P::drive, true, false},
      {"field.find", &P::field_find, true, false},
      {"field.corners", &P::field_corners, true, false},
      {"try", &P::try_draft, true, false},
      {"confirm", &P::confirm, true, false},
      {"set", &P::set, true, false},
      {"camera.quality", &P::camera_quality, true, true},
      {"light.measure", &P::light_measure, true, false},
      {"colors.picture", &P::colors_picture, true, false},
      {"colors.find", &P::colors_find, true, false},
      {"colors.click", &P::colors_click, true, false},
      {"colors.remove", &P::colors_remove, true, false},
      {"colors.reset", &P::colors_reset, true, false},
      {"radio.pattern", &P::radio_pattern, true, false},
      {"radio.measure", &P::radio_measure, true, false},
      {"radio.write", &P::radio_write, true, false},
      {"robots.set", &P::robots_set, true, false},
      {"robots.noise", &P::robots_noise, true, false},
      {"camera.set", &P::camera_set, true, false},
      {"radio.set", &P::radio_set, true, false},
  };
  return all;
}

Answer SetupProgram::field_find(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const FieldRequest request, field_request(arguments));
  return start(field_job("field.find", "field found", request));
}

Answer SetupProgram::field_corners(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(FieldRequest request, field_request(arguments));
  TOUCHLINE_TRY_ASSIGN(const std::vector<PixelPoint> corners, arguments.pixels("corners_px", 4));
  request.corners = {corners[0], corners[1], corners[2], corners[3]};
  return start(field_job("field.corners", "corners of the field", request));
}

Answer SetupProgram::light_measure(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const std::string surface, arguments.text("surface"));
  TOUCHLINE_TRY_ASSIGN(const bool keep_normal, arguments.flag("keep_normal", false));
  const bool moves = surface == "moving";
  Job job;
  job.command = "light.measure";
  job.text = "pictures of the light are being taken";
  job.step = "light";
  job.undo_name = "light measured";
  job.frame_count = moves ? kMovingFrames : kLightFrames;
  job.frame_interval_s = moves ? kMovingInterval_s : 0;
  job.work = [surface, keep_normal](const JobInput& input, const JobOutput& output) {
    return measure_light(surface, keep_normal, input, output);
  };
  return start(std::move(job));
}

Answer SetupProgram::colors_picture(const Arguments&) {
  if (draft_.now().color_frames.size() >= kMaxColorPictures) {
    return failure(ErrorCode::kOutOfRange, "there are %zu pictures already: reset them first", kMaxColorPictures);
  }
  Job job;
  job.command = "colors.picture";
  job.text = "a picture of robots and ball is being taken";
  job.step = "colors";
  job.undo_name = "picture of robots and ball";
  job.frame_count = 1;
  job.keeps_frames = true;
  job.work = show_color_picture;
  return start(std::move(job));
}

Answer SetupProgram::colors_find(const Arguments& arguments) {
  ColorRequest request;
  TOUCHLINE_TRY_ASSIGN(request.odd_colors, arguments.texts("odd_colors"));
  return start(color_job("colors.find", "colors found", request, draft_.now()));
}

Answer SetupProgram::colors_click(const Arguments& arguments) {
  const DraftState& draft = draft_.now();
  calibrate::Click click;
  TOUCHLINE_TRY_ASSIGN(click.color, arguments.text("name"));
  TOUCHLINE_TRY_ASSIGN(click.u_px, arguments.number("u_px", 0, kMaxFrameWidth));
  TOUCHLINE_TRY_ASSIGN(click.v_px, arguments.number("v_px", 0, kMaxFrameHeight));
  TOUCHLINE_TRY_ASSIGN(const double id, arguments.number("picture", 0, 4294967295.0, 0));
  std::size_t number = std::max<std::size_t>(draft.color_frames.size(), 1) - 1;
  if (id > 0) {
    const nlohmann::json ids = color_pictures(draft);
    const auto found = std::find(ids.begin(), ids.end(), nlohmann::json(static_cast<std::uint32_t>(id)));
    if (found == ids.end()) return failure(ErrorCode::kNotFound, "there is no picture %.0f of robots and ball", id);
    number = static_cast<std::size_t>(found - ids.begin());
  }
  click.image = color_image(number);
  ColorRequest request;
  request.click = click;
  return start(color_job("colors.click", click.color + ": click", request, draft));
}

Answer SetupProgram::colors_remove(const Arguments& arguments) {
  const DraftState& draft = draft_.now();
  const auto colors = draft.measured.find("colors");
  const std::size_t clicks =
      colors != draft.measured.end() && colors->contains("clicks") ? colors->at("clicks").size() : 0;
  if (clicks == 0) return Error{ErrorCode::kNotFound, "no click can be removed: there are none"};
  TOUCHLINE_TRY_ASSIGN(const double number, arguments.number("click", 0, static_cast<double>(clicks - 1)));
  ColorRequest request;
  request.removed_click = static_cast<std::size_t>(number);
  return start(color_job("colors.remove", "click removed", request, draft));
}

Answer SetupProgram::colors_reset(const Arguments&) {
  DraftState next = draft_.now();
  next.name = "pictures of the colors removed";
  next.measured.erase("colors");
  next.color_frames.clear();
  Answer changed = change(std::move(next));
  send_state();
  return changed;
}

Answer SetupProgram::camera_quality(const Arguments&) {
  constexpr std::size_t kMaxWaiting = 16;
  if (measure_camera_.size() >= kMaxWaiting) {
    return Error{ErrorCode::kDeviceBusy, "too many measurements wait for a picture"};
  }
  measure_camera_.push_back(asker_);
  answered_ = true;
  if (!running_ || !running_->waits_for_frame) send({{"type", "frames"}, {"count", 1}});
  return nlohmann::json(nullptr);
}

Answer SetupProgram::set(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(std::string key, arguments.text("key"));
  std::string value;
  if (arguments.has("value")) {
    TOUCHLINE_TRY_ASSIGN(value, toml_of(arguments["value"]));
  }
  const SetupFiles& files = draft_.now().files;
  TOUCHLINE_TRY_ASSIGN(const std::string file, file_of_key(files, key));
  TOUCHLINE_TRY_ASSIGN(const bool continues, arguments.flag("continues", false));
  // All changes while a slider is being moved count as one step.
  const bool replaces_last = continues && draft_.now().name.starts_with(key + " ");
  return change_text(key + " " + (value.empty() ? "removed" : value), file, replace_key(files.text(file), key, value),
                     replaces_last);
}

Answer SetupProgram::robots_set(const Arguments& arguments) {
  const SetupFiles& files = draft_.now().files;
  Result<std::string> text = files.text(files.team);
  if (arguments.has("layout")) text = replace_layout(text.value(), arguments["layout"]);
  if (text.ok() && arguments.has("ball")) text = replace_ball(text.value(), arguments["ball"]);
  for (const char* name : {"own", "opponent"}) {
    if (text.ok() && arguments.has(name)) text = replace_team(text.value(), name, arguments[name]);
  }
  return change_text("robots", files.team, std::move(text));
}

Answer SetupProgram::robots_noise(const Arguments&) {
  const SetupFiles& files = draft_.now().files;
  const auto recorder = std::make_shared<calibrate::NoiseRecorder>();
  TOUCHLINE_TRY(recorder->load(draft_.files_folder() + "/" + files.venue, draft_.files_folder() + "/" + files.team));
  Job job;
  job.command = "robots.noise";
  job.text = "pictures of standing robots are being taken";
  job.step = "robots";
  job.undo_name = "noise of standing robots";
  job.frame_count = kNoiseFrames;
  job.frame_interval_s = kNoiseInterval_s;
  job.take_frame = [recorder, number = 0](Frame frame) mutable {
    // Pictures get consecutive numbers and equal intervals, not those of the camera.
    ++number;
    frame.sequence = static_cast<decltype(frame.sequence)>(number);
    frame.capture_time = Instant(from_seconds(number * kNoiseInterval_s));
    return recorder->add(frame, "the camera's picture");
  };
  job.work = [recorder](const JobInput& input, const JobOutput& output) {
    return write_noise(*recorder, input, output);
  };
  return start(std::move(job));
}

Answer SetupProgram::camera_set(const Arguments& arguments) {
  return set_section("camera", {"backend", "device", "format", "width_px", "height_px", "rate_hz"}, arguments);
}

Answer SetupProgram::radio_set(const Arguments& arguments) {
  if (arguments.has("format")) {
    const SetupFiles& files = draft_.now().files;
    TOUCHLINE_TRY_ASSIGN(const std::string value, toml_of(arguments["format"]));
    return change_text("radio.format " + value, files.team, replace_key(files.text(files.team), "radio.format", value));
  }
  return set_section("radio", {"backend", "device", "baud"}, arguments);
}

Answer SetupProgram::radio_pattern(const Arguments& arguments) {
  PatternRequest request;
  TOUCHLINE_TRY_ASSIGN(const double robot, arguments.number("robot", 0, 127));
  TOUCHLINE_TRY_ASSIGN(const std::string pattern, arguments.text("pattern"));
  // A time limit, because nobody may watch the robot.
  TOUCHLINE_TRY_ASSIGN(request.duration_s, arguments.number("duration_s", 0.1, 10.0, request.duration_s));
  TOUCHLINE_TRY_ASSIGN(request.speed_mps, arguments.number("speed_mps", 0.01, 1.0, request.speed_mps));
  request.robot = static_cast<RobotId>(robot);
  const auto* const known = std::find_if(radio::kPatterns.begin(), radio::kPatterns.end(),
                                         [&](const auto& choice) { return choice.word == pattern; });
  if (known == radio::kPatterns.end()) {
    return failure(ErrorCode::kInconsistent, "the pattern %.40s is unknown", pattern.c_str());
  }
  request.pattern = known->value;
  TOUCHLINE_TRY_ASSIGN(auto files, load_draft(draft_.now().files, draft_.files_folder()));
  return start(pattern_job(request, std::move(files)));
}

Answer SetupProgram::radio_measure(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(const double robot, arguments.number("robot", 0, 127));
  TOUCHLINE_TRY_ASSIGN(auto files, load_draft(draft_.now().files, draft_.files_folder()));
  return start(measuring_job(static_cast<RobotId>(robot), std::move(files)));
}

// Writes a measured value into the draft. Only a measurement of this draft can be written.
Answer SetupProgram::radio_write(const Arguments& arguments) {
  TOUCHLINE_TRY_ASSIGN(std::string key, arguments.text("key"));
  nlohmann::json measured =
      draft_.now().measured.contains("radio") ? draft_.now().measured.at("radio") : nlohmann::json::object();
  if (!measured.contains("drive")) return Error{ErrorCode::kNotFound, "nothing was measured in this draft"};
  nlohmann::json& keys = measured["drive"]["keys"];
  const auto one =
      std::find_if(keys.begin(), keys.end(), [&](const nlohmann::json& entry) { return entry["key"] == key; });
  if (one == keys.end()) return failure(ErrorCode::kNotFound, "%.60s was not measured", key.c_str());
  const SetupFiles& files = draft_.now().files;
  TOUCHLINE_TRY_ASSIGN(const auto loaded, load_draft(files, draft_.files_folder()));
  const auto robot = measured["drive"]["robot"].get<int>();
  if (key.starts_with("own.robot") && !is_robot_of(key, robot, loaded->team)) {
    return failure(ErrorCode::kInconsistent, "the robots have changed since robot %d was measured: measure again",
                   robot);
  }
  const std::string value = (*one)["measured"];
  TOUCHLINE_TRY_ASSIGN(const std::string file, file_of_key(files, key));
  (*one)["written"] = true;
  return change_text("measured " + key + " = " + value, file, replace_key(files.text(file), key, value), false,
                     std::move(measured));
}

// Sets several keys of the board file as one step, because a device and its use belong together.
Answer SetupProgram::set_section(const std::string& section, std::initializer_list<const char*> keys,
                                 const Arguments& arguments) {
  const SetupFiles& files = draft_.now().files;
  Result<std::string> text = files.text(files.board);
  std::string name = section;
  for (const char* key : keys) {
    if (!text.ok() || !arguments.has(key)) continue;
    TOUCHLINE_TRY_ASSIGN(const std::string value, toml_of(arguments[key]));
    text = replace_key(text.value(), section + "." + key, value);
    name += " " + value;
  }
  return change_text(name, files.board, std::move(text));
}

}  // namespace touchline::setup
