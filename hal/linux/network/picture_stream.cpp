#include "hal/linux/network/picture_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>

namespace touchline::hal {
namespace {

// The last character is the version of the format.
constexpr std::string_view kHelloMagic = "TLPICS-2";
constexpr std::uint32_t kPictureMagic = 0x52464c54;  // "TLFR"
constexpr std::size_t kWordBytes = 16;               // the word of the format, filled up with zeros

/// Writes or reads numbers one after the other.
class Writer {
 public:
  explicit Writer(std::span<std::byte> out) : out_(out) {}
  void number(std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) out_[at_++] = static_cast<std::byte>(value >> (8 * i));
  }
  void real(float value) { number(std::bit_cast<std::uint32_t>(value), 4); }
  void text(std::string_view value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) out_[at_++] = static_cast<std::byte>(i < value.size() ? value[i] : '\0');
  }

 private:
  std::span<std::byte> out_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> in) : in_(in) {}
  std::uint64_t number(std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value |= std::to_integer<std::uint64_t>(in_[at_++]) << (8 * i);
    return value;
  }
  float real() { return std::bit_cast<float>(static_cast<std::uint32_t>(number(4))); }
  std::string_view text(std::size_t bytes) {
    const std::string_view all(reinterpret_cast<const char*>(in_.data()) + at_, bytes);
    at_ += bytes;
    return all.substr(0, all.find('\0'));
  }

 private:
  std::span<const std::byte> in_;
  std::size_t at_ = 0;
};

void write_truth(Writer& out, const TruePlaces& truth) {
  out.number(truth.is_known ? 1 : 0, 1);
  out.number(truth.robots.size(), 1);
  out.real(truth.ball.x_m);
  out.real(truth.ball.y_m);
  for (const TruePlaces::Robot& robot : truth.robots) {
    out.number(static_cast<std::uint8_t>(robot.team), 1);
    out.number(static_cast<std::uint8_t>(robot.id), 1);
    for (const float value : {robot.pose.position.x_m, robot.pose.position.y_m, robot.pose.theta_rad}) out.real(value);
  }
}

/// Returns false if it is none.
bool read_truth(Reader& in, TruePlaces& truth) {
  const std::uint64_t known = in.number(1), robots = in.number(1);
  if (known > 1 || robots > kMaxRobots) return false;
  truth.is_known = known == 1;
  truth.ball = {in.real(), in.real()};
  bool is_finite = std::isfinite(truth.ball.x_m) && std::isfinite(truth.ball.y_m);
  for (std::uint64_t i = 0; i < robots; ++i) {
    TruePlaces::Robot robot;
    const std::uint64_t team = in.number(1);
    if (team > static_cast<std::uint64_t>(Team::kOpponent)) return false;
    robot.team = static_cast<Team>(team);
    robot.id = static_cast<RobotId>(in.number(1));
    robot.pose.position = {in.real(), in.real()};
    robot.pose.theta_rad = in.real();
    for (const float value : {robot.pose.position.x_m, robot.pose.position.y_m, robot.pose.theta_rad})
      is_finite = is_finite && std::isfinite(value);
    truth.robots.push_back(robot);
  }
  return is_finite;
}

}  // namespace

std::size_t largest_picture(CameraFormat format, std::uint16_t width_px, std::uint16_t height_px) {
  return picture_layout(pixel_format(format), width_px, height_px).bytes;
}

StreamHelloBytes encode(const StreamHello& hello) {
  StreamHelloBytes bytes{};
  Writer out(bytes);
  out.text(kHelloMagic, kHelloMagic.size());
  out.text(kCameraFormats[static_cast<std::size_t>(hello.format)].word, kWordBytes);
  out.number(hello.width_px, 2);
  out.number(hello.height_px, 2);
  out.number(hello.rate_mhz, 4);
  out.number(hello.lockstep ? 1 : 0, 1);
  return bytes;
}

Result<StreamHello> parse_stream_hello(std::span<const std::byte, kStreamHelloBytes> bytes) {
  Reader in(bytes);
  if (in.text(kHelloMagic.size()) != kHelloMagic) {
    return failure(ErrorCode::kInconsistent, "the program there does not send pictures, or has another version");
  }
  const std::string_view word = in.text(kWordBytes);
  const auto format = std::find_if(kCameraFormats.begin(), kCameraFormats.end(),
                                   [&](const auto& choice) { return choice.word == word; });
  StreamHello hello;
  hello.width_px = static_cast<std::uint16_t>(in.number(2));
  hello.height_px = static_cast<std::uint16_t>(in.number(2));
  hello.rate_mhz = static_cast<std::uint32_t>(in.number(4));
  hello.lockstep = in.number(1) != 0;
  if (format == kCameraFormats.end()) {
    return failure(ErrorCode::kInconsistent, "it sends pictures of an unknown format");
  }
  hello.format = format->value;
  return hello;
}

PictureHeaderBytes encode(const PictureHeader& header) {
  PictureHeaderBytes bytes{};
  Writer out(bytes);
  out.number(kPictureMagic, 4);
  out.number(header.bytes, 4);
  out.number(header.sequence, 4);
  out.number(static_cast<std::uint64_t>(header.captured_ns), 8);
  out.number(static_cast<std::uint64_t>(header.ready_ns), 8);
  out.number(static_cast<std::uint64_t>(header.sent_ns), 8);
  write_truth(out, header.truth);
  return bytes;
}

Result<PictureHeader> parse_picture_header(std::span<const std::byte, kPictureHeaderBytes> bytes, std::size_t largest) {
  Reader in(bytes);
  if (in.number(4) != kPictureMagic) {
    return failure(ErrorCode::kInconsistent, "the bytes received are not a picture");
  }
  PictureHeader header;
  header.bytes = static_cast<std::uint32_t>(in.number(4));
  header.sequence = static_cast<std::uint32_t>(in.number(4));
  header.captured_ns = static_cast<std::int64_t>(in.number(8));
  header.ready_ns = static_cast<std::int64_t>(in.number(8));
  header.sent_ns = static_cast<std::int64_t>(in.number(8));
  if (header.bytes == 0 || header.bytes > largest) {
    return failure(ErrorCode::kInconsistent, "a picture of %u bytes is announced; at most %zu are possible",
                   header.bytes, largest);
  }
  // Differences of times beyond 30 years would not fit into a Duration's arithmetic.
  constexpr std::int64_t kLatest_ns = 1'000'000'000'000'000'000;
  for (const std::int64_t time : {header.captured_ns, header.ready_ns, header.sent_ns}) {
    if (time < 0 || time > kLatest_ns) {
      return failure(ErrorCode::kInconsistent, "the times of a picture are impossible");
    }
  }
  if (!read_truth(in, header.truth)) {
    return failure(ErrorCode::kInconsistent, "the places that come with a picture are impossible");
  }
  return header;
}

}  // namespace touchline::hal
