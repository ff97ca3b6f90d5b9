#include "tools/programs/latency/console_clients.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

namespace touchline::latency {
namespace {

// Returns the next line of `read_console`; "" if it has ended.
std::string line_from(int descriptor) {
  std::string line;
  for (char c = 0; ::read(descriptor, &c, 1) == 1 && c != '\n';) line += c;
  return line;
}

void close_pipe_end(int& descriptor) {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

}  // namespace

Result<void> ConsoleClients::attach(Session& session, SnapshotRing& snapshots) {
  const config::Configuration& configuration = session.configuration();
  TOUCHLINE_TRY_ASSIGN(
      console::ConsolePlan plan,
      console::plan_console(configuration.board.console, configuration.board_where,
                            {.is_requested = true, .is_for_network = false, .address = "127.0.0.1:0"}));
  // Do not connect a setup program, because it belongs to a firmware that may run at the same time.
  plan.setup_socket.clear();
  console_ = std::make_unique<console::Console>(std::move(plan));
  console_->attach(session, snapshots);
  return {};
}

Result<void> ConsoleClients::start(Session& session) {
  console_->start(session, nullptr, "touchline-latency", [](const std::string& line) { std::cerr << line + "\n"; });
  if (console_->port() == 0) return failure(ErrorCode::kIo, "--console-clients: the console is not served, see above");
  if (clients_ == 0) return {};
  TOUCHLINE_TRY(start_reader());
  if (line_from(from_reader_) != "ready") return failure(ErrorCode::kIo, "--console-clients: the clients were refused");
  return {};
}

Result<void> ConsoleClients::start_reader() {
  std::array<int, 2> in{-1, -1}, out{-1, -1};
  if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) {
    return failure(ErrorCode::kIo, "--console-clients: %s", std::strerror(errno));
  }
  to_reader_ = in[1];
  from_reader_ = out[0];
  posix_spawn_file_actions_t descriptors;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&descriptors);
  ::posix_spawn_file_actions_adddup2(&descriptors, in[0], STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&descriptors, out[1], STDOUT_FILENO);
  // Use a separate process group, so that Ctrl-C reaches only this program, which then ends the clients.
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::array<std::string, 5> words{"touchline-latency", "--read-console", std::to_string(console_->port()),
                                   "--console-clients", std::to_string(clients_)};
  std::array<char*, 6> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  const int refused = ::posix_spawn(&reader_, "/proc/self/exe", &descriptors, &attributes, arguments.data(), ::environ);
  ::posix_spawn_file_actions_destroy(&descriptors);
  ::posix_spawnattr_destroy(&attributes);
  close_pipe_end(in[0]);
  close_pipe_end(out[1]);
  if (refused == 0) return {};
  reader_ = -1;
  return failure(ErrorCode::kIo, "--console-clients: %s", std::strerror(refused));
}

ConsoleTraffic ConsoleClients::stop() {
  ConsoleTraffic traffic;
  traffic.clients = clients_;
  if (clients_ == 0) return traffic;
  close_pipe_end(to_reader_);
  const std::string line = line_from(from_reader_);
  end_reader();
  unsigned long long states = 0, pictures = 0, bytes = 0;
  double elapsed_s = 0.0;
  // This is the format in which read_console() writes.
  if (std::sscanf(line.c_str(), "%llu states, %llu pictures, %llu bytes, %lf s", &states, &pictures, &bytes,
                  &elapsed_s) != 4) {
    return traffic;
  }
  traffic.states = states;
  traffic.pictures = pictures;
  traffic.bytes = bytes;
  traffic.elapsed_s = elapsed_s;
  return traffic;
}

void ConsoleClients::end() {
  end_reader();
  if (console_ != nullptr) console_->stop();
}

void ConsoleClients::end_reader() {
  // The process ends when its standard input is closed.
  close_pipe_end(to_reader_);
  close_pipe_end(from_reader_);
  if (reader_ > 0) ::waitpid(reader_, nullptr, 0);
  reader_ = -1;
}

}  // namespace touchline::latency
