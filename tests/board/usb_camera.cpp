#include "tests/board/usb_camera.h"

#include <linux/usb/ch9.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "tests/linux/jpeg_encoder.h"

namespace touchline::board {
namespace {

constexpr std::uint8_t kControlInterface = 0, kStreamingInterface = 1;
constexpr std::uint8_t kCamera = 1, kProcessing = 2, kOutput = 3;  // entity ids
constexpr std::uint8_t kEndpoint = USB_DIR_IN | 1;
constexpr std::uint16_t kPacketBytes = 3 * 1024;  // the limit of USB high speed per microframe (125 us)
constexpr std::uint32_t kClockHz = 48000000;
constexpr std::uint8_t kWrongState = 2, kOutOfRange = 4,
                       kInvalidControl = 6;  // error codes, USB Video Class 1.0, 4.2.1.2

struct Size {
  std::uint16_t width, height;
};
constexpr std::uint8_t kYuyv = 1, kMjpg = 2;  // bFormatIndex
// GUID of the format YUY2.
constexpr std::array<std::uint8_t, 16> kYuy2 = {'Y',  'U', 'Y', '2',  0, 0,    0x10, 0,
                                                0x80, 0,   0,   0xaa, 0, 0x38, 0x9b, 0x71};
constexpr std::array<std::uint32_t, 2> kIntervals = {666666, 1000000};  // 100 ns: 15 Hz, 10 Hz

std::vector<Size> sizes_of(std::uint8_t format) {
  if (format == kMjpg) return {{640, 480}};
  return {{640, 480}, {320, 240}};
}

/// A sequence of USB descriptors, each of which begins with its length.
class Descriptors {
 public:
  Descriptors& begin(std::initializer_list<unsigned> type) {
    at_ = bytes.size();
    bytes.push_back(0);
    return add<1>(type);
  }
  template <std::size_t kBytes>
  Descriptors& add(std::initializer_list<std::uint32_t> values) {
    for (const std::uint32_t value : values) {
      for (std::size_t i = 0; i < kBytes; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i));
    }
    bytes[at_] = static_cast<std::uint8_t>(bytes.size() - at_);
    return *this;
  }
  void add(const Descriptors& others) { bytes.insert(bytes.end(), others.bytes.begin(), others.bytes.end()); }
  /// Writes the total number of bytes into the field at `at` of the first descriptor.
  void total(std::size_t at) {
    bytes[at] = static_cast<std::uint8_t>(bytes.size());
    bytes[at + 1] = static_cast<std::uint8_t>(bytes.size() >> 8U);
  }

  Bytes bytes;

