#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/region/region_scanner.h"
#include "tests/benchmark/field_picture.h"
#include "tests/benchmark/paper_scan.h"
#include "tests/region/patterns.h"
#include "tests/region/region_comparison.h"

// How long a scan takes, against reading the frame once (no scan is faster) and against the paper's algorithm.
//   bench_regions                     checks all results, measures, prints the table; takes Google Benchmark's options
//   bench_regions --check             checks only
//   bench_regions --once FRAME/WHAT   one call of `counted_call`, for a profiler that counts instructions
namespace touchline::testing {
namespace {

// Together larger than any cache, so that a frame is in memory only, as a camera's driver leaves it.
constexpr std::size_t kColdBytes = std::size_t{192} << 20;

struct Subject {
  std::string name;
  OwnedPicture picture;
  ScanParameters parameters;
  std::vector<OwnedPicture> copies;  // to be scanned in turn, so that none is in a cache; may be empty
  std::unique_ptr<RegionScanner> scanner, portable;
  std::unique_ptr<PaperScan> paper;  // null where it has no answer
  std::size_t turn;

  Status configure() {
    if (Status s = scanner->configure(parameters); !s.ok()) return s;
    ScanParameters without_vectors = parameters;
    without_vectors.kernel = KernelChoice::kPortable;
    if (Status s = portable->configure(without_vectors); !s.ok()) return s;
    return paper ? paper->configure(parameters) : Status();
  }
  Frame next_frame() {
    if (copies.empty()) return picture.frame();
    turn = (turn + 1) % copies.size();
    return copies[turn].frame();
  }
};

Runs runs;
Regions regions;

// Every byte, 128 at a time in four independent sums.
using Words [[gnu::vector_size(32)]] = std::uint64_t;
[[gnu::always_inline]] inline std::uint64_t sum_of(const std::uint8_t* bytes, std::size_t count) {
  Words sum[4] = {};
  std::size_t i = 0;
  for (; i + sizeof sum <= count; i += sizeof sum) {
    for (std::size_t k = 0; k < 4; ++k) {
      Words words;
      std::memcpy(&words, bytes + i + k * sizeof words, sizeof words);
      sum[k] ^= words;
    }
  }
  for (; i < count; ++i) sum[0][0] ^= bytes[i];
  const Words all = sum[0] ^ sum[1] ^ sum[2] ^ sum[3];
  return all[0] ^ all[1] ^ all[2] ^ all[3];
}
std::uint64_t read_portable(const std::uint8_t* bytes, std::size_t count) { return sum_of(bytes, count); }
#if defined(__x86_64__)
[[gnu::target("avx2")]] std::uint64_t read_avx2(const std::uint8_t* bytes, std::size_t count) {
  return sum_of(bytes, count);
}
bool has_avx2() { return __builtin_cpu_supports("avx2") != 0; }
#else
std::uint64_t read_avx2(const std::uint8_t* bytes, std::size_t count) { return sum_of(bytes, count); }
bool has_avx2() { return false; }
#endif

std::size_t plane_bytes(const Frame& frame, std::size_t plane) {
  const std::size_t rows = plane == 0 ? frame.height_px : (frame.height_px + 1u) / 2u;
  const std::size_t row = row_bytes(frame.format, plane, frame.width_px);
  return row == 0 ? 0 : (rows - 1) * frame.stride_bytes[plane] + row;
}

std::uint64_t read_frame(const Frame& frame) {
  std::uint64_t sum = 0;
  for (std::size_t plane = 0; plane < 2; ++plane) {
    const auto read = has_avx2() ? read_avx2 : read_portable;
    sum ^= read(frame.plane[plane], plane_bytes(frame, plane));
  }
  return sum;
}

void do_read(Subject& subject) { benchmark::DoNotOptimize(read_frame(subject.next_frame())); }
void do_scan(Subject& subject) {
  benchmark::DoNotOptimize(subject.scanner->scan(subject.next_frame(), runs, regions));
  benchmark::ClobberMemory();
}
void do_portable(Subject& subject) {
  benchmark::DoNotOptimize(subject.portable->scan(subject.next_frame(), runs, regions));
  benchmark::ClobberMemory();
}
void do_paper(Subject& subject) {
  benchmark::DoNotOptimize(subject.paper->scan(subject.next_frame()).data());
  benchmark::ClobberMemory();
}

using Work = void (*)(Subject&);
struct Method {
  const char* name;
  Work work;
};
constexpr std::array kMethods = {Method{"read", do_read}, Method{"scan", do_scan}, Method{"portable", do_portable},
                                 Method{"paper", do_paper}};

Subject subject_of(OwnedPicture picture, const ScanParameters& parameters) {
  return {{},
          std::move(picture),
          parameters,
          {},
          std::make_unique<RegionScanner>(),
          std::make_unique<RegionScanner>(),
          std::make_unique<PaperScan>(),
          0};
}

Subject field(const FieldScene& scene) { return subject_of(paint_field(scene), field_parameters(scene)); }

Subject cold(Subject subject) {
  const Frame frame = subject.picture.frame();
  const std::size_t bytes = plane_bytes(frame, 0) + plane_bytes(frame, 1);
  subject.copies.assign(kColdBytes / bytes + 1, subject.picture);
  return subject;
}

Subject lit(Subject subject) {
  subject.paper = nullptr;
  LightMap& light = subject.parameters.light;
  light.columns = 64, light.rows = 48;
  for (auto& plane : light.illumination) {
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = 0.85f + 0.3f * static_cast<float>(i % 64) / 64.0f;
  }
  return subject;
}

Subject worst(Pattern pattern) {
  std::mt19937 random(7);
  OwnedPicture picture = paint(make_pattern(pattern, 640, 480, random), PixelFormat::kRgb24, 0, random);
  const ScanParameters parameters = parameters_for(picture.frame());
  return subject_of(std::move(picture), parameters);
}

// The frames whose names contain `part`.
std::vector<Subject> make_subjects(std::string_view part) {
  std::vector<Subject> subjects;
  const auto add = [&](const std::string& name, const auto& make) {
    if (name.find(part) == std::string::npos) return;
    subjects.push_back(make());
    subjects.back().name = name;
  };
  const FieldScene vga;
  FieldScene yuyv = vga, nv12 = vga, noisy = vga, large = vga;
  yuyv.format = PixelFormat::kYuyv;
  nv12.format = PixelFormat::kNv12;
  noisy.noise = 8.0;
  noisy.specks_per_megapixel = 6000.0;
  large.width_px = 1920, large.height_px = 1080;
  add("field 640x480 rgb24", [&] { return field(vga); });
  add("field 640x480 rgb24, cold", [&] { return cold(field(vga)); });
  add("field 640x480 rgb24, light map", [&] { return lit(field(vga)); });
  add("field 640x480 yuyv", [&] { return field(yuyv); });
  add("field 640x480 nv12", [&] { return field(nv12); });
  add("field 640x480 rgb24, noisy", [&] { return field(noisy); });
  add("field 1920x1080 rgb24", [&] { return field(large); });
  for (const Pattern pattern : kAllPatterns) {
    add(name_of(pattern), [&] { return worst(pattern); });
  }
  return subjects;
}

// Empty when the scanner gives the paper's regions.
std::string difference_of(RegionScanner& scanner, const Frame& frame, const ColorGrid& colors) {
  const Status status = scanner.scan(frame, runs, regions);
  if (status.code() == ErrorCode::kFull) return difference_from_served(colors, 1, runs, regions);
  if (!status.ok()) return describe(status.code());
  return difference(expected_regions(colors), runs, regions);
}

// Empty when all methods give the paper's regions, and fields show what a field shows.
std::string wrong_about(Subject& subject) {
  if (!subject.configure().ok()) return "the parameters are refused";
  const Frame frame = subject.picture.frame();
  const ColorGrid colors = defined_colors(frame, subject.parameters);
  for (RegionScanner* scanner : {subject.portable.get(), subject.scanner.get()}) {
    if (std::string text = difference_of(*scanner, frame, colors); !text.empty()) return text;
  }
  if (subject.name.starts_with("field")) {
    const auto patches = std::count_if(regions.begin(), regions.end(), [](const Region& r) { return r.area_px >= 30; });
    if (patches < 18 || patches > 30) return std::to_string(patches) + " regions of a patch's size on the field";
  }
  if (!subject.paper) return {};
  std::uint64_t area = 0, expected_area = 0;
  const std::vector<ExpectedRegion> expected = expected_regions(colors);
  const std::vector<PaperScan::Found>& found = subject.paper->scan(frame);
  for (const PaperScan::Found& region : found) area += region.area_px;
  for (const ExpectedRegion& region : expected) expected_area += region.pixels.size();
  return found.size() == expected.size() && area == expected_area ? "" : "the paper's scan is not the paper's";
}

// Medians by frame and method, for the table of ratios.
class Table : public benchmark::BenchmarkReporter {
 public:
  explicit Table(const std::vector<Subject>& subjects) : subjects_(subjects) {}

  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& results) override {
    for (const Run& run : results) {
      if (run.error_occurred) std::printf("%s: %s\n", run.benchmark_name().c_str(), run.error_message.c_str());
      const bool median = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
      if (median || run.repetitions == 1) microseconds_[run.run_name.function_name] = run.GetAdjustedCPUTime();
    }
  }
  void Finalize() override {
    std::printf("%-34s %6s %8s | %7s | %8s %6s | %8s %6s | %8s %6s\n", "frame (median microseconds of CPU)", "runs",
                "regions", "read", "scan", "x read", "portable", "x scan", "paper", "x scan");
    for (const Subject& subject : subjects_) print(subject);
    std::printf("* more than the fixed capacities hold: the scan reported what fits and counted the rest\n");
  }

