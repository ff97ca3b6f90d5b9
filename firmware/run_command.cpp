#include "firmware/run_command.h"

#include <unistd.h>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "firmware/config/packet_text.h"
#include "firmware/config_reloader.h"
#include "firmware/console/console.h"
#include "firmware/crash_stop.h"
#include "firmware/network/connections.h"
#include "firmware/radio_plan.h"
#include "firmware/realtime.h"
#include "firmware/recording/recorder.h"
#include "firmware/recording/recording_shelf.h"
#include "firmware/report_printer.h"
#include "firmware/run_marker.h"
#include "firmware/service_notifier.h"
#include "firmware/session_switch.h"
#include "firmware/signals.h"
#include "hal/files/interruption.h"
#include "hal/files/terminal_color.h"

namespace touchline {
namespace {

// Width of the map. For the usual shape of a field, map and status line fit into a terminal of 80 columns and 24 rows.
constexpr int kMapColumns = 52;

bool is_paced(const CommandLine& command_line, const network::NetworkPlan& plan) {
  if (command_line.pace != Pace::kDefault) return command_line.pace == Pace::kReal;
  return !command_line.headless || !plan.empty() || command_line.console.is_requested;
}

// Returns whether the console is served. A simulation that runs as fast as possible shows nothing that a person could
// watch.
bool is_served(const console::ConsolePlan& plan, const config::BoardFile& board, bool is_paced) {
  return plan.is_enabled && (is_paced || board.camera.backend != hal::CameraBackend::kMock);
}

/// What open() found and negotiated, a line for each.
std::vector<std::string> device_lines(const Session& session) {
  std::vector<std::string> lines;
  const auto add = [&lines](const char* device, const std::string& description) {
    if (!description.empty()) lines.push_back(std::string(device) + ": " + description + "\n");
  };
  add("camera", session.camera_info().description);
  add("camera", session.camera_info().negotiated);
  add("radio", session.radio_description());
  add("gpio", session.gpio_description());
  return lines;
}

/// Prints what differs from the former session's lines: a camera that was absent has negotiated its format.
void print_changes(const Session& session, const std::vector<std::string>& former, hal::TextOutput& output) {
  std::string text;
  for (const std::string& line : device_lines(session)) {
    if (std::find(former.begin(), former.end(), line) == former.end()) text += line;
  }
  if (!text.empty()) output.print(text);
}

void print_start(const Session& session, const network::Connections& connections, const console::Console& console,
                 const std::vector<std::string>& refused, hal::TextOutput& output) {
  const config::Configuration& configuration = session.configuration();
  std::string text = "board " + configuration.board_where.file() + ", venue " + configuration.venue_where.file() +
                     ", team " + configuration.team_where.file() +
                     "\ncolors: " + std::string(config::kernel_word(configuration.board)) + " kernel\n";
  for (const std::string& line : device_lines(session)) text += line;
  std::istringstream warnings(config::radio_warnings(configuration));
  for (std::string warning; std::getline(warnings, warning);) text += "radio: " + warning + "\n";
  text += radio_hints(configuration);
  output.print(text + connections.start_text() + console.start_text(::isatty(STDOUT_FILENO) != 0));
  for (const std::string& refusal : refused) output.print_error("real time: " + refusal + "\n");
}

bool is_failure(LoopEnd end) { return end == LoopEnd::kDeviceLost || end == LoopEnd::kFault; }

std::string hold_text(const hal::GpioSettings& gpio) {
  return std::string("the previous run ended unexpectedly: robots are stopped until ") +
         (gpio.start_line != hal::kNoLine
              ? "the start button is pressed, or Start on the page Play"
              : "the service is restarted (systemctl restart touchline), or Start is pressed on the page Play") +
         "\n";
}

class FinishAtEnd {
 public:
  explicit FinishAtEnd(hal::TextOutput& output) : output_(output) {}
  FinishAtEnd(const FinishAtEnd&) = delete;
  FinishAtEnd& operator=(const FinishAtEnd&) = delete;
  ~FinishAtEnd() { static_cast<void>(output_.finish(hal::TextOutput::kPatience)); }