 private:
  std::size_t at_ = 0;
};

Descriptors video_control() {
  Descriptors d;
  d.begin({USB_DT_CS_INTERFACE, UVC_VC_HEADER}).add<2>({0x0100, 0}).add<4>({kClockHz}).add<1>({1, kStreamingInterface});
  // Bits of the controls: exposure mode, auto-exposure priority, exposure time; focus; automatic focus.
  d.begin({USB_DT_CS_INTERFACE, UVC_VC_INPUT_TERMINAL, kCamera}).add<2>({UVC_ITT_CAMERA}).add<1>({0, 0});
  d.add<2>({0, 0, 0}).add<1>({3, 0x2e, 0x00, 0x02});
  // Bits of the controls: brightness, white balance, gain, power line, automatic white balance.
  d.begin({USB_DT_CS_INTERFACE, UVC_VC_PROCESSING_UNIT, kProcessing, kCamera}).add<2>({0}).add<1>({2, 0x41, 0x16, 0});
  d.begin({USB_DT_CS_INTERFACE, UVC_VC_OUTPUT_TERMINAL, kOutput})
      .add<2>({UVC_TT_STREAMING})
      .add<1>({0, kProcessing, 0});
  d.total(5);
  return d;
}

Descriptors video_streaming() {
  Descriptors d;
  d.begin({USB_DT_CS_INTERFACE, UVC_VS_INPUT_HEADER, 2}).add<2>({0}).add<1>({kEndpoint, 0, kOutput, 0, 0, 0, 1, 0, 0});
  for (const std::uint8_t format : {kYuyv, kMjpg}) {
    const std::vector<Size> sizes = sizes_of(format);
    const auto count = static_cast<std::uint32_t>(sizes.size());
    if (format == kYuyv) {
      d.begin({USB_DT_CS_INTERFACE, UVC_VS_FORMAT_UNCOMPRESSED, format, count});
      for (const std::uint8_t byte : kYuy2) d.add<1>({byte});
      d.add<1>({16, 1, 0, 0, 0, 0});
    } else {
      d.begin({USB_DT_CS_INTERFACE, UVC_VS_FORMAT_MJPEG, format, count, 0, 1, 0, 0, 0, 0});
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t bytes = 2U * sizes[i].width * sizes[i].height;
      d.begin({USB_DT_CS_INTERFACE, format == kYuyv ? 5U : 7U, i + 1, 0}).add<2>({sizes[i].width, sizes[i].height});
      d.add<4>({bytes * 80, bytes * 120, bytes, kIntervals[0]}).add<1>({std::uint32_t{kIntervals.size()}});
      for (const std::uint32_t interval : kIntervals) d.add<4>({interval});
    }
    d.begin({USB_DT_CS_INTERFACE, UVC_VS_COLORFORMAT, 1, 1, 4});
  }
  d.total(4);
  return d;
}

Bytes configuration() {
  Descriptors d;
  d.begin({USB_DT_CONFIG}).add<2>({0}).add<1>({2, 1, 0, USB_CONFIG_ATT_ONE, 250});
  d.begin(
      {USB_DT_INTERFACE_ASSOCIATION, kControlInterface, 2, USB_CLASS_VIDEO, UVC_SC_VIDEO_INTERFACE_COLLECTION, 0, 0});
  d.begin({USB_DT_INTERFACE, kControlInterface, 0, 0, USB_CLASS_VIDEO, UVC_SC_VIDEOCONTROL, 0, 0});
  d.add(video_control());
  d.begin({USB_DT_INTERFACE, kStreamingInterface, 0, 0, USB_CLASS_VIDEO, UVC_SC_VIDEOSTREAMING, 0, 0});
  d.add(video_streaming());
  d.begin({USB_DT_INTERFACE, kStreamingInterface, 1, 1, USB_CLASS_VIDEO, UVC_SC_VIDEOSTREAMING, 0, 0});
  d.begin({USB_DT_ENDPOINT, kEndpoint, USB_ENDPOINT_XFER_ISOC | USB_ENDPOINT_SYNC_ASYNC});
  d.add<2>({2U << 11U | 1024U}).add<1>({1});  // three transactions of 1024 bytes per microframe
  d.total(2);
  return d.bytes;
}

Bytes device(const UsbIdentity& identity) {
  Descriptors d;
  d.begin({USB_DT_DEVICE})
      .add<2>({0x0200})
      .add<1>({identity.device_class, identity.device_subclass, identity.device_protocol, 64});
  d.add<2>({identity.vendor, identity.product, 0x0100}).add<1>({1, 2, 3, 1});
  return d.bytes;
}

std::optional<Bytes> string(std::size_t index) {
  constexpr std::array<const char*, 4> kStrings = {"", "Touchline", "Camera of a test", "0001"};
  Descriptors d;
  d.begin({USB_DT_STRING});
  if (index >= kStrings.size()) return {};
  if (index == 0) d.add<2>({0x0409});  // English
  for (const char* at = kStrings[index]; *at != 0; ++at) d.add<2>({static_cast<std::uint32_t>(*at)});
  return d.bytes;
}

Bytes number(std::int64_t value, std::size_t bytes) {
  Bytes out(bytes);
  for (std::size_t i = 0; i < bytes; ++i) out[i] = static_cast<std::uint8_t>(value >> 8 * i);
  return out;
}

Bytes jpeg_of(const FrameHeader& header, std::span<const std::uint8_t> rgb, bool with_huffman_tables) {
  const auto set_up = [with_huffman_tables](jpeg_compress_struct& jpeg) {
    jpeg_set_quality(&jpeg, 90, TRUE);
    jpeg.comp_info[0].h_samp_factor = 2;
    jpeg.comp_info[0].v_samp_factor = 1;
    jpeg_suppress_tables(&jpeg, FALSE);
    const boolean sent = with_huffman_tables ? FALSE : TRUE;
    for (int i = 0; i < 2; ++i) jpeg.dc_huff_tbl_ptrs[i]->sent_table = jpeg.ac_huff_tbl_ptrs[i]->sent_table = sent;
  };
  const auto fill_row = [rgb](unsigned v, std::span<std::uint8_t> row) {
    std::copy_n(rgb.begin() + static_cast<std::ptrdiff_t>(row.size() * v), row.size(), row.begin());
  };
  return testing::encode_jpeg(header.width_px, header.height_px, set_up, fill_row, false);
}

/// Returns the supported values that are nearest to the requested ones.
uvc_streaming_control negotiated(const uvc_streaming_control& requested) {
  uvc_streaming_control supported{};
  supported.bmHint = requested.bmHint;
  supported.bFormatIndex = std::clamp(requested.bFormatIndex, kYuyv, kMjpg);
  const std::vector<Size> sizes = sizes_of(supported.bFormatIndex);
  supported.bFrameIndex = std::clamp<std::uint8_t>(requested.bFrameIndex, 1, static_cast<std::uint8_t>(sizes.size()));
  const Size size = sizes[supported.bFrameIndex - 1U];
  const bool slow = std::uint32_t{requested.dwFrameInterval} > (kIntervals[0] + kIntervals[1]) / 2;
  supported.dwFrameInterval = kIntervals[slow ? 1 : 0];
  supported.dwMaxVideoFrameSize = 2U * size.width * size.height;
  supported.dwMaxPayloadTransferSize = kPacketBytes;
  return supported;
}

// Size of uvc_streaming_control in UVC 1.0, which ends before dwClockFrequency.
constexpr std::size_t kStreamingBytes = 26;

}  // namespace

