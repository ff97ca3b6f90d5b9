#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/fixed_vector.h"
#include "core/pixel_format.h"
#include "core/status.h"
#include "core/time.h"

// The values that pass between the stages, in the order in which a frame is processed.
namespace touchline {

// --- Capacities -----------------------------------------------------------------------------------------------------

// The largest sensor that single-board cameras of the leagues use (OV5647, 5 megapixels).
constexpr std::size_t kMaxFrameWidth = 2592;
constexpr std::size_t kMaxFrameHeight = 1944;
// Each box has one bit of the 32-bit table entries (paper, section 3.2).
constexpr std::size_t kMaxColorBoxes = 32;
constexpr std::size_t kMaxColors = 32;
// Limit of core/region/run_limiter.h for the largest frame.
constexpr std::size_t kMaxRuns = 8 * kMaxFrameHeight;
// A real field has 200; twenty times as many allow for clutter and noise.
constexpr std::size_t kMaxRegions = 4096;
// The largest teams of any league have 11 robots (SSL division A).
constexpr std::size_t kMaxRobotsPerTeam = 11;
constexpr std::size_t kMaxRobots = 2 * kMaxRobotsPerTeam;
// Five dots (SSL) and one spare.
constexpr std::size_t kMaxPatches = 6;

// --- Points ---------------------------------------------------------------------------------------------------------

/// Origin: center of the top-left pixel; u to the right, v downwards.
struct PixelPoint {
  float u_px = 0.0f, v_px = 0.0f;
};
/// Origin: center of the field; x along it, y to the left of x. The own team attacks towards positive x unless a
/// referee changes the sides.
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

/// Covariance of a pose's errors: x and y in m, heading t in rad.
struct PoseCovariance {
  float xx = 0.0f, yy = 0.0f, tt = 0.0f, xy = 0.0f, xt = 0.0f, yt = 0.0f;
};

// --- camera -> color ------------------------------------------------------------------------------------------------

struct Sightings;

/// A picture that this structure does not own. If pixels share chroma samples and the size is odd, the last column
/// and row use the chroma of their incomplete block.
struct Frame {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  std::array<const std::uint8_t*, kMaxPlanes> plane{};  // null: the format has fewer planes
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};
  Instant capture_time{};      // middle of the exposure, as accurate as the driver reports it
  std::uint32_t sequence = 0;  // frame number from the driver; gaps are lost frames
  // What the source itself recognized (a simulator, another vision system); then there is no picture, and format, size
  // and planes mean nothing. Null: the frame is a picture.
  const Sightings* sightings = nullptr;
};

/// A row of a frame: the first byte of each plane's row.
struct RowPixels {
  std::array<const std::uint8_t*, kMaxPlanes> plane{};
};
inline RowPixels row_pixels(const Frame& frame, std::size_t v) {
  const PixelFormatInfo& info = info_of(frame.format);
  const auto plane = [&](std::size_t i, std::size_t shift) {
    return frame.plane[i] + (v >> shift) * frame.stride_bytes[i];
  };
  if (info.planes == 1) return {{plane(0, 0)}};
  return {
      {plane(0, 0), plane(1, info.channel[1].shift_v), info.planes > 2 ? plane(2, info.channel[2].shift_v) : nullptr}};
}

/// Returns the bytes from the first to the last pixel of a plane; 0 if the format has no such plane.
inline std::size_t plane_bytes(const Frame& frame, std::size_t plane) {
  return plane_bytes(frame.format, plane, frame.width_px, frame.height_px, frame.stride_bytes[plane]);
}

/// Returns R, G, B or Y, U, V of pixel (u, v), which must lie in the frame.
inline std::array<std::uint8_t, 3> pixel_at(const Frame& frame, std::size_t u, std::size_t v) {
  std::array<std::uint8_t, 3> value;
  // gcc 12 unrolls no loops at -O2.
  _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
    const ChannelLayout& channel = info_of(frame.format).channel[c];
    const std::size_t row = (v >> channel.shift_v) * frame.stride_bytes[channel.plane];
    value[c] = frame.plane[channel.plane][row + channel.byte(u)];
  }
  return value;
}

// --- color -> region ------------------------------------------------------------------------------------------------

/// 0 is background; 1, 2, ... are the colors of the venue file in their order.
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
  bool is_cut = false;  // an overload dropped runs that touch it: the region may be a part of a larger one
};
/// Regions in raster order of their first pixel.
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

// Confidence: the probability that a sighting or a track is right, 0 to 1. With 0.9, nine in ten are right.
// - Robot with an id: this robot of this team is at this position.
// - Robot without an id: some robot of this team is at this position.
// - Ball: the ball is at this position.

