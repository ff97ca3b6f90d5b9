#include "tools/programs/latency/worst_frame_recorder.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "hal/files/output_file.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::latency {
namespace {

std::size_t bytes_of(const Frame& frame) {
  std::size_t bytes = 0;
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) bytes += plane_bytes(frame, plane);
  return bytes;
}

}  // namespace

WorstFrameRecorder::WorstFrameRecorder(std::string folder, std::size_t count)
    : folder_(std::move(folder)), slots_(folder_.empty() ? 0 : count) {}

Result<void> WorstFrameRecorder::check() const {
  namespace fs = std::filesystem;
  if (!is_on()) return {};
  std::error_code error;
  const bool exists = fs::exists(folder_, error);
  const bool empty = exists && fs::is_directory(folder_, error) && fs::is_empty(folder_, error);
  if (exists && !empty) {
    return failure(ErrorCode::kInconsistent,
                   "%s: must be a new or empty folder, so that a replay shows only new pictures", folder_.c_str());
  }
  const fs::path parent = exists ? fs::path(folder_) : fs::absolute(folder_).lexically_normal().parent_path();
  if (::access(parent.c_str(), W_OK | X_OK) != 0) {
    return failure(ErrorCode::kPermission, "%s: the folder cannot be created in %s", folder_.c_str(), parent.c_str());
  }
  return {};
}

void WorstFrameRecorder::prepare(const Frame& frame) {
  for (Slot& slot : slots_) slot.pixels.resize(bytes_of(frame));
}

void WorstFrameRecorder::add(const StepTrace& trace, std::uint64_t number, Duration latency) {
  if (!is_on()) return;
  Slot& fastest = *std::min_element(slots_.begin(), slots_.end(), [](const Slot& a, const Slot& b) {
    return a.number == 0 || b.number == 0 ? a.number < b.number : a.latency < b.latency;
  });
  if (fastest.number != 0 && latency <= fastest.latency) return;
  if (bytes_of(trace.frame) > fastest.pixels.size()) return;
  fastest.number = number;
  fastest.latency = latency;
  copy_pixels(trace.frame, fastest);
  copy_trace(trace, fastest.results);
}

void WorstFrameRecorder::copy_pixels(const Frame& frame, Slot& slot) {
  slot.frame = frame;
  std::uint8_t* to = slot.pixels.data();
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    if (frame.plane[plane] == nullptr) continue;
    slot.frame.plane[plane] = to;
    to = std::copy_n(frame.plane[plane], plane_bytes(frame, plane), to);
  }
}

Result<void> WorstFrameRecorder::write(const report::TraceNames& names) const {
  std::vector<const Slot*> in_order;
  for (const Slot& slot : slots_) {
    if (slot.number != 0) in_order.push_back(&slot);
  }
  if (in_order.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return failure(ErrorCode::kIo, "%s: %s", folder_.c_str(), error.message().c_str());
  std::sort(in_order.begin(), in_order.end(), [](const Slot* a, const Slot* b) { return a->number < b->number; });
  const std::filesystem::path folder(folder_);
  std::string lines;
  for (const Slot* slot : in_order) {
    char name[40];
    std::snprintf(name, sizeof name, "frame-%06llu.png", static_cast<unsigned long long>(slot->number));
    TOUCHLINE_TRY(hal::write_picture((folder / name).string(), calibrate::picture_of(slot->frame)));
    const Snapshot& results = slot->results;
    lines += report::trace_line({results.captured, results.ball, results.robots, results.tracks, results.overload},
                                names, slot->number, name) +
             "\n";
  }
  return hal::write_file((folder / "trace.jsonl").string(), lines);
}

}  // namespace touchline::latency
