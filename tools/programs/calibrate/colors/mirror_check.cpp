#include "tools/programs/calibrate/colors/mirror_check.h"

#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

// Number of additional robots that a mirror image must explain, all listed in the team file and without a doubt about a
// color. By chance, a patch or two of another robot lie where a mirror image has them, but not three whole robots: in
// 40 random teams, no real picture was taken for a mirrored one.
constexpr std::size_t kMoreRobots = 3;

}  // namespace

MarkerLayout mirrored(const MarkerLayout& layout) {
  MarkerLayout out = layout;
  for (PatchPlace& patch : out.patches) {
    patch.y_m = -patch.y_m;
    patch.turn_rad = -patch.turn_rad;
  }
  return out;
}

std::optional<DetectionDoubt> mirror_doubt(const VenueDraft& venue, const TeamColors& team,
                                           const std::vector<Click>& clicks,
                                           const std::map<std::string, CameraPicture>& pictures,
                                           const DetectedColors& found) {
  if (found.doubts.empty() && found.assignment.unknown_robots == 0) return std::nullopt;
  TeamColors seen = team;
  for (TeamMarking& marking : seen.marker.teams) marking.layout = mirrored(marking.layout);
  const Result<DetectedColors> other = auto_detect_colors(venue, seen, clicks, pictures);
  if (!other.ok() || !other.value().doubts.empty()) return std::nullopt;
  const std::size_t as_mirrored = other.value().assignment.named.size(), as_drawn = found.assignment.named.size();
  if (as_mirrored < as_drawn + kMoreRobots) return std::nullopt;
  return DetectionDoubt{
      formatted("the picture is mirrored: %zu robots fit the mirror image of their layout, %zu the layout of the team "
                "file; turn off the flip of the camera (writing below it must be readable), or correct the layout",
                as_mirrored, as_drawn),
      ""};
}

}  // namespace touchline::calibrate
