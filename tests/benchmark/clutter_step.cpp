#include "tests/benchmark/clutter_step.h"

#include <algorithm>
#include <random>

#include "tests/benchmark/hill_climb.h"
#include "tests/benchmark/step_benchmark.h"

namespace touchline::testing {
namespace {

using latency::ClutterNumber;
using latency::ClutterRecipe;

constexpr double kFrameInterval_s = 1.0 / 60.0;
// After this number of frames, the tracks of everything that the picture seems to show are complete.
constexpr int kStepsBefore = 6;

ClutterRecipe random_clutter(std::mt19937& random) {
  ClutterRecipe recipe;
  for (const ClutterNumber& number : latency::clutter_numbers()) {
    // Half of the numbers keep their default, because most heaps are slowest without anything else.
    if (pick(random, 0, 1) == 0) recipe.*number.value = pick(random, number.low, number.high);
  }
  return recipe;
}

ClutterRecipe changed_clutter(ClutterRecipe recipe, std::mt19937& random) {
  const auto numbers = latency::clutter_numbers();
  for (int i = pick(random, 1, 3); i > 0; --i) {
    const ClutterNumber& number =
        numbers[static_cast<std::size_t>(pick(random, 0, static_cast<int>(numbers.size()) - 1))];
    int& value = recipe.*number.value;
    const int range = number.high - number.low, reach = std::max(1, std::min(range / 4, value / 4 + range / 50));
    value = pick(random, 0, 9) == 0 ? pick(random, number.low, number.high)
                                    : std::clamp(value + pick(random, -reach, reach), number.low, number.high);
  }
  return recipe;
}

struct FoundStep {
  ClutterRecipe recipe;
  double time_us = 0.0, times_a_field = 0.0;
};

// Measures the second of two calls, as measure() does.
template <class Step>
double time_of(Step step) {
  step();
  const double begin = cpu_time_us();
  step();
  return cpu_time_us() - begin;
}

}  // namespace

Result<void> ClutterStep::configure(const config::FilePaths& files, ClutterTeams teams) {
  TOUCHLINE_TRY(config::load(files, *configuration_));
  PipelineParameters& parameters = configuration_->pipeline;
  if (teams == ClutterTeams::kLargest) parameters.marker.teams = largest_teams(parameters.marker.teams);
  Status status = pipeline_->configure(parameters);
  if (status.ok()) status = camera_.configure(parameters.camera);
  return status.ok() ? Result<void>() : Error{status.code(), "the pipeline refuses its configuration"};
}

void ClutterStep::show(const ClutterRecipe& recipe) {
  const ScanParameters& scan = parameters().scan;
  const auto background = scan.background.value_or(latency::PixelValue{});
  const std::vector<latency::PixelValue> values = latency::paint_clutter(recipe, parameters(), camera_, background);
  picture_ = OwnedPicture(scan.format, scan.width_px, scan.height_px, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    picture_.set(static_cast<int>(i % scan.width_px), static_cast<int>(i / scan.width_px), values[i]);
  }
  inputs_.events.reset = true;
  for (int i = 0; i < kStepsBefore; ++i) step();
}

Frame ClutterStep::next_frame() {
  Frame frame = picture_.frame();
  frame.sequence = ++frames_;
  frame.capture_time = Instant(from_seconds(kFrameInterval_s * frames_));
  return frame;
}

const StepTrace& ClutterStep::step() {
  const StepTrace& trace = pipeline_->step(next_frame(), inputs_);
  inputs_.events = {};
  return trace;
}

Result<void> add_clutter_cases(BenchmarkCases& cases, const std::string& filter) {
  for (const latency::NamedClutter& clutter : latency::worst_clutter()) {
    for (const ClutterTeams teams : {ClutterTeams::kMock, ClutterTeams::kLargest}) {
      const std::string name =
          std::string("step, ") + clutter.name + (teams == ClutterTeams::kMock ? "" : kLargestTeams);
      if (name.find(filter) == std::string::npos) continue;
      const auto recipe = latency::clutter_recipe_of(clutter.recipe);
      if (!recipe) return failure(ErrorCode::kInconsistent, "%s: not a recipe", clutter.name);
      const auto steps = std::make_shared<ClutterStep>();
      TOUCHLINE_TRY(steps->configure(mock_files(), teams));
      steps->show(*recipe);
      const StepTrace& trace = steps->step();
      auto benchmark = std::make_unique<BenchmarkCase>(
          BenchmarkCase{.name = name, .picture = OwnedPicture(PixelFormat::kRgb24, 1, 1, 0), .parameters = {}});
      benchmark->found = std::to_string(trace.regions.size()) + " regions, " +
                         std::to_string(trace.sightings.robots.size()) + " robots" +
                         (trace.overload ? ", overload" : "");
      benchmark->methods.push_back({"step", [steps] { static_cast<void>(steps->step()); }, {}});
      cases.push_back(std::move(benchmark));
    }
  }
  return {};
}

Result<void> search_slowest_step(double seconds, unsigned seed, ClutterTeams teams) {
  static StepBenchmark field;
  TOUCHLINE_TRY(field.prepare(mock_files()));
  ClutterStep clutter;
  TOUCHLINE_TRY(clutter.configure(mock_files(), teams));
  std::mt19937 random(seed);
  std::size_t pictures = 0;
  const auto evaluate = [&](const ClutterRecipe& recipe, int calls) {
    clutter.show(recipe);
    // Both are measured alternately, so that they run at the same clock, and the median of the ratios is taken.
    std::vector<float> times, in_fields;
    for (int i = 0; i < calls; ++i) {
      const double of_field = time_of([] { field.step(); }), time = time_of([&] { clutter.step(); });
      times.push_back(static_cast<float>(time));
      in_fields.push_back(static_cast<float>(time / of_field));
    }
    return FoundStep{recipe, quantiles_of(times).median_us, quantiles_of(in_fields).median_us};
  };
  const auto best = climb<FoundStep>(
      seconds, [&] { return random_clutter(random); },
      [&](const ClutterRecipe& recipe) { return changed_clutter(recipe, random); }, evaluate, pictures);
  std::printf("slowest step of %zu pictures: %.2f times a field's, %.1f microseconds of CPU%s\n%s\n", pictures,
              best.times_a_field, best.time_us, teams == ClutterTeams::kMock ? "" : kLargestTeams,
              latency::text_of(best.recipe).c_str());
  return {};
}

}  // namespace touchline::testing
