#pragma once

#include <array>
#include <span>

#include "core/marker/ball_appearance.h"
#include "core/marker/color_evidence.h"
#include "core/marker/marker_layout.h"
#include "core/marker/patch_finder.h"
#include "core/types.h"

namespace touchline {

struct BallParameters {
  ColorId color = kBackground;
  float radius_m = 0.02135f;
};

/// Returns the ball as a circular patch at the height of its center.
PatchPlace outline_of(const BallParameters& ball);

/// Finds the ball.
///
/// Without a frame, it chooses the candidate whose area fits best and whose region looks like a disk. Candidates on the
/// top of a reported robot have a much lower rank. If two candidates are about equally likely, no ball is reported.
///
/// With a frame, regions only give positions to examine. The evidence comes from the pixels at these positions
/// (ball_appearance.h), independently of the color boxes: how well a disk of the ball's size is filled, whether its
/// color ends where the disk ends, whether its outline is circular, whether patches of a robot are beside it, and how
/// much its color differs from the typical one. Pixels on the top of a robot do not count, because they hide the ball.
/// The track adds its expectation: the expected position is examined even if no region is there, and a ball there makes
/// others unlikely. The confidence is the probability of a candidate, compared with all others and with no ball; a ball
/// with less than kMinConfidence is not reported. The work is bounded: at most kMaxLooks patches and the expected
/// position.
class BallFinder {
 public:
  static constexpr float kMinConfidence = 0.6f;
  // kMaxExamined allows for the ball, and for clutter of its color and size. kMaxLooks also allows for patches of
  // robots, which are skipped.
  static constexpr std::size_t kMaxExamined = 6, kMaxLooks = 8;

  /// Input from one frame. `patches`: candidates of the ball's color inside the field.
  struct Scene {
    const Frame* frame = nullptr;  // may be null
    const ColorPatches& patches;
    const PatchFinder& finder;
    const std::array<TeamMarking, 2>& teams;
    const Regions& regions;
    ExpectedBall expected;
  };

  void configure(const BallParameters& ball) { ball_ = ball; }
  void set_typical(const TypicalColors& typical) { colors_.configure(typical); }

  /// Sets `out.ball` and the verdicts of the examined regions. `out.robots` must be complete.
  void find(const Scene& now, Sightings& out) const;

 private:
  // A position that may be the ball's.
  struct Candidate {
    const PatchCandidate* patch = nullptr;  // null: the position that the track expects
    BallAppearance shown;
    float log_odds = 0;  // log odds against no ball
  };
  using Candidates = FixedVector<Candidate, kMaxExamined + 1>;

  void find_by_regions(const Scene& now, Sightings& out) const;
  void find_by_pixels(const Scene& now, Sightings& out) const;
  void examine(const Scene& now, const PatchCandidate& patch, const Sightings& seen, Candidates& out) const;
  void examine_expected_place(const Scene& now, const Sightings& seen, Candidates& out) const;
  // Returns the log likelihood of a surface's mean color, relative to that of the typical value, in light of unknown
  // brightness.
  [[nodiscard]] float log_likelihood(const std::array<float, 3>& rgb, ColorId color, ColorSpace space) const;
  // Returns the log odds of the ball against all alternatives, including a patch of another color whose robot was not
  // found.
  [[nodiscard]] float log_odds_of(const BallAppearance& shown, float prior, ColorSpace space) const;
  [[nodiscard]] float place_log_odds(const Scene& now, PixelPoint center, const Sightings& seen) const;
  [[nodiscard]] float expectation_log_odds(const Scene& now, PixelPoint center) const;
  // Returns whether the list already has a candidate at this position.
  static bool is_listed(const Candidate& candidate, float radius_px, const Candidates& candidates);
  [[nodiscard]] bool shows_enough(const Scene& now, const BallAppearance& shown) const;

  BallParameters ball_;
  ColorEvidence colors_;
};

}  // namespace touchline