/// Reason why a robot of a known team has no id.
enum class IdDoubt : std::uint8_t {
  kNone,              // the robot has an id, or its team has no known robots
  kNoIdentification,  // only the robot's team patch is seen
  kSeveralPoses,      // the patches fit more than one pose
  kSeveralIds,        // two robots of the team are nearly as likely
  kUnknownColors,     // no robot of the team has these colors
  kInaccuratePlaces,  // the positions of the patches do not fit a marker
  kOtherOutline,      // the team patch seems to be a part of another surface
  kOverload,          // an overload removed a part of the patches, and pixels do not show their outlines
};
/// Returns a short lower-case English phrase ("two ids are possible"); "" for kNone.
const char* describe(IdDoubt doubt) noexcept;

/// A robot as seen in a single frame.
struct RobotSighting {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;  // an unknown id is better than a wrong one
  // Without a heading, theta_rad is only a guess, and position is a point on the robot (usually its team patch).
  bool has_heading = false;
  Pose pose;
  float residual_m = 0.0f;  // RMS distance of the patches from their positions in the layout
  // Covariance of the pose's errors according to this picture; without a heading only xx and yy are valid.
  PoseCovariance noise;
  // Share of these variances that is a bias from the pixel grid, colors and shape. The bias stays constant while the
  // robot stands, and decorrelates when the robot moves by `lasts_m`. The rest is noise, which differs from picture to
  // picture.
  float lasting_share = 0.0f, lasts_m = 0.0f;
  float confidence = 0.0f;  // see Confidence
  FixedVector<PatchSighting, kMaxPatches> patches;
  IdDoubt doubt = IdDoubt::kNone;
  bool is_by_track = false;  // found only because its track expected it here (core/subpixel/missed_robots.h)
};

struct BallSighting {
  bool seen = false;
  FieldPoint position;
  PixelPoint center;
  std::uint32_t area_px = 0;
  float sigma_m = 0.0f;                        // standard deviation of each coordinate according to this picture
  float confidence = 0.0f;                     // see Confidence
  float lasting_share = 0.0f, lasts_m = 0.0f;  // bias, as in RobotSighting
};

/// Whether and why a region was used for a sighting or not.
enum class Verdict : std::uint8_t {
  kNotExamined,  // the region's color belongs neither to a patch nor to the ball
  kTeamPatch,
  kIdentification,
  kBall,
  kFragment,  // merged into a patch (weighted refinement of section 5)
  kTooSmall,
  kTooLarge,
  kWrongShape,
  kOutsideField,
  kTooClose,      // eq. (1): a larger region of the same color is too close
  kNoPartner,     // eq. (2): no region at the right distance
  kPartnerTaken,  // the patch that would fit belongs to a better hypothesis
  kSurplus,       // beyond the maximum number of robots or balls
};
const char* describe(Verdict verdict) noexcept;
/// Returns whether a region of a patch's or the ball's color was not used.
bool is_refusal(Verdict verdict) noexcept;

struct Sightings {
  BallSighting ball;
  FixedVector<RobotSighting, kMaxRobots> robots;
  FixedVector<Verdict, kMaxRegions> verdicts;  // one verdict per region
  bool cut_short = false;                      // the search reached its bound before it tried all hypotheses
};

// --- marker -> track ------------------------------------------------------------------------------------------------

enum class TrackState : std::uint8_t { kNew, kSeen, kCoasting, kLost };

struct RobotTrack {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;
  TrackState state = TrackState::kLost;
  Pose pose;  // at capture time
  Twist twist;
  Pose pose_at_action;  // predicted for the time when the command acts
  Twist twist_at_action;
  // Standard deviations of x (m), y (m), theta (rad) at capture time. If the heading was never seen, theta is the
  // direction of motion with a deviation of 1.81 (uniform distribution), and position is the team patch's.
  std::array<float, 3> sigma{};
  float xy_covariance_m2 = 0.0f;  // covariance of x and y
  // Squared Mahalanobis distance of this frame's sighting from its prediction (chi-square with 3 degrees of freedom);
  // -1 if no sighting with a heading was fused.
  float innovation2 = -1.0f;
  Instant last_seen{};
  float confidence = 0.0f;  // see Confidence
};

struct BallTrack {
  TrackState state = TrackState::kLost;
  FieldPoint position, velocity;  // at capture time
  FieldPoint position_at_action, velocity_at_action;
  float sigma_m = 0.0f;
  float innovation2 = -1.0f;  // squared innovation as in RobotTrack, with 2 degrees of freedom
  Instant last_seen{};
  float confidence = 0.0f;  // see Confidence
};

