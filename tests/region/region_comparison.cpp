#include "tests/region/region_comparison.h"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <utility>

#include "core/region/run_limiter.h"

namespace touchline::testing {
namespace {

bool in_raster_order(const Pixel& a, const Pixel& b) { return a.v != b.v ? a.v < b.v : a.u < b.u; }

ExpectedRegion describe_list(const PixelList& list) {
  ExpectedRegion region;
  region.color = list.color;
  region.pixels = list.pixels;
  std::sort(region.pixels.begin(), region.pixels.end(), in_raster_order);
  region.left = region.right = region.pixels.front().u;
  region.top = region.pixels.front().v;
  region.bottom = region.pixels.back().v;
  std::int64_t sum_u = 0, sum_v = 0;
  for (const Pixel& pixel : region.pixels) {
    sum_u += pixel.u;
    sum_v += pixel.v;
    region.left = std::min(region.left, pixel.u);
    region.right = std::max(region.right, pixel.u);
  }
  const auto area = static_cast<double>(region.pixels.size());
  region.centroid_u = static_cast<double>(sum_u) / area;
  region.centroid_v = static_cast<double>(sum_v) / area;
  return region;
}

template <class... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

std::string chain_difference(const ExpectedRegion& expected, const Runs& runs, const Region& region,
                             std::vector<bool>& chained) {
  std::size_t pixel = 0;
  std::uint32_t last = kNoRun;
  for (std::uint32_t i = region.first_run; i != kNoRun; i = runs[i].next) {
    if (i >= runs.size()) return sentence("the chain leaves the runs: ", i);
    if (last != kNoRun && i <= last) return sentence("the chain goes back from run ", last, " to ", i);
    if (chained[i]) return sentence("run ", i, " is in two chains");
    chained[i] = true;
    last = i;
    const Run& run = runs[i];
    if (run.color != expected.color) return sentence("run ", i, " has color ", int{run.color});
    for (int u = run.begin; u < run.end; ++u, ++pixel) {
      if (pixel >= expected.pixels.size()) return sentence("superfluous pixel (", u, ", ", run.row, ")");
      if (expected.pixels[pixel] != Pixel{u, run.row}) {
        return sentence("pixel ", pixel, " is (", u, ", ", run.row, ") instead of (", expected.pixels[pixel].u, ", ",
                        expected.pixels[pixel].v, ")");
      }
    }
  }
  if (pixel != expected.pixels.size()) return sentence(pixel, " pixels instead of ", expected.pixels.size());
  return {};
}

std::string region_difference(const ExpectedRegion& expected, const Region& region) {
  if (region.color != expected.color) return sentence("color ", int{region.color}, " instead of ", int{expected.color});
  if (region.area_px != expected.pixels.size()) {
    return sentence("area ", region.area_px, " instead of ", expected.pixels.size());
  }
  // Must be the float nearest to the exact value.
  if (region.centroid.u_px != static_cast<float>(expected.centroid_u) ||
      region.centroid.v_px != static_cast<float>(expected.centroid_v)) {
    return sentence("centroid (", region.centroid.u_px, ", ", region.centroid.v_px, ") instead of (",
                    expected.centroid_u, ", ", expected.centroid_v, ")");
  }
  const PixelBox& box = region.box;
  if (box.left != expected.left || box.top != expected.top || box.right != expected.right ||
      box.bottom != expected.bottom) {
    return sentence("box ", box.left, " ", box.top, " ", box.right, " ", box.bottom, " instead of ", expected.left, " ",
                    expected.top, " ", expected.right, " ", expected.bottom);
  }
  return {};
}

std::string run_difference(const Runs& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].begin >= runs[i].end || runs[i].color == kBackground) return sentence("run ", i, " is empty");
    if (i == 0 || runs[i - 1].row < runs[i].row) continue;
    if (runs[i - 1].row > runs[i].row || runs[i - 1].end > runs[i].begin) return sentence("run ", i, " goes back");
    if (runs[i - 1].end == runs[i].begin && runs[i - 1].color == runs[i].color) {
      return sentence("run ", i, " continues the one before");
    }
  }
  return {};
}

struct RowRun {
  int begin, end;
};
std::vector<RowRun> runs_of_row(const ColorGrid& grid, int v) {
  std::vector<RowRun> runs;
  for (int u = 0; u < grid.width; ++u) {
    const ColorId color = grid.at(u, v);
    if (color == kBackground) continue;
    if (!runs.empty() && runs.back().end == u && grid.at(u - 1, v) == color) {
      ++runs.back().end;
    } else {
      runs.push_back({u, u + 1});
    }
  }
  return runs;
}

bool is_speck(const ColorGrid& grid, const RowRun& run, int v) {
  const auto like = [&](int row) {
    return row >= 0 && row < grid.height && grid.at(run.begin, row) == grid.at(run.begin, v);
  };
  return run.end - run.begin == 1 && !like(v - 1) && !like(v + 1);
}

// Every second row is read only where the rows above or below have a color within the same 64 columns, and in the next
// 64 columns if a color reaches their border.
void clear_unread_pixels(ColorGrid& grid) {
  constexpr int kWord = 64;
  const auto is_colored = [&](int u, int v) { return u >= 0 && u < grid.width && grid.at(u, v) != kBackground; };
  for (int v = 1; v + 1 < grid.height; v += 2) {
    std::vector<bool> is_read(static_cast<std::size_t>(grid.width));
    const auto read_word_of = [&](int u) {
      const int begin = u / kWord * kWord;
      std::fill_n(is_read.begin() + begin, std::min(kWord, grid.width - begin), true);
    };
    for (int u = 0; u < grid.width; ++u) {
      if (is_colored(u, v - 1) || is_colored(u, v + 1)) read_word_of(u);
    }
    const auto was_read = [&](int u) { return u >= 0 && u < grid.width && is_read[static_cast<std::size_t>(u)]; };
    for (int u = 0; u < grid.width; u += kWord) {
      if (was_read(u - 1) && is_colored(u - 1, v)) read_word_of(u);
    }
    for (int u = (grid.width - 1) / kWord * kWord - 1; u >= 0; u -= kWord) {
      if (was_read(u + 1) && is_colored(u + 1, v)) read_word_of(u);
    }
    for (int u = 0; u < grid.width; ++u) {
      if (!was_read(u)) grid.at(u, v) = kBackground;
    }
  }
}

