// The message of a step keeps every input and result, and a damaged one is refused.
#include "firmware/recording/step_message.h"

#include <cmath>

#include "firmware/recording/picture_message.h"

namespace touchline::testing {
namespace {

using namespace recording;

std::unique_ptr<StepMessage> example_message() {
  auto message = std::make_unique<StepMessage>();
  StepHeader& header = message->header;
  header.number = 7;
  header.session = 2;
  header.reload = 3;
  header.picture = PictureKind::kRaw;
  header.format = PixelFormat::kYuyv;
  header.width_px = 640;
  header.height_px = 480;
  header.sequence = 99;
  header.captured = Instant(Duration(123456789));
  header.revoked = header.is_unusable = header.was_cut_short = true;
  header.frame_number = 1234567890123;
  StepInputs& inputs = message->inputs;
  inputs.now = Instant(Duration(987654321));
  inputs.action_delay = Duration(40'000'000);
  inputs.lateness[10] = Duration(5);
  ExternalCommand command;
  command.id = 3;
  command.kind = ExternalCommand::Kind::kPose;
  command.target = {{0.1f, -0.2f}, 1.5f};
  command.has_heading = true;
  command.received = Instant(Duration(77));
  inputs.commands.push_back(command);
  inputs.teams.height_m = {0.05f, 0.06f};
  inputs.teams.sides_exchanged = true;
  inputs.situation.phase = GamePhase::kPrepare;
  inputs.halt = 0x80000001U;
  inputs.observing = true;
  inputs.picture_check.unusable_frames = 9;
  inputs.events.adaptation_mode = AdaptationMode::kFrozen;
  inputs.events.radio_opened = true;
  inputs.events.telemetry.push_back(std::byte{0xAB});
  inputs.events.telemetry_parts.push_back({1, 4});
  inputs.events.telemetry_received = Instant(Duration(55));

  message->drives.more_delay = Duration(3'000'000);
  message->drives.lag_s = 0.125;
  message->drives.wheels.push_back({4, {0.5f, 1.25f}});
  message->state = "state";

  Sightings sightings;
  sightings.ball.seen = true;
  sightings.ball.position = {0.3f, 0.4f};
  RobotSighting robot;
  robot.id = 5;
  robot.pose.theta_rad = -1.0f;
  robot.patches.push_back({PatchRole::kIdentification, 2, 3, {10.0f, 20.0f}});
  robot.doubt = IdDoubt::kSeveralIds;
  sightings.robots.push_back(robot);
  Tracks tracks;
  tracks.ball.velocity = {1.0f, 2.0f};
  tracks.robots.push_back({});
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({4, {0.5f, 0.25f}, {0.1f, 0.2f}, CommandSource::kExternal, PlayRole::kAttacker});
  OutgoingPackets packets;
  packets.push_back({{}, 3});
  write_results(sightings, tracks, commands, packets, message->results);
  return message;
}

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

// Filters must not compute with them.
TEST(StepMessage, RefusesCorrectionsThatNoDriveHas) {
  const auto is_read = [](auto change) {
    const auto message = example_message(), read = std::make_unique<StepMessage>();
    change(message->drives);
    std::string bytes;
    encode(*message, bytes);
    return decode(bytes_of(bytes), *read).ok();
  };
  EXPECT_TRUE(is_read([](DriveCorrections&) {}));
  EXPECT_FALSE(is_read([](DriveCorrections& drives) { drives.lag_s = -0.1; }));
  EXPECT_FALSE(is_read([](DriveCorrections& drives) { drives.lag_s = 1.1; }));
  EXPECT_FALSE(is_read([](DriveCorrections& drives) { drives.lag_s = std::nan(""); }));
  EXPECT_FALSE(is_read([](DriveCorrections& drives) { drives.wheels[0].factor[1] = std::nanf(""); }));
  EXPECT_FALSE(is_read([](DriveCorrections& drives) { drives.more_delay = Duration::max(); }));
}

TEST(StepMessage, ReadsBackAsItWasWritten) {
  const auto written = example_message();
  std::string bytes, again;
  encode(*written, bytes);
  const auto read = std::make_unique<StepMessage>();
  ASSERT_TRUE(decode(bytes_of(bytes), *read).ok());
  encode(*read, again);
  EXPECT_EQ(again, bytes);
  EXPECT_EQ(read->header.frame_number, 1234567890123U);
  EXPECT_EQ(read->header.format, PixelFormat::kYuyv);
  EXPECT_EQ(read->inputs.commands[0].target.position.y_m, -0.2f);
  EXPECT_EQ(read->inputs.events.telemetry_parts[0].sender, 4U);
  EXPECT_EQ(read->inputs.events.adaptation_mode, AdaptationMode::kFrozen);
  EXPECT_EQ(read->inputs.halt, 0x80000001U);
  EXPECT_EQ(read->drives.lag_s, 0.125);
  EXPECT_EQ(read->drives.wheels[0].factor[1], 1.25f);
  EXPECT_EQ(read->state, "state");
  const auto sightings = std::make_unique<Sightings>();
  ASSERT_TRUE(decode_sightings(read->results, *sightings).ok());
  EXPECT_EQ(sightings->robots[0].patches[0].center.v_px, 20.0f);
  EXPECT_EQ(sightings->robots[0].doubt, IdDoubt::kSeveralIds);
}

TEST(StepMessage, EachCutIsRefused) {
  std::string bytes;
  encode(*example_message(), bytes);
  const auto read = std::make_unique<StepMessage>();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode(bytes_of(bytes).first(size), *read).code(), ErrorCode::kCorruptFrame) << size;
  }
  EXPECT_EQ(decode(bytes_of(bytes + "x"), *read).code(), ErrorCode::kCorruptFrame);
}

