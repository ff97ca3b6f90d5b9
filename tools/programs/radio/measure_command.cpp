#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/crash_stop.h"
#include "firmware/signals.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/radio/drive_measurement.h"
#include "tools/programs/radio/measured_files.h"
#include "tools/programs/radio/radio_commands.h"

namespace touchline::radio {
namespace {

int refuse_measurement(const std::string& message, int exit_code) {
  return fail("touchline-radio", message, exit_code);
}

MeasurementSettings settings_of(const RadioOptions& options, const config::Configuration& configuration) {
  MeasurementSettings settings = measurement_settings(configuration, static_cast<RobotId>(options.robot));
  if (options.duration_s > 0.0) settings.duration_s = options.duration_s;
  settings.seed = options.session.seed;
  if (options.speed_mps > 0.0) settings.limits.max_speed_mps = options.speed_mps;
  settings.limits.radius_m = options.radius_m;
  return settings;
}

// Asks for each value that differs from the files, and writes it. Returns the exit code.
int write_values(const std::vector<MeasuredKey>& keys, bool yes) {
  for (const MeasuredKey& key : keys) {
    if (!key.differs()) continue;
    const std::string question = formatted("Write %s = %s into %s (now %s)?", key.name().c_str(), key.text().c_str(),
                                           key.path.c_str(), key.text_now().c_str());
    if (!yes && !is_confirmed(question.c_str())) continue;
    if (const Result<void> written = write_key(key); !written.ok()) {
      return refuse_measurement(std::string(written.text()), kExitBadFile);
    }
    std::fprintf(stderr, "%s: wrote %s = %s; the former file is %s.bak\n", key.path.c_str(), key.name().c_str(),
                 key.text().c_str(), key.path.c_str());
  }
  return kExitOk;
}

}  // namespace

int measure_drive(const RadioOptions& options) {
  SessionOptions session_options = options.session;
  for (std::string& wanted : measuring_overrides()) session_options.files.overrides.push_back(std::move(wanted));
  const auto session = std::make_unique<Session>();
  if (const Result<void> loaded = session->load(session_options); !loaded.ok()) {
    std::cerr << loaded.text() << '\n';
    return kExitBadFile;
  }
  const config::Configuration& configuration = session->configuration();
  if (configuration.board.radio.backend == hal::RadioBackend::kNone) {
    return refuse_measurement(configuration.board_where.file() + ": radio.backend = \"none\": choose the radio first",
                              kExitBadFile);
  }
  const MeasurementSettings settings = settings_of(options, configuration);
  const auto measurement = std::make_unique<DriveMeasurement>(settings);
  std::fprintf(
      stderr,
      "robot %d will drive by itself for %.0f s at up to %.2f m/s, within %.2f m of its place.\nIt needs %.2f m to "
      "walls, ball and other robots. Ctrl-C stops it.\n",
      options.robot, settings.duration_s, settings.limits.max_speed_mps, settings.limits.radius_m,
      measurement->wall_distance_m());
  if (!options.yes && !is_confirmed("Is the robot on the field, and may it drive?")) {
    return refuse_measurement("nothing was sent: answer y, or use --yes", kExitBadCommandLine);
  }
  crash_stop::install_handlers();
  const std::atomic<bool>& stop = handle_stop_signals();
  ExternalInputSettings input;
  input.commands = &measurement->commands();
  session->set_external_input(input);
  session->set_restart(&measurement->has_ended());
  LoopObserver observer;
  observer.context = measurement.get();
  observer.on_step = [](void* context, const StepTrace& trace, const StepTiming& timing) {
    static_cast<DriveMeasurement*>(context)->on_step(trace, timing);
  };
  if (const Result<void> opened = session->open(observer); !opened.ok()) {
    return refuse_measurement(std::string(opened.text()), kExitDeviceFailure);
  }
  const LoopEnd end = session->loop().run(stop);
  session->loop().close();
  if (end == LoopEnd::kFault || end == LoopEnd::kDeviceLost) {
    return refuse_measurement("a device failed: " + fault_line(session->loop().last_fault()), kExitDeviceFailure);
  }
  using End = DriveMeasurement::End;
  if (measurement->end() != End::kDone) {
    std::fprintf(stderr, "touchline-radio: robot %d: %s\n", options.robot, describe(measurement->end()));
  }
  const bool has_values = measurement->end() == End::kDone || measurement->end() == End::kNone;
  if (!has_values) return kExitDeviceFailure;
  measurement->estimator().solve();
  const DriveEstimate& estimate = measurement->estimator().estimate();
  const std::vector<MeasuredKey> keys = measured_keys(estimate, options.robot, configuration);
  std::fputs((options.json ? measured_json(estimate, options.robot)
                           : measured_text(estimate, options.robot, measurement->driven_s(), keys))
                 .c_str(),
             stdout);
  std::fflush(stdout);
  return options.write ? write_values(keys, options.yes) : kExitOk;
}

}  // namespace touchline::radio
