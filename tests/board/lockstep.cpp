#include "tests/board/lockstep.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>

namespace touchline::board {
namespace {

using Clock = std::chrono::steady_clock;

bool readable(int file, double timeout_s) {
  pollfd entry{file, POLLIN, 0};
  return ::poll(&entry, 1, static_cast<int>(timeout_s * 1000.0)) > 0;
}

bool send_all(int file, const void* data, std::size_t bytes) {
  for (const auto* at = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t sent = ::send(file, at, bytes, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    bytes -= static_cast<std::size_t>(sent);
  }
  return true;
}

}  // namespace

Lockstep::Lockstep(const config::BoardFile& board, std::uint64_t seed, int pictures, int radio, double frame_timeout_s)
    : arena_(board.arena, board.camera, board.radio, seed),
      fourcc_(info_of(hal::pixel_format(board.camera.format)).v4l2),
      period_us_(static_cast<std::uint32_t>(std::lround(1e6 / board.camera.rate_hz))),
      frame_timeout_s_(frame_timeout_s),
      pictures_(pictures),
      radio_(radio),
      picture_(
          picture_layout(hal::pixel_format(board.camera.format), board.camera.width_px, board.camera.height_px).bytes) {
  for (const hal::mock::ArenaRobot& robot : board.arena.robot) is_own_.push_back(robot.team == hal::mock::Side::kOwn);
  arena_.start_camera();
}

FrameHeader Lockstep::next_header(ToGuest kind) {
  FrameHeader header;
  header.kind = kind;
  header.number = number_++;
  header.period_us = period_us_;
  header.fourcc = fourcc_;
  header.width_px = arena_.camera().width_px;
  header.height_px = arena_.camera().height_px;
  header.bytes = static_cast<std::uint32_t>(picture_.size());
  return header;
}

Result<FrameAnswer> Lockstep::exchange(const FrameHeader& header) {
  const std::size_t bytes = has_picture(header.kind) ? picture_.size() : 0;
  if (!send_all(pictures_, &header, sizeof header) || !send_all(pictures_, picture_.data(), bytes)) {
    return failure(ErrorCode::kIo, "the guest does not accept the picture: %s", std::strerror(errno));
  }
  FrameAnswer answer;
  auto* const at = reinterpret_cast<char*>(&answer);
  for (std::size_t got = 0; got < sizeof answer;) {
    const ssize_t more = readable(pictures_, frame_timeout_s_) ? ::read(pictures_, at + got, sizeof answer - got) : 0;
    if (more <= 0) return failure(ErrorCode::kTimeout, "the guest does not answer frame %u", header.number);
    got += static_cast<std::size_t>(more);
  }
  if (answer.magic == kWireMagic && answer.number == header.number) return answer;
  return failure(ErrorCode::kInconsistent, "the guest sent a wrong answer for frame %u", header.number);
}

Result<Lockstep::Received> Lockstep::receive(double timeout_s, Expect expect) {
  Received received;
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  while (readable(radio_, timeout_s)) {
    std::array<std::byte, 256> bytes;
    const ssize_t got = ::read(radio_, bytes.data(), bytes.size());
    if (got <= 0) return failure(ErrorCode::kIo, "the radio socket was closed");
    for (ssize_t i = 0; i < got; ++i) {
      stream_.push(bytes[static_cast<std::size_t>(i)]);
      Commands commands;
      std::uint8_t sequence = 0;
      while (stream_.next(commands, sequence)) {
        if (last_sequence_ >= 0 && sequence != ((last_sequence_ + 1) & 0xff)) ++sequence_gaps_;
        last_sequence_ = sequence;
        ++(commands.stop ? received.stops : received.drives);
        Packet packet;
        // Unlike the guest's time, the arena's time does not advance between frames. A packet is lost if the queue is
        // full.
        if (const Status encoded = encode(commands, sequence, packet); !encoded.ok()) {
          return failure(encoded.code(), "packet %u cannot be encoded: %s", sequence, describe(encoded.code()));
        }
        const Result<void> sent = arena_.channel().send({packet.data(), packet.size()}, arena_.now());
        if (!sent.ok() && sent.code() != ErrorCode::kBusy) {
          return failure(sent.code(), "the arena's radio channel refuses packet %u: %s", sequence,
                         sent.error().text.c_str());
        }
      }
    }
    const bool enough = received.drives > 0 || (expect != Expect::kSpeeds && received.stops > 0);
    // With enough packets, only reads those that have already arrived.
    timeout_s = enough ? 0.0 : std::max(0.0, std::chrono::duration<double>(end - Clock::now()).count());
  }
  return received;
}

Result<void> Lockstep::play_frame(ToGuest kind, Expect expect, PlayResult& out) {
  const hal::mock::Snapshot before = arena_.world().snapshot();
  std::optional<hal::mock::Exposure> exposure;
  while (!(exposure = arena_.take_exposure())) arena_.advance_to(*arena_.next_frame_ready());
  const hal::mock::Snapshot after = arena_.world().snapshot();
  out.ball.push_back(after.ball);
  for (std::size_t i = 0; i < after.robots.size(); ++i) {
    if (!is_own_[i]) continue;
    out.own_path_m +=
        std::hypot(after.robots[i].x_m - before.robots[i].x_m, after.robots[i].y_m - before.robots[i].y_m);
  }
  const FrameHeader header = next_header(kind);
  if (has_picture(kind)) arena_.render(*exposure, picture_);
  TOUCHLINE_TRY_ASSIGN(const FrameAnswer answer, exchange(header));
  const bool shown = kind == ToGuest::kFrame && answer.error == 0;
  if (answer.error != 0) out.last_error = answer.error;
  out.shown += shown ? 1 : 0;
  out.late += answer.late_us > 0 ? 1 : 0;
  out.latest_us = std::max(out.latest_us, answer.late_us);
  const bool wait = shown && expect != Expect::kNothing;
  TOUCHLINE_TRY_ASSIGN(const Received received, receive(wait ? frame_timeout_s_ : 0.0, expect));
  out.packets += received.drives + received.stops;
  out.stops += received.stops;
  const char letter = received.drives > 0 ? (received.stops > 0 ? 'm' : 'd') : (received.stops > 0 ? 's' : '.');
  out.frames += shown || letter == '.' ? letter : static_cast<char>(letter - 'a' + 'A');
  if (wait && (letter == '.' || (expect == Expect::kSpeeds && received.drives == 0))) {
    return failure(ErrorCode::kTimeout, "no packet followed frame %u", header.number);
  }
  return {};
}

Result<void> Lockstep::play(std::uint64_t count, ToGuest kind, Expect expect, PlayResult& out) {
  for (std::uint64_t i = 0; i < count; ++i) TOUCHLINE_TRY(play_frame(kind, expect, out));
  return {};
}

Result<void> Lockstep::plug(bool in) {
  TOUCHLINE_TRY_ASSIGN(const FrameAnswer answer, exchange(next_header(in ? ToGuest::kPlug : ToGuest::kUnplug)));
  if (answer.error == 0) return {};
  return failure(ErrorCode::kIo, "the guest's camera cannot be opened: %s", std::strerror(answer.error));
}

Result<void> Lockstep::listen(double quiet_s, PlayResult& out) {
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const Received received, receive(quiet_s, Expect::kNothing));
    if (received.drives + received.stops == 0) return {};
    out.packets += received.drives + received.stops;
    out.stops += received.stops;
    out.frames += received.drives > 0 ? (received.stops > 0 ? 'm' : 'd') : 's';
  }
}

}  // namespace touchline::board
