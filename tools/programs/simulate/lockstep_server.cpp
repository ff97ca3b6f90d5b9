#include "tools/programs/simulate/lockstep_server.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "hal/linux/network/tcp_socket.h"
#include "hal/linux/system_error.h"

namespace touchline::simulate {
namespace {

constexpr std::string_view kTcp = "tcp://";
constexpr std::size_t kReadBytes = 65536;

std::string error_line(const Error& error, bool ends_game = false) {
  nlohmann::json line{{"error", error.text.str()}};
  if (ends_game) line["ended"] = true;
  // Messages may quote any bytes of a program.
  return line.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

const char* name_of(std::size_t index) { return index == 0 ? "the program" : "the opponents' program"; }

}  // namespace

std::string StreamAddress::text() const {
  if (address.kind == hal::NetworkAddress::Kind::kUnix) return address.text();
  return hal::TcpAddress{address.ipv4, address.port}.text();
}

Result<StreamAddress> parse_stream_address(const std::string& text) {
  if (text.starts_with(kTcp)) {
    TOUCHLINE_TRY_ASSIGN(hal::NetworkAddress address, hal::parse_udp_destination(text.substr(kTcp.size()), 0));
    return StreamAddress{std::move(address)};
  }
  if (text.starts_with("unix://")) {
    TOUCHLINE_TRY_ASSIGN(hal::NetworkAddress address, hal::parse_network_address(text));
    return StreamAddress{std::move(address)};
  }
  return failure(ErrorCode::kOutOfRange, "\"%s\" is not an address: write unix:///PATH or tcp://ADDRESS:PORT",
                 text.c_str());
}

Result<void> LockstepServer::open(const StreamAddress& address) {
  address_ = address;
  if (address.address.kind == hal::NetworkAddress::Kind::kUnix) return unix_.open(address.address.path);
  TOUCHLINE_TRY_ASSIGN(tcp_, hal::listen_tcp({address.address.ipv4, address.address.port}));
  if (const std::uint16_t port = hal::local_port(tcp_); port != 0) address_.address.port = port;
  return {};
}

Result<void> LockstepServer::serve() {
  while (!is_over_) {
    for (std::size_t i = 0; i < connections_.size(); ++i) TOUCHLINE_TRY(process_lines(i));
    if (is_over_) break;
    if (can_run()) {
      game_.run();
      TOUCHLINE_TRY(finish_steps());
    } else {
      TOUCHLINE_TRY(wait());
    }
  }
  return {};
}

bool LockstepServer::can_run() const {
  return connections_[kFirst].in_step && (!game_.has_other_program() || connections_[kOpponents].in_step);
}

// The messages of the opponents' program wait for a game that it may play.
bool LockstepServer::may_read(std::size_t index) const {
  const Connection& connection = connections_[index];
  return connection.socket.is_open() && !connection.in_step && (index == kFirst || game_.has_other_program());
}

Result<void> LockstepServer::process_lines(std::size_t index) {
  Connection& connection = connections_[index];
  std::size_t begin = 0;
  Result<void> done;
  while (done.ok() && may_read(index)) {
    const std::size_t end = connection.received.find('\n', begin);
    if (end == std::string::npos) break;
    const std::string line = connection.received.substr(begin, end - begin);
    begin = end + 1;
    done = process(index, line);
  }
  connection.received.erase(0, begin);
  if (done.ok() && may_read(index) && connection.received.size() > kMaxLockstepBytes) {
    return end_game(
        failure(ErrorCode::kOutOfRange, "a message of %s is longer than %zu bytes", name_of(index), kMaxLockstepBytes));
  }
  return done;
}

Result<void> LockstepServer::process(std::size_t index, std::string_view line) {
  const Result<LockstepMessage> message = parse_lockstep_message(line);
  if (!message.ok()) return send(index, error_line(message.error()));
  const Result<std::string> answer =
      index == kFirst ? answer_first(message.value()) : answer_opponents(message.value());
  if (!answer.ok()) return send(index, error_line(answer.error()));
  // A step is answered when it is done.
  return answer.value().empty() ? Result<void>() : send(index, answer.value());
}

Result<std::string> LockstepServer::answer_first(const LockstepMessage& message) {
  if (const auto* reset = std::get_if<ResetMessage>(&message)) {
    TOUCHLINE_TRY(game_.reset(*reset));
    Connection& opponents = connections_[kOpponents];
    opponents.told = false;
    if (opponents.in_step) {
      opponents.in_step = false;
      opponents.told = true;
      TOUCHLINE_TRY(send(kOpponents, game_.description()));
    }
    return game_.description();
  }
  if (!game_.has_begun()) return failure(ErrorCode::kInconsistent, "there is no game yet; send a reset first");
  if (const auto* step = std::get_if<StepMessage>(&message)) {
    TOUCHLINE_TRY(game_.begin_step(hal::mock::Side::kOwn, *step));
    connections_[kFirst].in_step = true;
    return std::string();
  }
  if (const auto* place = std::get_if<PlaceMessage>(&message)) return game_.place(*place);
  if (const auto* fault = std::get_if<FaultMessage>(&message)) return game_.inject(*fault);
  return game_.hash();
}

Result<std::string> LockstepServer::answer_opponents(const LockstepMessage& message) {
  const auto* step = std::get_if<StepMessage>(&message);
  if (step == nullptr) {
    return failure(ErrorCode::kUnsupported,
                   "the opponents' program can only send steps; the first program does the rest");
  }
  Connection& connection = connections_[kOpponents];
  if (!std::exchange(connection.told, true)) return game_.description();
  TOUCHLINE_TRY(game_.begin_step(hal::mock::Side::kOpponent, *step));
  connection.in_step = true;
  return std::string();
}

Result<void> LockstepServer::finish_steps() {
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    Connection& connection = connections_[i];
    if (!connection.in_step || !game_.is_done(side_of(i))) continue;
    connection.in_step = false;
    TOUCHLINE_TRY(send(i, game_.end_step(side_of(i))));
  }
  return {};
}

Result<void> LockstepServer::send(std::size_t index, std::string answer) {
  Connection& connection = connections_[index];
  answer += '\n';
  std::string_view rest = answer;
  while (!rest.empty()) {
    const ssize_t sent = ::send(connection.socket.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
    if (sent >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno != EAGAIN && errno != EINTR) {
      // Whether that is an error is decided where the end of its stream is read.
      return {};
    }
    pollfd writable{connection.socket.get(), POLLOUT, 0};
    const int limit_ms = silence_s_ > 0.0 ? static_cast<int>(std::ceil(1000.0 * silence_s_)) : -1;
    if (::poll(&writable, 1, limit_ms) == 0) {
      return end_game(failure(ErrorCode::kTimeout, "%s did not read its answer for %g s; the game has ended",
                              name_of(index), silence_s_));
    }
  }
  connection.answered = Clock::now();
  return {};
}

// Returns how long to wait for the programs that the game waits for; -1: without limit.
int LockstepServer::wait_ms(Clock::time_point now, std::size_t* silent) const {
  int shortest_ms = -1;
  if (silence_s_ <= 0.0 || !game_.has_begun()) return shortest_ms;
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    if (!may_read(i)) continue;
    const double left_s = silence_s_ - std::chrono::duration<double>(now - connections_[i].answered).count();
    const int left_ms = std::max(0, static_cast<int>(std::ceil(1000.0 * left_s)));
    if (shortest_ms >= 0 && left_ms >= shortest_ms) continue;
    shortest_ms = left_ms;
    *silent = i;
  }
  return shortest_ms;
}

Result<void> LockstepServer::wait() {
  const int listener = unix_.descriptor() >= 0 ? unix_.descriptor() : tcp_.get();
  std::array<pollfd, 3> waited{pollfd{listener, POLLIN, 0}, pollfd{-1, POLLIN, 0}, pollfd{-1, POLLIN, 0}};
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    // One whose step is not done sends nothing, but may go.
    if (connections_[i].received.size() <= kMaxLockstepBytes) waited[i + 1].fd = connections_[i].socket.get();
  }
  std::size_t silent = 0;
  const int limit_ms = wait_ms(Clock::now(), &silent);
  const int ready = ::poll(waited.data(), waited.size(), limit_ms);
  if (ready < 0 && errno != EINTR) {
    return failure(ErrorCode::kIo, "%s: waiting failed: %s", address().c_str(), hal::system_text(errno));
  }
  if (ready == 0) {
    return end_game(
        failure(ErrorCode::kTimeout, "%s was silent for %g s; the game has ended", name_of(silent), silence_s_));
  }
  if (ready < 0) return {};
  if (waited[0].revents != 0) accept();
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    if (waited[i + 1].revents != 0) TOUCHLINE_TRY(receive(i));
  }
  return {};
}

