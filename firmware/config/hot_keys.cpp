#include "firmware/config/hot_keys.h"

#include <algorithm>
#include <array>

namespace touchline::config {
namespace {

/// A key or a whole section, and how it is taken over.
struct HotKey {
  FileKind file;
  std::string_view path;
  Taker taker;
  void (*take)(const Configuration& next, Configuration& running);
};

constexpr std::array kHotKeys{
    // Which files are read: what they say is compared by itself.
    HotKey{FileKind::kBoard, "name", kNobody,
           [](const auto& next, auto& running) { running.board.name = next.board.name; }},
    HotKey{FileKind::kBoard, "venue", kNobody,
           [](const auto& next, auto& running) { running.board.venue = next.board.venue; }},
    HotKey{FileKind::kBoard, "team", kNobody,
           [](const auto& next, auto& running) { running.board.team = next.board.team; }},
    HotKey{FileKind::kBoard, "camera.exposure_us", kCamera,
           [](const auto& next, auto& running) { running.board.camera.exposure_us = next.board.camera.exposure_us; }},
    HotKey{FileKind::kBoard, "camera.exposure_steps", kCamera,
           [](const auto& next, auto& running) {
             running.board.camera.exposure_steps = next.board.camera.exposure_steps;
           }},
    HotKey{FileKind::kBoard, "camera.gain", kCamera,
           [](const auto& next, auto& running) { running.board.camera.gain = next.board.camera.gain; }},
    HotKey{FileKind::kBoard, "camera.white_balance_k", kCamera,
           [](const auto& next, auto& running) {
             running.board.camera.white_balance_k = next.board.camera.white_balance_k;
           }},
    HotKey{FileKind::kBoard, "camera.focus", kCamera,
           [](const auto& next, auto& running) { running.board.camera.focus = next.board.camera.focus; }},
    HotKey{FileKind::kBoard, "camera.power_line", kCamera,
           [](const auto& next, auto& running) { running.board.camera.power_line = next.board.camera.power_line; }},
    HotKey{FileKind::kBoard, "radio.delay_s", kLoop,
           [](const auto& next, auto& running) { running.board.radio.delay_s = next.board.radio.delay_s; }},
    HotKey{FileKind::kBoard, "faults", kLoop,
           [](const auto& next, auto& running) { running.board.faults = next.board.faults; }},
    HotKey{FileKind::kVenue, "color", kThresholds,
           [](const auto& next, auto& running) { running.venue.color = next.venue.color; }},
    HotKey{FileKind::kVenue, "colors.background", kThresholds,
           [](const auto& next, auto& running) { running.venue.colors.background = next.venue.colors.background; }},
    HotKey{FileKind::kVenue, "light", kThresholds,
           [](const auto& next, auto& running) { running.venue.light = next.venue.light; }},
    HotKey{FileKind::kVenue, "region_of_interest", kThresholds,
           [](const auto& next, auto& running) { running.venue.region_of_interest = next.venue.region_of_interest; }},
    HotKey{FileKind::kVenue, "picture.min_area_px", kThresholds,
           [](const auto& next, auto& running) { running.venue.picture.min_area_px = next.venue.picture.min_area_px; }},
    HotKey{FileKind::kVenue, "adaptation", kThresholds,
           [](const auto& next, auto& running) { running.venue.adaptation = next.venue.adaptation; }},
    HotKey{FileKind::kTeam, "control", kControl,
           [](const auto& next, auto& running) { running.team.control = next.team.control; }},
};

bool is_at_or_below(std::string_view key, std::string_view path) {
  return key.starts_with(path) && (key.size() == path.size() || key[path.size()] == '.' || key[path.size()] == '[');
}

const HotKey* find(const Change& change) {
  const auto found = std::find_if(kHotKeys.begin(), kHotKeys.end(), [&](const HotKey& hot) {
    return hot.file == change.file && is_at_or_below(change.key, hot.path);
  });
  return found == kHotKeys.end() ? nullptr : &*found;
}

/// Boxes, maps and polygons mean something for these pictures and color numbers only.
bool same_pictures_and_colors(const Configuration& a, const Configuration& b) {
  const ScanParameters &x = a.pipeline.scan, &y = b.pipeline.scan;
  return x.format == y.format && x.width_px == y.width_px && x.height_px == y.height_px &&
         std::equal(a.venue.color.begin(), a.venue.color.end(), b.venue.color.begin(), b.venue.color.end(),
                    [](const ColorEntry& one, const ColorEntry& other) { return one.name == other.name; });
}

}  // namespace

Status take_hot_keys(const Configuration& next, Configuration& running, HotChanges& changes, Problems& problems) {
  changes = {};
  const bool thresholds_fit = same_pictures_and_colors(running, next);
  for (Change& change : difference(running, next)) {
    const HotKey* hot = find(change);
    if (hot == nullptr || (hot->taker == kThresholds && !thresholds_fit)) {
      changes.need_restart.push_back(std::move(change));
      continue;
    }
    hot->take(next, running);
    changes.takers |= hot->taker;
    changes.taken.push_back(std::move(change));
  }
  if ((changes.takers & kControl) != 0) running.pipeline.control = running.team.control;
  if ((changes.takers & kThresholds) == 0) return {};
  running.venue_where = next.venue_where;  // a light map is looked for beside the venue file
  const ScanParameters& scan = running.pipeline.scan;
  const InputFormat input{scan.format, scan.width_px, scan.height_px, "the camera that runs"};
  return resolve(input, running, problems);
}

}  // namespace touchline::config
