#include <gtest/gtest.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>

#include "tests/console/server_fixture.h"

namespace touchline::console {
namespace {

class WebAccess : public ConsoleServer {
 protected:
  [[nodiscard]] std::string own_origin() const { return "Origin: http://127.0.0.1:" + std::to_string(port()) + "\r\n"; }
};

TEST_F(WebAccess, RequestsUnderOtherNamesAreRefused) {
  start();
  EXPECT_EQ(get(port(), "/").status, 200);
  for (const char* const path : {"/", "/snapshot.jpg", "/stream.mjpg", "/metrics", "/login"}) {
    const HttpAnswer answer = get(port(), path, "Host: evil.example\r\n");
    EXPECT_EQ(answer.status, 403) << path;
  }
  EXPECT_NE(SocketPage(port(), "Host: evil.example:8642\r\n").status(), 101);
  EXPECT_EQ(SocketPage(port(), "Host: localhost\r\n").status(), 101);
}

TEST_F(WebAccess, RequestsOfOtherSitesAreRefused) {
  start();
  for (const char* const origin : {"http://evil.example", "null", "http://127.0.0.1:1", "http://localhost"}) {
    const std::string header = "Origin: " + std::string(origin) + "\r\n";
    EXPECT_NE(SocketPage(port(), header).status(), 101) << origin;
    EXPECT_EQ(get(port(), "/metrics", header).status, 403) << origin;
  }
  EXPECT_NE(SocketPage(port(), "Origin: http://" + std::string(3000, 'a') + "\r\n").status(), 101);
  EXPECT_EQ(SocketPage(port(), own_origin()).status(), 101);
  EXPECT_EQ(get(port(), "/snapshot.jpg", "Sec-Fetch-Site: cross-site\r\n").status, 403);
  EXPECT_EQ(get(port(), "/", "Sec-Fetch-Site: cross-site\r\n").status, 200) << "a link";
  EXPECT_EQ(get(port(), "/snapshot.jpg", "Sec-Fetch-Site: same-origin\r\n").status, 200);
}

TEST_F(WebAccess, OnlyThePathAndTheSubprotocolOfTheConsoleOpenASocket) {
  start();
  EXPECT_NE(SocketPage(port(), "", "/other").status(), 101);
  EXPECT_NE(SocketPage(port(), "", "/ws", "touchline.9").status(), 101);
  EXPECT_NE(SocketPage(port(), "", "/ws", "").status(), 101);
  EXPECT_NE(SocketPage(port(), "", "/ws", "http").status(), 101);
}

TEST_F(WebAccess, OnlyGetAndHeadArePossible) {
  start();
  EXPECT_EQ(get(port(), "/", "Content-Length: 0\r\n", "POST").status, 405);
  const HttpAnswer head = get(port(), "/", "", "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(get(port(), "/", "Host: evil.example\r\n", "HEAD").status, 403);
}

TEST_F(WebAccess, EveryAnswerForbidsOtherSites) {
  start();
  for (const char* const path : {"/", "/metrics", "/nothing", "/snapshot.jpg"}) {
    const HttpAnswer answer = get(port(), path);
    for (const char* const header : {"content-security-policy: default-src 'self'", "frame-ancestors 'none'",
                                     "x-content-type-options: nosniff", "cross-origin-resource-policy: same-origin"}) {
      EXPECT_NE(answer.head.find(header), std::string::npos) << path << ": " << answer.head;
    }
  }
}

TEST_F(WebAccess, TheTokenIsExchangedForACookie) {
  settings.access.token = std::string(64, 'a');
  start();
  EXPECT_EQ(get(port(), "/login?token=" + std::string(64, 'b')).status, 403);
  EXPECT_EQ(get(port(), "/login?token=").status, 403);
  EXPECT_EQ(get(port(), "/login").status, 403);
  const HttpAnswer answer = get(port(), "/login?token=" + settings.access.token);
  EXPECT_EQ(answer.status, 200);
  EXPECT_NE(answer.head.find("set-cookie: touchline_token=" + settings.access.token + "; Path=/;"), std::string::npos)
      << answer.head;
  EXPECT_NE(answer.head.find("HttpOnly; SameSite=Strict"), std::string::npos);
}

TEST_F(WebAccess, WithoutAPageTheServerSaysHowToBuildIt) {
  start();
  const HttpAnswer answer = get(port(), "/");
  EXPECT_EQ(answer.status, 200);
  EXPECT_NE(answer.body.find("tools/console"), std::string::npos);
}

TEST_F(WebAccess, FilesOfThePageAreServedAndNothingElse) {
  const std::filesystem::path above = ::testing::TempDir() + "console-web-" + std::to_string(::getpid());
  std::filesystem::create_directories(above / "dist/assets");
  std::ofstream(above / "secret.txt") << "secret";
  std::ofstream(above / "dist/index.html") << "<p>page</p>";
  std::ofstream(above / "dist/assets/a.js") << std::string(200000, 'x');
  settings.page_folder = (above / "dist").string();
  start();
  EXPECT_EQ(get(port(), "/").body, "<p>page</p>");
  const HttpAnswer code = get(port(), "/assets/a.js");
  EXPECT_EQ(code.body.size(), 200000U);
  EXPECT_NE(code.head.find("immutable"), std::string::npos) << code.head;
  for (const char* const path : {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
                                 "/assets/%2e%2e/%2e%2e/secret.txt", "//secret.txt", "/./../secret.txt",
                                 "/assets/..\\..\\secret.txt", "/secret.txt%00.js"}) {
    const HttpAnswer answer = get(port(), path);
    EXPECT_NE(answer.status, 200) << path;
    EXPECT_EQ(answer.body.find("secret"), std::string::npos) << path;
  }
  std::filesystem::remove_all(above);
}

}  // namespace
}  // namespace touchline::console
