#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/linux/v4l2/mjpg_decoder.h"
#include "tests/benchmark/clutter_teams.h"
#include "tests/benchmark/stored_frames.h"

// Runs the whole step, from the bytes of a frame to the packet, for a profiler:
//   profile_step FRAMES FORMAT VENUE KERNEL TEAMS COUNTED
// FRAMES: a file of touchline-bench --store; VENUE: a file, or "" for the mock board's; TEAMS: mock or largest. The
// last COUNTED frames are steps in counted_call(), the frames before in another function. Prints the results of the
// last step.
namespace touchline::testing {
namespace {

class Steps {
 public:
  Result<void> prepare(char** words) {
    const std::string format = words[2];
    TOUCHLINE_TRY_ASSIGN(frames_, read_frames(words[1]));
    const config::FilePaths files{TOUCHLINE_BOARDS "/mock/board.toml",
                                  words[3],
                                  "",
                                  {"camera.format=" + format, std::string("scan.kernel=") + words[4]}};
    TOUCHLINE_TRY(config::load(files, *configuration_));
    PipelineParameters& parameters = configuration_->pipeline;
    if (words[5] == std::string("largest")) parameters.marker.teams = largest_teams(parameters.marker.teams);
    if (const Status s = pipeline_->configure(parameters); !s.ok())
      return Error{s.code(), "the pipeline refuses its configuration"};
    inputs_.action_delay = from_seconds(configuration_->board.radio.delay_s);
    const ScanParameters& scan = parameters.scan;
    is_jpeg_ = format == "mjpg";
    decoder_.open(scan.width_px, scan.height_px);
    layout_ = is_jpeg_ ? decoder_.layout() : picture_layout(scan.format, scan.width_px, scan.height_px);
    decoded_.resize(layout_.bytes);
    return {};
  }
  [[nodiscard]] std::size_t frames() const { return frames_.size(); }

  const StepTrace& step(std::size_t number) {
    const StoredFrame& stored = frames_[number];
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(stored.bytes.data());
    if (is_jpeg_) {
      // Cannot fail, because an encoder has made it.
      if (!decoder_.decode({bytes, stored.bytes.size()}, decoded_.data()).ok()) std::abort();
      bytes = decoded_.data();
    } else if (stored.bytes.size() != layout_.bytes) {
      std::abort();  // the file has another format
    }
    const ScanParameters& scan = configuration_->pipeline.scan;
    Frame frame;
    frame.format = scan.format;
    frame.width_px = scan.width_px;
    frame.height_px = scan.height_px;
    frame.stride_bytes = layout_.stride_bytes;
    for (std::size_t i = 0; i < info_of(scan.format).planes; ++i) frame.plane[i] = bytes + layout_.offset_bytes[i];
    frame.capture_time = stored.capture_time;
    frame.sequence = static_cast<std::uint32_t>(number);
    return pipeline_->step(frame, inputs_);
  }

 private:
  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  StepInputs inputs_;
  std::vector<StoredFrame> frames_;
  hal::MjpgDecoder decoder_;
  PictureLayout layout_;
  std::vector<std::uint8_t> decoded_;
  bool is_jpeg_ = false;
};

// These names appear in the emulator's log and in callgrind.
extern "C" [[gnu::noinline]] void trace_begins() { asm volatile(""); }
extern "C" [[gnu::noinline]] void trace_ends() { asm volatile(""); }
[[gnu::noinline]] const StepTrace& counted_call(Steps& steps, std::size_t number) {
  trace_begins();
  const StepTrace& trace = steps.step(number);
  trace_ends();
  return trace;
}

int run(int argc, char** argv) {
  if (argc != 7) return 64;
  Steps steps;
  if (const Result<void> prepared = steps.prepare(argv); !prepared.ok()) {
    std::fprintf(stderr, "profile_step: %s\n", prepared.text().c_str());
    return 1;
  }
  const std::size_t counted = std::strtoul(argv[6], nullptr, 10);
  const StepTrace* trace = nullptr;
  for (std::size_t i = 0; i < steps.frames(); ++i) {
    trace = i + counted < steps.frames() ? &steps.step(i) : &counted_call(steps, i);
  }
  if (trace == nullptr) return 70;
  std::printf("%zu regions, %zu robots, %s\n", trace->regions.size(), trace->sightings.robots.size(),
              describe(trace->status.code()));
  return 0;
}

}  // namespace
}  // namespace touchline::testing

int main(int argc, char** argv) { return touchline::testing::run(argc, argv); }
