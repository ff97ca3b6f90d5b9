#include <cstdlib>
#include <memory>

#include "firmware/console/setup_link.h"
#include "tests/console/setup_relay_fixture.h"

namespace touchline::console {
namespace {

TEST_F(SetupRelayTest, WithoutTheProgramThePageIsToldHowToStartIt) {
  start();
  SocketPage page(port());
  EXPECT_EQ(json::parse(page.read().payload)["setup"], false);
  become_driver(page);
  const json answer = ask(page, "setup", R"("command":"begin")", 3);
  EXPECT_EQ(answer["ok"], false);
  EXPECT_NE(answer["error"].get<std::string>().find("systemctl start touchline-setup"), std::string::npos);
}

TEST_F(SetupRelayTest, AProgramThatComesLaterIsFoundAndThatItHasLeftIsSaid) {
  start();
  SocketPage page(port());
  peer = std::make_unique<SetupPeer>(setup_socket);
  ASSERT_TRUE(peer->accept());
  const json hello = peer->read().text;
  EXPECT_EQ(hello["camera"]["width_px"], 320);
  EXPECT_EQ(hello["camera"]["format"], "rgb24");
  EXPECT_TRUE(std::filesystem::path(hello["venue"].get<std::string>()).is_absolute());
  EXPECT_EQ(json::parse(SocketPage(port()).read().payload)["setup"], false) << "it has not said anything yet";
  peer->send(R"({"type":"setup","state":{}})");
  wait_for_program(page, true);
  EXPECT_EQ(json::parse(SocketPage(port()).read().payload)["setup"], true);
  peer->leave();
  wait_for_program(page, false);
  peer = std::make_unique<SetupPeer>(setup_socket);
  ASSERT_TRUE(peer->accept());
  peer->send(R"({"type":"setup","state":{}})");
  wait_for_program(page, true);
}

TEST_F(SetupRelayTest, OnlyTheDriverGivesCommandsAndGetsTheAnswer) {
  start_both();
  SocketPage driver(port()), watcher(port());
  wait_for_program(driver, true);
  become_driver(driver);
  watch_setup(watcher);
  const json refused = ask(watcher, "setup", R"("command":"save")", 7);
  EXPECT_EQ(refused["ok"], false);
  EXPECT_NE(refused["error"].get<std::string>().find("take over"), std::string::npos);
  driver.send_text(R"({"type":"setup","request":8,"command":"begin","name":"<script>"})");
  const json passed = peer->read_type("setup").text;
  EXPECT_EQ(passed["client"], 1);
  EXPECT_EQ(passed["request"], 8);
  EXPECT_EQ(passed["command"], "begin");
  EXPECT_EQ(passed["name"], "<script>");
  peer->send(R"({"type":"answer","client":1,"to":8,"ok":true,"result":{"rms_mm":1.5}})");
  EXPECT_EQ(read_answer(driver, 8)["result"]["rms_mm"], 1.5);
  // The watcher gets the state, and before it no answer to another client.
  peer->send(R"({"type":"setup","state":{"open":true}})");
  for (;;) {
    const json state = json::parse(watcher.read().payload);
    ASSERT_FALSE(state["type"] == "answer" && state["to"] == 8);
    if (state["type"] == "setup" && state["state"]["open"] == true) break;
  }
}

TEST_F(SetupRelayTest, AClientCannotSpeakInTheNameOfAnother) {
  start_both();
  SocketPage driver(port());
  wait_for_program(driver, true);
  become_driver(driver);
  // A parser takes the last of several members with the same name.
  for (const char* forged : {R"({"client":5,"type":"setup","request":3,"command":"save"})",
                             R"({"type":"setup","request":3,"command":"save","client":5})",
                             R"({"type":"setup","request":3,"command":"save","cl\u0069ent":5,"client":6})"}) {
    driver.send_text(forged);
    const SetupPeer::Message passed = peer->read_type("setup");
    EXPECT_EQ(passed.text["client"], 1);
    EXPECT_EQ(passed.text["command"], "save");
    peer->send(R"({"type":"answer","client":1,"to":3,"ok":true})");
    EXPECT_EQ(read_answer(driver, 3)["ok"], true);
  }
}

TEST_F(SetupRelayTest, WhoWatchesLaterGetsTheLastStateAtOnce) {
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  watch_setup(page);
  EXPECT_EQ(read_json(page, "setup")["state"]["open"], false);
  EXPECT_EQ(peer->read_type("watch").text["client"], 1);
}

TEST_F(SetupRelayTest, PicturesOfTheProgramArePassedOnAndNothingElseInBinary) {
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  watch_setup(page);
  std::string picture("TLPC\x01\x02\x00\x00\x00\x00\x00\x00\x2a\x00\x00\x00", 16);
  picture.resize(32, '\0');
  picture += "PNG";
  picture += std::string(std::size_t{3} * 2592 * 1944, 'x');  // picture of the largest camera
  peer->send(R"({"type":"binary"})", picture);
  for (;;) {
    const SocketMessage message = page.read();
    ASSERT_NE(message.opcode, 0);
    if (message.opcode == 2) {
      EXPECT_EQ(message.payload, picture);
      break;
    }
  }
  picture[5] = 1;  // pictures of the camera come only from the camera
  peer->send(R"({"type":"binary"})", picture);
  wait_for_program(page, false);
  EXPECT_TRUE(eventually([&] { return is_in_log("wrong header"); }));
}

TEST_F(SetupRelayTest, ARequestWhoseProgramDiesIsAnswered) {
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  become_driver(page);
  page.send_text(R"({"type":"setup","request":9,"command":"colors.find"})");
  EXPECT_EQ(peer->read_type("setup").text["request"], 9);
  peer->send_bytes(length_bytes(500) + length_bytes(0) + "{\"type\":");
  peer->hang_up();
  const json answer = read_answer(page, 9);
  EXPECT_EQ(answer["ok"], false);
  EXPECT_NE(answer["error"].get<std::string>().find("within a message"), std::string::npos);
}

TEST_F(SetupRelayTest, MalformedMessagesEndTheConnectionAndTheNextOneWorks) {
  start_both();
  SocketPage page(port());
  const std::string too_long = length_bytes(kMaxSetupTextBytes + 1) + length_bytes(0);
  const std::string too_much = length_bytes(2) + length_bytes(kMaxSetupBinaryBytes + 1);
  const auto framed = [](std::string_view text) {
    return length_bytes(static_cast<std::uint32_t>(text.size())) + length_bytes(0) + std::string(text);
  };
  for (const std::string& bytes : {too_long, too_much, framed("{"), framed("[1]"), framed(R"({"type":5})"),
                                   framed("{\"type\":\"a\xff\"}"), framed("")}) {
    wait_for_program(page, true);
    peer->send_bytes(bytes);
    EXPECT_TRUE(peer->read_type("nothing").text.is_null()) << "the firmware ends the connection";
    wait_for_program(page, false);
    ASSERT_TRUE(peer->accept());
    peer->send(R"({"type":"setup","state":{}})");
  }
  wait_for_program(page, true);
}

TEST_F(SetupRelayTest, AHalfOpenConnectionIsEnded) {
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  peer->end_sending();
  wait_for_program(page, false);
}

TEST_F(SetupRelayTest, AProgramThatSaysNothingIsNotRunning) {
  peer = std::make_unique<SetupPeer>(setup_socket);
  start();
  ASSERT_TRUE(peer->accept());
  EXPECT_TRUE(eventually([&] { return is_in_log("it does not answer"); }));
}

TEST_F(SetupRelayTest, CameraPicturesComeAsManyAsAskedForAndNotTooFast) {
  start_both();
  peer->send(R"({"type":"frames","count":3})");
  double last_s = 0;
  for (int i = 0; i < 3; ++i) {
    const SetupPeer::Message frame = peer->read_type("frame");
    ASSERT_FALSE(frame.text.is_null());
    EXPECT_EQ(frame.text["width_px"], 320);
    EXPECT_EQ(frame.text["height_px"], 240);
    EXPECT_EQ(frame.text["format"], "rgb24");
    EXPECT_EQ(frame.text["planes"][0]["stride_bytes"], 960);
    EXPECT_EQ(frame.text["planes"][0]["rows"], 240);
    ASSERT_EQ(frame.binary.size(), 3U * 320 * 240);
    EXPECT_EQ(static_cast<unsigned char>(frame.binary[700]), 100) << "the fixture's pixels";
    // 0.2 s, less the inaccuracy of both clocks. A busy machine makes the distance larger.
    const auto captured_s = frame.text["captured_s"].get<double>();
    EXPECT_GE(captured_s, last_s + 0.18);
    last_s = captured_s;
  }
  EXPECT_EQ(pictures_copied, 3U);
}

TEST_F(SetupRelayTest, OnlyTheDriverMaySendLongMessages) {
  start_both();
  SocketPage driver(port()), watcher(port());
  wait_for_program(driver, true);
  become_driver(driver);
  const std::string part(60000, 'p');
  driver.send_text(R"({"type":"setup","command":"import","part":")" + part + "\"}");
  EXPECT_EQ(peer->read_type("setup").text["part"].get<std::string>(), part);
  watcher.send_text(R"({"type":"setup","command":"import","part":")" + part + "\"}");
  for (SocketMessage message = watcher.read(); message.opcode != 0; message = watcher.read()) {
    if (message.opcode != 8) continue;
    EXPECT_EQ(message.close_code(), 1009);
    return;
  }
  FAIL() << "the connection ended without a reason";
}

