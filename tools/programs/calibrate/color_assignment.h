#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/marker/marker_layout.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/marker_search.h"

namespace touchline::calibrate {

/// A color that the team file names, and what is known of its look.
struct WantedColor {
  std::string name;
  std::optional<Rgb> look;  // as clicked on, or usual_rgb(); none: nothing is known
  bool clicked = false;     // the look is this camera's, not a guess
};

struct AssignmentInput {
  std::vector<WantedColor> colors;   // ColorId is the index + 1
  std::array<TeamMarking, 2> teams;  // indexed by Team
  ColorId ball = kBackground;
  std::vector<FoundPatch> patches;   // of all pictures
  std::vector<std::size_t> picture;  // a patch: where it was found
  std::vector<MarkerCandidate> markers;
  std::vector<std::size_t> balls;  // patches that could be the ball by size and shape
};

/// What a wanted color was found to be.
struct AssignedColor {
  std::vector<std::size_t> patches;  // empty: not found
  std::vector<std::size_t> others;   // of its look, but of no robot, or no ball that stands alone
  Rgb rgb{};                         // their median
  double unlikeness = 0;             // unlikeness() to the look, light and white balance taken out
  double margin = 0;                 // by how much another assignment of this color is worse, in nats
  std::string rival;                 // what else its patches would then be, or ""
  [[nodiscard]] double confidence() const;
};

struct Assignment {
  std::vector<AssignedColor> colors;  // as in the input
  std::size_t robots = 0;             // markers that this makes robots of the team file
  std::size_t strangers = 0;          // markers of known colors in a combination that no robot has
};

/// Clusters the patches by color and finds which cluster is which color. What counts, as a negative logarithm of
/// likelihood: how unlike a cluster is to what its name lets expect (after one gain a channel for all of them, found
/// with it), robots that become explained (a team patch, and identification patches of a combination that this team
/// has, none twice in a picture), a ball that stands alone and once a picture. All cuts of the clustering and all
/// pairs of team colors are tried; the best sum wins. A margin is the loss when that color has to be another cluster.
Assignment assign_colors(const AssignmentInput& input);

}  // namespace touchline::calibrate
