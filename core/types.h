#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/fixed_vector.h"
#include "core/status.h"
#include "core/time.h"

// All values that pass between the stages, in the order in which a frame goes through them.
namespace touchline {

// --- Capacities -----------------------------------------------------------------------------------------------------

// The largest sensor that single-board cameras of the leagues use (OV5647, 5 megapixels).
constexpr std::size_t kMaxFrameWidth = 2592;
constexpr std::size_t kMaxFrameHeight = 1944;
// One bit each of the 32-bit table entries (paper, section 3.2).
constexpr std::size_t kMaxColorBoxes = 32;
constexpr std::size_t kMaxColors = 32;
// What core/region/run_budget.h allows the largest frame.
constexpr std::size_t kMaxRuns = 8 * kMaxFrameHeight;
// A realistic field has 200; twenty-fold for clutter and noise.
constexpr std::size_t kMaxRegions = 4096;
// 11 robots a team is the largest class of any league (SSL division A).
constexpr std::size_t kMaxRobotsPerTeam = 11;
constexpr std::size_t kMaxRobots = 2 * kMaxRobotsPerTeam;
// Five dots (SSL) and one spare.
constexpr std::size_t kMaxPatches = 6;

// --- Points ---------------------------------------------------------------------------------------------------------

/// Origin: center of the top-left pixel; u to the right, v downwards.
struct PixelPoint {
  float u_px = 0.0f, v_px = 0.0f;
};
/// Origin: center of the field; x along it towards the opponent's goal, y to the left.
struct FieldPoint {
  float x_m = 0.0f, y_m = 0.0f;
};
/// Heading counter-clockwise from x, in (-pi, pi].
struct Pose {
  FieldPoint position;
  float theta_rad = 0.0f;
};
/// Linear velocity along the heading, angular velocity counter-clockwise.
struct Twist {
  float v_mps = 0.0f, w_radps = 0.0f;
};

// --- camera -> color ------------------------------------------------------------------------------------------------

enum class PixelFormat : std::uint8_t { kRgb24, kBgr24, kYuyv, kUyvy, kNv12 };

/// Which three channels a format delivers; color boxes are in the same.
enum class ColorSpace : std::uint8_t { kRgb, kYuv };
constexpr ColorSpace color_space(PixelFormat format) {
  return format == PixelFormat::kRgb24 || format == PixelFormat::kBgr24 ? ColorSpace::kRgb : ColorSpace::kYuv;
}

/// A view of a picture that somebody else owns. Chroma of YUYV/UYVY is shared by pixel pairs (2k, 2k+1), of NV12 by
/// 2 x 2 blocks; at odd sizes the last column and row use the chroma sample of the pair or block they begin.
struct Frame {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  std::array<const std::uint8_t*, 2> plane{};  // second one: NV12's interleaved U, V
  std::array<std::uint32_t, 2> stride_bytes{};
  Instant capture_time{};      // middle of the exposure as well as the driver knows it
  std::uint32_t sequence = 0;  // the driver's count: gaps are lost frames
};

// --- color -> region ------------------------------------------------------------------------------------------------

/// 0 is background, 1.. are the colors of the venue file in their order.
using ColorId = std::uint8_t;
constexpr ColorId kBackground = 0;

constexpr std::uint32_t kNoRun = std::numeric_limits<std::uint32_t>::max();

/// Pixels [begin, end) of a row that have one color. The runs of a region are chained in raster order by `next`.
struct Run {
  std::uint16_t row = 0, begin = 0, end = 0;
  ColorId color = kBackground;
  std::uint32_t next = kNoRun;
};
using Runs = FixedVector<Run, kMaxRuns>;

/// Inclusive bounds.
struct PixelBox {
  std::uint16_t left = 0, top = 0, right = 0, bottom = 0;
};

/// A 4-connected set of pixels of one color. Its number is its index in `Regions`.
struct Region {
  std::uint32_t first_run = kNoRun;
  std::uint32_t area_px = 0;
  PixelPoint centroid;
  PixelBox box;
  ColorId color = kBackground;
};
/// In raster order of their first pixel.
using Regions = FixedVector<Region, kMaxRegions>;

// --- region -> marker -----------------------------------------------------------------------------------------------

enum class Team : std::uint8_t { kOwn, kOpponent };
using RobotId = std::int8_t;
constexpr RobotId kUnknownId = -1;

enum class PatchRole : std::uint8_t { kTeam, kIdentification };

struct PatchSighting {
  PatchRole role = PatchRole::kTeam;
  std::uint8_t patch = 0;  // index in the layout's list of patches
  ColorId color = kBackground;
  PixelPoint center;
};

/// What this frame alone shows of one robot.
struct RobotSighting {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;  // unknown is better than wrong
  // Without one theta_rad is meaningless, and position anywhere on the robot (that of its team patch, as a rule).
  bool has_heading = false;
  Pose pose;
  float residual_m = 0.0f;  // RMS of the patches against their layout
  FixedVector<PatchSighting, kMaxPatches> patches;
};

struct BallSighting {
  bool seen = false;
  FieldPoint position;
  PixelPoint center;
  std::uint32_t area_px = 0;
};

/// Why a region is, or is not, part of what was reported.
enum class Verdict : std::uint8_t {
  kNotExamined,  // color of no patch and no ball
  kTeamPatch,
  kIdentification,
  kBall,
  kFragment,  // merged into a patch by the weighted refinement
  kTooSmall,
  kTooLarge,
  kWrongShape,
  kOutsideField,
  kTooClose,      // eq. (1): another team region of greater area stands there
  kNoPartner,     // eq. (2): no region at the right distance
  kPartnerTaken,  // its partner belongs to a better match
  kSurplus,       // more of them than robots or balls on the field
};
const char* describe(Verdict verdict) noexcept;

struct Sightings {
  BallSighting ball;
  FixedVector<RobotSighting, kMaxRobots> robots;
  FixedVector<Verdict, kMaxRegions> verdicts;  // one a region
  bool cut_short = false;                      // more could be read into the picture than the bounded search tried
};

// --- marker -> track ------------------------------------------------------------------------------------------------

enum class TrackState : std::uint8_t { kNew, kSeen, kCoasting, kLost };

struct RobotTrack {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;
  TrackState state = TrackState::kLost;
  Pose pose;  // at capture time
  Twist twist;
  Pose pose_at_action;  // when the command computed from it will act
  Twist twist_at_action;
  // Standard deviations of x (m), y (m), theta (rad) at capture time. A robot whose heading was never seen has 1.81
  // (nothing known); its theta is then the direction in which it moves, its position that of its team patch.
  std::array<float, 3> sigma{};
  Instant last_seen{};
};

struct BallTrack {
  TrackState state = TrackState::kLost;
  FieldPoint position, velocity;  // m and m/s at capture time
  FieldPoint position_at_action, velocity_at_action;
  float sigma_m = 0.0f;
  Instant last_seen{};
};

struct Tracks {
  Instant capture_time{}, action_time{};
  BallTrack ball;
  FixedVector<RobotTrack, kMaxRobots> robots;  // states kNew, kSeen and kCoasting; lost ones are not listed
};

// --- track -> control -> radio --------------------------------------------------------------------------------------

struct WheelSpeeds {
  float left_mps = 0.0f, right_mps = 0.0f;  // of the rim
};

struct RobotCommand {
  RobotId id = kUnknownId;
  Twist twist;  // after all limits; what the filter is driven by
  WheelSpeeds wheels;
};

struct Commands {
  bool stop = true;  // robots must halt, whatever the list says
  FixedVector<RobotCommand, kMaxRobotsPerTeam> robots;
};

// Header, 11 robots of 5 bytes and the checksum are 63 (docs/radio.md); twice that leaves room for a robot of 10 bytes.
constexpr std::size_t kMaxPacketBytes = 128;
using Packet = FixedVector<std::byte, kMaxPacketBytes>;

// --- radio -> robots' own words -------------------------------------------------------------------------------------

constexpr std::int8_t kLinkUnknown = -1;

/// What one robot says of itself (docs/radio.md).
struct RobotTelemetry {
  RobotId id = kUnknownId;
  std::uint8_t sequence = 0;
  float battery_v = 0.0f;                   // 0: it does not measure it
  std::int8_t link_percent = kLinkUnknown;  // of our packets, how many it heard lately
};

/// What is known of one robot from its own words.
struct RobotReport {
  RobotTelemetry last;
  Instant heard{};                        // when it came
  std::uint32_t packets = 0, missed = 0;  // missed: by their sequence numbers
  bool battery_low = false;
};

struct RobotReports {
  FixedVector<RobotReport, kMaxRobotsPerTeam> robots;  // in the order of their ids
  std::uint64_t packets = 0;                           // of all robots
  std::uint64_t foreign_bytes = 0;                     // that belonged to no good packet
};

// --- the whole way --------------------------------------------------------------------------------------------------

enum class Stage : std::uint8_t { kRegion, kMarker, kTrack, kControl, kRadio };  // classification is part of kRegion
constexpr std::size_t kStageCount = 5;
const char* describe(Stage stage) noexcept;

/// What the adaptation to the light has come to; known after Pipeline::adapt().
struct LightTrace {
  float brightness = 1.0f;    // of the field, relative to the calibration
  std::uint32_t patches = 0;  // that it learned from in this frame
};

/// Everything that one frame led to. Recorder, console, latency report and tests read this and nothing else.
struct StepTrace {
  Frame frame;  // its pixels are gone once the lease is given back
  Runs runs;
  Regions regions;
  Sightings sightings;
  Tracks tracks;
  Commands commands;
  Packet packet;
  LightTrace light;
  RobotReports reports;  // all that robots have said until now
  Status status;         // of the scan: kUnsupported (nothing seen), kFull (see overload)
  std::array<Duration, kStageCount> stage_time{};
  bool overload = false;  // some capacity was reached; the counters say which
  std::uint32_t runs_dropped = 0, regions_dropped = 0;
};

}  // namespace touchline
