#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/geometry/camera_model.h"
#include "firmware/config/configuration.h"
#include "firmware/console/event_log.h"
#include "firmware/console/frame_feed.h"
#include "firmware/console/recordings.h"
#include "firmware/console_input.h"
#include "firmware/loop_report.h"
#include "firmware/report/json_writer.h"
#include "firmware/snapshot.h"
#include "hal/camera.h"
#include "hal/linux/unix_time.h"

// Writes the server's messages in JSON (docs/console-protocol.md).
namespace touchline::console {

/// Facts that do not change while the loop runs.
struct Scene {
  std::shared_ptr<const config::Configuration> configuration;
  hal::CameraInfo camera;
  std::string version;  // version of the program
  CameraModel model;    // camera model of the configuration
  bool is_draft = false, is_calibrated = true;
  std::uint64_t order = 0;  // number of the order that led to the session, see UseFiles; 0: none
  config::FilePaths files;  // of the configuration, absolute
};
/// Asks the system for the current folder, so the console's thread must not call it while it serves.
Scene scene_of(std::shared_ptr<const config::Configuration> configuration, const hal::CameraInfo& camera,
               std::string version);

/// Returns R, G and B of a color of the venue file; gray for the background.
std::array<std::uint8_t, 3> rgb_of(const Scene& scene, ColorId color);
/// Returns the corners of the robot's square at the height of its marker. They are meaningless without a heading.
std::array<PixelPoint, 4> outline_px(const Scene& scene, const RobotSighting& robot);

/// Returns "saved" or "draft".
constexpr std::string_view word_of_files(const Scene& scene) { return scene.is_draft ? "draft" : "saved"; }

/// Answer to a client's message.
struct Answer {
  std::int64_t to = 0;
  std::string error;  // "": the request was carried out
};

/// Load and temperature of the machine.
struct MachineStatus {
  double cpu_percent = 0.0;  // percent of one processor
  std::optional<double> temperature_c;
  double memory_mb = 0.0;
};

/// Writes the member `halt`, a list of words for the reasons. `halt` has bits of Halt.
void write_halt(report::JsonWriter& json, std::uint32_t halt);

// Each function below writes one object.
/// `has_setup`: the setup program is running.
void write_hello(report::JsonWriter& json, const Scene& scene, bool has_setup, std::uint32_t you, double now_unix_s);
/// `console`: the client whose commands the console gives; `told`: the score that a person told, used if no referee
/// tells it.
void write_state(report::JsonWriter& json, const Scene& scene, const Snapshot& snapshot, const ConsoleInput& console,
                 const hal::UnixTimeOffset& unix_time, const std::optional<Score>& told = {});
/// `halt` has bits of Halt; nullopt: unknown. `waits_for_start`: whether a start ends at least one of these reasons.
/// `recording`: nullopt: nothing can be recorded.
void write_status(report::JsonWriter& json, const Scene& scene, const FrameFeed& feed, const StatusReport& report,
                  std::optional<std::uint32_t> halt, bool waits_for_start, const MachineStatus& machine,
                  std::size_t clients, double now_unix_s, const std::optional<RecordingStatus>& recording);
/// Returns the Unix time of the capture.
double captured_unix_s(const Snapshot& snapshot, const hal::UnixTimeOffset& unix_time);
void write_event(report::JsonWriter& json, const Event& event);
void write_driver(report::JsonWriter& json, std::optional<std::uint32_t> driver, std::uint32_t you);
void write_answer(report::JsonWriter& json, const Answer& answer);

void write_setup_program(report::JsonWriter& json, bool is_running);
/// Returns the first message to the setup program.
std::string setup_hello_text(const Scene& scene);

/// Returns the figures of the status in the text format of Prometheus.
std::string metrics_text(const FrameFeed& feed, const StatusReport& report, const MachineStatus& machine,
                         std::size_t clients, std::uint64_t pictures);

}  // namespace touchline::console