TEST_F(SetupRelayTest, AProgramThatDoesNotReadIsLostAndTheConsoleGoesOn) {
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  become_driver(page);
  const std::string part(60000, 'p');
  // more than the kernel buffers
  for (int i = 0; i < 60; ++i) {
    page.send_text(R"({"type":"setup","command":"import","part":")" + part + "\"}");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the server's limit is 100 a second
  }
  wait_for_program(page, false);
  EXPECT_TRUE(is_in_log("it does not read its messages"));
  EXPECT_EQ(ask(page, "stop", {}, 99)["ok"], true);
}

TEST_F(SetupRelayTest, WithADraftRobotsStandExceptOneThatIsDrivenAndATry) {
  std::atomic<int> drafts{0};
  use_files = [this, &drafts](const config::FilePaths& files, std::uint64_t order) -> Result<FilesUse> {
    drafts += files.board == "/draft/board.toml" ? 1 : 0;
    begin_session_later(!files.board.empty(), true, {}, order);
    return FilesUse::kInNextSession;
  };
  start_both();
  SocketPage driver(port());
  wait_for_program(driver, true);
  become_driver(driver);
  EXPECT_EQ(input().setup, SetupWish::kNone);
  peer->send(R"({"type":"use","request":4,"source":"draft","board":"/draft/board.toml"})");
  const json used = peer->read_type("used").text;
  EXPECT_EQ(used["to"], 4);
  EXPECT_EQ(used["ok"], true);
  EXPECT_EQ(drafts, 1);
  EXPECT_EQ(read_json(driver, "hello")["using"], "draft");
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; }));

  driver.send_text(text_of("drive", R"("id":1,"speed_mps":0.5,"turn_radps":0)"));
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  const ConsoleInput driven = input();
  EXPECT_EQ(driven.commands.size(), 5U) << "every own robot has a command";
  for (const ExternalCommand& command : driven.commands) {
    EXPECT_EQ(command.twist.v_mps, command.id == 1 ? 0.5f : 0.0f);
  }
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; })) << "0.3 s later";

  peer->send(R"({"type":"try","request":5,"on":true})");
  EXPECT_EQ(peer->read_type("tried").text["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  EXPECT_EQ(ask(driver, "stop", {}, 6)["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand && input().stop; })) << "a stop ends a try";
  const json ended = peer->read_type("tried").text;
  EXPECT_EQ(ended["ok"], false) << "and the program is told";
  EXPECT_EQ(ended["error"], "a stop ended the try");
  EXPECT_EQ(ask(driver, "start", stop_in_force(), 7)["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand && !input().stop; }));

  peer->send(R"({"type":"try","request":8,"on":true})");
  EXPECT_EQ(peer->read_type("tried").text["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  peer->send(R"({"type":"use","request":9,"source":"draft","board":"/draft/board.toml"})");
  const json changed = peer->read_type("tried").text;
  EXPECT_EQ(changed["to"], 0);
  EXPECT_EQ(changed["error"], "the files have changed");
  EXPECT_EQ(peer->read_type("used").text["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; })) << "other files end a try";

  peer->send(R"({"type":"try","request":10,"on":true})");
  EXPECT_EQ(peer->read_type("tried").text["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kPermit; }));
  peer->leave();
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; })) << "nobody watches over the draft";
  EXPECT_EQ(ask(driver, "use_saved", {}, 9)["ok"], true);
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kNone && input().stop; })) << "until Start";
  EXPECT_TRUE(input().setup_ended) << "nobody has pressed Stop";
}

TEST_F(SetupRelayTest, ATryWhileFilesAreBeingLoadedIsRefused) {
  std::atomic<bool> loads{false};
  use_files = [&](const config::FilePaths& /*files*/, std::uint64_t /*order*/) -> Result<FilesUse> {
    loads = true;
    return FilesUse::kInNextSession;
  };
  start_both();
  peer->send(R"({"type":"use","request":4,"source":"draft","board":"/draft/board.toml"})");
  EXPECT_TRUE(eventually([&] { return loads.load(); }));
  peer->send(R"({"type":"try","request":5,"on":true})");
  const json tried = peer->read_type("tried").text;
  EXPECT_EQ(tried["ok"], false);
  EXPECT_EQ(tried["error"], "other files are being loaded");
}

TEST_F(SetupRelayTest, ADraftThatTheRunningSessionAdoptsIsAnsweredAtOnce) {
  use_files = [](const config::FilePaths& /*files*/, std::uint64_t /*order*/) -> Result<FilesUse> {
    return FilesUse::kAtOnce;
  };
  start_both();
  // Done twice, to check that the first order does not stay open.
  for (const char* request : {"4", "5"}) {
    peer->send(std::string(R"({"type":"use","source":"draft","board":"/draft/board.toml","request":)") + request + "}");
    const json used = peer->read_type("used").text;
    EXPECT_EQ(used["ok"], true);
    EXPECT_EQ(used["calibrated"], true);
  }
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; }));
}

