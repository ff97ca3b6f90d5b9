#include <algorithm>
#include <cstdio>
#include <random>

#include "tests/benchmark/hill_climb.h"
#include "tests/benchmark/measurement.h"
#include "tests/region/patterns.h"
#include "tests/region/tile_recipe.h"

namespace touchline::testing {
namespace {

constexpr int kLargestTile = 24;

std::string random_cells(std::mt19937& random, int count) {
  std::string cells;
  const int colors = pick(random, 0, kPaletteColors);
  for (int i = 0; i < count; ++i) cells += static_cast<char>('0' + pick(random, 0, colors));
  return cells;
}

TileRecipe random_recipe(std::mt19937& random) {
  TileRecipe recipe;
  recipe.width = pick(random, 1, kLargestTile), recipe.height = pick(random, 1, kLargestTile);
  recipe.scale_u = 1 << pick(random, 0, 3), recipe.scale_v = 1 << pick(random, 0, 3);
  recipe.shift = pick(random, 0, recipe.width);
  recipe.noise_per_mille = pick(random, 0, 1) * pick(random, 0, 1000);
  recipe.runs = pick(random, 1, 12);
  recipe.seed = static_cast<unsigned>(random());
  recipe.cells = random_cells(random, recipe.width * recipe.height);
  return recipe;
}

TileRecipe changed(TileRecipe recipe, std::mt19937& random) {
  const auto near = [&](int value, int low, int high) { return std::clamp(value + pick(random, -2, 2), low, high); };
  switch (pick(random, 0, 8)) {
    case 0:
      recipe.width = near(recipe.width, 1, kLargestTile);
      recipe.cells.resize(static_cast<std::size_t>(recipe.width * recipe.height), '0');
      break;
    case 1:
      recipe.height = near(recipe.height, 1, kLargestTile);
      recipe.cells.resize(static_cast<std::size_t>(recipe.width * recipe.height), '1');
      break;
    case 2:
      recipe.scale_u = near(recipe.scale_u, 1, 16);
      break;
    case 3:
      recipe.scale_v = near(recipe.scale_v, 1, 64);
      break;
    case 4:
      recipe.shift = near(recipe.shift, 0, kLargestTile);
      break;
    case 5:
      recipe.noise_per_mille = std::clamp(recipe.noise_per_mille + pick(random, -80, 80), 0, 1000);
      break;
    case 6:
      recipe.runs = near(recipe.runs, 1, 40);
      break;
    default:
      for (int i = pick(random, 1, 4); i > 0; --i) {
        const int cell = pick(random, 0, static_cast<int>(recipe.cells.size()) - 1);
        recipe.cells[static_cast<std::size_t>(cell)] = static_cast<char>('0' + pick(random, 0, kPaletteColors));
      }
  }
  return recipe;
}

struct Found {
  TileRecipe recipe;
  std::uint32_t min_area_px = 1;
  const char* kernel = "";
  double time_us = 0.0, times_a_field = 0.0;
};

class Stopwatch {
 public:
  Stopwatch() {
    for (const auto& [choice, name] :
         {std::pair(KernelChoice::kAvx2, "avx2"), std::pair(KernelChoice::kNeon, "neon")}) {
      Kernel kernel = {choice, name, std::make_unique<RegionScanner>()};
      if (configure(*kernel.of_field, field_, kernel)) kernels_.push_back(std::move(kernel));
    }
  }

  // Measures the picture with each kernel, relative to a realistic field measured at the same time, because the
  // processor's clock changes. Returns the slowest combination.
  Found evaluate(const TileRecipe& recipe, int calls) {
    Found slowest;
    BenchmarkCase benchmark = many_colors_case(make_tiles(recipe, 640, 480), 1);
    for (const Kernel& kernel : kernels_) {
      for (const std::uint32_t min_area : {1u, 2u}) {
        benchmark.parameters.min_area_px = min_area;
        if (!configure(*scanner_, benchmark, kernel)) continue;
        // Both pictures are measured alternately, so that they run at the same clock, and the median of the ratios is
        // taken.
        std::vector<float> times, in_fields;
        for (int i = 0; i < calls; ++i) {
          const double of_field = time_us(*kernel.of_field, field_), time = time_us(*scanner_, benchmark);
          times.push_back(static_cast<float>(time));
          in_fields.push_back(static_cast<float>(time / of_field));
        }
        const double fields = quantiles_of(in_fields).median_us;
        if (fields > slowest.times_a_field) {
          slowest = {recipe, min_area, kernel.name, quantiles_of(times).median_us, fields};
        }
      }
    }
    return slowest;
  }

 private:
  struct Kernel {
    KernelChoice choice;
    const char* name;
    std::unique_ptr<RegionScanner> of_field;
  };

  static bool configure(RegionScanner& scanner, const BenchmarkCase& benchmark, const Kernel& kernel) {
    ScanParameters parameters = benchmark.parameters;
    parameters.kernel = kernel.choice;
    return scanner.configure(parameters).ok();
  }

  // Measures the second of two calls, as measure() does.
  double time_us(RegionScanner& scanner, const BenchmarkCase& benchmark) {
    static_cast<void>(scanner.scan(benchmark.picture.frame(), *runs_, *regions_));
    const double begin = cpu_time_us();
    static_cast<void>(scanner.scan(benchmark.picture.frame(), *runs_, *regions_));
    return cpu_time_us() - begin;
  }

  // The first case with this name is the unmodified field.
  const BenchmarkCase field_ = std::move(*make_cases("field 640x480 rgb24").front());
  std::vector<Kernel> kernels_;
  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Runs> runs_ = std::make_unique<Runs>();
  std::unique_ptr<Regions> regions_ = std::make_unique<Regions>();
};

}  // namespace

void search_slowest_picture(double seconds, unsigned seed) {
  std::mt19937 random(seed);
  Stopwatch stopwatch;
  std::size_t pictures = 0;
  const Found best = climb<Found>(
      seconds, [&] { return random_recipe(random); }, [&](const TileRecipe& recipe) { return changed(recipe, random); },
      [&](const TileRecipe& recipe, int calls) { return stopwatch.evaluate(recipe, calls); }, pictures);
  std::printf("slowest of %zu pictures: %.2f times a field, %.1f microseconds of CPU, %s, minimum area %u\n%s\n",
              pictures, best.times_a_field, best.time_us, best.kernel, best.min_area_px, text_of(best.recipe).c_str());
}

}  // namespace touchline::testing