/// Position at which the track expects the ball in the next frame.
struct ExpectedBall {
  bool known = false;
  FieldPoint position;
  float sigma_m = 0.0f;  // standard deviation along one axis
};

/// Where the track of a robot with an id expects it in the next frame.
struct ExpectedRobot {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;
  Pose pose;
};
using ExpectedRobots = FixedVector<ExpectedRobot, kMaxRobots>;

struct Tracks {
  Instant capture_time{}, action_time{};
  BallTrack ball;
  // Robots in states kNew, kSeen and kCoasting; lost robots are not listed.
  FixedVector<RobotTrack, kMaxRobots> robots;
};

// --- track -> control -> radio --------------------------------------------------------------------------------------

struct WheelSpeeds {
  float left_mps = 0.0f, right_mps = 0.0f;  // speed of the rim
};

enum class CommandSource : std::uint8_t {
  kPlay,      // the built-in play
  kExternal,  // another program
  kExpired    // another program whose last command is too old: the robot stops
};

/// Role of a robot in the built-in play.
enum class PlayRole : std::uint8_t { kNone, kGoalkeeper, kAttacker, kSupporter };

struct RobotCommand {
  RobotId id = kUnknownId;
  Twist twist;  // velocities after all limits; input of the tracking filter
  WheelSpeeds wheels;
  CommandSource source = CommandSource::kPlay;
  PlayRole role = PlayRole::kNone;
};

struct Commands {
  bool stop = true;  // all robots must stop, whatever the list contains
  FixedVector<RobotCommand, kMaxRobotsPerTeam> robots;
};

/// What the built-in play decided for a robot, in the venue's coordinates.
struct PlayDecision {
  static constexpr std::uint8_t kNoLine = 255;
  RobotId id = kUnknownId;
  // Indices in job_table() and skill_table() (core/control/play_table.h). kNoLine: the robot has no job in the table.
  std::uint8_t job_line = kNoLine, skill_line = kNoLine;
  std::optional<FieldPoint> target{};    // where it drives; nullopt: it turns or stands where it is
  std::optional<float> direction_rad{};  // of the motion at the target; nullopt: any
  float time_s = -1.0f;  // until it is there, as estimated when the jobs were given; negative: not estimated
};
using PlayDecisions = FixedVector<PlayDecision, kMaxRobotsPerTeam>;

// Touchline's own packet of 11 robots has 65 bytes (docs/radio.md); a list of 11 ids and speeds in ASCII has up to 200.
constexpr std::size_t kMaxPacketBytes = 256;
using Packet = FixedVector<std::byte, kMaxPacketBytes>;

// The receiver of a packet is a robot, given by its index in the team file's list own.robot, or kAllRobots.
constexpr std::size_t kAllRobots = kMaxRobotsPerTeam;
constexpr std::size_t kMaxReceivers = kMaxRobotsPerTeam + 1;

struct OutgoingPacket {
  Packet packet;
  std::size_t receiver = kAllRobots;
};
using OutgoingPackets = FixedVector<OutgoingPacket, kMaxRobotsPerTeam>;

// --- radio -> telemetry ---------------------------------------------------------------------------------------------

constexpr std::int8_t kLinkUnknown = -1;

/// Telemetry of one robot (docs/radio.md).
struct RobotTelemetry {
  RobotId id = kUnknownId;
  std::uint8_t sequence = 0;
  float battery_v = 0.0f;                   // 0: not measured
  std::int8_t link_percent = kLinkUnknown;  // percentage of our packets that the robot received recently
  std::optional<WheelSpeeds> wheels{};      // as its encoders measure them
};

/// Telemetry state of one robot.
struct RobotReport {
  RobotTelemetry last;
  Instant heard{};                        // time of reception
  std::uint32_t packets = 0, missed = 0;  // missed: gaps in the sequence numbers
  bool battery_low = false;
};

struct RobotReports {
  FixedVector<RobotReport, kMaxRobotsPerTeam> robots;  // sorted by id
  std::uint64_t packets = 0;                           // of all robots
  std::uint64_t foreign_bytes = 0;                     // not part of a valid packet
  std::size_t report_bytes = 0;                        // of one packet, at most
};

// --- identification -> loop ------------------------------------------------------------------------------------------

/// A measured value and its standard deviation.
struct MeasuredValue {
  double value = 0.0;
  double sigma = std::numeric_limits<double>::infinity();
  bool is_known = false;  // the standard deviation is small enough for use
};

