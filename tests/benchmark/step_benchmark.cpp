#include "tests/benchmark/step_benchmark.h"

#include <cstring>

#include "firmware/devices.h"

namespace touchline::testing {
namespace {

// After this time, all robots are identified and moving.
constexpr std::size_t kFramesBefore = 90;

}  // namespace

StepBenchmark::Picture StepBenchmark::copy_of(const Frame& frame) {
  Picture copy;
  copy.frame = frame;
  std::array<std::size_t, kMaxPlanes> begin{};
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    begin[plane] = copy.bytes.size();
    copy.bytes.insert(copy.bytes.end(), frame.plane[plane], frame.plane[plane] + plane_bytes(frame, plane));
  }
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    if (frame.plane[plane] != nullptr) copy.frame.plane[plane] = copy.bytes.data() + begin[plane];
  }
  return copy;
}

Result<void> StepBenchmark::play(std::size_t frames) {
  Devices devices;
  TOUCHLINE_TRY(devices.make(*configuration_, 1));
  const HalDevices loop = devices.hal_devices();
  TOUCHLINE_TRY(loop.camera.open());
  TOUCHLINE_TRY(loop.camera.start());
  TOUCHLINE_TRY(loop.radio.open());
  inputs_.action_delay = from_seconds(configuration_->board.radio.delay_s);
  for (std::size_t i = 0; i < kFramesBefore + frames; ++i) {
    const Result<hal::FrameLease> lease = loop.camera.wait(loop.clock.now() + std::chrono::seconds(1));
    if (!lease.ok()) return lease.error();
    const Frame& frame = lease.value().frame();
    const StepTrace& trace = pipeline_->step(frame, inputs_);
    for (const OutgoingPacket& outgoing : trace.packets) TOUCHLINE_TRY(loop.radio.send(outgoing.packet));
    pipeline_->adapt();
    if (i < kFramesBefore) continue;
    if (!trace.status.ok()) return Error{trace.status.code(), describe(trace.status.code())};
    if (trace.sightings.robots.size() != configuration_->board.arena.robot.size()) {
      return Error{ErrorCode::kInconsistent, "a frame does not show all robots"};
    }
    pictures_.push_back(copy_of(frame));
  }
  loop.camera.stop();
  return {};
}

Result<void> StepBenchmark::prepare(const config::FilePaths& files, std::size_t frames) {
  TOUCHLINE_TRY(config::load(files, *configuration_));
  if (const Status s = pipeline_->configure(configuration_->pipeline); !s.ok()) {
    return Error{s.code(), "the pipeline refuses its configuration"};
  }
  ScanParameters scan = configuration_->pipeline.scan;
  scan.min_height_px = 1;  // this makes the scan read every row
  if (const Status s = scanner_->configure(scan); !s.ok()) {
    return Error{s.code(), "the scanner refuses its configuration"};
  }
  TOUCHLINE_TRY(play(frames));
  stepped_ = pictures_.size();
  if (pictures_.empty()) return Error{ErrorCode::kInconsistent, "no frames were rendered"};
  return {};
}

void StepBenchmark::scan_only() {
  scanned_ = (scanned_ + 1) % pictures_.size();
  static_cast<void>(scanner_->scan(pictures_[scanned_].frame, *runs_, *regions_));
}

const StepTrace& StepBenchmark::step() {
  inputs_.events.reset = stepped_ >= pictures_.size();
  if (inputs_.events.reset) stepped_ = 0;
  return pipeline_->step(pictures_[stepped_++].frame, inputs_);
}

}  // namespace touchline::testing
