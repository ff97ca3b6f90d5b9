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

/// A webcam (USB Video Class 1.0) with YUYV and MJPG of 640 x 480 pixels and typical controls: a menu of exposure modes
/// with gaps, and values that are refused while their automatic mode is on. Prints what the host sets.
class UsbCamera final : public UsbDevice {
 public:
  UsbCamera();
  [[nodiscard]] UsbIdentity identity() const override;
  std::optional<Bytes> answer(const ControlRequest& request) override;

  /// Splits a picture (YUYV; RGB24 if the host has chosen MJPG) into packets of the chosen format. Empty if the picture
  /// has another format or size. Every other JPEG has no Huffman tables, as with many cameras.
  std::vector<Bytes> packets_of(const FrameHeader& header, std::span<const std::uint8_t> picture);

 private:
  struct Control {
    const char* name;
    std::uint8_t entity, selector;
    std::size_t bytes;
    std::int32_t low, high, step, default_value;
    const char* automatic = nullptr;  // this control can be set only while the one named here has the value `manual`
    std::int32_t manual = 0;
    std::int32_t now = default_value;
  };
  std::optional<Bytes> answer_streaming(const ControlRequest& request);
  std::optional<Bytes> answer_controls(const ControlRequest& request);
  bool set(Control& control, std::int32_t value);
  Control* find_control(const std::string& name);

  Bytes configuration_;
  std::vector<Control> controls_;
  uvc_streaming_control probed_{}, committed_{};
  std::uint8_t error_ = 0;  // error code of the last rejected request
  std::uint8_t frame_ = 0;  // number of the frame; the packets contain its lowest bit
};

}  // namespace touchline::board