/// A value that the files state, what was measured while robots drove, and the one of both that is in force.
struct ComparedValue {
  double stated = 0.0, used = 0.0;
  MeasuredValue measured;

  /// Returns whether the measurement contradicts the files.
  [[nodiscard]] bool is_contradicted() const { return used != stated; }
};

/// What was measured of an own robot's drive while it drove.
struct RobotDrive {
  RobotId id = kUnknownId;
  MeasuredValue delay_s, lag_s;       // from the packet's last byte to the wheels; time constant of the wheels
  std::array<ComparedValue, 2> gain;  // of the left and right wheel, as own.robot.wheel_gain
};

struct DriveReports {
  FixedVector<RobotDrive, kMaxRobotsPerTeam> robots;  // sorted by id
  ComparedValue delay_s, lag_s;                       // of all robots together
};

/// What the measured drives change in a step. Nothing, unless a measurement contradicts the files.
struct DriveCorrections {
  struct Wheels {
    RobotId id = kUnknownId;
    std::array<float, 2> factor{1.0f, 1.0f};  // of the speeds of the left and right wheel
  };
  Duration more_delay{};          // how much longer than stated the delay of the radio and the robots is
  std::optional<double> lag_s{};  // time constant of the wheels; nullopt: as the files state
  FixedVector<Wheels, kMaxRobotsPerTeam> wheels;  // of other robots: 1
};

// --- whole pipeline ------------------------------------------------------------------------------------------------

enum class Stage : std::uint8_t { kRegion, kMarker, kTrack, kControl, kRadio };  // classification is part of kRegion
constexpr std::size_t kStageCount = 5;
const char* describe(Stage stage) noexcept;

/// State of the adaptation to the light, valid after Pipeline::adapt().
struct LightTrace {
  float brightness = 1.0f;    // brightness of the field relative to the calibration
  std::uint32_t patches = 0;  // number of patches that the adaptation learned from in this frame
};

/// Result of the picture check (core/supervision) for this frame: reasons to doubt that the picture shows the field
/// now.
struct PictureTrace {
  bool repeats = false;      // the camera has delivered the picture, or a part of it, before
  bool replays = false;      // a part of the picture continues an older one
  bool overloads = false;    // the picture exceeds capacities of the step, frame after frame
  bool hides_field = false;  // the field is not recognizable: dark, covered, or something else is shown
  bool contradicts = false;  // the own robots move otherwise than commanded, or everything is elsewhere at once (jumps)
  bool jumps = false;
  bool stands = false;                // all commanded robots have stood for a second: a warning
  float repeated_share = 0.0f;        // share of the picture that was delivered before, for longer than usual
  float repeated_s = 0.0f;            // age of the repeated part
  float field_share = -1.0f;          // share of the field that is recognizable; negative: not measured
  std::uint32_t overload_frames = 0;  // number of consecutive frames with an overload
  // Numbers of own robots: commanded to move, and of these standing and contradicting.
  std::uint8_t commanded = 0, standing = 0, contradicting = 0;

  /// Returns true if robots must not be driven by this picture.
  [[nodiscard]] bool is_unusable() const { return repeats || overloads || hides_field; }
};

struct StepInputs;  // core/step_inputs.h

/// All inputs and results of one frame. Recorder, console, latency report and tests read only this structure.
struct StepTrace {
  Frame frame;  // the frame's pixels are invalid after its release
  // What the step used beside the frame, valid until the next call of the pipeline. Null: there was no step.
  const StepInputs* inputs = nullptr;
  // kOutOfRange or kInconsistent: the step refused the assignment of teams or the control parameters, kept the former
  // ones, and stops the robots.
  Status inputs_status;
  bool revoked = false;  // Pipeline::revoke() replaced the commands by a stop after the step
  Runs runs;
  Regions regions;
  Sightings sightings;
  Tracks tracks;
  Commands commands;
  PlayDecisions play;  // empty while robots stand or line up, and if the built-in play drives nobody
  OutgoingPackets packets;
  LightTrace light;
  PictureTrace picture;
  RobotReports reports;  // telemetry of all robots received so far
  DriveReports drives;   // measured so far, valid after Pipeline::adapt()
  Status status;         // status of the scan: kUnsupported (no sightings), kFull (see overload)
  std::array<Duration, kStageCount> stage_time{};
  bool overload = false;  // a capacity was reached; the counters tell which
  std::uint32_t runs_dropped = 0, regions_dropped = 0;
};

}  // namespace touchline
