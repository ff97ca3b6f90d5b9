#include "tools/programs/calibrate/light/light_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/programs/calibrate/imaging/channel_image.h"
#include "tools/programs/calibrate/light/floor_light.h"
#include "tools/programs/calibrate/light/light_grid.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Least share of plain floor in a cell.
constexpr double kMinFloorShare = 0.3;
// Range of the map: core/light limits the gain to 4, and the file format ends at 65535 / 32768 = 1.99997.
constexpr float kMinIllumination = 0.25f, kMaxIllumination = 65535.0f / 32768.0f;

// Returns the median of each pixel over all pictures, which is what most of them show.
Plane usual_value(const std::vector<hal::Picture>& pictures, std::size_t channel) {
  Plane out(std::size_t{pictures[0].width_px} * pictures[0].height_px);
  std::vector<double> values(pictures.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t p = 0; p < pictures.size(); ++p) values[p] = channel_value(pictures[p], 3 * i + channel);
    out[i] = statistics::median(values);
  }
  return out;
}

Plane mean_value(const std::vector<hal::Picture>& pictures, std::size_t channel) {
  Plane out(std::size_t{pictures[0].width_px} * pictures[0].height_px, 0.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (const hal::Picture& p : pictures) out[i] += channel_value(p, 3 * i + channel);
    out[i] /= static_cast<double>(pictures.size());
  }
  return out;
}

// Adds a spot for each group of connected flagged cells (4-neighborhood).
void add_spots(const LightGrid& grid, std::vector<std::uint8_t> flagged, bool saturated, std::vector<LightSpot>& out) {
  for (std::size_t start = 0; start < flagged.size(); ++start) {
    if (flagged[start] == 0) continue;
    flagged[start] = 0;
    std::vector<std::size_t> spot = {start};
    std::size_t left = grid.columns(), right = 0, top = grid.rows(), bottom = 0;
    for (std::size_t i = 0; i < spot.size(); ++i) {  // `spot` grows in this loop
      const std::size_t column = spot[i] % grid.columns(), row = spot[i] / grid.columns();
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
      const auto visit = [&](bool there, std::size_t next) {
        if (!there || flagged[next] == 0) return;
        flagged[next] = 0;
        spot.push_back(next);
      };
      visit(column > 0, spot[i] - 1);
      visit(column + 1 < grid.columns(), spot[i] + 1);
      visit(row > 0, spot[i] - grid.columns());
      visit(row + 1 < grid.rows(), spot[i] + grid.columns());
    }
    out.push_back({saturated, grid.left_px(left), grid.top_px(top), grid.left_px(right + 1) - 1,
                   grid.top_px(bottom + 1) - 1, spot.size()});
  }
}

}  // namespace

double channel_value(const hal::Picture& picture, std::size_t index) {
  return picture.is_16_bit() ? picture.rgb16[index] / 257.0 : static_cast<double>(picture.rgb8[index]);
}

