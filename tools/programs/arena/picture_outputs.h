#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/console/jpeg_encoder.h"
#include "hal/mock/arena.h"
#include "tools/programs/arena/loopback_output.h"
#include "tools/programs/arena/picture_sender.h"

namespace touchline::arena {

/// Renders pictures and writes them to a receiver and to a device.
class PictureOutputs {
 public:
  explicit PictureOutputs(const hal::CameraSettings& camera);

  [[nodiscard]] PictureSender& sender() { return sender_; }
  [[nodiscard]] LoopbackOutput& loopback() { return loopback_; }
  /// Sets the machine's time minus the arena's, in real time.
  void set_clock_offset(Duration offset) { clock_offset_ = offset; }
  /// Renders a picture and writes it. Errors of the device.
  Result<void> write(hal::mock::Arena& arena, const hal::mock::Exposure& exposure);
  /// Returns the longest time that a picture took from its exposure's readiness until it was ready to be sent; of
  /// arenas in real time.
  [[nodiscard]] Duration largest_delay() const { return largest_delay_; }

 private:
  Result<std::span<const std::byte>> compressed();

  const hal::CameraSettings camera_;
  const PictureLayout layout_;
  PictureSender sender_;
  LoopbackOutput loopback_;
  std::vector<std::uint8_t> picture_;
  std::vector<std::byte> jpeg_;
  console::JpegEncoder encoder_;
  Duration clock_offset_{}, largest_delay_{};
};

}  // namespace touchline::arena
