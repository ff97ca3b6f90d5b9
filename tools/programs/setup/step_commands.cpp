#include "tools/programs/setup/field_step.h"
#include "tools/programs/setup/setup_program.h"

// The commands of the six steps.
namespace touchline::setup {
namespace {

using Answer = Result<nlohmann::json>;

// Averaging halves the noise.
constexpr std::size_t kFieldFrames = 4;

// Ranges as the options of touchline-calibrate field.
Result<FieldRequest> field_request(const Arguments& arguments) {
  FieldRequest request;
  TOUCHLINE_TRY_ASSIGN(request.choice.preset, arguments.text("preset", ""));
  TOUCHLINE_TRY_ASSIGN(request.choice.length_m, arguments.number("length_m", 0.3, 30.0, 0.0));
  TOUCHLINE_TRY_ASSIGN(request.choice.width_m, arguments.number("width_m", 0.3, 30.0, 0.0));
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

}  // namespace

const std::vector<SetupProgram::Command>& SetupProgram::commands() {
  using P = SetupProgram;
  static const std::vector<Command> kCommands = {
      // Name, handler, whether it needs a draft, whether it is possible during long work.
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
  };
  return kCommands;
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

}  // namespace touchline::setup
