#include "firmware/recording/picture_message.h"

#include <array>
#include <cstring>

namespace touchline::recording {
namespace {

// The encapsulation of CDR: plain, little-endian. Positions are counted from its end.
constexpr std::string_view kEncapsulation{"\0\1\0\0", 4};

constexpr std::string_view kHeaderDefinition =
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";

class CdrWriter {
 public:
  explicit CdrWriter(std::string& out) : out_(out) { out_.assign(kEncapsulation); }

  void number(std::uint32_t value) {
    while (out_.size() % sizeof(value) != 0) out_.push_back('\0');
    std::array<char, sizeof(value)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(value));
    out_.append(bytes.data(), bytes.size());
  }
  void byte(std::uint8_t value) { out_.push_back(static_cast<char>(value)); }
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    out_.append(value);
    out_.push_back('\0');
  }

 private:
  std::string& out_;
};

class CdrReader {
 public:
  explicit CdrReader(std::span<const std::byte> message) : message_(message) {}

  std::uint32_t number() {
    std::uint32_t value = 0;
    position_ = (position_ + sizeof(value) - 1) / sizeof(value) * sizeof(value);
    if (position_ + sizeof(value) > message_.size()) return fail();
    std::memcpy(&value, message_.data() + position_, sizeof(value));
    position_ += sizeof(value);
    return value;
  }
  void skip(std::size_t bytes) {
    if (bytes > message_.size() - position_) fail();
    if (ok_) position_ += bytes;
  }
  void skip_text() { skip(number()); }
  /// Without the byte 0 at its end.
  std::string_view text() {
    const std::size_t bytes = number();
    const std::size_t begin = position_;
    skip(bytes);
    if (!ok_ || bytes == 0) return {};
    return {reinterpret_cast<const char*>(message_.data()) + begin, bytes - 1};
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::span<const std::byte> rest() const { return message_.subspan(position_); }

 private:
  std::uint32_t fail() {
    ok_ = false;
    position_ = message_.size();
    return 0;
  }

  std::span<const std::byte> message_;
  std::size_t position_ = kEncapsulation.size();
  bool ok_ = true;
};

std::string_view ros_encoding(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return "rgb8";
    case PixelFormat::kBgr24:
      return "bgr8";
    case PixelFormat::kXrgb8888:
      return "bgra8";
    case PixelFormat::kYuyv:
      return "yuv422_yuy2";
    case PixelFormat::kUyvy:
      return "yuv422";
    case PixelFormat::kNv12:
    case PixelFormat::kI420:
    case PixelFormat::kYuvj422p:
      break;
  }
  return info_of(format).word;
}

}  // namespace

std::string_view picture_schema_name(PictureKind kind) {
  return kind == PictureKind::kJpeg ? "sensor_msgs/msg/CompressedImage" : "sensor_msgs/msg/Image";
}

std::string_view picture_schema(PictureKind kind) {
  static const std::string compressed =
      "std_msgs/Header header\nstring format\nuint8[] data\n" + std::string(kHeaderDefinition);
  static const std::string raw =
      "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] "
      "data\n" +
      std::string(kHeaderDefinition);
  return kind == PictureKind::kJpeg ? compressed : raw;
}

void write_picture_head(const StepHeader& step, std::uint64_t time_ns, std::size_t bytes, std::string& out) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  CdrWriter writer(out);
  writer.number(static_cast<std::uint32_t>(time_ns / kSecond));
  writer.number(static_cast<std::uint32_t>(time_ns % kSecond));
  writer.text("camera");
  if (step.picture == PictureKind::kJpeg) {
    writer.text("jpeg");
  } else {
    writer.number(step.height_px);
    writer.number(step.width_px);
    writer.text(ros_encoding(step.format));
    writer.byte(0);
    writer.number(static_cast<std::uint32_t>(row_bytes(step.format, 0, step.width_px)));
  }
  writer.number(static_cast<std::uint32_t>(bytes));
}

std::optional<RawPicture> raw_picture_of(std::span<const std::byte> message) {
  if (message.size() < kEncapsulation.size()) return std::nullopt;
  CdrReader reader(message);
  static_cast<void>(reader.number());  // time
  static_cast<void>(reader.number());
  reader.skip_text();
  const std::uint32_t height = reader.number(), width = reader.number();
  const std::string_view encoding = reader.text();
  const std::optional<std::span<const std::byte>> bytes = picture_of(PictureKind::kRaw, message);
  if (!reader.ok() || !bytes || width == 0 || height == 0 || width > kMaxFrameWidth || height > kMaxFrameHeight) {
    return std::nullopt;
  }
  for (const PixelFormatInfo& info : kPixelFormatTable) {
    const PixelFormat format = info.format;
    if (ros_encoding(format) != encoding || picture_layout(format, width, height).bytes != bytes->size()) continue;
    return RawPicture{format, static_cast<std::uint16_t>(width), static_cast<std::uint16_t>(height), *bytes};
  }
  return std::nullopt;
}

Frame frame_of(const RawPicture& picture) {
  Frame frame;
  frame.format = picture.format;
  frame.width_px = picture.width_px;
  frame.height_px = picture.height_px;
  const PictureLayout layout = picture_layout(picture.format, picture.width_px, picture.height_px);
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(picture.bytes.data());
  for (std::size_t plane = 0; plane < info_of(picture.format).planes; ++plane) {
    frame.plane[plane] = begin + layout.offset_bytes[plane];
    frame.stride_bytes[plane] = layout.stride_bytes[plane];
  }
  return frame;
}

std::optional<std::span<const std::byte>> picture_of(PictureKind kind, std::span<const std::byte> message) {
  if (message.size() < kEncapsulation.size()) return std::nullopt;
  CdrReader reader(message);
  static_cast<void>(reader.number());  // time
  static_cast<void>(reader.number());
  reader.skip_text();
  if (kind == PictureKind::kJpeg) {
    reader.skip_text();
  } else {
    static_cast<void>(reader.number());  // height and width
    static_cast<void>(reader.number());
    reader.skip_text();
    reader.skip(1);
    static_cast<void>(reader.number());
  }
  const std::uint32_t bytes = reader.number();
  if (!reader.ok() || bytes != reader.rest().size()) return std::nullopt;
  return reader.rest();
}

}  // namespace touchline::recording
