#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/console/jpeg_encoder.h"
#include "firmware/console/recordings.h"
#include "hal/recording/mcap_index.h"
#include "hal/result.h"

namespace touchline::recording {

/// What a list of recordings tells about one of them.
struct RecordingFacts {
  std::string file;  // for messages
  std::uint64_t bytes = 0;
  std::uint64_t begin_ns = 0, end_ns = 0;  // Unix time of the first and last frame; 0: there is none
  std::uint64_t frames = 0, goals = 0, stops = 0, lost = 0;
  std::string score = "null";  // JSON, of the newest event that tells it
  bool is_complete = false;
  std::string problem;  // why it cannot be shown; "": it can
};

/// Shows a recording: its frames by their number, and its events. Reads what it needs, one chunk at a time. For one
/// thread, which may wait for the disk.
class RecordingView {
 public:
  /// Finds the frames. Errors of McapIndex::open(); kFull: there are more than a page can show.
  Result<void> open(const std::string& path);
  [[nodiscard]] RecordingFacts facts() const;
  /// Returns JSON (docs/console-protocol.md, `/recordings/NAME`).
  [[nodiscard]] std::string description(const std::string& name) const;
  /// Returns frames with their pictures (ibid., `/recordings/NAME/frames`). kOutOfRange: there is no frame
  /// `range.from`; kCorruptFrame: it is damaged.
  Result<std::string> frames(const console::FrameRange& range);
  [[nodiscard]] std::uint64_t size() const { return index_.size(); }

 private:
  enum class PictureForm : std::uint8_t { kNone, kJpeg, kRaw };
  /// A state, and the picture that precedes it in the chunk.
  struct FramePlace {
    std::uint64_t time_ns = 0;
    std::uint32_t chunk = 0, state = 0, picture = 0;  // offsets in the chunk's records
    PictureForm form = PictureForm::kNone;
  };
  /// A scene or an event.
  struct Part {
    std::uint64_t time_ns = 0;
    std::uint32_t chunk = 0, offset = 0;
    std::string json;
  };

  Result<void> add_frames(std::uint32_t chunk);
  Result<void> add_parts(std::uint32_t chunk, std::uint16_t channel, std::vector<Part>& out);
  Result<void> load(std::uint32_t chunk);
  Result<std::string> picture_of(const FramePlace& frame);
  /// Returns the number of the frame that the part precedes in the file, or of the last one.
  [[nodiscard]] std::size_t frame_after(const Part& part) const;

  std::string path_;
  hal::mcap::McapIndex index_;
  std::uint16_t state_ = 0, jpeg_ = 0, raw_ = 0;  // channels
  std::vector<FramePlace> frames_;
  std::vector<Part> scenes_, events_;
  RecordingFacts facts_;
  std::size_t damaged_ = 0;  // chunks whose index cannot be read
  std::uint32_t loaded_ = ~std::uint32_t{0};
  std::string records_;  // of the chunk `loaded_`
  console::JpegEncoder encoder_;
  std::vector<std::byte> jpeg_bytes_;
};

}  // namespace touchline::recording