UsbCamera::UsbCamera()
    : configuration_(configuration()),
      controls_{
          {"exposure mode", kCamera, UVC_CT_AE_MODE_CONTROL, 1, 1, 8, 1 | 8, 8},  // bits: manual, aperture priority
          {"auto-exposure priority", kCamera, UVC_CT_AE_PRIORITY_CONTROL, 1, 0, 1, 1, 1},
          {"exposure", kCamera, UVC_CT_EXPOSURE_TIME_ABSOLUTE_CONTROL, 4, 3, 2047, 1, 250, "exposure mode", 1},
          {"focus", kCamera, UVC_CT_FOCUS_ABSOLUTE_CONTROL, 2, 0, 250, 5, 0, "automatic focus", 0},
          {"automatic focus", kCamera, UVC_CT_FOCUS_AUTO_CONTROL, 1, 0, 1, 1, 1},
          {"brightness", kProcessing, UVC_PU_BRIGHTNESS_CONTROL, 2, -64, 64, 1, 0},
          {"gain", kProcessing, UVC_PU_GAIN_CONTROL, 2, 0, 255, 1, 64},
          {"power line", kProcessing, UVC_PU_POWER_LINE_FREQUENCY_CONTROL, 1, 0, 2, 1, 2},
          {"white balance", kProcessing, UVC_PU_WHITE_BALANCE_TEMPERATURE_CONTROL, 2, 2800, 6500, 10, 4600,
           "automatic white balance", 0},
          {"automatic white balance", kProcessing, UVC_PU_WHITE_BALANCE_TEMPERATURE_AUTO_CONTROL, 1, 0, 1, 1, 1},
      },
      probed_(negotiated({})),
      committed_(probed_) {}

UsbIdentity UsbCamera::identity() const {
  return {.device_class = USB_CLASS_MISC,
          .device_subclass = 2,
          .device_protocol = 1,
          .vendor = 0x1d6b,
          .product = 0x0102,
          .interfaces = {{USB_CLASS_VIDEO, UVC_SC_VIDEOCONTROL}, {USB_CLASS_VIDEO, UVC_SC_VIDEOSTREAMING}},
          .stream_endpoint = kEndpoint,
          .stream_interface = kStreamingInterface,
          .packet_bytes = kPacketBytes};
}

std::optional<Bytes> UsbCamera::answer(const ControlRequest& request) {
  if ((request.type & USB_TYPE_MASK) == USB_TYPE_CLASS) {
    return (request.index & 0xffU) == kStreamingInterface ? answer_streaming(request) : answer_controls(request);
  }
  if (request.request == USB_REQ_GET_STATUS) return Bytes(2);
  if (request.request != USB_REQ_GET_DESCRIPTOR) return Bytes{};
  switch (request.value >> 8U) {
    case USB_DT_DEVICE:
      return device(identity());
    case USB_DT_CONFIG:
      return configuration_;
    case USB_DT_STRING:
      return string(request.value & 0xffU);
    default:
      return {};
  }
}