// The bytes that differ between two messages of the same size are those of an enum, a bool or a number of a color;
// with 200 there the message is refused.
template <class Change>
void expect_bounds(const Change& change) {
  const auto message = example_message();
  std::string former, bytes;
  encode(*message, former);
  change(*message);
  encode(*message, bytes);
  ASSERT_EQ(bytes.size(), former.size());
  const auto differs = std::mismatch(bytes.begin(), bytes.end(), former.begin());
  ASSERT_NE(differs.first, bytes.end());
  const auto read = std::make_unique<StepMessage>();
  EXPECT_TRUE(decode(bytes_of(bytes), *read).ok());
  *differs.first = static_cast<char>(200);
  EXPECT_EQ(decode(bytes_of(bytes), *read).code(), ErrorCode::kCorruptFrame);
}

TEST(StepMessage, AByteThatIsNoValueOfItsEnumOrBoolIsRefused) {
  expect_bounds([](StepMessage& m) { m.header.kind = StepKind::kStop; });
  expect_bounds([](StepMessage& m) { m.header.picture = PictureKind::kJpeg; });
  expect_bounds([](StepMessage& m) { m.header.format = PixelFormat::kNv12; });
  expect_bounds([](StepMessage& m) { m.header.revoked = false; });
  expect_bounds([](StepMessage& m) { m.inputs.commands[0].kind = ExternalCommand::Kind::kWheels; });
  expect_bounds([](StepMessage& m) { m.inputs.situation.phase = GamePhase::kRunning; });
  expect_bounds([](StepMessage& m) { m.inputs.situation.restart = Restart::kFreeKick; });
  expect_bounds([](StepMessage& m) { m.inputs.events.adaptation_mode = AdaptationMode::kOff; });
  expect_bounds([](StepMessage& m) { m.inputs.observing = false; });
}

