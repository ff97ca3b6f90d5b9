// Requests to an arena in another process.
#include "firmware/remote_arena.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <string>
#include <thread>

#include "firmware/arena_objects.h"
#include "hal/linux/network/tcp_socket.h"
#include "hal/linux/network/udp_socket.h"

namespace touchline {
namespace {

class RemoteArenaTest : public ::testing::Test {
 protected:
  RemoteArenaTest() {
    Result<hal::Descriptor> socket = hal::udp_socket("test");
    EXPECT_TRUE(socket.ok());
    socket_ = std::move(socket).value();
    const sockaddr_in at = hal::socket_address(INADDR_LOOPBACK, 0);
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
    address_.ipv4 = INADDR_LOOPBACK;
    address_.port = hal::local_port(socket_);
  }
  // Answers one request, which it returns.
  std::string answer(const std::string& text) {
    std::array<char, 1000> request{};
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    ssize_t count = -1;
    while (count < 0) {
      count = ::recvfrom(socket_.get(), request.data(), request.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    }
    ::sendto(socket_.get(), text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&from), size);
    return {request.data(), static_cast<std::size_t>(count)};
  }

  hal::Descriptor socket_;
  hal::NetworkAddress address_;
};

TEST_F(RemoteArenaTest, PassesRequestsOnAndReturnsWhatIsWrong) {
  ArenaObjects objects;
  objects.attach(address_);
  ArenaRequest request;
  request.text = R"({"reset":{"seed":2}})";
  std::string got;
  for (const std::string text : {"ok", "the ball is in the way"}) {
    std::thread arena([&] { got = answer(text); });
    const Result<void> done = objects.control(request);
    arena.join();
    EXPECT_EQ(got, request.text);
    EXPECT_EQ(done.ok(), text == "ok");
    EXPECT_EQ(done.ok() ? "ok" : done.text(), text);
  }
  objects.detach();
  EXPECT_EQ(objects.control(request).code(), ErrorCode::kUnsupported) << "the next session's field is real";
}

TEST_F(RemoteArenaTest, AnAnswerThatIsLateIsNotThatOfTheNextRequest) {
  RemoteArena arena(address_);
  EXPECT_EQ(arena.ask("{}").code(), ErrorCode::kTimeout);
  EXPECT_EQ(answer("too late"), "{}");
  std::thread next([&] { answer("ok"); });
  EXPECT_TRUE(arena.ask("{}").ok());
  next.join();
}

TEST_F(RemoteArenaTest, ReportsThatNobodyListens) {
  RemoteArena arena(address_);
  socket_.reset();
  const Result<void> done = arena.ask("{}");
  EXPECT_EQ(done.code(), ErrorCode::kNotFound);
  EXPECT_NE(std::string(done.text()).find("touchline-arena serve --control"), std::string::npos) << done.text();
}

}  // namespace
}  // namespace touchline
