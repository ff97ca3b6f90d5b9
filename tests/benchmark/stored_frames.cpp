#include "tests/benchmark/stored_frames.h"

#include <cstring>

#include "hal/files/input_file.h"
#include "hal/files/output_file.h"

namespace touchline::testing {
namespace {

struct FrameHeader {
  std::int64_t capture_time;
  std::uint64_t bytes;
};

}  // namespace

Result<void> write_frames(const std::string& path, const std::vector<StoredFrame>& frames) {
  std::string file;
  for (const StoredFrame& frame : frames) {
    const FrameHeader header{frame.capture_time.time_since_epoch().count(), frame.bytes.size()};
    file.append(reinterpret_cast<const char*>(&header), sizeof header);
    file += frame.bytes;
  }
  return hal::write_file(path, file);
}

Result<std::vector<StoredFrame>> read_frames(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(const std::string file, hal::read_file(path, hal::kMaxDataFileBytes));
  std::vector<StoredFrame> frames;
  FrameHeader header{};
  for (std::size_t at = 0; at < file.size(); at += sizeof header + header.bytes) {
    if (file.size() - at >= sizeof header) std::memcpy(&header, file.data() + at, sizeof header);
    if (file.size() - at < sizeof header || file.size() - at - sizeof header < header.bytes)
      return failure(ErrorCode::kInconsistent, "%s ends within a frame", path.c_str());
    frames.push_back({Instant(Instant::duration(header.capture_time)), file.substr(at + sizeof header, header.bytes)});
  }
  return frames;
}

}  // namespace touchline::testing
