#include "tests/benchmark/real_pictures.h"

#include <cstdlib>
#include <memory>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/replay/replay_camera.h"
#include "tests/benchmark/ssl_vision_scan.h"

namespace touchline::testing {
namespace {

struct RealSet {
  config::Configuration configuration;
  std::vector<Frame> frames;
  std::vector<std::vector<std::uint8_t>> bytes;
  Runs runs;
  Regions regions;
};

// Cycles through the pictures of a set. Each method has a cycle of its own.
class Turn {
 public:
  explicit Turn(std::shared_ptr<RealSet> set) : set_(std::move(set)) {}
  const Frame& next() {
    turn_ = (turn_ + 1) % set_->frames.size();
    return set_->frames[turn_];
  }
  // The tracks are reset after all pictures of the set; a single picture is like a camera at rest.
  [[nodiscard]] bool begins_again() const { return turn_ == 0 && set_->frames.size() > 1; }
  RealSet& set() { return *set_; }

 private:
  std::shared_ptr<RealSet> set_;
  std::size_t turn_ = 0;
};

Result<void> read_pictures(const std::string& path, const std::string& prefix, std::size_t most, RealSet& set) {
  hal::ReplayCamera camera(hal::ReplayParameters{.path = path, .format = PixelFormat::kRgb24, .rate_hz = 30.0});
  TOUCHLINE_TRY(camera.open());
  TOUCHLINE_TRY(camera.start());
  while (set.frames.size() < most) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    if (!lease.ok()) break;  // the end
    if (!camera.file().starts_with(prefix)) continue;
    Frame frame = lease.value().frame();
    set.bytes.emplace_back(frame.plane[0], frame.plane[0] + plane_bytes(frame, 0));
    frame.plane[0] = set.bytes.back().data();
    set.frames.push_back(frame);
  }
  if (set.frames.size() % 2 == 0 && !set.frames.empty()) set.frames.pop_back();
  if (set.frames.empty()) return failure(ErrorCode::kNotFound, "%s: no picture %s*", path.c_str(), prefix.c_str());
  return {};
}

Result<void> add_scan(BenchmarkCase& benchmark, const std::shared_ptr<RealSet>& set, const ScanParameters& parameters,
                      const std::string& name) {
  const auto scanner = std::make_shared<RegionScanner>();
  const Status status = scanner->configure(parameters);
  if (status.code() == ErrorCode::kUnsupported) return {};
  if (!status.ok()) return Error{status.code(), "the scanner refuses the venue"};
  benchmark.methods.push_back({name,
                               [scanner, turn = Turn(set)]() mutable {
                                 RealSet& of = turn.set();
                                 static_cast<void>(scanner->scan(turn.next(), of.runs, of.regions));
                               },
                               {}});
  benchmark.methods.back().work();
  benchmark.found = std::to_string(set->frames.size()) + " pictures; in one of them " +
                    std::to_string(set->runs.size()) + " runs, " + std::to_string(set->regions.size()) + " regions";
  return {};
}

// For each kernel, measures the scan of a step, and a scan that reads every row.
Result<void> add_scans_of(BenchmarkCase& benchmark, const std::shared_ptr<RealSet>& set) {
  for (const Choice<KernelChoice>& choice : kKernelChoices) {
    if (choice.value == KernelChoice::kFastest) continue;
    ScanParameters parameters = set->configuration.pipeline.scan;
    parameters.kernel = choice.value;
    TOUCHLINE_TRY(add_scan(benchmark, set, parameters, std::string(choice.word)));
    parameters.min_height_px = 1;
    TOUCHLINE_TRY(add_scan(benchmark, set, parameters, std::string(choice.word) + kEveryRow));
  }
  return {};
}

Result<void> fill_real_case(BenchmarkCase& benchmark, const std::string& name, const std::string& shared,
                            std::size_t most) {
  const auto set = std::make_shared<RealSet>();
  const std::string venue = std::string(TOUCHLINE_FOOTAGE) + "/" + name;
  const bool is_bar = name.starts_with("vsss-bar");
  const std::string file = is_bar ? "vsss-bar" : name == "vss-overhead" ? name + ".mp4" : name;
  TOUCHLINE_TRY(read_pictures(shared + "/footage/" + file, is_bar ? "normal" : "", most, *set));
  TOUCHLINE_TRY(config::load_venue_and_team({{}, venue + "-venue.toml", venue + "-team.toml", {}}, set->configuration));
  const Frame& first = set->frames.front();
  TOUCHLINE_TRY(
      config::resolve({PixelFormat::kRgb24, first.width_px, first.height_px, "a picture"}, set->configuration));

  benchmark.methods.push_back({"read",
                               [turn = Turn(set), sum = std::uint64_t{0}]() mutable {
                                 sum ^= read_frame(turn.next());
                                 asm volatile("" : : "g"(&sum) : "memory");
                               },
                               {}});
  TOUCHLINE_TRY(add_scans_of(benchmark, set));
  const auto peer = std::make_shared<SslVisionScan>();
  if (const Status s = peer->configure(set->configuration.pipeline.scan); !s.ok()) {
    return Error{s.code(), "ssl-vision's method refuses the venue"};
  }
  benchmark.methods.push_back(
      {"ssl-vision", [peer, turn = Turn(set)]() mutable { static_cast<void>(peer->scan(turn.next())); }, {}});
  const auto pipeline = std::make_shared<Pipeline>();
  if (const Status s = pipeline->configure(set->configuration.pipeline); !s.ok()) {
    return Error{s.code(), "the pipeline refuses the venue"};
  }
  benchmark.methods.push_back({"step",
                               [pipeline, inputs = StepInputs(), turn = Turn(set)]() mutable {
                                 const Frame& frame = turn.next();
                                 inputs.events.reset = turn.begins_again();
                                 static_cast<void>(pipeline->step(frame, inputs));
                               },
                               {}});
  return {};
}

}  // namespace

Result<void> add_real_pictures(BenchmarkCases& cases, const std::string& filter, std::size_t most) {
  const char* const shared = std::getenv("TOUCHLINE_SHARED");
  for (const std::string name : kRealSets) {
    if (shared == nullptr || ("real " + name).find(filter) == std::string::npos) continue;
    cases.push_back(std::make_unique<BenchmarkCase>(BenchmarkCase{
        .name = "real " + name, .picture = OwnedPicture(PixelFormat::kRgb24, 1, 1, 0), .parameters = {}}));
    Result<void> filled = fill_real_case(*cases.back(), name, shared, most);
    if (!filled.ok()) return prefixed(name, std::move(filled).error());
  }
  return {};
}

}  // namespace touchline::testing
