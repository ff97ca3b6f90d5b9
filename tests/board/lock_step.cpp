#include "tests/board/lock_step.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>

#include "core/radio/packet.h"
#include "hal/mock/sensor.h"

namespace touchline::board {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t fourcc(const char (&letters)[5]) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = (code << 8U) | static_cast<unsigned char>(letters[i]);
  return code;
}

std::uint32_t fourcc_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return fourcc("RGB3");
    case PixelFormat::kBgr24:
      return fourcc("BGR3");
    case PixelFormat::kYuyv:
      return fourcc("YUYV");
    case PixelFormat::kUyvy:
      return fourcc("UYVY");
    case PixelFormat::kNv12:
      return fourcc("NV12");
  }
  return 0;
}

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

LockStep::LockStep(const config::BoardFile& board, std::uint64_t seed, int pictures, int radio, double frame_timeout_s)
    : arena_(board.arena, board.camera, board.radio, seed),
      fourcc_(fourcc_of(hal::pixel_format(board.camera.format))),
      period_us_(static_cast<std::uint32_t>(std::lround(1e6 / board.camera.rate_hz))),
      frame_timeout_s_(frame_timeout_s),
      pictures_(pictures),
      radio_(radio),
      picture_(
          hal::mock::layout_of(hal::pixel_format(board.camera.format), board.camera.width_px, board.camera.height_px)
              .bytes) {
  for (const hal::mock::ArenaRobot& robot : board.arena.robot) is_own_.push_back(robot.team == hal::mock::Side::kOwn);
  arena_.start_camera();
}

FrameHeader LockStep::next_header(ToGuest kind) {
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

bool LockStep::exchange(const FrameHeader& header, FrameAnswer& answer, std::string& reason) {
  const std::size_t bytes = has_picture(header.kind) ? picture_.size() : 0;
  if (!send_all(pictures_, &header, sizeof header) || !send_all(pictures_, picture_.data(), bytes)) {
    reason = std::string("the guest takes no picture: ") + std::strerror(errno);
    return false;
  }
  auto* const at = reinterpret_cast<char*>(&answer);
  for (std::size_t got = 0; got < sizeof answer;) {
    const ssize_t more = readable(pictures_, frame_timeout_s_) ? ::read(pictures_, at + got, sizeof answer - got) : 0;
    if (more <= 0) {
      reason = "the guest does not answer to frame " + std::to_string(header.number);
      return false;
    }
    got += static_cast<std::size_t>(more);
  }
  if (answer.magic == kWireMagic && answer.number == header.number) return true;
  reason = "the guest answered something else to frame " + std::to_string(header.number);
  return false;
}

bool LockStep::hear(double timeout_s, Expect expect, Heard& heard, std::string& reason) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  while (readable(radio_, timeout_s)) {
    std::array<std::byte, 256> bytes;
    const ssize_t got = ::read(radio_, bytes.data(), bytes.size());
    if (got <= 0) {
      reason = "the line to the robots was closed";
      return false;
    }
    for (ssize_t i = 0; i < got; ++i) {
      stream_.push(bytes[static_cast<std::size_t>(i)]);
      Commands commands;
      std::uint8_t sequence = 0;
      while (stream_.next(commands, sequence)) {
        if (last_sequence_ >= 0 && sequence != ((last_sequence_ + 1) & 0xff)) ++sequence_gaps_;
        last_sequence_ = sequence;
        ++(commands.stop ? heard.stops : heard.drives);
        Packet packet;
        // The arena's time stands still between frames, the guest's does not: a packet that finds the air full is lost.
        const Status sent = encode(commands, sequence, packet).ok()
                                ? arena_.channel().send({packet.data(), packet.size()}, arena_.now())
                                : ErrorCode::kInconsistent;
        if (!sent.ok() && sent.code() != ErrorCode::kBusy) {
          reason = "the arena's air does not take packet " + std::to_string(sequence);
          return false;
        }
      }
    }
    const bool enough = heard.drives > 0 || (expect != Expect::kSpeeds && heard.stops > 0);
    // Then only what is there already.
    timeout_s = enough ? 0.0 : std::max(0.0, std::chrono::duration<double>(end - Clock::now()).count());
  }
  return true;
}

bool LockStep::one_frame(ToGuest kind, Expect expect, Played& out, std::string& reason) {
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
  FrameAnswer answer;
  if (!exchange(header, answer, reason)) return false;
  const bool shown = kind == ToGuest::kFrame && answer.error == 0;
  if (answer.error != 0) out.last_error = answer.error;
  out.shown += shown ? 1 : 0;
  out.late += answer.late_us > 0 ? 1 : 0;
  out.latest_us = std::max(out.latest_us, answer.late_us);
  Heard heard;
  const bool wait = shown && expect != Expect::kNothing;
  if (!hear(wait ? frame_timeout_s_ : 0.0, expect, heard, reason)) return false;
  out.packets += heard.drives + heard.stops;
  out.stops += heard.stops;
  const char letter = heard.drives > 0 ? (heard.stops > 0 ? 'm' : 'd') : (heard.stops > 0 ? 's' : '.');
  out.frames += shown || letter == '.' ? letter : static_cast<char>(letter - 'a' + 'A');
  if (wait && (letter == '.' || (expect == Expect::kSpeeds && heard.drives == 0))) {
    reason = "no packet came for frame " + std::to_string(header.number);
    return false;
  }
  return true;
}

bool LockStep::play(std::uint64_t count, ToGuest kind, Expect expect, Played& out, std::string& reason) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!one_frame(kind, expect, out, reason)) return false;
  }
  return true;
}

bool LockStep::plug(bool in, std::string& reason) {
  FrameAnswer answer;
  if (!exchange(next_header(in ? ToGuest::kPlug : ToGuest::kUnplug), answer, reason)) return false;
  if (answer.error != 0) reason = std::string("the guest's camera cannot be opened: ") + std::strerror(answer.error);
  return answer.error == 0;
}

bool LockStep::listen(double quiet_s, Played& out, std::string& reason) {
  for (;;) {
    Heard heard;
    if (!hear(quiet_s, Expect::kNothing, heard, reason)) return false;
    if (heard.drives + heard.stops == 0) return true;
    out.packets += heard.drives + heard.stops;
    out.stops += heard.stops;
    out.frames += heard.drives > 0 ? (heard.stops > 0 ? 'm' : 'd') : 's';
  }
}

}  // namespace touchline::board