// A camera that was absent appears while the draft is being loaded: its session comes first.
TEST_F(SetupRelayTest, ASessionThatWasNotOrderedAnswersNoOrder) {
  std::atomic<std::uint64_t> order{0};
  use_files = [&](const config::FilePaths& /*files*/, std::uint64_t number) -> Result<FilesUse> {
    order = number;
    return FilesUse::kInNextSession;
  };
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  peer->send(R"({"type":"use","request":4,"source":"draft","board":"/draft/board.toml"})");
  EXPECT_TRUE(eventually([&] { return order != 0; }));
  begin_session_later(false, true);
  EXPECT_EQ(read_json(page, "hello")["using"], "saved");
  peer->send(R"({"type":"use","request":5,"source":"saved"})");
  const json second = peer->read_type("used").text;
  EXPECT_EQ(second["to"], 5);
  EXPECT_EQ(second["error"], "other files are being loaded");
  EXPECT_EQ(input().setup, SetupWish::kStand) << "the draft is on its way";

  begin_session_later(true, true, {}, order);
  const json used = peer->read_type("used").text;
  EXPECT_EQ(used["to"], 4);
  EXPECT_EQ(used["ok"], true);
  EXPECT_EQ(read_json(page, "hello")["using"], "draft");

  // The answer to an order whose devices cannot be opened comes from the session with the saved files.
  const std::uint64_t first = order;
  peer->send(R"({"type":"use","request":6,"source":"draft","board":"/draft/board.toml"})");
  EXPECT_TRUE(eventually([&] { return order != first; }));
  begin_session_later(false, true, "camera: /dev/video0: no such device", order);
  const json refused = peer->read_type("used").text;
  EXPECT_EQ(refused["to"], 6);
  EXPECT_EQ(refused["error"], "camera: /dev/video0: no such device");
}