void LockstepServer::accept() {
  const int listener = unix_.descriptor() >= 0 ? unix_.descriptor() : tcp_.get();
  hal::Descriptor socket(::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.is_open()) return;
  // A third program is refused: its connection is closed at once.
  const std::size_t index = is_served_ ? kOpponents : kFirst;
  if (connections_[index].socket.is_open()) return;
  const int on = 1;
  if (tcp_.is_open()) ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  is_served_ = true;
  connections_[index] = Connection{};
  connections_[index].socket = std::move(socket);
  connections_[index].answered = Clock::now();
}

Result<void> LockstepServer::receive(std::size_t index) {
  Connection& connection = connections_[index];
  std::array<char, kReadBytes> bytes;
  const ssize_t size = ::recv(connection.socket.get(), bytes.data(), bytes.size(), 0);
  if (size > 0) {
    connection.received.append(bytes.data(), static_cast<std::size_t>(size));
    return {};
  }
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return {};
  connection.socket.reset();
  if (index == kFirst) {
    is_over_ = true;
    return {};
  }
  if (!game_.has_other_program()) return {};
  return end_game(failure(ErrorCode::kDisconnected, "the opponents' program has ended, and with it the game"));
}

Error LockstepServer::end_game(Error error) {
  const std::string line = error_line(error, true) + "\n";
  for (const Connection& connection : connections_) {
    if (!connection.socket.is_open()) continue;
    // A program that does not read gets no message.
    static_cast<void>(::send(connection.socket.get(), line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
  }
  return error;
}

}  // namespace touchline::simulate