// Returns the largest regions, of equal ones the first, in their order.
std::vector<ExpectedRegion> largest(std::vector<ExpectedRegion> regions, std::size_t count) {
  std::vector<std::size_t> order(regions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return regions[a].pixels.size() > regions[b].pixels.size(); });
  order.resize(std::min(count, order.size()));
  std::sort(order.begin(), order.end());
  std::vector<ExpectedRegion> chosen;
  for (const std::size_t i : order) chosen.push_back(std::move(regions[i]));
  return chosen;
}

}  // namespace

std::vector<ExpectedRegion> expected_regions(const ColorGrid& grid, std::uint32_t min_area_px,
                                             std::uint32_t min_height_px) {
  LiteralLabeling literal;
  std::vector<ExpectedRegion> regions;
  for (const PixelList& list : literal.label(grid)) {
    if (!list.pixels.empty() && list.pixels.size() >= min_area_px) regions.push_back(describe_list(list));
  }
  std::erase_if(regions, [&](const ExpectedRegion& region) {
    return static_cast<std::uint32_t>(region.bottom - region.top + 1) < min_height_px;
  });
  std::sort(regions.begin(), regions.end(), [](const ExpectedRegion& a, const ExpectedRegion& b) {
    return in_raster_order(a.pixels.front(), b.pixels.front());
  });
  return regions;
}

std::string difference(const std::vector<ExpectedRegion>& expected, const Runs& runs, const Regions& regions) {
  if (std::string text = run_difference(runs); !text.empty()) return text;
  std::vector<bool> chained(runs.size());
  for (std::size_t i = 0; i < std::min(expected.size(), regions.size()); ++i) {
    std::string text = region_difference(expected[i], regions[i]);
    if (text.empty()) text = chain_difference(expected[i], runs, regions[i], chained);
    if (!text.empty()) return sentence("region ", i, ": ", text);
  }
  if (regions.size() != expected.size()) return sentence(regions.size(), " regions instead of ", expected.size());
  const auto loose = std::find(chained.begin(), chained.end(), false);
  if (loose != chained.end()) return sentence("run ", loose - chained.begin(), " is in no chain");
  return {};
}

LimitedPicture without_dropped_runs(const ColorGrid& whole, std::uint32_t min_area_px, std::uint32_t min_height_px) {
  LimitedPicture picture = {whole, 0};
  if (min_height_px > 1) clear_unread_pixels(picture.grid);
  const ColorGrid grid = picture.grid;
  std::size_t credit = RunLimiter::reserve(static_cast<std::size_t>(grid.height));
  const std::size_t held_back = credit / 6;
  for (int v = 0; v < grid.height; ++v) {
    std::vector<RowRun> runs = runs_of_row(grid, v);
    if (min_area_px > 1) std::erase_if(runs, [&](const RowRun& run) { return is_speck(grid, run, v); });
    credit += kRunsPerRow;
    std::size_t limit = credit / 2;
    if (runs.size() > 32) limit = std::min<std::size_t>(limit, 8);
    if (runs.size() > 32 && runs.size() <= 128 && credit > held_back) limit = std::max(limit, credit - held_back);
    const std::vector<RowRun> kept = longest_runs(runs, limit);
    credit -= kept.size();
    if (kept.size() == runs.size()) continue;
    picture.runs_dropped += runs.size() - kept.size();
    for (int u = 0; u < grid.width; ++u) {
      const auto holds = [u](const RowRun& run) { return run.begin <= u && u < run.end; };
      if (std::none_of(kept.begin(), kept.end(), holds)) picture.grid.at(u, v) = kBackground;
    }
  }
  return picture;
}

ExpectedScan expected_scan(const ColorGrid& grid, std::uint32_t min_area_px, std::uint32_t min_height_px) {
  const LimitedPicture picture = without_dropped_runs(grid, min_area_px, min_height_px);
  std::vector<ExpectedRegion> all = expected_regions(picture.grid, min_area_px, min_height_px);
  const std::size_t count = all.size();
  std::vector<ExpectedRegion> reported = largest(std::move(all), kMaxRegions);
  const std::size_t missing = count - reported.size();
  return {std::move(reported), picture.runs_dropped, missing};
}

std::string difference(const ExpectedScan& expected, const Runs& runs, const Regions& regions) {
  if (runs.overflow() != expected.runs_dropped) {
    return sentence(runs.overflow(), " runs dropped instead of ", expected.runs_dropped);
  }
  if (regions.overflow() != expected.regions_dropped) {
    return sentence(regions.overflow(), " regions dropped instead of ", expected.regions_dropped);
  }
  return difference(expected.regions, runs, regions);
}

std::string difference_from_limited(const ColorGrid& grid, std::uint32_t min_area_px, const Runs& runs,
                                    const Regions& regions, std::uint32_t min_height_px) {
  return difference(expected_scan(grid, min_area_px, min_height_px), runs, regions);
}

std::size_t count_runs(const ColorGrid& grid) {
  std::size_t count = 0;
  for (int v = 0; v < grid.height; ++v) count += runs_of_row(grid, v).size();
  return count;
}

}  // namespace touchline::testing
