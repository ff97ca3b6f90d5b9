#pragma once

#include <linux/usb/video.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/board/usb_link.h"
#include "tests/board/wire.h"

namespace touchline::board {

/// A webcam (USB Video Class 1.0) with YUYV and MJPG of 640 x 480 and usual controls: a menu of exposure modes with
/// holes, and values that are refused while their automatic is on. Prints what the host sets to standard output.
class UsbCamera final : public UsbDevice {
 public:
  UsbCamera();
  [[nodiscard]] UsbIdentity identity() const override;
  std::optional<Bytes> answer(const ControlRequest& request) override;

  /// The picture (YUYV, or RGB24 where MJPG is asked for) in packets of the format that the host has chosen; none:
  /// it is not of that format or size. Every other JPEG has no Huffman tables, as with many cameras.
  std::vector<Bytes> packets_of(const FrameHeader& header, std::span<const std::uint8_t> picture);

 private:
  struct Control {
    const char* name;
    std::uint8_t entity, selector;
    std::size_t bytes;
    std::int32_t low, high, step, normal;
    const char* automatic = nullptr;  // the control that must be `manual` for this one to be set
    std::int32_t manual = 0;
    std::int32_t now = normal;
  };
  std::optional<Bytes> answer_streaming(const ControlRequest& request);
  std::optional<Bytes> answer_controls(const ControlRequest& request);
  bool set(Control& control, std::int32_t value);
  Control* named(const std::string& name);

  Bytes configuration_;
  std::vector<Control> controls_;
  uvc_streaming_control probed_{}, committed_{};
  std::uint8_t error_ = 0;  // reason of the last refused control
  std::uint8_t frame_ = 0;  // the packets contain its lowest bit
};

}  // namespace touchline::board