Result<void> fit_light(const LightFitInput& input, LightMap& out, LightReport& report) {
  report = {};
  const std::vector<hal::Picture>& pictures = input.pictures;
  if (pictures.empty() || pictures[0].width_px == 0 || pictures[0].height_px == 0) {
    return Error{ErrorCode::kOutOfRange, "there is no reference picture"};
  }
  const std::size_t width = pictures[0].width_px, height = pictures[0].height_px;
  for (const hal::Picture& p : pictures) {
    if (p.width_px != width || p.height_px != height) {
      return failure(ErrorCode::kInconsistent, "the reference pictures differ in size: %zu x %zu and %u x %u", width,
                     height, p.width_px, p.height_px);
    }
  }
  if (input.surface == LightSurface::kMoving && pictures.size() < 3) {
    return failure(ErrorCode::kNotFound,
                   "at least three pictures are needed to remove moving objects; a few dozen are better");
  }
  std::vector<std::uint8_t> inside =
      inside_mask(input.region_of_interest, static_cast<int>(width), static_cast<int>(height));
  for (std::size_t i = 0; i < input.floor.size(); ++i) inside[i] = inside[i] != 0 && input.floor[i] != 0 ? 1 : 0;
  const LightGrid grid(width, height);
  const bool paper = input.surface == LightSurface::kGreyPaper, border = input.surface == LightSurface::kBorder;
  std::array<Plane, 3> background, planes;
  for (std::size_t c = 0; c < 3; ++c) background[c] = paper ? mean_value(pictures, c) : usual_value(pictures, c);
  const bool floor = !paper && !border;
  const std::vector<std::uint8_t> counts = floor ? plain_floor(background, inside, width, height) : inside;
  const double least_share = floor ? kMinFloorShare : 0.0;
  std::vector<std::uint8_t> known(grid.cells(), 0), saturated(grid.cells(), 0), dark(grid.cells(), 0);
  std::array<Plane, 3> continued;
  if (border) {
    TOUCHLINE_TRY(border_light(background, input.border, grid, width, height, continued));
  }
  for (std::size_t channel = 0; channel < 3; ++channel) {
    planes[channel] = grid.reduce(background[channel], counts, least_share);
    for (std::size_t i = 0; border && i < grid.cells(); ++i) {
      if (!std::isnan(planes[channel][i])) planes[channel][i] = continued[channel][i];
    }
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      if (std::isnan(planes[channel][i])) continue;
      known[i] = 1;
      if (planes[channel][i] >= kSaturated) saturated[i] = 1;
      if (planes[channel][i] < kDark) dark[i] = 1;
    }
  }
  const auto cells = static_cast<std::size_t>(std::count(known.begin(), known.end(), 1));
  report.saturated_cells = static_cast<std::size_t>(std::count(saturated.begin(), saturated.end(), 1));
  report.dark_cells = static_cast<std::size_t>(std::count(dark.begin(), dark.end(), 1));
  report.known_cells = cells;
  add_spots(grid, saturated, true, report.spots);
  add_spots(grid, dark, false, report.spots);
  std::stable_sort(report.spots.begin(), report.spots.end(),
                   [](const LightSpot& a, const LightSpot& b) { return a.cells > b.cells; });
  if (const auto able = static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1));
      floor && 4 * static_cast<std::size_t>(std::count(counts.begin(), counts.end(), 1)) < able) {
    return Error{ErrorCode::kOutOfRange,
                 "less than a quarter of the field is plain floor: use pictures of grey paper (--surface grey)"};
  }
  if (cells == 0 || 2 * report.saturated_cells > cells || 2 * report.dark_cells > cells) {
    return failure(ErrorCode::kOutOfRange, "%zu of %zu cells are saturated and %zu are black: change the exposure",
                   report.saturated_cells, cells, report.dark_cells);
  }

  if (floor) mend_floor(grid, planes);
  std::array<Plane, 3> smooth;
  // All channels have the same factor, so that a gray surface stays gray.
  double factor = 1.0;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    grid.fill(planes[channel]);
    smooth[channel] = grid.smooth(planes[channel]);
    std::vector<double> values;
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      if (known[i] != 0) values.push_back(smooth[channel][i]);
    }
    report.normal[channel] = input.normal ? (*input.normal)[channel] : statistics::median(values);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    report.least[channel] = *least;
    report.most[channel] = *most;
    if (input.normal) continue;
    factor = std::max(factor, *most / report.normal[channel] / static_cast<double>(kMaxIllumination));
  }
  LightMap map;
  map.columns = static_cast<std::uint16_t>(grid.columns());
  map.rows = static_cast<std::uint16_t>(grid.rows());
  std::vector<std::uint8_t> clamped(grid.cells(), 0);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    report.normal[channel] *= factor;
    report.least[channel] /= report.normal[channel];
    report.most[channel] /= report.normal[channel];
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      const auto ratio = static_cast<float>(smooth[channel][i] / report.normal[channel]);
      map.illumination[channel][i] = std::clamp(ratio, kMinIllumination, kMaxIllumination);
      if (known[i] != 0 && ratio != map.illumination[channel][i]) clamped[i] = 1;
    }
  }
  report.clamped_cells = static_cast<std::size_t>(std::count(clamped.begin(), clamped.end(), 1));
  if (2 * report.clamped_cells > cells) {
    return failure(
        ErrorCode::kOutOfRange,
        "%zu of %zu cells have %.2f to %.2f times the light in which the colors were learned; a light map can correct "
        "0.25 to 2 times. The light or the camera's black level has changed too much: learn the colors again",
        report.clamped_cells, cells, report.least[1], report.most[1]);
  }
  out = map;
  return {};
}

hal::Picture map_picture(const LightMap& map) {
  hal::Picture picture;
  picture.width_px = map.columns;
  picture.height_px = map.rows;
  const std::size_t cells = static_cast<std::size_t>(map.columns) * map.rows;
  picture.rgb16.resize(3 * cells);
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const long value = std::lround(static_cast<double>(map.illumination[c][i]) * 32768.0);
      picture.rgb16[3 * i + c] = static_cast<std::uint16_t>(std::clamp(value, 1L, 65535L));
    }
  }
  return picture;
}

}  // namespace touchline::calibrate