TEST_F(SetupRelayTest, ADraftThatCannotBeUsedLeavesRobotsStopped) {
  use_files = [](const config::FilePaths& /*files*/, std::uint64_t /*order*/) {
    return failure(ErrorCode::kNotFound, "/draft: no such file");
  };
  start_both();
  SocketPage page(port());
  peer->send(R"({"type":"use","request":4,"source":"draft","board":"/draft/board.toml"})");
  const json used = peer->read_type("used").text;
  EXPECT_EQ(used["ok"], false);
  EXPECT_EQ(used["error"], "/draft: no such file");
  EXPECT_TRUE(eventually([&] { return input().setup == SetupWish::kStand; }));
  EXPECT_TRUE(is_in_log("/draft: no such file"));
  peer->send(R"({"type":"try","request":5,"on":true})");
  EXPECT_EQ(peer->read_type("tried").text["ok"], false);
}

TEST_F(SetupRelayTest, WithoutCalibrationNothingMoves) {
  use_files = [this](const config::FilePaths& files, std::uint64_t order) -> Result<FilesUse> {
    begin_session_later(!files.board.empty(), false, {}, order);
    return FilesUse::kInNextSession;
  };
  start_both();
  SocketPage page(port());
  wait_for_program(page, true);
  peer->send(R"({"type":"use","request":4,"source":"draft","board":"/draft/board.toml"})");
  EXPECT_EQ(peer->read_type("used").text["calibrated"], false);
  EXPECT_EQ(read_json(page, "hello")["calibrated"], false);
  peer->send(R"({"type":"try","request":5,"on":true})");
  EXPECT_EQ(peer->read_type("tried").text["ok"], false);
  EXPECT_EQ(input().setup, SetupWish::kStand);
}

}  // namespace
}  // namespace touchline::console