TEST(StepMessage, SightingsWithNumbersBeyondTheirTablesAreRefused) {
  const auto expect_refused = [](const auto& change) {
    const auto sightings = std::make_unique<Sightings>();
    RobotSighting robot;
    robot.patches.push_back({PatchRole::kIdentification, 2, 3, {10.0f, 20.0f}});
    sightings->robots.push_back(robot);
    change(sightings->robots[0]);
    StepResults results;
    write_results(*sightings, {}, {}, {}, results);
    const auto read = std::make_unique<Sightings>();
    EXPECT_EQ(decode_sightings(results, *read).code(), ErrorCode::kCorruptFrame);
  };
  expect_refused([](RobotSighting& robot) { robot.team = static_cast<Team>(2); });
  expect_refused([](RobotSighting& robot) { robot.doubt = static_cast<IdDoubt>(8); });
  expect_refused([](RobotSighting& robot) { robot.patches[0].role = static_cast<PatchRole>(2); });
  expect_refused([](RobotSighting& robot) { robot.patches[0].color = kMaxColors + 1; });
  expect_refused([](RobotSighting& robot) { robot.patches[0].patch = 200; });
}

// Recordings of the former version have neither drives nor a state.
TEST(StepMessage, TheFormerFormatIsRead) {
  const auto written = example_message();
  written->drives = {};
  written->state.clear();
  std::string bytes;
  encode(*written, bytes);
  std::size_t after_drives = sizeof(std::uint32_t);
  for (const std::string& part : written->results) after_drives += sizeof(std::uint32_t) + part.size();
  constexpr std::size_t kNoDrives = sizeof(std::int64_t) + sizeof(std::uint8_t) + sizeof(std::uint16_t);
  bytes.erase(bytes.size() - after_drives - kNoDrives, kNoDrives);
  bytes.resize(bytes.size() - sizeof(std::uint32_t));
  bytes[0] = kStepFormatWithoutState;
  const auto read = example_message();
  const Result<void> decoded = decode(bytes_of(bytes), *read);
  ASSERT_TRUE(decoded.ok()) << decoded.text();
  EXPECT_EQ(read->results, written->results);
  EXPECT_EQ(read->inputs.halt, written->inputs.halt);
  EXPECT_EQ(read->drives.lag_s, std::nullopt);
  EXPECT_TRUE(read->state.empty());
}

TEST(StepMessage, AnotherFormatIsNamed) {
  std::string bytes;
  encode(*example_message(), bytes);
  bytes[0] = 9;
  const auto read = std::make_unique<StepMessage>();
  const Result<void> decoded = decode(bytes_of(bytes), *read);
  EXPECT_EQ(decoded.code(), ErrorCode::kUnsupported);
  EXPECT_NE(decoded.text().find("format 9"), std::string::npos);
}

TEST(StepMessage, EveryByteOfTheResultsChangesTheHash) {
  const auto message = example_message();
  const auto hash_of = [](const StepResults& results) {
    hal::Fnv1a hash;
    add_to(hash, results);
    return hash.value();
  };
  const std::uint64_t former = hash_of(message->results);
  for (std::string& part : message->results) {
    ASSERT_FALSE(part.empty());
    part.back() = static_cast<char>(part.back() ^ 1);
    EXPECT_NE(hash_of(message->results), former);
    part.back() = static_cast<char>(part.back() ^ 1);
  }
  EXPECT_EQ(hash_of(message->results), former);
}

TEST(PictureMessage, ReturnsThePicture) {
  StepHeader step;
  step.width_px = 3;
  step.height_px = 2;
  const std::string pixels = "18 bytes of pixels";
  for (const PictureKind kind : {PictureKind::kJpeg, PictureKind::kRaw}) {
    step.picture = kind;
    std::string message;
    write_picture_head(step, 1'500'000'000, pixels.size(), message);
    EXPECT_EQ(message.size() % 4, 0U) << "the array's size is aligned";
    message += pixels;
    const auto found = picture_of(kind, bytes_of(message));
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(found->data()), found->size()), pixels);
    for (std::size_t size = 0; size < message.size(); ++size) {
      EXPECT_FALSE(picture_of(kind, bytes_of(message).first(size)).has_value()) << size;
    }
  }
}

}  // namespace
}  // namespace touchline::testing