std::optional<Bytes> UsbCamera::answer_streaming(const ControlRequest& request) {
  const bool commits = request.value >> 8U == UVC_VS_COMMIT_CONTROL;
  if (request.request == UVC_GET_INFO) return Bytes{UVC_CONTROL_CAP_GET | UVC_CONTROL_CAP_SET};
  if (request.request == UVC_GET_LEN) return number(kStreamingBytes, 2);
  if (request.request == UVC_SET_CUR) {
    uvc_streaming_control requested{};
    std::memcpy(&requested, request.data.data(), std::min(request.data.size(), kStreamingBytes));
    (commits ? committed_ : probed_) = negotiated(requested);
    if (commits) std::printf("format: %s\n", committed_.bFormatIndex == kMjpg ? "mjpg" : "yuyv");
    return Bytes{};
  }
  const uvc_streaming_control& state = commits ? committed_ : probed_;
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(&state);
  return Bytes(begin, begin + kStreamingBytes);
}

std::optional<Bytes> UsbCamera::answer_controls(const ControlRequest& request) {
  const unsigned entity = request.index >> 8U, selector = request.value >> 8U;
  if (entity == 0 && selector == UVC_VC_REQUEST_ERROR_CODE_CONTROL) return Bytes{error_};
  const auto found = std::find_if(controls_.begin(), controls_.end(),
                                  [&](const Control& c) { return c.entity == entity && c.selector == selector; });
  error_ = found == controls_.end() ? kInvalidControl : 0;
  if (error_ != 0) return {};
  switch (request.request) {
    case UVC_SET_CUR: {
      std::int32_t value = 0;
      for (std::size_t i = 0; i < std::min(found->bytes, request.data.size()); ++i) value |= request.data[i] << 8 * i;
      if (found->bytes == 2) value = static_cast<std::int16_t>(value);
      return set(*found, value) ? std::optional<Bytes>(Bytes{}) : std::nullopt;
    }
    case UVC_GET_CUR:
      return number(found->now, found->bytes);
    case UVC_GET_MIN:
      return number(found->low, found->bytes);
    case UVC_GET_MAX:
      return number(found->high, found->bytes);
    case UVC_GET_RES:
      return number(found->step, found->bytes);
    case UVC_GET_DEF:
      return number(found->default_value, found->bytes);
    case UVC_GET_LEN:
      return number(static_cast<std::int64_t>(found->bytes), 2);
    case UVC_GET_INFO:
      return Bytes{UVC_CONTROL_CAP_GET | UVC_CONTROL_CAP_SET};
    default:
      return {};
  }
}

UsbCamera::Control* UsbCamera::find_control(const std::string& name) {
  return &*std::find_if(controls_.begin(), controls_.end(), [&](const Control& c) { return name == c.name; });
}

bool UsbCamera::set(Control& control, std::int32_t value) {
  if (control.automatic != nullptr && find_control(control.automatic)->now != control.manual) {
    error_ = kWrongState;
  } else if (value < control.low || value > control.high) {
    error_ = kOutOfRange;
  } else {
    control.now = value;
  }
  std::printf("%s: %d%s\n", control.name, value, error_ == 0 ? "" : " refused");
  return error_ == 0;
}

std::vector<Bytes> UsbCamera::packets_of(const FrameHeader& header, std::span<const std::uint8_t> picture) {
  const Size size = sizes_of(committed_.bFormatIndex)[committed_.bFrameIndex - 1U];
  const bool compressed = committed_.bFormatIndex == kMjpg;
  const std::size_t bytes = std::size_t{size.width} * size.height * (compressed ? 3 : 2);
  if (header.width_px != size.width || header.height_px != size.height || picture.size() != bytes) return {};
  ++frame_;
  Bytes jpeg;
  if (compressed) jpeg = jpeg_of(header, picture, (frame_ & 1U) == 0);
  std::span<const std::uint8_t> left = compressed ? std::span<const std::uint8_t>(jpeg) : picture;
  std::vector<Bytes> packets;
  while (!left.empty()) {
    const std::size_t part = std::min<std::size_t>(left.size(), kPacketBytes - 2U);
    const unsigned end = part == left.size() ? UVC_STREAM_EOF : 0;
    Bytes packet{2, static_cast<std::uint8_t>(UVC_STREAM_EOH | end | (frame_ & 1U))};
    packet.insert(packet.end(), left.begin(), left.begin() + static_cast<std::ptrdiff_t>(part));
    packets.push_back(std::move(packet));
    left = left.subspan(part);
  }
  return packets;
}

}  // namespace touchline::board