 private:
  hal::TextOutput& output_;
};

/// Objects and settings that all sessions of a run share.
struct RunContext {
  const CommandLine& command_line;
  network::Connections& connections;
  console::Console& console;
  bool serves_console;
  bool is_paced;
  AdaptationRequests& adaptation;
  const std::atomic<std::uint32_t>& reload_requests;
  const std::atomic<bool>& stop;
  std::vector<std::string>& refused;        // real-time settings that the system refuses
  std::shared_ptr<hal::TextOutput> output;  // shared with the console's file thread, as `next` is

  // Shared with the console's file thread, which outlives the run if the disk blocks it.
  std::shared_ptr<SessionSwitch> next = std::make_shared<SessionSwitch>();
  std::shared_ptr<SharedReloader> reloader = std::make_shared<SharedReloader>();
  LinePrinter lines{};
  std::vector<std::string> device_lines{};  // of the former session
  std::optional<ServiceNotifier> service{};
  std::optional<console::ConsoleThread> console_thread{};
  std::unique_ptr<recording::Recorder> recorder{};  // null: nothing is recorded. Last, because its thread prints
};

/// Loads a draft, or the saved files if `draft` names none. With `may_lack_calibration` a session without recognition
/// takes the place of one whose venue is not calibrated yet. A venue that --venue names must exist: a mistyped path
/// must not leave a calibrated field without recognition.
Result<std::unique_ptr<Session>> load_session(const SessionOptions& saved, const config::FilePaths& draft,
                                              bool may_lack_calibration, hal::TextOutput& output) {
  SessionOptions options = saved;
  const bool is_draft = !draft.board.empty();
  if (is_draft) {
    options.files.board = draft.board;
    options.files.venue = draft.venue;
    options.files.team = draft.team;
  }
  std::error_code unknown;
  const bool is_mistyped =
      !is_draft && !saved.files.venue.empty() &&
      std::filesystem::status(saved.files.venue, unknown).type() == std::filesystem::file_type::not_found;
  auto session = std::make_unique<Session>();
  Result<void> loaded = session->load(options);
  if (!loaded.ok() && may_lack_calibration && !is_mistyped) {
    session = std::make_unique<Session>();
    if (session->load_uncalibrated(options).ok()) {
      output.print_error(std::string(loaded.text()) +
                         "\nnot calibrated: robots stay stopped; set the board up in the console\n");
      loaded = {};
    }
  }
  if (!loaded.ok()) return loaded.error();
  if (is_draft) session->set_draft();
  return session;
}

/// Returns a function that loads files. It owns everything that it uses, because the console's file thread calls it.
console::UseFiles use_files(const SessionOptions& saved, const RunContext& run) {
  return [saved, next = run.next, reloader = run.reloader, output = run.output](
             const config::FilePaths& draft, std::uint64_t order) -> Result<console::FilesUse> {
    Result<std::unique_ptr<Session>> loaded = load_session(saved, draft, true, *output);
    if (!loaded.ok()) return loaded.error();
    Session& session = *loaded.value();
    if (session.is_draft() && reloader->adjust_camera_only(session.files(), session.configuration())) {
      return console::FilesUse::kAtOnce;
    }
    session.set_order(order);
    next->offer(std::move(loaded).value());
    return console::FilesUse::kInNextSession;
  };
}

Result<void> open_session(Session& session, RunContext& run) {
  session.set_adaptation_requests(run.adaptation);
  session.set_arena_time(run.is_paced ? ArenaTime::kPaced : ArenaTime::kFast);
  session.set_restart(&run.next->is_waiting());
  if (run.serves_console) run.console.attach(session, run.connections.snapshots());
  run.connections.attach(session);
  if (run.recorder != nullptr) session.set_recording(&run.recorder->tap());
  TOUCHLINE_TRY(session.open(LoopObserver{}));
  if (run.recorder != nullptr) {
    run.recorder->begin_session(session, session.devices().hal_devices().simulated_time);
  }
  return {};
}

ReportPrinterSettings reporting_of(const Session& session, RunContext& run) {
  ReportPrinterSettings reporting;
  reporting.expected = session.expectation();
  reporting.service = &*run.service;
  // The status is not printed, because the service manager shows the last one, and its journal should contain only
  // events.
  reporting.status_lines = !run.service->is_enabled();
  reporting.map_columns = !run.command_line.headless && ::isatty(STDOUT_FILENO) != 0 ? kMapColumns : 0;
  reporting.map_colors = hal::shows_color(STDOUT_FILENO);
  if (!run.connections.plan().empty()) reporting.network = [&run] { return run.connections.status_text(); };
  if (run.serves_console) {
    reporting.on_status = [&run](const StatusReport& status) { run.console.reports().set(status); };
    reporting.on_halt = [&run](const HaltReport& halt) { run.console.reports().set_halt(halt); };
  }
  if (run.serves_console || run.recorder != nullptr) {
    reporting.on_event = [&run](const char* level, const std::string& line) {
      if (run.serves_console) run.console.reports().events.add(level, line);
      if (run.recorder != nullptr) run.recorder->add_line(level, line);
    };
  }
  return reporting;
}

/// Runs the loop of an open session. `error` says why it is not the requested session, or is "".
LoopEnd run_session(Session& session, RunContext& run, const std::string& error) {
  const config::RealtimeSettings& realtime = session.configuration().board.realtime;
  const bool is_first = !run.service.has_value();
  if (is_first) {
    run.service.emplace(session.loop().heartbeat());
  } else {
    run.service->watch(&session.loop().heartbeat());
  }
  ConfigReloader reloader(session.files(), session.configuration(), session.devices().hal_devices().camera,
                          session.live_update());
  if (run.recorder != nullptr) {
    reloader.set_on_offer([&run](const config::Configuration& files) { run.recorder->add_reload(files); });
  }
  run.reloader->attach(reloader);
  LoopEnd end = LoopEnd::kRequested;
  {
    // These threads are started before this thread gets its real-time priority, which they would inherit.
    ReportPrinter printer(session.reports(), reporting_of(session, run), *run.output);
    run.lines.set(&printer);
    const auto print_line = [&run](const std::string& line) { run.lines.print(line); };
    const ReloadThread reload([&](const std::atomic<bool>& cancelled) { return run.reloader->reload(cancelled); },
                              run.reload_requests, print_line);
    if (run.recorder != nullptr) run.recorder->start(print_line);
    const network::ConnectionThreads threads(run.connections, session.configuration(), print_line);
    if (run.serves_console && is_first) {
      run.console_thread.emplace(run.console, session, &run.adaptation, TOUCHLINE_VERSION, print_line);
      if (run.console.port() != 0) run.service->set_ready();
    } else if (run.serves_console) {
      run.console.begin_session(session, error);
    }
    const NormalScheduling normal;
    std::vector<std::string> refused = become_realtime(realtime);
    for (std::string& hint : realtime_hints(realtime, is_realtime())) refused.push_back(std::move(hint));
    if (is_first) {
      run.refused.insert(run.refused.end(), refused.begin(), refused.end());
      print_start(session, run.connections, run.console, run.refused, *run.output);
    } else {
      print_changes(session, run.device_lines, *run.output);
    }
    run.device_lines = device_lines(session);
    // Nobody could choose a device that is missing.
    const bool waits_in_vain = run.serves_console && run.console.port() == 0 && !session.has_all_devices();
    end = waits_in_vain ? LoopEnd::kFault : touchline::run(session.loop(), *run.service, run.stop);
    normal.restore();
    if (end != LoopEnd::kRestart) run.console_thread.reset();
    run.lines.set(nullptr);
  }
  run.reloader->detach();
  session.loop().close();
  return end;
}

/// With the page, a person can choose the devices, so the program waits for them. It never waits for a recording.
DeviceFlags awaited_devices(const Session& session, const RunContext& run) {
  const hal::CameraBackend camera = session.configuration().board.camera.backend;
  DeviceFlags awaited{};
  if (!run.serves_console) return awaited;
  awaited.fill(true);
  awaited[static_cast<std::size_t>(Device::kCamera)] =
      camera == hal::CameraBackend::kV4l2 || camera == hal::CameraBackend::kLibcamera;
  return awaited;
}

/// Opens the session that waits or, if its devices cannot be opened, one with the saved files; `error` says why.
Result<std::unique_ptr<Session>> begin_next(std::unique_ptr<Session> former, RunContext& run, std::string& error) {
  std::unique_ptr<Session> next = run.next->take();
  const bool was_chosen = next != nullptr;
  if (!was_chosen) {  // an awaited camera has appeared: use the files as they were read, even if somebody edits them
                      // now
    next = std::make_unique<Session>();
    TOUCHLINE_TRY(next->load_again(*former));
  }
  // A device that a person has just chosen must be present, unless the former one was absent, too.
  DeviceFlags awaited = awaited_devices(*next, run);
  for (const Device device : kDevices) {
    const bool must_be_there = was_chosen && next->is_draft() && former->loop().is_open(device);
    awaited[static_cast<std::size_t>(device)] &= !must_be_there;
  }
  next->await(awaited);
  // A camera that opens in the former session and not in the next one must not make sessions follow each other without
  // pause.
  if (!was_chosen) next->set_former_pauses(former->loop().pauses());
  // Robots that were to stand until somebody acts stand in the next session too.
  const HeldStops held = former->loop().held();
  const std::uint64_t number = former->next_number();
  former.reset();  // the next session needs its devices
  // The next loop counts requests from 0.
  run.adaptation.freeze = run.adaptation.reset = 0;
  const auto open = [&](Session& session) {
    session.hold(held);
    session.set_first_number(number);
    return open_session(session, run);
  };
  const Result<void> opened = open(*next);
  if (opened.ok()) return next;
  error = opened.text();
  const std::uint64_t order = next->order();
  next.reset();
  Result<std::unique_ptr<Session>> saved = load_session(run.command_line.session, {}, true, *run.output);
  if (!saved.ok()) return saved;
  saved.value()->set_order(order);  // which `error` answers
  saved.value()->await(awaited_devices(*saved.value(), run));
  TOUCHLINE_TRY(open(*saved.value()));
  return saved;
}

/// Returns whether command line and board file demand the console.
bool wants_console(const CommandLine& command_line) {
  if (command_line.console.is_requested) return true;
  const auto files = std::make_unique<config::Configuration>();
  static_cast<void>(config::load(command_line.session.files, *files));  // the session reports errors of the files
  return files->board.console.enabled;
}

}  // namespace

int run_command(const CommandLine& command_line) {
  // From here on, all output goes through this object, so that a blocked terminal holds up no thread that stops robots.
  const auto shared_output = std::make_shared<hal::TextOutput>();
  hal::TextOutput& output = *shared_output;
  // The destructor of the output does not do this, because a thread that a disk blocks may still hold it.
  const FinishAtEnd finish_at_end{output};
  Result<std::unique_ptr<Session>> loaded = load_session(command_line.session, {}, wants_console(command_line), output);
  Result<network::NetworkPlan> plan =
      loaded.ok() ? network::plan_network(loaded.value()->configuration(), command_line.network) : loaded.error();
  if (!plan.ok()) {
    output.print_error(plan.text() + "\n");
    return kExitBadFile;
  }
  std::unique_ptr<Session> session = std::move(loaded).value();
  const std::shared_ptr<const config::Configuration> configuration = session->shared_configuration();
  const config::BoardFile& board = configuration->board;
  Result<console::ConsolePlan> console_plan =
      console::plan_console(board.console, configuration->board_where, command_line.console);
  if (!console_plan.ok()) {
    output.print_error(console_plan.text() + "\n");
    return kExitBadFile;
  }
  network::Connections connections(std::move(plan).value());
  const auto console = std::make_unique<console::Console>(std::move(console_plan).value());
  connections.set_arena_objects(console->arena_objects());
  const bool paced = is_paced(command_line, connections.plan());
  const bool serves_console = is_served(console->plan(), board, paced);
  if (!session->is_calibrated() && !serves_console) {
    output.print_error(
        "the board is not calibrated, and only the console can set it up: run with --pace real, or with --console\n");
    return kExitBadFile;
  }
  std::unique_ptr<recording::Recorder> recorder;
  const recording::RecordingPlan recording = recording::plan_recording(*configuration, command_line.recordings);
  if (!recording.folder.empty()) {
    Result<std::unique_ptr<recording::Recorder>> opened = recording::Recorder::open(recording, TOUCHLINE_VERSION);
    if (!opened.ok()) output.print_error(opened.text() + "\n");
    // A missing disk keeps a board that records by its file from no game; who asks for a recording gets it or nothing.
    if (!opened.ok() && !command_line.recordings.empty()) return kExitBadFile;
    if (opened.ok()) recorder = std::move(opened).value();
    console->set_recordings(std::make_shared<recording::RecordingShelf>(recording.folder, recorder.get()));
  }
  std::vector<std::string> refused = lock_memory(board.realtime);
  crash_stop::install_handlers();
  const std::atomic<bool>& stop = handle_stop_signals();
  hal::set_interruption(&stop);  // for a recording that arrives through a FIFO
  AdaptationRequests& adaptation = handle_adaptation_signals();
  const std::atomic<std::uint32_t>& reload_requests = handle_reload_signal();
  const RunMarker marker = RunMarker::of_service();
  if (marker.exists()) session->hold({kHaltCrash});
  RunContext run{command_line, connections,     *console, serves_console, paced,
                 adaptation,   reload_requests, stop,     refused,        shared_output};
  run.recorder = std::move(recorder);
  console->set_use_files(use_files(command_line.session, run));
  session->await(awaited_devices(*session, run));
  if (const Result<void> opened = open_session(*session, run); !opened.ok()) {
    output.print_error(opened.text() + "\n");
    return kExitDeviceFailure;
  }
  if (marker.exists()) output.print_error(hold_text(board.gpio));
  if (const Result<void> marked = marker.create(); !marked.ok()) {
    output.print_error(marked.text() + "\n");
  }
  const CpuLatencyRequest cpu_latency_request(board.realtime);
  refused.insert(refused.end(), cpu_latency_request.refused().begin(), cpu_latency_request.refused().end());
  LoopEnd end = run_session(*session, run, {});
  while (end == LoopEnd::kRestart) {
    std::string error;
    Result<std::unique_ptr<Session>> next = begin_next(std::move(session), run, error);
    if (!next.ok()) {
      output.print_error(error + "\n" + next.text() + "\n");
      return kExitDeviceFailure;
    }
    session = std::move(next).value();
    end = run_session(*session, run, error);
  }
  if (!is_failure(end)) marker.remove();
  std::string recorded;
  if (run.recorder) {
    run.recorder->finish();
    recorded = run.recorder->summary();
  }
  output.print("\n" + summary(session->loop().statistics(), end) + connections.summary() +
               session->devices().summary() + recorded);
  if (!is_failure(end)) return kExitOk;
  output.print_error(fault_line(session->loop().last_fault()) + "\n");
  return kExitDeviceFailure;
}

}  // namespace touchline