 private:
  void print(const Subject& subject) {
    const auto time = [&](const char* method) {
      const auto found = microseconds_.find(subject.name + "/" + method);
      return found == microseconds_.end() ? 0.0 : found->second;
    };
    const double read = time("read"), scan = time("scan"), portable = time("portable"), paper = time("paper");
    if (scan <= 0.0) return;  // filtered out
    const Status status = subject.scanner->scan(subject.picture.frame(), runs, regions);
    std::printf("%-34s %6zu %7zu%s | %7.1f | %8.1f %6.1f | %8.1f %6.1f | %8.1f %6.1f\n", subject.name.c_str(),
                runs.size(), regions.size(), status.ok() ? " " : "*", read, scan, read > 0.0 ? scan / read : 0.0,
                portable, portable / scan, paper, paper / scan);
  }

  const std::vector<Subject>& subjects_;
  std::map<std::string, double> microseconds_;
};

[[gnu::noinline]] void counted_call(Work work, Subject& subject) { work(subject); }

bool has_method(const Subject& subject, const Method& method) { return method.work != do_paper || subject.paper; }

int call_once(const std::string& name) {
  const std::size_t slash = std::min(name.find('/'), name.size() - 1);
  std::vector<Subject> subjects = make_subjects(std::string_view(name).substr(0, slash));
  for (Subject& subject : subjects) {
    for (const Method& method : kMethods) {
      if (name != subject.name + "/" + method.name || !has_method(subject, method)) continue;
      if (!subject.configure().ok()) return 1;
      method.work(subject);  // grows the paper's lists to their size
      counted_call(method.work, subject);
      return 0;
    }
  }
  std::fprintf(stderr, "bench_regions: there is no %s\n", name.c_str());
  return 64;
}

void register_all(std::vector<Subject>& subjects) {
  for (Subject& subject : subjects) {
    for (const Method& method : kMethods) {
      if (!has_method(subject, method)) continue;
      benchmark::RegisterBenchmark((subject.name + "/" + method.name).c_str(), [&subject, work = method.work](
                                                                                   benchmark::State& state) {
        for (auto _ : state) work(subject);
      })->Unit(benchmark::kMicrosecond);
    }
  }
}

int run(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--once") == 0) return call_once(argv[2]);
  std::vector<Subject> subjects = make_subjects("");
  int wrong = 0;
  for (Subject& subject : subjects) {
    if (const std::string text = wrong_about(subject); !text.empty()) {
      std::fprintf(stderr, "bench_regions: %s: %s\n", subject.name.c_str(), text.c_str());
      ++wrong;
    }
  }
  if (wrong > 0) return 1;
  if (argc == 2 && std::strcmp(argv[1], "--check") == 0) {
    std::printf("%zu frames, the paper's regions on each\n", subjects.size());
    return 0;
  }

  // Interleaved, so that a disturbance hits all methods alike; the given options come later and win.
  std::string repetitions = "--benchmark_repetitions=15", interleaved = "--benchmark_enable_random_interleaving=true",
              least_time = "--benchmark_min_time=0.02";
  std::vector<char*> arguments = {argv[0], repetitions.data(), interleaved.data(), least_time.data()};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 64;
  register_all(subjects);
  Table table(subjects);
  benchmark::RunSpecifiedBenchmarks(&table);
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace touchline::testing

int main(int argc, char** argv) { return touchline::testing::run(argc, argv); }
