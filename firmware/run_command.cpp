#include "firmware/run_command.h"

#include <unistd.h>
#include <cstdio>
#include <optional>
#include <utility>

#include "firmware/config_reloader.h"
#include "firmware/console/console.h"
#include "firmware/crash_stop.h"
#include "firmware/network/connections.h"
#include "firmware/realtime.h"
#include "firmware/report_printer.h"
#include "firmware/run_marker.h"
#include "firmware/service_notifier.h"
#include "firmware/signals.h"

namespace touchline {
namespace {

// With the usual shape of a field, map and status line fit into a terminal of 80 columns and 24 rows.
constexpr int kMapColumns = 52;

bool is_paced(const CommandLine& command_line, const network::NetworkPlan& plan) {
  if (command_line.pace != Pace::kDefault) return command_line.pace == Pace::kReal;
  return !command_line.headless || !plan.empty() || command_line.console.is_requested;
}

// While a simulation runs as fast as possible, there is nothing that a person could watch.
bool is_served(const console::ConsolePlan& plan, const config::BoardFile& board, bool is_paced) {
  return plan.is_enabled && (is_paced || board.camera.backend != hal::CameraBackend::kMock);
}

void print_start(const Session& session, const network::Connections& connections, const console::Console& console,
                 const std::vector<std::string>& refused) {
  const config::Configuration& configuration = session.configuration();
  std::printf("board %s, venue %s, team %s\n", configuration.board_where.file().c_str(),
              configuration.venue_where.file().c_str(), configuration.team_where.file().c_str());
  std::printf("colors: %s kernel\n", std::string(config::kernel_word(configuration.board)).c_str());
  const auto print_device = [](const char* device, const std::string& text) {
    if (!text.empty()) std::printf("%s: %s\n", device, text.c_str());
  };
  print_device("camera", session.camera_info().description);
  print_device("camera", session.camera_info().negotiated);
  print_device("radio", session.radio_description());
  print_device("gpio", session.gpio_description());
  std::fputs(connections.start_text().c_str(), stdout);
  std::fputs(console.start_text().c_str(), stdout);
  std::fflush(stdout);
  for (const std::string& refusal : refused) std::fprintf(stderr, "real time: %s\n", refusal.c_str());
}

bool is_failure(LoopEnd end) { return end == LoopEnd::kDeviceLost || end == LoopEnd::kFault; }

void print_hold(const hal::GpioSettings& gpio) {
  std::fprintf(stderr, "the previous run ended unexpectedly: robots are stopped until %s\n",
               gpio.start_line != hal::kNoLine ? "the start button is pressed"
                                               : "the service is restarted (systemctl restart touchline)");
}

}  // namespace

int run_command(const CommandLine& command_line) {
  Session session;
  const Result<void> loaded = session.load(command_line.session);
  Result<network::NetworkPlan> plan =
      loaded.ok() ? network::plan_network(session.configuration(), command_line.network) : loaded.error();
  if (!plan.ok()) {
    std::fprintf(stderr, "%s\n", plan.error().text.c_str());
    return kExitBadFile;
  }
  const config::BoardFile& board = session.configuration().board;
  Result<console::ConsolePlan> console_plan =
      console::plan_console(board.console, session.configuration().board_where, command_line.console);
  if (!console_plan.ok()) {
    std::fprintf(stderr, "%s\n", console_plan.error().text.c_str());
    return kExitBadFile;
  }
  network::Connections connections(std::move(plan).value());
  const auto console = std::make_unique<console::Console>(std::move(console_plan).value());
  const config::RealtimeSettings& realtime = board.realtime;
  std::vector<std::string> refused = lock_memory(realtime);
  crash_stop::install_handlers();
  const std::atomic<bool>& stop = handle_stop_signals();
  AdaptationRequests& adaptation = handle_adaptation_signals();
  session.set_adaptation_requests(adaptation);
  const std::atomic<std::uint32_t>& reload_requests = handle_reload_signal();
  const RunMarker marker = RunMarker::of_service();
  session.hold_after_crash(marker.exists());
  const bool paced = is_paced(command_line, connections.plan());
  session.set_arena_time(paced ? ArenaTime::kPaced : ArenaTime::kFast);
  const bool serves_console = is_served(console->plan(), board, paced);
  if (serves_console) console->attach(session, connections.snapshots());
  connections.attach(session);
  if (const Result<void> opened = session.open(LoopObserver{}); !opened.ok()) {
    std::fprintf(stderr, "%s\n", opened.error().text.c_str());
    return kExitDeviceFailure;
  }
  if (marker.exists()) print_hold(board.gpio);
  if (const Result<void> marked = marker.create(); !marked.ok()) {
    std::fprintf(stderr, "%s\n", marked.error().text.c_str());
  }
  ReportPrinterSettings reporting;
  reporting.expected = session.expectation();
  ServiceNotifier service(session.loop().heartbeat());
  reporting.service = &service;
  // The service manager shows the last status; its journal should contain events only.
  reporting.status_lines = !service.is_enabled();
  reporting.map_columns = !command_line.headless && ::isatty(STDOUT_FILENO) != 0 ? kMapColumns : 0;
  if (!connections.plan().empty()) reporting.network = [&connections] { return connections.status_text(); };
  if (serves_console) {
    reporting.on_status = [&console](const StatusReport& status) { console->reports().set(status); };
    reporting.on_event = [&console](const char* level, const std::string& line) {
      console->reports().events.add(level, line);
    };
  }
  LoopEnd end = LoopEnd::kRequested;
  const CpuLatencyRequest cpu_latency_request(realtime);
  refused.insert(refused.end(), cpu_latency_request.refused().begin(), cpu_latency_request.refused().end());
  ConfigReloader reloader(session.files(), session.configuration(), session.devices().hal_devices().camera,
                          session.live_update());
  {
    // These threads are started before this thread gets its real-time priority, which they would inherit.
    ReportPrinter printer(session.reports(), reporting, stdout, stderr);
    const auto print_line = [&printer](const std::string& line) { printer.print_line(line); };
    const ReloadThread reload([&](const std::atomic<bool>& cancelled) { return reloader.reload(cancelled); },
                              reload_requests, print_line);
    const network::ConnectionThreads threads(connections, session.configuration(), print_line);
    std::optional<console::ConsoleThread> console_thread;
    if (serves_console) console_thread.emplace(*console, session, &adaptation, TOUCHLINE_VERSION, print_line);
    for (std::string& refusal : become_realtime(realtime)) refused.push_back(std::move(refusal));
    for (std::string& hint : realtime_hints(realtime, is_realtime())) refused.push_back(std::move(hint));
    print_start(session, connections, *console, refused);
    end = run(session.loop(), service, stop);
  }
  session.loop().close();
  if (!is_failure(end)) marker.remove();
  std::printf("\n%s%s%s", summary(session.loop().statistics(), end).c_str(), connections.summary().c_str(),
              session.devices().summary().c_str());
  if (!is_failure(end)) return kExitOk;
  std::fprintf(stderr, "%s\n", fault_line(session.loop().last_fault()).c_str());
  return kExitDeviceFailure;
}

}  // namespace touchline
