// Programs at a stream socket: one or two of them own the time; silence, early ends and wrong messages.
#include "tools/programs/simulate/lockstep_server.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace touchline::simulate {
namespace {

using nlohmann::json;

// A program at the other end of the socket.
class Program {
 public:
  explicit Program(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    const timeval limit{20, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
  }
  void tell(const std::string& text) {
    const std::string line = text + "\n";
    EXPECT_EQ(::send(socket_.get(), line.data(), line.size(), MSG_NOSIGNAL), static_cast<ssize_t>(line.size()));
  }
  // Returns the next line; null if the connection was closed.
  json hear() {
    for (;;) {
      if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
        const json line = json::parse(received_.substr(0, end));
        received_.erase(0, end + 1);
        return line;
      }
      std::array<char, 4096> bytes;
      const ssize_t size = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
      if (size <= 0) return nullptr;
      received_.append(bytes.data(), static_cast<std::size_t>(size));
    }
  }
  json ask(const std::string& text) {
    tell(text);
    return hear();
  }
  void close() { socket_.reset(); }

 private:
  hal::Descriptor socket_;
  std::string received_;
};

// Serves on a thread of its own.
class Served {
 public:
  explicit Served(double silence_s = 20.0) : game_(TOUCHLINE_BOARDS "/mock/board.toml", {}), server_(game_, silence_s) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("lockstep-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    path_ = folder / "socket";
    const Result<StreamAddress> address = parse_stream_address("unix://" + path_);
    EXPECT_TRUE(address.ok() && server_.open(address.value()).ok());
    thread_ = std::thread([this] { result_ = server_.serve(); });
  }
  ~Served() {
    if (thread_.joinable()) thread_.join();
    std::filesystem::remove_all(std::filesystem::path(path_).parent_path());
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  Result<void> result() {
    thread_.join();
    return *result_;
  }

 private:
  LockstepGame game_;
  LockstepServer server_;
  std::string path_;
  std::optional<Result<void>> result_;
  std::thread thread_;
};

TEST(LockstepServer, AnswersEachMessageAndGoesOnAfterErrors) {
  Served served;
  Program program(served.path());
  EXPECT_EQ(program.ask(R"({"step": {}})"), (json{{"error", "there is no game yet; send a reset first"}}));
  const json begun = program.ask(R"({"reset": {"robots": 2}})");
  EXPECT_EQ(begun["reset"]["robots"]["blue"], (json{0, 1}));
  EXPECT_EQ(begun["reset"]["opponent"], "yellow");
  EXPECT_EQ(program.ask("{")["error"], "the message is not a JSON object");
  EXPECT_EQ(program.ask("\xff\xfe")["error"], "the message is not a JSON object");
  EXPECT_EQ(program.ask(R"({"step": {"commands": [{"id": 1, "v": 99, "w": 0}]}})")["error"],
            "step.commands: commands[0].v = 99 is not within -10 to 10");
  EXPECT_EQ(program.ask(R"({"step": {"frames": 3}})")["frames"].size(), 3u);
  EXPECT_EQ(program.ask(R"({"throw": {"vx": 0.5}})"), (json{{"done", "place"}}));
  EXPECT_EQ(program.ask(R"({"hash": {}})")["hash"].get<std::string>().size(), 16u);
  // Several messages at once are answered in their order.
  program.tell("{\"step\": {}}\n{\"hash\": {}}\n{\"step\": {}}");
  EXPECT_EQ(program.hear()["frames"][0]["frame"], 3);
  EXPECT_TRUE(program.hear().contains("hash"));
  EXPECT_EQ(program.hear()["frames"][0]["frame"], 4);
  program.close();
  EXPECT_TRUE(served.result().ok());
}

// Time waits for both programs, so the order in which they answer does not matter.
TEST(LockstepServer, TwoProgramsGiveTheSameGameWhoeverIsFaster) {
  const auto play = [](bool opponent_first) {
    Served served;
    Program own(served.path());
    EXPECT_TRUE(
        own.ask(R"({"reset": {"robots": 2, "opponent": "program", "robots_return": false}})").contains("reset"));
    Program opponent(served.path());
    EXPECT_TRUE(opponent.ask(R"({"step": {}})").contains("reset")) << "its first step tells it that there is a game";
    for (int i = 0; i < 20; ++i) {
      const std::string ahead = R"({"step": {"commands": [{"id": 0, "v": 0.4, "w": 0.5}]}})";
      (opponent_first ? opponent : own).tell(ahead);
      (opponent_first ? own : opponent).tell(ahead);
      EXPECT_EQ(own.hear()["frames"][0]["side"]["team"], "blue");
      EXPECT_EQ(opponent.hear()["frames"][0]["side"]["team"], "yellow");
    }
    const json hash = own.ask(R"({"hash": {}})");
    EXPECT_EQ(opponent.ask(R"({"reset": {}})")["error"],
              "the opponents' program can only send steps; the first program does the rest");
    // A new game ends the step that waits.
    opponent.tell(R"({"step": {}})");
    EXPECT_TRUE(own.ask(R"({"reset": {"opponent": "program"}})").contains("reset"));
    EXPECT_TRUE(opponent.hear().contains("reset"));
    own.close();
    return hash;
  };
  EXPECT_EQ(play(true), play(false));
}

TEST(LockstepServer, ASilentProgramEndsTheGame) {
  Served served(0.05);
  Program program(served.path());
  EXPECT_TRUE(program.ask(R"({"reset": {}})").contains("reset"));
  EXPECT_EQ(program.hear(),
            (json{{"error", "the program was silent for 0.05 s; the game has ended"}, {"ended", true}}));
  EXPECT_EQ(served.result().code(), ErrorCode::kTimeout);
}

TEST(LockstepServer, ASilentOpponentEndsTheGameOfBoth) {
  Served served(0.3);
  Program own(served.path());
  EXPECT_TRUE(own.ask(R"({"reset": {"opponent": "program", "robots": 1}})").contains("reset"));
  Program opponent(served.path());
  EXPECT_TRUE(opponent.ask(R"({"step": {}})").contains("reset"));
  own.tell(R"({"step": {}})");
  const json said{{"error", "the opponents' program was silent for 0.3 s; the game has ended"}, {"ended", true}};
  EXPECT_EQ(own.hear(), said);
  EXPECT_EQ(opponent.hear(), said);
  EXPECT_EQ(served.result().code(), ErrorCode::kTimeout);
}

TEST(LockstepServer, AnOpponentThatEndsEndsTheGame) {
  Served served;
  Program own(served.path());
  EXPECT_TRUE(own.ask(R"({"reset": {"opponent": "program", "robots": 1}})").contains("reset"));
  Program opponent(served.path());
  EXPECT_TRUE(opponent.ask(R"({"step": {}})").contains("reset"));
  own.tell(R"({"step": {}})");
  opponent.close();
  EXPECT_EQ(own.hear(), (json{{"error", "the opponents' program has ended, and with it the game"}, {"ended", true}}));
  EXPECT_EQ(served.result().code(), ErrorCode::kDisconnected);
}

TEST(LockstepServer, AMessageWithoutEndIsAnError) {
  Served served;
  Program program(served.path());
  program.tell(std::string(2 * kMaxLockstepBytes, ' '));
  EXPECT_EQ(program.hear(), (json{{"error", "a message of the program is longer than 65536 bytes"}, {"ended", true}}));
  EXPECT_EQ(served.result().code(), ErrorCode::kOutOfRange);
}

TEST(LockstepServer, AddressesAreUnixOrTcp) {
  EXPECT_EQ(parse_stream_address("tcp://127.0.0.1:20013").value().text(), "tcp://127.0.0.1:20013");
  EXPECT_EQ(parse_stream_address("unix:///tmp/game").value().text(), "unix:///tmp/game");
  EXPECT_EQ(parse_stream_address("udp://127.0.0.1:1").text(),
            "\"udp://127.0.0.1:1\" is not an address: write unix:///PATH or tcp://ADDRESS:PORT");
  EXPECT_FALSE(parse_stream_address("tcp://127.0.0.1").ok());
}

}  // namespace
}  // namespace touchline::simulate
