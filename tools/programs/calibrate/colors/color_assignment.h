#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/marker/marker_layout.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/colors/marker_search.h"
#include "tools/programs/calibrate/colors/patch_labels.h"

namespace touchline::calibrate {

/// A color of the team file and its expected appearance.
struct WantedColor {
  std::string name;
  std::optional<Rgb> look;  // usual_rgb() of the name; empty if unknown
  bool clicked = false;     // a click names a patch of this color
};

struct AssignmentInput {
  std::vector<WantedColor> colors;   // ColorId is the index + 1
  std::array<TeamMarking, 2> teams;  // indexed by Team
  ColorId ball = kBackground;
  std::vector<FoundPatch> patches;   // patches of all pictures
  std::vector<std::size_t> picture;  // for each patch, the index of its picture
  std::vector<std::size_t> named;    // for each patch, the color that a click gives to it, or kNone
  std::vector<MarkerCandidate> markers;
  std::vector<std::size_t> balls;  // patches with size and shape of the ball
};

/// The patches assigned to a color.
struct AssignedColor {
  std::vector<std::size_t> patches;  // empty: not found
  // Patches of this color on no robot or on a robot in odd light, or balls that are not the only one.
  std::vector<std::size_t> others;
  Rgb rgb{};                 // median of the patches
  double dissimilarity = 0;  // dissimilarity() to the expected color, corrected for exposure and white balance
  double margin = 0;         // cost difference to the best other assignment of this color, nats
  std::string alternative;   // color of the patches in the alternative assignment, or ""
  bool alone = false;        // the color has no patch elsewhere in the other assignment
  bool same = false;         // in the other assignment the color has all of its present patches and robots, and more
  [[nodiscard]] double confidence() const;
};

/// A robot of the team file that was recognized.
struct AssignedRobot {
  std::size_t picture = 0, team = 0, robot = 0;  // indices of the picture, of the team and in TeamMarking::robots
  std::size_t team_patch = 0;                    // index of its patch
  std::vector<std::size_t> patches;              // all patches in the order of the layout, the team patch first
};

struct Assignment {
  std::vector<AssignedColor> colors;  // in the order of the input
  std::size_t robots = 0;             // markers recognized as robots of the team file
  std::vector<AssignedRobot> named;   // recognized robots that the team file lists
  // Robots whose colors are known but belong to no robot in the team file: AssignedRobot::robot is kNone.
  std::vector<AssignedRobot> unlisted;
  // Robots that are unrecognized only because of unusual light on them and a color that no other robot shows; `patches`
  // is empty.
  std::vector<AssignedRobot> in_odd_light;
  std::size_t unknown_robots = 0;  // robots in `unlisted`, and robots that a picture shows twice
};

/// Clusters the patches by color and assigns the clusters to colors. The cost is a negative log-likelihood: the
/// dissimilarity of each cluster to the color of its name (after one gain per channel, which is estimated as well),
/// recognized robots (a team patch and a combination of identification patches of that team, each robot at most once
/// per picture), and single balls (at most one per picture). A patch that a click names has the color that the click
/// gives, and so has its cluster. All cuts of the dendrogram and all pairs of team colors are tried; the lowest cost
/// wins. The margin of a color is the increase of the cost if the color must take another cluster.
Assignment assign_colors(const AssignmentInput& input);

}  // namespace touchline::calibrate
